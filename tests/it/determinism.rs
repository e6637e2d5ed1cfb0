//! Same study, same bytes; same samples, same counts: on any number of threads.

use crate::support::{build, shipped_study};
use pcc_evaluate::artifact::{Format, encode};
use pcc_evaluate::evaluation::{evaluate_points, monte_carlo};
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::probability::inputs::random_points;
use pcc_evaluate::probability::random::Purpose;

fn on_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

#[test]
fn builds_have_the_same_bytes_on_1_2_and_8_threads() {
    let mut study = shipped_study(3);
    study.design.initial = 20; // several levels
    study.design.step = 15;
    let bytes = |threads| on_threads(threads, || encode(&build(&study), Format::Binary).unwrap());
    let one = bytes(1);
    assert_eq!(bytes(2), one);
    assert_eq!(bytes(8), one);
}

#[test]
fn evaluations_have_the_same_counts_and_moments_on_1_2_3_and_8_threads() {
    let surrogate = build(&shipped_study(2));
    let summary = |threads| on_threads(threads, || monte_carlo(&surrogate, 100_003, 7, &Silent).unwrap());
    let one = summary(1);
    assert_eq!(one.samples(), 100_003);
    for threads in [2, 3, 8] {
        assert_eq!(summary(threads), one);
    }
}

#[test]
fn the_compiled_plan_equals_the_plain_sum_at_the_same_points() {
    let surrogate = build(&shipped_study(4));
    let plan = pcc_evaluate::evaluation::Plan::new(&surrogate);
    let points = random_points(&surrogate.inputs, 3, Purpose::Evaluation, 0..100);
    let references: Vec<&[f64]> = points.iter().map(Vec::as_slice).collect();
    let block = evaluate_points(&surrogate, &plan, &references);
    for (i, point) in points.iter().enumerate() {
        let expected = surrogate.evaluate(point);
        for (id, value) in expected.iter().enumerate() {
            // The same terms in another order.
            assert!((block.components[id][i] - value).abs() <= 1e-11 * value.abs().max(1.0));
        }
        assert!((block.max_re[i] - surrogate.max_re(&expected)).abs() <= 1e-11 * 100.0);
    }
}

/// Pins the evaluation points and the classification: counts are exact on every machine whose coefficients agree.
#[test]
fn known_counts_of_a_shipped_surrogate() {
    let surrogate = pcc_evaluate::artifact::read(&crate::support::repository("surrogates/clutch-r8-eigenvalues.pcc"))
        .unwrap()
        .surrogate;
    let summary = monte_carlo(&surrogate, 1_000_000, 1, &Silent).unwrap();
    insta::assert_snapshot!(format!(
        "stable {}, unstable modes {:?}",
        summary.stable,
        summary.eigenvalues.iter().map(|mode| mode.unstable).collect::<Vec<_>>()
    ));
}

#[test]
fn moments_from_coefficients_equal_monte_carlo_moments_within_4_standard_errors() {
    const SAMPLES: u64 = 400_000;
    let surrogate = pcc_evaluate::artifact::read(&crate::support::repository("surrogates/clutch-r8-eigenvalues.pcc"))
        .unwrap()
        .surrogate;
    let summary = monte_carlo(&surrogate, SAMPLES, 1, &Silent).unwrap();
    // Fourth central moments, for the standard error of the variance, from a smaller independent sample.
    let plan = pcc_evaluate::evaluation::Plan::new(&surrogate);
    let points = random_points(&surrogate.inputs, 2, Purpose::Evaluation, 0..50_000);
    let block = evaluate_points(&surrogate, &plan, &points.iter().map(Vec::as_slice).collect::<Vec<_>>());
    for (id, (mean, variance)) in surrogate.moments().into_iter().enumerate() {
        let found = &summary.components[id];
        let fourth = block.components[id].iter().map(|x| (x - mean).powi(4)).sum::<f64>() / 50_000.0;
        let n = SAMPLES as f64;
        assert!((found.mean() - mean).abs() < 4.0 * (variance / n).sqrt(), "mean of component {id}");
        assert!((found.variance() - variance).abs() < 4.0 * ((fourth - variance * variance) / n).sqrt());
    }
}
