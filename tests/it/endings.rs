//! Builds end: of models whose answers carry noise, like programs with a finite tolerance or few printed digits, of
//! models with many inputs, and of those that the user stops. They say why, and give the share that is known.

use crate::coverage;
use crate::support::{repository, text};
use num_complex::Complex;
use pcc::report::FitReport;
use pcc_compile::compilation::{build, build_with};
use pcc_compile::mechanics::model::{Model, ModelError};
use pcc_compile::study::Study;
use pcc_evaluate::artifact::read;
use pcc_evaluate::evaluation::monte_carlo;
use pcc_evaluate::foundation::{Observer, Silent, is_interruption};
use pcc_evaluate::probability::random::{Purpose, Stream};
use pcc_evaluate::surrogate::{StopReason, Surrogate};
use std::sync::atomic::{AtomicUsize, Ordering};

const SAMPLES: u64 = 100_000;

/// Slower modes are rigid-body motion here, in rad/s.
const SLOWEST: f64 = 1.0;

/// What answers carry.
#[derive(Clone, Copy)]
enum Noise {
    /// An error of this share of |λ|, the same at the same point.
    Relative(f64),
    /// So many digits.
    Printed(usize),
}

/// A model that answers with noise, and only one of each conjugate pair.
struct Noisy(Box<dyn Model>, Noise);

impl Model for Noisy {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        let key = point.iter().fold(0u64, |key, value| key.rotate_left(17) ^ value.to_bits().wrapping_mul(0x9E37_79B9));
        let mut stream = Stream::new(key >> 1, Purpose::Evaluation, 0);
        // Twelve uniform variables have about a normal sum of unit variance.
        let mut normal = || (0..12).map(|_| stream.next_unit()).sum::<f64>() - 6.0;
        let found = self.0.eigenvalues(point)?.into_iter().filter(|lambda| lambda.im > SLOWEST);
        let mut found: Vec<Complex<f64>> = found.collect();
        found.sort_by(|a, b| a.im.total_cmp(&b.im));
        Ok(found
            .into_iter()
            .map(|lambda| match self.1 {
                Noise::Relative(noise) => lambda + Complex::new(normal(), normal()) * (noise * lambda.norm()),
                Noise::Printed(digits) => {
                    let printed = |value: f64| format!("{value:.*e}", digits - 1).parse::<f64>().unwrap();
                    Complex::new(printed(lambda.re), printed(lambda.im))
                }
            })
            .collect())
    }
}

/// A shipped study, or one of these lines, without derivatives.
fn without_derivatives(toml: &str, seed: u64) -> Study {
    let mut study =
        Study::from_toml_in(&format!("{toml}\n[fit]\nderivatives = false\n"), &repository("surrogates")).unwrap();
    study.seed = seed;
    study
}

fn built(study: &Study, noise: Noise) -> Surrogate {
    build_with(study, Box::new(Noisy(study.model().unwrap(), noise)), &Silent).unwrap()
}

fn stable(surrogate: &Surrogate) -> f64 {
    monte_carlo(surrogate, SAMPLES, 1, &Silent).unwrap().stable_proportion().value()
}

/// The noise-free surrogate of the same study, and that with noise: shares, numbers of runs, and the latter.
fn compared(study: &Study, noise: Noise) -> ([f64; 2], [u64; 2], Surrogate) {
    let surrogates = [built(study, Noise::Relative(0.0)), built(study, noise)];
    let shares = [stable(&surrogates[0]), stable(&surrogates[1])];
    let runs = [0, 1].map(|k| surrogates[k].training.counts.direct_computations);
    let [_, noisy] = surrogates;
    (shares, runs, noisy)
}

const BELT: &str = r#"
    format = 1
    name = "belt"
    [model]
    kind = "matrices"
    M = [[2, 0], [0, 2]]
    C = [[2, 0], [0, 2]]
    K = [[3000, "500 - mu*k_n"], [500, "1000 + k_n"]]
    [inputs]
    mu  = { distribution = "uniform", lower = 0.0, upper = 0.5 }
    k_n = { distribution = "uniform", lower = 1800.0, upper = 2400.0 }
"#;

#[test]
fn the_belt_as_a_noisy_program_ends_with_a_sentence() {
    for noise in [Noise::Relative(1e-9), Noise::Relative(1e-6), Noise::Printed(7)] {
        for seed in 1..=5 {
            let ([exact, noisy], [_, runs], surrogate) = compared(&without_derivatives(BELT, seed), noise);
            assert!(runs <= 60, "{runs} runs, seed {seed}");
            assert!((exact - noisy).abs() <= 5e-4, "{noisy}, not {exact}, seed {seed}");
            // The mean of both modes is constant.
            assert_eq!(surrogate.expansions[0].indices.len(), 1, "seed {seed}");
            if surrogate.expansions[0].stop == StopReason::Stalled {
                let warnings = FitReport::warnings_of(&surrogate).join("\n");
                assert!(warnings.contains("re_s_1_2") && warnings.contains("no longer fall"), "{warnings}");
                assert!(!warnings.contains("worse than by"), "{warnings}");
            }
        }
    }
}

#[test]
fn the_clutch_as_a_noisy_program_needs_about_as_many_runs() {
    // Eight inputs take half a minute: tools/src/bin/noisy_clutch.rs.
    for seed in 1..=3 {
        let study = without_derivatives(&text("surrogates/clutch-r3.toml"), seed);
        let ([exact, noisy], [without, with], _) = compared(&study, Noise::Relative(1e-8));
        assert!((exact - noisy).abs() <= 1e-3 * exact, "{noisy}, not {exact}");
        assert!(with as f64 <= 1.3 * without as f64, "{with} runs, not {without}");
    }
}

/// 200 degrees of freedom and five inputs, lightly damped: what an iterative solver with a tolerance of 10⁻⁹ answers.
#[test]
fn a_large_program_with_an_iterative_solver_ends() {
    // What is shipped was built from the same model without noise.
    let exact = stable(&read(&repository("surrogates/block.pcc")).unwrap().surrogate);
    let study = text("surrogates/block.toml").replace("[fit]\nproportion_tolerance = 2e-4", "");
    let surrogate = built(&without_derivatives(&study, 1), Noise::Relative(1e-9));
    let (noisy, runs) = (stable(&surrogate), surrogate.training.counts.direct_computations);
    assert!(runs <= 150, "{runs} runs");
    assert!((exact - noisy).abs() <= 1e-3 * exact, "{noisy}, not {exact}");
}

/// A chain with as many uncertain springs as masses.
fn chain(inputs: usize) -> String {
    let row = |i: usize| {
        let above = if i + 1 < inputs { format!(" + k_{}", i + 2) } else { String::new() };
        let mut entries = vec!["0".to_owned(); i];
        entries.push(format!("k_{}{above}", i + 1));
        if i > 0 {
            entries[i - 1] = format!("-k_{}", i + 1);
        }
        format!("[{}]", entries.iter().map(|entry| format!("\"{entry}\"")).collect::<Vec<_>>().join(", "))
    };
    let rows: Vec<String> = (0..inputs).map(row).collect();
    let springs =
        |i: usize| format!("k_{} = {{ distribution = \"uniform\", nominal = {}, spread = 0.05 }}", i + 1, 1000 + 3 * i);
    let springs: Vec<String> = (0..inputs).map(springs).collect();
    let diagonal = |entry: &str| vec![entry; inputs].join(", ");
    format!(
        "format = 1\nname = \"chain\"\n[model]\nkind = \"matrices\"\nM = {{ diagonal = [{}] }}\nC = {{ diagonal = [{}] }}\n\
         K = {{ form = \"symmetric\", rows = [{}] }}\n[spectrum]\nmodes = [1, 2]\n[inputs]\n{}\n",
        diagonal("1"),
        diagonal("0.02"),
        rows.join(", "),
        springs.join("\n"),
    )
}

#[test]
fn thirty_inputs_have_two_levels_and_an_estimate() {
    let study = Study::from_toml(&format!("{}[design]\nmaximum = 100\n", chain(30))).unwrap();
    let surrogate = build(&study, &Silent).unwrap();
    assert_eq!(surrogate.training.levels, [50, 100]);
    assert!(surrogate.decision.proportion_error.is_some());
    for id in 0..surrogate.component_count() {
        assert!(surrogate.fit_of(id).s2.is_none_or(|s2| s2 > 0.999), "component {id}");
    }
}

#[test]
fn designs_of_any_number_of_inputs_have_two_levels() {
    for (inputs, initial, maximum) in [(8, 16, 333), (30, 50, 125), (38, 50, 125), (100, 50, 125)] {
        let study = Study::from_toml(&chain(inputs)).unwrap();
        assert_eq!((study.design.initial, study.design.maximum), (initial, maximum), "{inputs} inputs");
    }
    let small = Study::from_toml(&format!("{}[design]\nmaximum = 12\n", chain(8))).unwrap();
    assert_eq!(small.design.initial, 6, "what there may be at most is halved");
}

/// Re λ has four waves over the range of a, more than the first designs can follow.
struct Wavy;

impl Model for Wavy {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        Ok(vec![Complex::new(0.5 * (25.0 * point[0]).sin() + point[0] - 0.6, 50.0 + point[1])])
    }
}

/// Runs that were not made because the user stopped are no failures.
#[test]
fn a_build_that_is_stopped_between_runs_has_no_failures() {
    let study = Study::from_toml(coverage::STUDY).unwrap();
    let impatient = Impatient { levels: AtomicUsize::new(1), takes_what_there_is: true };
    let surrogate = build_with(&study, Box::new(Wavy), &impatient).unwrap();
    assert_eq!((surrogate.coverage.clone(), surrogate.training.counts.failed), (None, 0));
    assert_eq!(surrogate.training.counts.direct_computations, 18);
}

/// A component that looks like noise to a small design is no reason to be sure of the proportion.
#[test]
fn what_small_designs_cannot_follow_is_not_estimated_away() {
    for seed in 1..=3 {
        let study = Study { seed, ..Study::from_toml(coverage::STUDY).unwrap() };
        let surrogate = build_with(&study, Box::new(Wavy), &Silent).unwrap();
        let truth = (0..100_000).filter(|i| {
            let a = (f64::from(*i) + 0.5) * 1e-5;
            0.5 * (25.0 * a).sin() + a - 0.6 < 0.0
        });
        let truth = truth.count() as f64 * 1e-5;
        let found = stable(&surrogate);
        let estimated = surrogate.decision.proportion_error.map_or(f64::INFINITY, |error| error * found);
        assert!((found - truth).abs() < 5e-3_f64.max(3.0 * estimated), "{found} ± {estimated}, not {truth}");
    }
}

/// Asks to stop at the first step after so many levels.
struct Impatient {
    levels: AtomicUsize,
    takes_what_there_is: bool,
}

impl Observer for Impatient {
    fn begin(&self, _: &str, _: u64) {}
    fn advance(&self, _: u64) {}
    fn finish(&self) {}
    fn remark(&self, _: &str) {
        self.levels.fetch_sub(1, Ordering::SeqCst);
    }
    fn takes_what_there_is(&self) -> bool {
        self.takes_what_there_is
    }
    fn interrupted(&self) -> bool {
        self.levels.load(Ordering::SeqCst) == 0
    }
}

#[test]
fn a_stopped_build_gives_its_best_level_if_asked_to() {
    let study = Study::from_toml(&text("surrogates/clutch-r8.toml")).unwrap();
    let stopped = |takes_what_there_is| build(&study, &Impatient { levels: AtomicUsize::new(2), takes_what_there_is });
    let refusal = stopped(false).unwrap_err();
    assert!(is_interruption(&refusal), "{refusal}");
    let surrogate = stopped(true).unwrap();
    assert_eq!(surrogate.training.levels, [16, 40]);
    let warnings = FitReport::warnings_of(&surrogate).join("\n");
    assert!(warnings.contains("because it was stopped"), "{warnings}");
    assert!(surrogate.self_test.points.len() == 16 && surrogate.decision.proportion_error.is_some());
}

/// An undamped belt whose answers carry noise: its growth rates are noise, and known to be if the study says so.
#[test]
fn noise_that_a_study_states_tells_constants_and_zeros() {
    let undamped = BELT.replace("    C = [[2, 0], [0, 2]]\n", "").replace("- mu", "+ mu");
    let study = without_derivatives(&format!("{undamped}[spectrum]\nnoise = 1e-6\n"), 1);
    let surrogate = built(&study, Noise::Relative(1e-7));
    assert!(surrogate.is_undamped());
    let summary = monte_carlo(&surrogate, SAMPLES, 1, &Silent).unwrap();
    assert_eq!(summary.marginal(), SAMPLES);
    let damped = without_derivatives(&format!("{BELT}[spectrum]\nnoise = 1e-6\n"), 1);
    let ([exact, noisy], [_, runs], surrogate) = compared(&damped, Noise::Relative(1e-7));
    assert!(runs <= 36 && (exact - noisy).abs() <= 5e-4, "{runs} runs: {noisy}, not {exact}");
    assert_eq!(surrogate.expansions[0].stop, StopReason::Constant);
    for wrong in ["-1e-9", "0.1", "nan"] {
        let refused = Study::from_toml(&format!("{BELT}[spectrum]\nnoise = {wrong}\n")).unwrap_err();
        assert!(refused.to_string().contains("spectrum.noise"), "{refused}");
    }
}

/// Answers with few digits tell how far off they are, so that what varies in the last digit alone is a constant.
#[test]
fn printed_digits_are_the_noise_of_a_program_that_rounds() {
    let study = without_derivatives(BELT, 1);
    let stop = |surrogate: &Surrogate, name: &str| {
        let component = surrogate.components().into_iter().find(|component| component.name == name).unwrap().id;
        surrogate.fit_of(component).stop
    };
    let rounded = built(&study, Noise::Printed(8));
    assert_eq!(stop(&rounded, "re_s_1_2"), StopReason::Constant);
    let noisy = built(&study, Noise::Relative(1e-8));
    assert_ne!(stop(&noisy, "re_s_1_2"), StopReason::Constant, "a program that prints everything does not tell");
}
