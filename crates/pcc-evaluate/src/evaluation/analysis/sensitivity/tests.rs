//! Intervals hold what is known exactly at their level.

use super::*;
use crate::evaluation::monte_carlo;
use crate::evaluation::test_surrogates::{XI, expansion, inputs, on_threads, polynomial, surrogate};
use crate::foundation::Silent;
use crate::probability::inputs::random_point;

/// Strong and weak inputs, an interaction, and one input without influence.
fn mixture() -> Surrogate {
    polynomial(
        4,
        &[
            (&[0, 0, 0, 0], -1.0),
            (&[1, 0, 0, 0], 3.0),
            (&[0, 2, 0, 0], 1.0),
            (&[1, 1, 0, 0], 1.5),
            (&[0, 0, 3, 0], 0.2),
        ],
    )
}

fn holds(estimate: Estimate, exact: f64) -> bool {
    // The indices of inputs without influence, and those of 1, are found but for rounding.
    estimate.lower <= exact + 1e-12 && exact - 1e-12 <= estimate.upper
}

/// For every index, the share of seeds whose interval holds the exact value, first and total alternating.
fn coverage(
    surrogate: &Surrogate,
    samples: u64,
    output: fn(Sensitivities) -> Option<Vec<Sensitivity>>,
    exact: &[(f64, f64)],
) -> Vec<f64> {
    const SEEDS: u64 = 400;
    let mut covered = vec![0.0; 2 * exact.len()];
    for seed in 0..SEEDS {
        let found = output(sensitivities(surrogate, samples, seed, &Silent).unwrap()).unwrap();
        for (j, (sensitivity, &(first, total))) in found.iter().zip(exact).enumerate() {
            covered[2 * j] += f64::from(holds(sensitivity.first, first)) / SEEDS as f64;
            covered[2 * j + 1] += f64::from(holds(sensitivity.total, total)) / SEEDS as f64;
        }
    }
    covered
}

/// 0.92 is nearly three standard errors of 400 seeds below 0.95.
const LOWEST_COVERAGE: f64 = 0.92;

#[test]
fn intervals_of_max_re_hold_the_indices_of_the_coefficients_at_their_level() {
    let surrogate = mixture();
    let exact = surrogate.expansions[0].sobol_indices().unwrap();
    let exact: Vec<(f64, f64)> = exact.first.into_iter().zip(exact.total).collect();
    for samples in [300, 2000] {
        let covered = coverage(&surrogate, samples, |found| found.max_re, &exact);
        assert!(covered.iter().all(|&share| share >= LOWEST_COVERAGE), "{samples} samples: {covered:?}");
    }
}

#[test]
fn indices_converge_to_those_of_the_coefficients() {
    let surrogate = mixture();
    let exact = surrogate.expansions[0].sobol_indices().unwrap();
    let found = sensitivities(&surrogate, 200_000, 1, &Silent).unwrap().max_re.unwrap();
    for (j, sensitivity) in found.iter().enumerate() {
        assert!((sensitivity.first.value - exact.first[j]).abs() < 0.01, "S_{j}: {sensitivity:?}");
        assert!((sensitivity.total.value - exact.total[j]).abs() < 0.01, "T_{j}: {sensitivity:?}");
    }
    let none = found[3];
    assert!(none.first.upper < 1e-6 && none.total.upper < 1e-12, "no influence: {none:?}");
}

/// max(ξ1, ξ2): E\[f | ξ1\] = (1 + ξ1)²/4, of variance 4/45; f has variance 2/9.
#[test]
fn the_largest_of_two_modes_has_its_own_indices() {
    let modes = vec![expansion(&[(&[1, 0], XI)]), expansion(&[(&[0, 1], XI)])];
    let surrogate = surrogate(inputs(&[(-1.0, 1.0), (3.0, 8.0)]), modes);
    let exact = [(0.4, 0.6), (0.4, 0.6)];
    let covered = coverage(&surrogate, 1000, |found| found.max_re, &exact);
    assert!(covered.iter().all(|&share| share >= LOWEST_COVERAGE), "{covered:?}");
}

#[test]
fn a_single_input_that_decides_has_indices_1_and_others_0() {
    let surrogate = polynomial(2, &[(&[0, 0], -0.3), (&[1, 0], XI)]);
    let found = sensitivities(&surrogate, 100_000, 3, &Silent).unwrap();
    for output in [found.max_re.unwrap(), found.stability.unwrap()] {
        for (sensitivity, exact) in output.iter().zip([1.0, 0.0]) {
            for estimate in [sensitivity.first, sensitivity.total] {
                assert!((estimate.value - exact).abs() < 1e-3, "{estimate:?}");
                assert!(holds(estimate, exact) && estimate.upper - estimate.lower < 1e-3, "{estimate:?}");
            }
        }
    }
}

/// ξ1 + ξ2 < 0 has probability ½ and, given ξ1, (1 − ξ1)/2, of variance 1/12: S = (1/12)/(1/4).
#[test]
fn intervals_of_the_indicator_hold_the_indices_of_a_half_plane_at_their_level() {
    let surrogate = polynomial(2, &[(&[1, 0], XI), (&[0, 1], XI)]);
    let exact = [(1.0 / 3.0, 2.0 / 3.0); 2];
    for samples in [200, 2000] {
        let covered = coverage(&surrogate, samples, |found| found.stability, &exact);
        assert!(covered.iter().all(|&share| share >= LOWEST_COVERAGE), "{samples} samples: {covered:?}");
    }
}

/// max(ξ1, ξ2) − c ≥ 0, each alone with probability q: the indicator is a product, (1 − q)² and 1 − q given ξ1 < c.
#[test]
fn intervals_of_the_indicator_hold_where_few_samples_are_unstable() {
    let q = 0.01;
    let mode = |alpha| expansion(&[(&[0, 0], 2.0 * q - 1.0), (alpha, XI)]);
    let surrogate = surrogate(inputs(&[(-1.0, 1.0); 2]), vec![mode(&[1, 0]), mode(&[0, 1])]);
    let stable = (1.0 - q) * (1.0 - q);
    let variance = stable * (1.0 - stable);
    let first = (1.0 - q) * (1.0 - q) * q * (1.0 - q) / variance;
    let exact = [(first, 1.0 - first); 2];
    // About 20 of 1000 samples are unstable.
    let covered = coverage(&surrogate, 1000, |found| found.stability, &exact);
    assert!(covered.iter().all(|&share| share >= LOWEST_COVERAGE), "{covered:?}");
}

/// ξ1 + ε ξ2 < 0 is decided by ξ2 in n ε/3 of n samples: given ξ2, it has probability (1 − ε ξ2)/2, of variance
/// ε²/12, so S_2 = ε²/3; given ξ1, stability is open where |ξ1| < ε, and T_2 = 2ε/3.
#[test]
fn intervals_of_the_indicator_hold_where_an_input_decides_few_samples() {
    const SAMPLES: u64 = 300;
    for deciding in [0.1, 1.0, 3.0, 10.0] {
        let epsilon = 3.0 * deciding / SAMPLES as f64;
        let surrogate = polynomial(2, &[(&[1, 0], XI), (&[0, 1], epsilon * XI)]);
        let (first, total) = (epsilon * epsilon / 3.0, 2.0 * epsilon / 3.0);
        let covered =
            coverage(&surrogate, SAMPLES, |found| found.stability, &[(1.0 - total, 1.0 - first), (first, total)]);
        assert!(covered.iter().all(|&share| share >= LOWEST_COVERAGE), "{deciding} samples: {covered:?}");
    }
}

#[test]
fn an_input_that_was_not_seen_to_matter_is_not_excluded() {
    // Stability changes with ξ2 only where |ξ1| < 10⁻⁶.
    let surrogate = polynomial(2, &[(&[1, 0], XI), (&[0, 1], 1e-6 * XI)]);
    let found = sensitivities(&surrogate, 10_000, 1, &Silent).unwrap().stability.unwrap();
    assert_eq!((found[1].first.lower, found[1].total.lower), (0.0, 0.0));
    // 1.96²/(2 · 10⁴ · ¼)
    assert!((found[1].total.upper - 7.68e-4).abs() < 1e-5, "{found:?}");
}

#[test]
fn small_indices_are_sharper_than_those_of_a_plain_correlation() {
    let found = sensitivities(&mixture(), 10_000, 1, &Silent).unwrap().max_re.unwrap();
    let plain = 2.0 * 1.96 / 10_000f64.sqrt();
    let weak = found[2].first;
    assert!(weak.upper - weak.lower < 0.3 * plain, "{weak:?}");
}

#[test]
fn outputs_that_do_not_vary_have_no_indices() {
    let constant = sensitivities(&polynomial(2, &[(&[0, 0], -0.1)]), 5000, 1, &Silent).unwrap();
    assert_eq!(constant, Sensitivities { samples: 5000, max_re: None, stability: None });
    let stable = sensitivities(&polynomial(2, &[(&[0, 0], -9.0), (&[1, 0], 1.0)]), 5000, 1, &Silent).unwrap();
    assert!(stable.max_re.is_some() && stable.stability.is_none());
}

#[test]
fn few_samples_leave_everything_open() {
    let surrogate = polynomial(2, &[(&[1, 0], 1.0), (&[1, 1], 0.5)]);
    for samples in 1..10 {
        let found = sensitivities(&surrogate, samples, 1, &Silent).unwrap();
        for estimate in found.max_re.iter().chain(&found.stability).flatten().flat_map(|s| [s.first, s.total]) {
            assert!(0.0 <= estimate.lower && estimate.lower <= estimate.value, "{estimate:?}");
            assert!(estimate.value <= estimate.upper && estimate.upper <= 1.0, "{estimate:?}");
        }
    }
    let single = sensitivities(&surrogate, 1, 1, &Silent).unwrap().max_re.unwrap();
    assert_eq!((single[0].first.lower, single[0].first.upper), (0.0, 1.0));
}

#[test]
fn a_large_mean_costs_no_accuracy() {
    let near = polynomial(2, &[(&[1, 0], 1.0), (&[1, 1], 0.5)]);
    let far = polynomial(2, &[(&[0, 0], -1e8), (&[1, 0], 1.0), (&[1, 1], 0.5)]);
    let found = |surrogate| sensitivities(surrogate, 2000, 1, &Silent).unwrap().max_re.unwrap();
    for (near, far) in found(&near).iter().zip(found(&far)) {
        for (near, far) in [(near.first, far.first), (near.total, far.total)] {
            assert!((near.value - far.value).abs() < 1e-6 && (near.upper - far.upper).abs() < 1e-6);
        }
    }
}

#[test]
fn results_are_the_same_bits_on_1_and_3_threads() {
    let found = |threads| on_threads(threads, || sensitivities(&mixture(), 10_007, 5, &Silent).unwrap());
    assert_eq!(found(1), found(3));
}

#[test]
fn a_is_the_point_of_plain_sampling_and_b_is_another() {
    let space = inputs(&[(-1.0, 1.0), (0.0, 5.0), (-1.0, 1.0)]);
    let (mut pair, mut point) = ([0.0; 6], [0.0; 3]);
    for index in [0, 1, 1 << 40] {
        draw(&Region::whole(&space), 9, index, &mut pair);
        random_point(&space, 9, Purpose::Evaluation, index, &mut point);
        assert_eq!(pair[..3], point);
        assert!(pair[..3].iter().zip(&pair[3..]).all(|(a, b)| a != b));
    }
}

#[test]
fn values_that_are_no_use_are_refused_with_their_point() {
    let refused = |terms: &[(&[u16], f64)]| sensitivities(&polynomial(1, terms), 100, 1, &Silent).unwrap_err();
    for terms in [&[(&[0][..], 1e80)][..], &[(&[1][..], 1e80)], &[(&[30][..], 1e308), (&[31][..], 1e308)]] {
        let error = refused(terms);
        assert!(matches!(&error, EvalError::NotFinite { point } if point.starts_with("x1 = ")), "{error}");
    }
    assert_eq!(sensitivities(&mixture(), 0, 1, &Silent), Err(EvalError::NoSamples));
    assert!(monte_carlo(&mixture(), 1, 1, &Silent).is_ok());
}
