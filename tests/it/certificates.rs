//! Verified bounds hold whatever the surrogate, and are narrow where it is good.

use crate::support::{build, built, model_sample, shipped_study};
use pcc_compile::reference::certify_with_model;
use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::probability::statistics::Proportion;
use pcc_evaluate::surrogate::Surrogate;

const RUNS: u64 = 300;
const LEVEL: f64 = 0.95;

/// A deliberately poor surrogate: components with 8 inputs on few runs.
fn poor(runs: usize) -> (Study, Surrogate) {
    let mut study = shipped_study(8);
    (study.design.initial, study.design.maximum) = (runs, runs);
    let surrogate = build(&study);
    (study, surrogate)
}

#[test]
fn the_truth_lies_inside_the_bound_in_at_least_95_percent_of_repetitions() {
    // 50 repetitions on each of four degrees of badness; the reference has an error of 0.03 %.
    let truth =
        crate::support::csv_rows("tests/data/stability_reference.csv").into_iter().find(|row| row[0] == 8.0).unwrap()
            [2];
    let alone = Proportion { hits: (truth * RUNS as f64) as u64, samples: RUNS }.clopper_pearson(LEVEL);
    let (mut inside, mut repetitions) = (0, 0);
    for runs in [30, 60, 120, 240] {
        let (study, surrogate) = poor(runs);
        let misclassified = model_sample(8).compare(&surrogate).unwrap().misclassified_percent();
        for seed in 1..=50 {
            let certificate = certify_with_model(&surrogate, &study, RUNS, seed, LEVEL, &Silent).unwrap();
            repetitions += 1;
            inside += usize::from(certificate.lower <= truth && truth <= certificate.upper);
            if misclassified < 3.0 {
                assert!(certificate.upper - certificate.lower < alone.upper - alone.lower, "{runs} runs, seed {seed}");
            }
        }
    }
    assert!(inside * 100 >= repetitions * 95, "{inside} of {repetitions}");
}

#[test]
fn good_surrogates_are_certified_to_less_than_half_the_width_of_runs_alone() {
    let study = crate::support::invariants_study(3);
    let certificate = certify_with_model(built("clutch-r3"), &study, RUNS, 7, LEVEL, &Silent).unwrap();
    let alone = Proportion { hits: RUNS / 5, samples: RUNS }.clopper_pearson(LEVEL);
    assert_eq!((certificate.falsely_stable, certificate.falsely_unstable), (0, 0));
    let width = certificate.upper - certificate.lower;
    assert!(width < 0.4 * (alone.upper - alone.lower), "{width}");
}
