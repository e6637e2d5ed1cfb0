//! Surrogates by invariants: as exact as promised with a tenth of the runs, whatever the seed.

use crate::support::reproduction::TABLE_2;
use crate::support::{build, built, invariants_study, model_sample, shipped_study};
use pcc_compile::fitting::fit::{FitMethod, Smooth};
use pcc_compile::study::{Derivatives, Study};
use pcc_evaluate::components::OutputKind;

/// Inputs, most model runs, largest error of the proportion and share of misclassified points in percent.
type Bar = (usize, u64, f64, f64);

const WITH_DERIVATIVES: [Bar; 5] =
    [(1, 20, 0.0, 0.0), (2, 20, 0.0, 0.0), (3, 20, 0.01, 0.002), (5, 40, 0.05, 0.02), (8, 70, 0.03, 0.01)];
const VALUES_ALONE: [Bar; 5] =
    [(1, 40, 0.0, 0.0), (2, 40, 0.0, 0.0), (3, 60, 0.01, 0.002), (5, 120, 0.05, 0.05), (8, 240, 0.12, 0.1)];

#[test]
fn every_row_with_derivatives_stays_within_its_bar() {
    WITH_DERIVATIVES.iter().for_each(|bar| stays_within(*bar, true));
}

#[test]
fn every_row_of_values_alone_stays_within_its_bar() {
    VALUES_ALONE.iter().for_each(|bar| stays_within(*bar, false));
}

fn stays_within((inputs, most_runs, largest_error, most_misclassified): Bar, derivatives: bool) {
    for row in TABLE_2.sparse(inputs, "invariants", derivatives) {
        let (runs, error, misclassified) = (row.direct_computations, row.error(), row.misclassified_percent);
        let found = format!("r = {inputs}, seed {}: {runs} runs, {error} %, {misclassified} % misclassified", row.seed);
        println!("{found}");
        assert!(runs <= most_runs && error <= largest_error && misclassified <= most_misclassified, "{found}");
    }
}

/// The file says what was used: every run counts with its derivatives, and errors leave out whole runs.
#[test]
fn derivatives_are_recorded() {
    use pcc_evaluate::surrogate::{LeaveOut, SettingValue};
    let with = built("clutch-r3");
    let mut study = invariants_study(3);
    study.fit.derivatives = Derivatives::Never;
    (study.design.initial, study.design.step) = (30, 30);
    let without = build(&study);
    for (surrogate, used, leaves_out) in [(with, true, LeaveOut::Run), (&without, false, LeaveOut::Row)] {
        let counts = surrogate.training.counts;
        assert_eq!(counts.gradients, if used { counts.values } else { 0 });
        assert_eq!((counts.values, counts.direct_computations), (counts.direct_computations, counts.values));
        let flag = surrogate.training.settings.iter().find(|setting| setting.key == "derivatives");
        assert_eq!(flag.map(|setting| &setting.value), used.then_some(&SettingValue::Flag(true)));
        assert!(surrogate.expansions.iter().all(|expansion| expansion.leave_out == leaves_out));
    }
    let largest = *with.training.levels.last().unwrap();
    assert!(3 * largest <= *without.training.levels.last().unwrap(), "{largest} runs");
}

#[test]
fn the_coalescing_pair_is_found_and_the_other_modes_stay_single() {
    let surrogate = built("clutch-r2");
    let found: Vec<_> = surrogate.outputs.iter().map(|output| (output.kind, output.modes.clone())).collect();
    let eigenvalue = OutputKind::Eigenvalue;
    assert_eq!(found, [(eigenvalue, vec![1]), (eigenvalue, vec![2]), (OutputKind::Cluster, vec![3, 4])]);
}

#[test]
fn lists_of_modes_may_leave_out_whole_groups() {
    let mut study = invariants_study(2);
    study.spectrum.modes = pcc_compile::mechanics::spectrum::Modes::Ranks(vec![3, 4]);
    let surrogate = build(&study);
    assert_eq!((surrogate.modes(), surrogate.outputs.len()), (vec![3, 4], 1));
    study.spectrum.modes = pcc_compile::mechanics::spectrum::Modes::Ranks(vec![1, 2]);
    assert_eq!(build(&study).outputs.len(), 2);
}

/// Every method fits either target, and every method is better on invariants than the paper's on eigenvalues.
#[test]
fn methods_and_targets_combine_freely() {
    let error = |mut study: Study, method: FitMethod| {
        study.fit.method = method;
        study.fit.proportion_tolerance = None;
        (study.design.initial, study.design.maximum) = (60, 60);
        let surrogate = build(&study);
        model_sample(3).compare(&surrogate).unwrap().misclassified_percent()
    };
    let smooth = || Smooth { max_degree: 15, s2_target: 0.999 };
    let papers = shipped_study(3).fit.method;
    let by_eigenvalues = error(shipped_study(3), papers.clone());
    let by_invariants = error(invariants_study(3), papers);
    assert!(by_invariants < 0.5 * by_eigenvalues, "{by_invariants} against {by_eigenvalues}");
    for method in [FitMethod::Omp(smooth()), FitMethod::MinimumNorm(smooth()), FitMethod::Auto(smooth())] {
        let name = method.name();
        let found = error(invariants_study(3), method.clone());
        assert!(found < 0.1 * by_eigenvalues, "{name}: {found} against {by_eigenvalues}");
        assert!(error(shipped_study(3), method) < 50.0, "{name} on eigenvalues");
    }
}

/// Two levels at least, and more where the tolerance asks for it; levels share their runs.
#[test]
fn the_design_grows_until_the_decision_is_accurate() {
    let mut study = invariants_study(5);
    (study.design.initial, study.design.step) = (10, 10);
    study.fit.proportion_tolerance = Some(0.025);
    let loose = build(&study);
    // Of a fifth, √(p (1 − p)) = 2p.
    study.fit.proportion_tolerance = Some(5e-5);
    let tight = build(&study);
    assert_eq!(loose.training.levels[..2], [10, 20]);
    assert!(tight.training.levels.starts_with(&loose.training.levels));
    assert!(tight.training.levels.len() > loose.training.levels.len());
    let error = tight.decision.proportion_error.unwrap();
    assert!(error <= 1e-4, "{error}");
    study.design.maximum = 10;
    assert_eq!(build(&study).decision.proportion_error, None, "one level cannot be judged by itself");
}

/// The estimate is neither blind nor wildly pessimistic: over seeds and sizes, the median of truth over estimate lies
/// between a tenth and two, and the truth is seldom more than three times the estimate.
#[test]
fn the_estimated_error_of_the_proportion_is_of_the_order_of_the_true_one() {
    let mut ratios = Vec::new();
    for seed in 1..=6 {
        for level in [12, 16] {
            let mut study = invariants_study(8);
            study.seed = seed;
            study.fit.proportion_tolerance = Some(1e-5);
            (study.design.initial, study.design.step, study.design.maximum) = (level, level, 2 * level);
            let surrogate = build(&study);
            let estimate = surrogate.decision.proportion_error.unwrap();
            let comparison = model_sample(8).compare(&surrogate).unwrap();
            let truth = comparison.relative_error_percent().unwrap() / 100.0;
            ratios.push(truth / estimate);
        }
    }
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    assert!((0.1..=2.0).contains(&median), "{ratios:?}");
    assert!(ratios.iter().filter(|&&ratio| ratio > 3.0).count() <= 2, "{ratios:?}");
}
