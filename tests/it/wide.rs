//! Spectra of any width: slow modes beside fast ones, soft mounts, bodies that are free to move, and what neither grows
//! nor decays. Reference values have 40 digits (`tests/data/wide/eigenvalues.py`) or closed forms.

use crate::support::{repository, text};
use num_complex::Complex;
use pcc_compile::campaign::{Run, Runner};
use pcc_compile::compilation::build;
use pcc_compile::reference::{ModelSample, certify_with_model, monte_carlo};
use pcc_compile::study::Study;
use pcc_evaluate::components::Verdict;
use pcc_evaluate::foundation::Silent;
use std::collections::HashMap;

const POINTS: u64 = 20_000;

fn study(name: &str) -> Study {
    Study::from_toml_in(&text(&format!("tests/data/wide/{name}.toml")), &repository("tests/data/wide")).unwrap()
}

/// The model of a study at the point of its reference values.
fn run_at_reference_point(name: &str) -> Run {
    let study = study(name);
    let table = text("tests/data/wide/points.csv");
    let values: HashMap<&str, f64> = table
        .lines()
        .filter_map(|line| line.strip_prefix(name)?.strip_prefix(',')?.split_once(','))
        .map(|(input, value)| (input, value.parse().unwrap()))
        .collect();
    let point: Vec<f64> = study.inputs.names().map(|input| values[input]).collect();
    let mut runner = Runner::new(&study).unwrap().without_ranks().with_derivatives(true);
    runner.run(&[point], &Silent).unwrap().remove(0)
}

/// Upper halves of the reference values.
fn reference(file: &str) -> Vec<Complex<f64>> {
    let table = text(&format!("tests/data/wide/{file}.csv"));
    let row = |line: &str| {
        let cells: Vec<f64> = line.split(',').skip(1).map(|cell| cell.parse().unwrap()).collect();
        Complex::new(cells[0], cells[1])
    };
    table.lines().skip(1).map(row).filter(|lambda| lambda.im > 0.0).collect()
}

/// Every reference value is found, Re λ as well as Im λ, and nothing slower but what is listed.
fn check_eigenvalues(name: &str, file: &str, digits: f64, rigid_body_modes: usize) {
    let run = run_at_reference_point(name);
    assert_eq!(run.spectrum.rigid_body_modes(), rigid_body_modes, "{name}");
    let expected = reference(file);
    for (expected, found) in expected.iter().zip(run.spectrum.oscillating()) {
        assert!((found - expected).norm() <= digits * expected.norm(), "{name}: {found}, not {expected}");
        assert!((found.re - expected.re).abs() <= digits * expected.re.abs(), "{name}: {found}, not {expected}");
    }
    assert!(run.reductions.is_some_and(|reductions| !reductions.systems.is_empty()), "{name}");
}

#[test]
fn slow_modes_of_a_beam_are_those_of_forty_digits() {
    check_eigenvalues("beam-20", "eigenvalues_20", 1e-9, 0);
    check_eigenvalues("beam-80", "eigenvalues_80", 1e-9, 0);
    check_eigenvalues("machine", "eigenvalues_machine", 1e-9, 0);
}

/// Without springs two motions are free, each with two eigenvalues; the first bending mode follows at once.
#[test]
fn free_bodies_are_told_from_those_on_soft_springs() {
    check_eigenvalues("beam-20-free", "eigenvalues_free_20", 1e-6, 4);
    check_eigenvalues("beam-80-free", "eigenvalues_free_80", 1e-6, 4);
}

/// Stable in exactly so many percent, by a closed form.
#[test]
fn machines_on_soft_mounts_are_stable_where_the_closed_form_says() {
    for (name, stable) in [("wide", 50.0), ("beam-20", 50.0), ("machine", 30.0)] {
        let study = study(name);
        let surrogate = build(&study, &Silent).unwrap();
        let counts = surrogate.training.counts;
        assert!(counts.direct_computations <= 30, "{name}: {counts:?}");
        assert_eq!(counts.gradients, counts.values, "{name}: derivatives survive the width of the spectrum");
        let found = pcc_evaluate::evaluation::monte_carlo(&surrogate, 1_000_000, 1, &Silent).unwrap();
        let share = 100.0 * found.stable_proportion().value();
        // Four standard errors of the samples, and the bar.
        assert!((share - stable).abs() < 0.2, "{name}: {share} %");
        let marginal = 100.0 * found.marginal() as f64 / 1e6;
        assert!(marginal < 0.3, "{name}: {marginal} % marginal");
        let model = monte_carlo(&study, 300, 3, &Silent).unwrap().summary;
        assert!(model.marginal() <= 1, "{name}: the model is marginal at {} of 300 points", model.marginal());
    }
}

/// Flutter, divergence and marginal shares in percent, and runs at most. The shares of chains and penalty springs are
/// those of their structure, of undamped2 by (200 + k)² > 4 (120 (80 + k) + μk²), of undiv by k < 1/3; the others by
/// `shares.py`, and by the model alone.
const UNDAMPED: [(&str, Option<[f64; 3]>, u64); 13] = [
    ("chain-2", Some([0.0, 0.0, 100.0]), 30),
    ("chain-5", Some([0.0, 0.0, 100.0]), 30),
    ("chain-16", Some([0.0, 0.0, 100.0]), 30),
    ("blades3", Some([0.0, 0.0, 100.0]), 30),
    ("pen", Some([0.0, 0.0, 100.0]), 30),
    ("undamped2", Some([71.03, 0.0, 28.97]), 30),
    ("undiv", Some([0.0, 29.1667, 70.8333]), 30),
    ("friction-2", Some([70.035, 0.0, 29.965]), 30),
    ("friction-4", Some([27.222, 13.165, 59.613]), 30),
    ("spin-2", Some([36.753, 10.894, 52.352]), 30),
    ("shaft8", None, 30),
    ("shaft16", None, 30),
    ("belt6", None, 30),
];

#[test]
fn undamped_systems_are_marginal_where_they_neither_flutter_nor_diverge() {
    for (name, expected, most_runs) in UNDAMPED {
        let study = study(name);
        let surrogate = build(&study, &Silent).unwrap();
        let runs = surrogate.training.counts.direct_computations;
        assert!(runs <= most_runs, "{name}: {runs} runs");
        assert_eq!(surrogate.is_undamped(), name != "pen", "{name}");
        let sample = ModelSample::new(&study, POINTS, 7, &Silent).unwrap();
        let comparison = sample.compare(&surrogate).unwrap();
        let misclassified = comparison.misclassified_percent();
        assert!(misclassified <= 0.1, "{name}: {misclassified} %");
        for component in &comparison.components {
            let error = component.mean_error_percent();
            assert!(error.is_none_or(|error| error < 1.0), "{name}: mean of {} {error:?} %", component.name);
        }
        let Some(expected) = expected else { continue };
        let block = sample.surrogate_at(&surrogate, POINTS as usize).unwrap();
        let kinds = [Verdict::Flutter, Verdict::Divergence, Verdict::Marginal];
        for (kind, expected) in kinds.into_iter().zip(expected) {
            let hits = (0..POINTS as usize).filter(|&i| block.top(i).verdict() == kind).count();
            let (share, expected) = (hits as f64 / POINTS as f64, 0.01 * expected);
            let tolerance = 4.0 * (expected * (1.0 - expected) / POINTS as f64).sqrt() + 1e-3;
            assert!((share - expected).abs() <= tolerance, "{name}: {kind:?} {share}, not {expected}");
        }
    }
}

/// Sixteen masses on a string that turns: more bands of flutter than so few runs can tell. The surrogate calls all
/// points unstable, whatever residual is added to it, and its own runs contradict it.
#[test]
fn fits_that_their_own_runs_contradict_do_not_look_exact() {
    let mut study = study("spin-16");
    study.design.maximum = 20;
    let surrogate = build(&study, &Silent).unwrap();
    let comparison = ModelSample::new(&study, 500, 7, &Silent).unwrap().compare(&surrogate).unwrap();
    let (error, misclassified) = (surrogate.decision.proportion_error.unwrap(), comparison.misclassified_percent());
    assert!(misclassified > 50.0 && misclassified < 300.0 * error, "{error}, {misclassified} %");
}

#[test]
fn certificates_bound_all_three_shares() {
    let study = study("undamped2");
    let surrogate = build(&study, &Silent).unwrap();
    let mut held = 0;
    for seed in 1..=100 {
        let certificate = certify_with_model(&surrogate, &study, 300, seed, 0.95, &Silent).unwrap();
        let bounds = certificate.marginal.unwrap();
        let holds = |[lower, upper]: [f64; 2], truth: f64| lower <= truth && truth <= upper;
        let stable = holds([certificate.lower, certificate.upper], 0.0);
        held += u32::from(stable && holds(bounds.marginal, 0.2897) && holds(bounds.unstable, 0.7103));
    }
    assert!(held >= 95, "{held} of 100");
}
