//! Full expansions on one element and on several: against an independent projection, direct quadrature, and the paper's
//! table.

use crate::support::reproduction::TABLE_2;
use crate::support::{model_sample, repository, text};
use nalgebra::Complex;
use pcc_compile::compilation::{build, build_with};
use pcc_compile::mechanics::model::{Model, ModelError};
use pcc_compile::mechanics::spectrum::Modes;
use pcc_compile::reference::ModelSample;
use pcc_compile::study::Study;
use pcc_evaluate::artifact::{Format, decode, encode, read};
use pcc_evaluate::evaluation::monte_carlo;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::surrogate::{StopReason, Surrogate};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Double precision against 50 digits, rounded once; eigenvalues are accurate to 1e-11 next to coalescence.
const PROJECTION_TOLERANCE: f64 = 1e-10;

/// Half the points of the documented study, `pcc reproduce --runs 1000000`: they leave errors of the size of the bars
/// below open by 0.02 %, 10⁵ of them by 0.04 %.
const POINTS: u64 = 500_000;

fn study(inputs: usize, kind: &str, lines: &str) -> Study {
    Study::from_toml(&format!("{}\n{lines}", text(&format!("surrogates/clutch-r{inputs}{kind}.toml")))).unwrap()
}

fn gpc(inputs: usize, degree: u16) -> Study {
    study(inputs, "-eigenvalues", &format!("[fit]\nmethod = \"gpc\"\nmax_degree = {degree}\n"))
}

fn multi_element(inputs: usize, elements: usize) -> Study {
    let lines = format!("[fit]\nmethod = \"me-gpc\"\ntheta_1 = 0.0\nelements = {elements}\n");
    study(inputs, "-eigenvalues", &lines)
}

/// Error of the proportion in percent.
fn error(sample: &ModelSample<'_>, surrogate: &Surrogate) -> f64 {
    sample.compare(surrogate).unwrap().relative_error_percent().unwrap()
}

/// `tests/data/tensor_quadrature.csv` is computed with mpmath from the definitions alone.
#[test]
fn quadrature_equals_an_independent_projection() {
    let data = text("tests/data/tensor_quadrature.csv");
    let mut lines = data.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').skip(2).collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    for inputs in 1..=4 {
        let invariants = Study {
            spectrum: pcc_compile::study::SpectrumSettings {
                noise: 0.0,
                modes: Modes::Ranks(vec![3, 4]),
                ..study(inputs, "", "").spectrum.clone()
            },
            ..study(inputs, "", "[fit]\nmethod = \"gpc\"\nmax_degree = 6\n")
        };
        let surrogates = [gpc(inputs, 6), invariants].map(|study| build(&study, &Silent).unwrap());
        let own: Vec<&Vec<&str>> = rows.iter().filter(|row| row[0] == inputs.to_string()).collect();
        assert_eq!(own.len(), surrogates[0].expansions[0].indices.len());
        let mut compared = 0;
        for surrogate in &surrogates {
            for component in surrogate.components() {
                let known = component.name.strip_suffix("_3_4").unwrap_or(&component.name);
                let column = 2 + names.iter().position(|name| *name == known).unwrap();
                let expansion = surrogate.expansion(0, component.id);
                for row in &own {
                    let alpha: Vec<u16> = row[1].split(' ').map(|degree| degree.parse().unwrap()).collect();
                    let at = expansion.indices.iter().position(|known| known[..] == alpha[..]).unwrap();
                    let (found, expected) = (component.scale * expansion.coefficients[at], row[column].parse::<f64>());
                    let difference = (found - expected.unwrap()).abs();
                    assert!(difference <= PROJECTION_TOLERANCE, "r = {inputs}, {known}, {alpha:?}: {difference:e}");
                    compared += 1;
                }
            }
        }
        assert_eq!(compared, 8 * own.len());
    }
}

/// The paper's value for r = 2 is a misprint.
#[test]
fn full_expansions_are_as_wrong_as_in_the_paper() {
    for (inputs, degree, paper) in
        [(1, 6, 6.45), (3, 6, 6.45), (4, 6, 7.54), (5, 5, 8.04), (6, 3, 26.85), (7, 2, 43.84), (8, 2, 43.88)]
    {
        let study = gpc(inputs, degree);
        let surrogate = build(&study, &Silent).unwrap();
        let runs = u64::from(degree + 1).pow(inputs as u32);
        assert_eq!(surrogate.training.counts.direct_computations, runs);
        let found = TABLE_2.full(inputs, "gpc", runs).error();
        let factor = (found / paper).max(paper / found);
        assert!(factor <= 1.4, "r = {inputs}: {found} % against {paper} %");
    }
}

#[test]
fn elements_reach_the_papers_errors_with_its_numbers_of_elements() {
    let rows: [(usize, &[(usize, f64)]); 6] = [
        (2, &[(14, 0.18), (26, 0.18)]),
        (3, &[(14, 0.227), (28, 0.227)]),
        (4, &[(8, 1.22), (12, 0.59)]),
        (5, &[(14, 1.68), (24, 0.59)]),
        (6, &[(6, 1.04), (7, 1.04)]),
        (7, &[(4, 2.45)]),
    ];
    for (inputs, of_inputs) in rows {
        for &(elements, paper) in of_inputs {
            let surrogate = build(&multi_element(inputs, elements), &Silent).unwrap();
            let counts = surrogate.training.counts;
            assert_eq!(surrogate.mesh.elements().len(), elements);
            assert_eq!(counts.final_mesh, elements as u64 * 3u64.pow(inputs as u32));
            assert!(counts.direct_computations > counts.final_mesh, "divided elements were run, too");
            let row = TABLE_2.full(inputs, "me-gpc", counts.final_mesh);
            assert_eq!(row.direct_computations, counts.direct_computations);
            let (found, bar) = (row.error(), (3.0 * paper).max(0.3));
            assert!(found <= bar, "r = {inputs}, {elements} elements: {found} %, more than {bar} %");
        }
    }
}

/// So few points are misclassified that many are needed. The shipped surrogate stands for the model on them, and its
/// own distance from the model is added, which is so small that fewer points tell it.
#[test]
fn full_expansions_of_invariants_need_only_degree_3() {
    let shipped = read(&repository("surrogates/clutch-r8.pcc")).unwrap().surrogate;
    let stable = |surrogate: &Surrogate| monte_carlo(surrogate, POINTS, 1, &Silent).unwrap().stable as f64;
    let (expected, own_error) = (stable(&shipped), error(model_sample(8), &shipped));
    for (lines, runs, bar) in [("derivatives = false", 330, 0.1), ("", 37, 0.15)] {
        let lines = format!("[fit]\nmethod = \"gpc\"\nsolver = \"least-squares\"\nmax_degree = 3\n{lines}\n");
        let surrogate = build(&study(8, "", &lines), &Silent).unwrap();
        assert_eq!(surrogate.training.counts.direct_computations, runs);
        assert_eq!(surrogate.expansions[0].indices.len(), 165);
        let found = 100.0 * (stable(&surrogate) / expected - 1.0).abs() + own_error;
        println!("{runs} runs: {found} %, {own_error} % of it by the shipped surrogate");
        assert!(found <= bar, "{runs} runs: {found} %, {own_error} % of it by the shipped surrogate");
    }
}

/// One mode whose growth rate is a polynomial of degree 2 on each side of ξ₁ = 0 and jumps there; counts its runs.
struct Jump(Arc<AtomicU64>);

fn growth_rate(xi: [f64; 2]) -> f64 {
    let [x, y] = xi;
    if x < 0.0 { 1.0 + x + 0.5 * y * y } else { -2.0 * x * x + x * y - 0.25 }
}

impl Model for Jump {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        self.0.fetch_add(1, Ordering::Relaxed);
        let re = growth_rate([4.0 * point[0] - 1.0, (point[1] - 16e6) / 0.8e6]);
        Ok(vec![Complex::new(re, 10.0), Complex::new(re, -10.0)])
    }
}

/// Mean and mean square of `f` over a box by the 5-point Gauss rule (Abramowitz and Stegun 1964, table 25.4).
fn direct_quadrature(lower: &[f64], upper: &[f64], f: impl Fn([f64; 2]) -> f64) -> (f64, f64) {
    const RULE: [(f64, f64); 5] = [
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let at = |j: usize, node: f64| 0.5 * (lower[j] + upper[j]) + 0.5 * (upper[j] - lower[j]) * node;
    let (mut mean, mut square) = (0.0, 0.0);
    for (x, w) in RULE {
        for (y, v) in RULE {
            let value = f([at(0, x), at(1, y)]);
            mean += 0.25 * w * v * value;
            square += 0.25 * w * v * value * value;
        }
    }
    (mean, square)
}

#[test]
fn moments_over_elements_equal_direct_quadrature_and_every_run_is_counted() {
    let runs = Arc::new(AtomicU64::new(0));
    let mut study = multi_element(2, 7);
    study.spectrum.modes = Modes::All;
    let surrogate = build_with(&study, Box::new(Jump(runs.clone())), &Silent).unwrap();
    assert!(surrogate.mesh.splits()[0].input == 0 && surrogate.mesh.splits()[0].at == 0.0, "the jump is found first");
    let (mut mean, mut square) = (0.0, 0.0);
    for (number, element) in surrogate.mesh.elements().iter().enumerate() {
        let (of_element, square_of_element) = direct_quadrature(&element.lower, &element.upper, growth_rate);
        let expansion = surrogate.expansion(number, 0);
        assert!((expansion.mean() - of_element).abs() < 1e-10);
        let variance = square_of_element - of_element * of_element;
        assert!((expansion.variance() - variance).abs() < 1e-10);
        mean += element.weight * of_element;
        square += element.weight * square_of_element;
    }
    let (found_mean, found_variance) = surrogate.moments()[0];
    assert!((found_mean - mean).abs() < 1e-10 && (found_variance - (square - mean * mean)).abs() < 1e-10);
    let counts = surrogate.training.counts;
    assert_eq!(counts.direct_computations, runs.load(Ordering::Relaxed));
    assert_eq!(counts.final_mesh, 9 * surrogate.mesh.elements().len() as u64);
}

#[test]
fn divisions_end_where_every_element_decays_or_runs_run_out() {
    let build_jump = |lines: &str| {
        let mut study = study(2, "-eigenvalues", &format!("[fit]\nmethod = \"me-gpc\"\n{lines}\n"));
        study.spectrum.modes = Modes::All;
        build_with(&study, Box::new(Jump(Arc::default())), &Silent).unwrap()
    };
    // Polynomials of degree 2: only degree 3 can leave the highest order empty on both sides of the jump.
    let settled = build_jump("max_degree = 3");
    assert_eq!((settled.mesh.elements().len(), settled.fit_of(0).stop), (2, StopReason::Settled));
    assert!(settled.fit_of(0).r2.unwrap() > 1.0 - 1e-12);
    let limited = build_jump("theta_1 = 0.0\n[design]\nmaximum = 50");
    assert_eq!(limited.training.counts.direct_computations, 45, "five elements, of which three are left");
    assert_eq!((limited.mesh.elements().len(), limited.fit_of(0).stop), (3, StopReason::Limited));
    assert_eq!(limited.training.levels, [9, 27, 45], "two parts each");
}

/// Degree 2 is exact from the second element on: nothing is left to divide, whatever θ₁ is.
#[test]
fn what_decays_completely_is_not_divided_and_constant_parts_of_varying_components_are_no_constants() {
    let mut study = study(2, "-eigenvalues", "[fit]\nmethod = \"me-gpc\"\nmax_degree = 1\ntheta_1 = 0.0\n");
    study.spectrum.modes = Modes::All;
    let surrogate = build_with(&study, Box::new(Step), &Silent).unwrap();
    assert_eq!(surrogate.mesh.elements().len(), 2);
    let fit = surrogate.fit_of(0);
    assert_eq!((fit.degree, fit.terms, fit.stop), (0, 1, StopReason::Settled));
    assert!((fit.r2.unwrap() - 1.0).abs() < 1e-12);
    assert_eq!(surrogate.fit_of(1).stop, StopReason::Constant);
    assert!((surrogate.moments()[0].1 - 1.0).abs() < 1e-12);
    let sobol = surrogate.sobol_indices()[0].clone().unwrap();
    assert!((sobol.first[0] - 1.0).abs() < 1e-12 && sobol.total[1] < 1e-12);
}

/// One mode that grows on one side of ξ₁ = 0 and decays on the other.
struct Step;

impl Model for Step {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        let re = if point[0] < 0.25 { -1.0 } else { 1.0 };
        Ok(vec![Complex::new(re, 10.0), Complex::new(re, -10.0)])
    }
}

/// Two points do not determine six terms, even with derivatives: the design is what the degree says, and the fit says
/// so.
#[test]
fn least_squares_take_the_runs_they_say_and_tell_if_these_are_too_few() {
    for (inputs, degree) in [(2, 2), (2, 4), (3, 2), (5, 2)] {
        let lines = "method = \"gpc\"\nsolver = \"least-squares\"\noversampling = 1.0";
        let study = study(inputs, "", &format!("[fit]\n{lines}\nmax_degree = {degree}\n"));
        let surrogate = build(&study, &Silent).unwrap();
        assert_eq!(surrogate.training.counts.direct_computations, study.design.initial as u64);
        let fits = pcc::report::FitReport::warnings_of(&surrogate);
        assert!(fits.iter().any(|warning| warning.contains("hardly determine all terms")), "{fits:?}");
    }
}

/// Mode 3 alone is always stable, the model is never: nothing of this may be lost.
#[test]
fn modes_left_out_of_a_quadrature_are_warned_of() {
    let mut study = study(3, "-eigenvalues", "[fit]\nmethod = \"me-gpc\"\n");
    study.spectrum.modes = Modes::Ranks(vec![3]);
    let mut inputs = study.inputs.inputs().to_vec();
    inputs[0].marginal = pcc_evaluate::probability::inputs::Marginal::Uniform(
        pcc_evaluate::probability::inputs::Uniform::new(0.2, 0.5).unwrap(),
    );
    study.inputs = pcc_evaluate::probability::inputs::InputSpace::new(inputs).unwrap();
    let surrogate = build(&study, &Silent).unwrap();
    assert!((surrogate.decision.proportion_error.unwrap() - 1.0).abs() < 1e-12);
    let warnings = pcc::report::FitReport::warnings_of(&surrogate);
    assert!(warnings.iter().any(|warning| warning.contains("may be off by 100 %")), "{warnings:?}");
}

#[test]
fn surrogates_of_elements_survive_both_forms_and_any_number_of_threads() {
    let study = multi_element(3, 14);
    let on_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let surrogate = build(&study, &Silent).unwrap();
            let summary = monte_carlo(&surrogate, 50_001, 1, &Silent).unwrap();
            (encode(&surrogate, Format::Binary).unwrap(), summary)
        })
    };
    let (bytes, summary) = on_threads(1);
    for threads in [2, 8] {
        assert!(on_threads(threads) == (bytes.clone(), summary.clone()), "{threads} threads");
    }
    let binary = decode(&bytes).unwrap();
    assert!(binary.is_canonical && binary.version == (1, 2));
    let json = encode(&binary.surrogate, Format::Json).unwrap();
    assert_eq!(encode(&decode(&json).unwrap().surrogate, Format::Binary).unwrap(), bytes);
    assert!(pcc_evaluate::evaluation::self_test_difference(&binary.surrogate) < binary.surrogate.self_test.tolerance);
    assert_eq!(binary.surrogate.agrees_with(&build(&study, &Silent).unwrap()), Ok(()));
}

#[test]
fn elements_of_invariants_are_regrouped_without_another_run() {
    let lines = "[fit]\nmethod = \"me-gpc\"\ntheta_1 = 0.0\nelements = 8\n";
    let surrogate = build(&study(4, "", lines), &Silent).unwrap();
    let names: Vec<&str> = surrogate.outputs.iter().map(|output| output.name.as_str()).collect();
    assert_eq!(names, ["mode 1", "mode 2", "modes 3, 4"]);
    assert!(error(model_sample(4), &surrogate) <= 0.1);
}

#[test]
fn shown_studies_of_full_expansions_read_back() {
    let quadrature = gpc(5, 5);
    assert_eq!(Study::from_toml(&study(5, "-eigenvalues", "[fit]\nmethod = \"gpc\"\n").to_toml()).unwrap(), quadrature);
    let mut named = vec![quadrature, multi_element(2, 3)];
    named.push(study(3, "", "[fit]\nmethod = \"gpc\"\nsolver = \"least-squares\"\noversampling = 3.5\n"));
    for study in named {
        let again = Study::from_toml(&study.to_toml()).unwrap();
        assert_eq!((again.study_hash(), &again), (study.study_hash(), &study));
    }
}

/// One overdamped degree of freedom: nothing oscillates, so there is no component to expand.
struct Overdamped;

impl Model for Overdamped {
    fn eigenvalues(&self, _: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        Ok(vec![Complex::new(-1.0, 0.0), Complex::new(-2.0, 0.0)])
    }
}

#[test]
fn models_without_an_oscillating_mode_are_refused_where_modes_have_ranks() {
    for fit in ["method = \"gpc\"", "method = \"gpc\"\nsolver = \"least-squares\"", "method = \"me-gpc\"", ""] {
        for kind in if fit.is_empty() { &["-eigenvalues"][..] } else { &["-eigenvalues", ""] } {
            let mut study = study(2, kind, &format!("[fit]\n{fit}\n"));
            study.spectrum.modes = Modes::All;
            let refused = build_with(&study, Box::new(Overdamped), &Silent);
            assert!(refused.is_err(), "{fit} {kind}");
        }
    }
}
