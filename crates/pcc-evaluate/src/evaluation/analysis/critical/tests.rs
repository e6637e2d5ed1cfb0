//! Critical values are those of functions whose crossings are known.

use super::*;
use crate::evaluation::monte_carlo;
use crate::evaluation::test_surrogates::{XI, expansion, inputs, on_threads, polynomial, surrogate};
use crate::foundation::Silent;
use crate::probability::inputs::random_point;

/// φ_2 = √5 (3ξ² − 1)/2, so ξ² = 1/3 + 2 φ_2/(3√5).
const SQUARE: [f64; 2] = [1.0 / 3.0, 0.298_142_396_999_972];

/// max Re λ = ξ1 + slope ξ2 with x1 on \[10, 30\].
fn linear(slope: f64) -> Surrogate {
    let terms: [(&[u16], f64); 2] = [(&[1, 0], XI), (&[0, 1], slope * XI)];
    surrogate(inputs(&[(10.0, 30.0), (-3.0, 5.0)]), vec![expansion(&terms)])
}

/// The critical values of `linear` at the samples themselves, ascending; infinite where there is none.
fn sorted_crossings(slope: f64, samples: u64, seed: u64) -> Vec<f64> {
    let surrogate = linear(slope);
    let mut point = [0.0; 2];
    let mut crossings: Vec<f64> = (0..samples)
        .map(|index| {
            random_point(&surrogate.inputs, seed, Purpose::Evaluation, index, &mut point);
            let xi = (-slope * point[1]).max(-1.0);
            if xi <= 1.0 { 20.0 + 10.0 * xi } else { f64::INFINITY }
        })
        .collect();
    crossings.sort_by(f64::total_cmp);
    crossings
}

#[test]
fn values_of_a_linear_boundary_are_those_of_the_samples() {
    const SAMPLES: u64 = 5000;
    for (slope, seed) in [(0.5, 1), (2.0, 2)] {
        let found = critical_values(&linear(slope), 0, SAMPLES, seed, &Silent).unwrap();
        let exact = sorted_crossings(slope, SAMPLES, seed);
        let lost: Vec<f64> = exact.iter().copied().filter(|value| value.is_finite()).collect();
        assert_eq!(found.never, SAMPLES - lost.len() as u64);
        assert_eq!(found.unstable_from_start, exact.iter().filter(|&&value| value == 10.0).count() as u64);
        let mean = lost.iter().sum::<f64>() / lost.len() as f64;
        // 10⁻⁹ of the width.
        assert!((found.mean().unwrap() - mean).abs() < 20e-9);
        assert!((found.minimum().unwrap() - lost[0]).abs() < 20e-9);
        assert!((found.maximum().unwrap() - lost[lost.len() - 1]).abs() < 20e-9);
        for level in CRITICAL_LEVELS {
            let at = (level * SAMPLES as f64).ceil() as usize - 1;
            match found.quantile(level) {
                Some(value) => {
                    assert!((value - exact[at]).abs() <= 20e-4 + 1e-9, "{level}: {value}, {}", exact[at])
                }
                None => assert_eq!(exact[at], f64::INFINITY, "{level}"),
            }
        }
    }
}

/// ξ1 = −ξ2/2 is uniform on \[−½, ½\]: x1 on \[15, 25\].
#[test]
fn quantiles_converge_to_those_of_the_known_distribution() {
    let found = critical_values(&linear(0.5), 0, 100_000, 3, &Silent).unwrap();
    assert_eq!((found.never, found.unstable_from_start), (0, 0));
    for level in CRITICAL_LEVELS {
        let standard_error = 10.0 * (level * (1.0 - level) / 100_000f64).sqrt();
        let value = found.quantile(level).unwrap();
        assert!((value - (15.0 + 10.0 * level)).abs() < 4.0 * standard_error + 20e-4, "{level}: {value}");
    }
}

/// With slope 2 a quarter each is unstable from the start and never.
#[test]
fn quantiles_count_samples_that_are_never_or_always_unstable() {
    let found = critical_values(&linear(2.0), 0, 20_000, 4, &Silent).unwrap();
    let expected = |count: u64| (count as f64 - 5000.0).abs() < 4.0 * (20_000.0f64 * 0.25 * 0.75).sqrt();
    assert!(expected(found.never) && expected(found.unstable_from_start), "{found:?}");
    assert_eq!([0.0, 0.01, 0.05].map(|level| found.quantile(level)), [Some(10.0); 3]);
    assert_eq!([0.95, 0.99, 1.0].map(|level| found.quantile(level)), [None; 3]);
    assert!((found.quantile(0.5).unwrap() - 20.0).abs() < 0.5);
}

#[test]
fn systems_that_are_never_unstable_have_no_critical_value() {
    let found = critical_values(&polynomial(2, &[(&[0, 0], -3.0), (&[1, 0], XI)]), 0, 3000, 1, &Silent).unwrap();
    assert_eq!((found.samples, found.never, found.unstable_from_start), (3000, 3000, 0));
    assert_eq!((found.mean(), found.minimum(), found.maximum()), (None, None, None));
    assert_eq!(CRITICAL_LEVELS.map(|level| found.quantile(level)), [None; 7]);
}

#[test]
fn systems_that_are_always_unstable_have_the_lower_bound() {
    // What grows at all is unstable.
    for growth_rate in [1e-300, 3.0] {
        let always = surrogate(inputs(&[(0.1, 0.7), (0.0, 1.0)]), vec![expansion(&[(&[0, 0], growth_rate)])]);
        let found = critical_values(&always, 0, 3000, 1, &Silent).unwrap();
        assert_eq!((found.never, found.unstable_from_start), (0, 3000));
        assert_eq!((found.mean(), found.minimum(), found.maximum()), (Some(0.1), Some(0.1), Some(0.1)));
        assert_eq!(CRITICAL_LEVELS.map(|level| found.quantile(level)), [Some(0.1); 7]);
    }
}

#[test]
fn systems_that_are_marginal_everywhere_lose_nothing() {
    let undamped = surrogate(inputs(&[(0.1, 0.7)]), vec![expansion(&[(&[0], 0.0)])]);
    let found = critical_values(&undamped, 0, 3000, 1, &Silent).unwrap();
    assert_eq!((found.never, found.unstable_from_start), (3000, 0));
}

#[test]
fn the_first_of_several_crossings_counts() {
    // ¼ − ξ²: unstable between −½ and ½.
    let inside = polynomial(1, &[(&[0], 0.25 - SQUARE[0]), (&[2], -SQUARE[1])]);
    let found = critical_values(&inside, 0, 10, 1, &Silent).unwrap();
    assert!((found.minimum().unwrap() + 0.5).abs() < 2e-9 && found.minimum() == found.maximum());
    // ξ² − ¼: unstable at both ends of the domain.
    let outside = polynomial(1, &[(&[0], SQUARE[0] - 0.25), (&[2], SQUARE[1])]);
    let found = critical_values(&outside, 0, 10, 1, &Silent).unwrap();
    assert_eq!((found.unstable_from_start, found.maximum()), (10, Some(-1.0)));
}

#[test]
fn the_first_mode_to_become_unstable_counts() {
    let mode = |center, slope| expansion(&[(&[0], center), (&[1], slope * XI)]);
    let both = surrogate(inputs(&[(-1.0, 1.0)]), vec![mode(-0.4, 1.0), mode(-0.3, 10.0)]);
    let found = critical_values(&both, 0, 1, 1, &Silent).unwrap();
    assert!((found.minimum().unwrap() - 0.03).abs() < 2e-9, "{found:?}");
}

/// What the module's documentation says is missed, and what is not.
#[test]
fn instability_wider_than_a_cell_is_found() {
    // w² − (ξ − 0.01)², unstable on an interval of width 2w; cells are 1/32 wide and 0 is a grid point.
    let bump = |w: f64| {
        let center = w * w - 1e-4 - SQUARE[0];
        critical_values(&polynomial(1, &[(&[0], center), (&[1], 0.02 * XI), (&[2], -SQUARE[1])]), 0, 1, 1, &Silent)
    };
    assert_eq!(bump(0.005).unwrap().never, 1);
    for w in [0.0157, 0.05] {
        assert!((bump(w).unwrap().minimum().unwrap() - (0.01 - w)).abs() < 2e-9);
    }
}

#[test]
fn every_input_can_be_chosen() {
    let found = critical_values(&linear(2.0), 1, 20_000, 4, &Silent).unwrap();
    // ξ2 = −ξ1/2: x2 = 1 + 4ξ2 on [−1, 3].
    assert_eq!((found.never, found.unstable_from_start), (0, 0));
    assert!((found.minimum().unwrap() + 1.0).abs() < 1e-2 && (found.maximum().unwrap() - 3.0).abs() < 1e-2);
    let error = critical_values(&linear(2.0), 2, 10, 1, &Silent).unwrap_err();
    assert_eq!(error, EvalError::NoSuchInput { input: 2, inputs: 2 });
    assert_eq!(critical_values(&linear(2.0), 0, 0, 1, &Silent), Err(EvalError::NoSamples));
}

#[test]
fn results_are_the_same_bits_on_1_and_3_threads() {
    let found = |threads| on_threads(threads, || critical_values(&linear(2.0), 0, 10_007, 5, &Silent).unwrap());
    assert_eq!(found(1), found(3));
}

#[test]
fn overflow_is_refused_with_its_point() {
    let overflowing = polynomial(1, &[(&[0], -1e308), (&[30], 1e308), (&[31], 1e308)]);
    assert!(monte_carlo(&overflowing, 1000, 1, &Silent).is_err());
    let error = critical_values(&overflowing, 0, 10, 1, &Silent).unwrap_err();
    assert!(matches!(&error, EvalError::NotFinite { point } if point.starts_with("x1 = ")), "{error}");
}

proptest::proptest! {
    #[test]
    fn quantiles_are_ascending(levels in proptest::collection::vec(0.0..=1.0f64, 2..20), seed in 0..50u64) {
        let found = critical_values(&linear(1.5), 0, 40, seed, &Silent).unwrap();
        let mut levels = levels;
        levels.sort_by(f64::total_cmp);
        let quantiles: Vec<f64> =
            levels.iter().map(|&level| found.quantile(level).unwrap_or(f64::INFINITY)).collect();
        proptest::prop_assert!(quantiles.is_sorted(), "{:?}", quantiles);
    }
}
