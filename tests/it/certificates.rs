//! Verified bounds hold whatever the surrogate, and are narrow where it is good.

use crate::support::command::output;
use crate::support::{build, built, in_one_line, model_sample, shipped_study, text};
use pcc_compile::reference::{ReferenceError, certify_with_model, runs_for_width};
use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::probability::statistics::Proportion;
use pcc_evaluate::surrogate::{AssumedBound, RareSide, Surrogate, Withheld};
use std::sync::OnceLock;

const RUNS: u64 = 300;
const LEVEL: f64 = 0.95;

/// A deliberately poor surrogate: components with 4 inputs on few runs.
fn poor(runs: usize) -> (Study, Surrogate) {
    let mut study = shipped_study(4);
    (study.design.initial, study.design.maximum) = (runs, runs);
    let surrogate = build(&study);
    (study, surrogate)
}

#[test]
fn the_truth_lies_inside_the_bound_in_at_least_95_percent_of_repetitions() {
    // 50 repetitions on each of four degrees of badness; the reference has an error of 0.03 %.
    let truth =
        crate::support::csv_rows("tests/data/stability_reference.csv").into_iter().find(|row| row[0] == 4.0).unwrap()
            [2];
    let alone = Proportion { hits: (truth * RUNS as f64) as u64, samples: RUNS }.clopper_pearson(LEVEL);
    let (mut inside, mut above, mut below, mut repetitions) = (0, 0, 0, 0);
    for runs in [10, 15, 25, 80] {
        let (study, surrogate) = poor(runs);
        let misclassified = model_sample(4).compare(&surrogate).unwrap().misclassified_percent();
        for seed in 1..=50 {
            let certificate = certify_with_model(&surrogate, &study, RUNS, seed, LEVEL, &Silent).unwrap();
            repetitions += 1;
            above += usize::from(certificate.lower <= truth);
            below += usize::from(truth <= certificate.upper);
            inside += usize::from(certificate.lower <= truth && truth <= certificate.upper);
            if misclassified < 3.0 {
                assert!(certificate.upper - certificate.lower < alone.upper - alone.lower, "{runs} runs, seed {seed}");
            }
        }
    }
    for held in [above, below, inside] {
        assert!(held * 100 >= repetitions * 95, "{above} {below} {inside} of {repetitions}");
    }
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

/// The clutch with a friction that makes it squeal in a thousandth of all cases, built once for all tests.
fn rare() -> &'static (Study, Surrogate) {
    static RARE: OnceLock<(Study, Surrogate)> = OnceLock::new();
    RARE.get_or_init(|| {
        let study = text("surrogates/clutch-r4.toml").replace("upper = 0.5", "upper = 0.0723");
        let study = Study::from_toml(&study).unwrap();
        let surrogate = build(&study);
        (study, surrogate)
    })
}

#[test]
fn a_share_of_a_thousandth_is_bounded_on_both_sides() {
    let (study, surrogate) = rare();
    for seed in 1..=3 {
        let certificate = certify_with_model(surrogate, study, RUNS, seed, LEVEL, &Silent).unwrap();
        let strata = certificate.strata.unwrap();
        assert_eq!((certificate.samples, strata.rare_side), (450, RareSide::NotStable));
        assert_eq!((strata.outside.rare, strata.inside.rare), (0, 50));
        let share = strata.surrogate.rare as f64 / strata.surrogate.samples as f64;
        assert!((share / 9.8e-4 - 1.0).abs() < 0.05, "{share}");
        assert!(strata.rare_lower >= 0.9 * share && strata.rare_upper <= share + 0.0102, "{strata:?}");
        assert_eq!((certificate.lower, certificate.upper), (1.0 - strata.rare_upper, 1.0 - strata.rare_lower));
        assert!((certificate.level - 0.9).abs() < 1e-12);
        let AssumedBound::Upper(assumed) = strata.if_errors_fall_off.bound else { panic!("{strata:?}") };
        assert!(assumed > share && assumed <= 2e-3, "{assumed}");
    }
}

/// That none of a thousand samples is unstable does not contradict a bound of a thousandth from below.
#[test]
fn few_samples_do_not_look_as_if_a_certificate_contradicted_them() {
    let folder = tempfile::tempdir().unwrap();
    let (study, surrogate) = rare();
    let mut surrogate = surrogate.clone();
    surrogate.certificates.push(certify_with_model(&surrogate, study, 30, 1, LEVEL, &Silent).unwrap());
    surrogate.save(folder.path().join("rare.pcc")).unwrap();
    let said = output(folder.path(), &["eval", "rare.pcc", "-n", "100"]);
    assert!(said.contains("none of 100") && !said.contains("contradicts"), "{said}");
    let facts = in_one_line(&said);
    assert!(facts.contains("each end at 95 %, both at 90 %, 90 fresh model runs"), "{said}");
    assert!(facts.contains("if errors fall off below"), "{said}");
}

#[test]
fn certificates_are_the_same_on_any_number_of_threads() {
    let (study, surrogate) = rare();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| certify_with_model(surrogate, study, 30, 4, LEVEL, &Silent).unwrap())
    };
    let one = on(1);
    assert!(one == on(2) && one == on(8));
}

/// Of a surrogate that calls too much stable, runs inside say so; the assumption takes all of it for stable.
#[test]
fn the_second_line_is_never_weaker_than_the_first() {
    let study = crate::support::invariants_study(2);
    let right = built("clutch-r2");
    let mut cautious = right.clone();
    let mean = right.components().into_iter().find(|component| component.name.starts_with("re_s")).unwrap();
    cautious.expansions[mean.id].coefficients[0] -= 3.0 / mean.scale;
    let mut withheld = 0;
    for (surrogate, runs, seed) in [(right, 30, 1), (right, 300, 2), (&cautious, 300, 3), (&cautious, 100, 4)] {
        let certificate = certify_with_model(surrogate, &study, runs, seed, LEVEL, &Silent).unwrap();
        let strata = certificate.strata.unwrap();
        match strata.if_errors_fall_off.bound {
            AssumedBound::Upper(upper) => assert!(upper < strata.rare_upper, "{upper}, {}", strata.rare_upper),
            AssumedBound::Withheld(reason) => {
                assert_eq!(reason, Withheld::NoLower, "{runs} runs, seed {seed}");
                withheld += 1;
            }
        }
    }
    println!("{withheld} withheld");
    assert_eq!(withheld, 2, "where it would be weaker");
}

/// Half of all cases diverge, and the surrogate knows of none: its slow eigenvalue is moved away.
#[test]
fn a_surrogate_that_is_wrong_far_from_its_boundary_is_contradicted_and_has_no_second_line() {
    let study = Study::from_toml(&text("tests/data/field/cap.toml")).unwrap();
    let mut surrogate = build(&study);
    let slow = surrogate.components().into_iter().find(|component| component.name == "real_1").unwrap().id;
    surrogate.expansions[slow].coefficients[0] -= 10.0;
    let certificate = certify_with_model(&surrogate, &study, RUNS, 1, LEVEL, &Silent).unwrap();
    assert!(certificate.lower <= 0.5 && 0.5 <= certificate.upper && certificate.upper < 0.7, "{certificate:?}");
    let strata = certificate.strata.unwrap();
    assert_eq!((strata.surrogate.rare, strata.inside.runs, strata.outside.runs), (0, 0, 300));
    // The prediction is the same everywhere, so no point is nearer to the boundary than another.
    assert_eq!(strata.if_errors_fall_off.bound, AssumedBound::Withheld(Withheld::NoRuns));
}

#[test]
fn a_certificate_on_fewer_than_ten_runs_is_refused() {
    let (study, _) = rare();
    let surrogate = built("clutch-r4");
    let other = certify_with_model(surrogate, study, 300, 1, LEVEL, &Silent);
    assert!(matches!(other, Err(ReferenceError::OtherProblem { .. })), "{other:?}");
    let study = crate::support::invariants_study(4);
    let few = certify_with_model(surrogate, &study, 9, 1, LEVEL, &Silent);
    assert_eq!(few, Err(ReferenceError::TooFewRuns { runs: 9, least: 10 }));
}

#[test]
fn the_runs_for_a_width_are_known_before_any_is_made() {
    let (study, surrogate) = rare();
    let needed = runs_for_width(surrogate, 0.0102, 1, LEVEL, &Silent).unwrap();
    assert_eq!(needed.rare_side, RareSide::NotStable);
    let runs = needed.runs[0];
    assert!((290..=300).contains(&runs.outside) && runs.inside == 50, "{runs:?}");
    assert_eq!(runs.layer, runs.outside.div_ceil(3));
    // A certificate of this seed on so many runs has this width.
    let certificate = certify_with_model(surrogate, study, runs.outside, 1, LEVEL, &Silent).unwrap();
    let strata = certificate.strata.unwrap();
    assert_eq!(strata.outside.rare, 0);
    let width = strata.rare_upper - needed.share.value();
    assert!(width <= 0.0102 && width > 0.0101, "{width}");
    assert!(needed.runs[1].outside > runs.outside && needed.runs[2].outside > needed.runs[1].outside);
    let narrow = runs_for_width(surrogate, 1e-6, 1, LEVEL, &Silent);
    assert!(matches!(narrow, Err(ReferenceError::TooNarrow { .. })), "{narrow:?}");
}

#[test]
fn marginal_points_give_no_second_line() {
    let text = text("tests/data/wide/undamped2.toml");
    let study = Study::from_toml(&text).unwrap();
    let certificate = certify_with_model(&build(&study), &study, 100, 1, LEVEL, &Silent).unwrap();
    let strata = certificate.strata.unwrap();
    assert_eq!((strata.rare_side, strata.surrogate.rare, strata.inside.runs), (RareSide::Stable, 0, 0));
    assert_eq!(strata.if_errors_fall_off.bound, AssumedBound::Withheld(Withheld::Marginal));
}
