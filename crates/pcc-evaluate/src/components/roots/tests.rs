//! Roots are found to the accuracy their conditioning allows.

use super::*;
use proptest::prelude::*;
use std::f64::consts::TAU;

fn real(coefficients: &[f64]) -> Vec<Complex<f64>> {
    coefficients.iter().map(|&c| Complex::new(c, 0.0)).collect()
}

fn roots_of(coefficients: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let mut found = vec![Complex::new(f64::NAN, 0.0); coefficients.len()];
    roots(coefficients, &mut found);
    found
}

/// Coefficients of Π (z − z_i), in the order of [`roots`].
fn expanded(roots: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let mut coefficients = Vec::with_capacity(roots.len());
    for root in roots {
        coefficients.push(ZERO);
        for i in (0..coefficients.len()).rev() {
            let above = if i == 0 { Complex::new(1.0, 0.0) } else { coefficients[i - 1] };
            coefficients[i] -= root * above;
        }
    }
    coefficients
}

/// Largest difference between the coefficients of Π (z − found_i) and `coefficients`, relative to those of
/// Π (z + |found_i|).
fn backward_error(coefficients: &[Complex<f64>], found: &[Complex<f64>]) -> f64 {
    let moduli: Vec<_> = found.iter().map(|z| Complex::new(-z.norm(), 0.0)).collect();
    (expanded(found).iter().zip(coefficients).zip(expanded(&moduli)))
        .map(|((back, c), scale)| if back == c { 0.0 } else { (back - c).norm() / scale.norm() })
        .fold(0.0, f64::max)
}

/// |p(z)| relative to the sum of the moduli of its terms: the backward error of one root.
fn residual(coefficients: &[Complex<f64>], z: Complex<f64>) -> f64 {
    let (mut value, mut moduli) = (Complex::new(1.0, 0.0), 1.0);
    for c in coefficients {
        value = value * z + c;
        moduli = moduli * z.norm() + c.norm();
    }
    value.norm() / moduli
}

/// Largest distance from a root in `expected` to the nearest one in `found` that no other has taken, relative to
/// it.
fn distance(found: &[Complex<f64>], expected: &[Complex<f64>]) -> f64 {
    let mut left = found.to_vec();
    let mut worst: f64 = 0.0;
    for root in expected {
        let away = |z: &Complex<f64>| (z - root).norm();
        let (at, nearest) = left.iter().map(away).enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        worst = worst.max(if nearest == 0.0 { 0.0 } else { nearest / root.norm() });
        left.swap_remove(at);
    }
    worst
}

/// Up to eight roots with moduli between 1e-6 and 1e6, times a common scale between 1e-100 and 1e100, or as far as
/// the product of all is a normal number.
fn scaled_roots() -> impl Strategy<Value = Vec<Complex<f64>>> {
    let root = (-6.0..6.0f64, 0.0..TAU);
    (prop::collection::vec(root, 1..=8), -1.0..1.0f64).prop_map(|(roots, scale)| {
        let scale = scale * (290.0 / roots.len() as f64 - 6.0).min(100.0);
        roots.iter().map(|&(exponent, angle)| Complex::from_polar(10f64.powf(exponent + scale), angle)).collect()
    })
}

/// The same without pairs that are closer than a tenth of their modulus.
fn separated_roots() -> impl Strategy<Value = Vec<Complex<f64>>> {
    let far = |a: Complex<f64>, b: Complex<f64>| (a - b).norm() > 0.1 * a.norm();
    scaled_roots().prop_filter("two roots are close", move |roots| {
        (0..roots.len()).all(|i| (0..roots.len()).all(|j| i == j || far(roots[i], roots[j])))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn every_root_is_exact_for_nearby_coefficients(known in scaled_roots()) {
        let coefficients = expanded(&known);
        for root in roots_of(&coefficients) {
            prop_assert!(residual(&coefficients, root) <= 2.0 * known.len() as f64 * f64::EPSILON);
        }
    }

    #[test]
    fn separated_roots_multiply_to_the_polynomial(known in separated_roots()) {
        let coefficients = expanded(&known);
        let found = roots_of(&coefficients);
        prop_assert!(backward_error(&coefficients, &found) <= 1e-12);
    }

    #[test]
    fn separated_roots_are_found(known in separated_roots()) {
        prop_assert!(distance(&roots_of(&expanded(&known)), &known) < 1e-10);
    }

    #[test]
    fn roots_of_arbitrary_coefficients_are_exact_for_nearby_ones(
        parts in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64, -9..9i32), 1..24)
    ) {
        let coefficients: Vec<_> =
            parts.iter().map(|&(re, im, power)| Complex::new(re, im) * 10f64.powi(power)).collect();
        for root in roots_of(&coefficients) {
            prop_assert!(residual(&coefficients, root) <= 2.0 * coefficients.len() as f64 * f64::EPSILON);
        }
    }

    #[test]
    fn anything_finite_has_finite_roots(bits in prop::collection::vec((any::<f64>(), any::<f64>()), 1..6)) {
        let coefficients: Vec<_> = bits.iter().map(|&(re, im)| Complex::new(re, im) / 32.0).collect();
        prop_assume!(coefficients.iter().all(|c| c.re.is_finite() && c.im.is_finite()));
        for root in roots_of(&coefficients) {
            prop_assert!(root.re.is_finite() && root.im.is_finite(), "{root}");
        }
    }
}

#[test]
fn powers_of_z_have_exact_zero_roots() {
    for degree in [1, 2, 3, 4, 20] {
        assert_eq!(roots_of(&vec![ZERO; degree]), vec![ZERO; degree]);
    }
    // z²(z − 3) and z²(z² + 4)
    assert_eq!(roots_of(&real(&[-3.0, 0.0, 0.0])), real(&[3.0, 0.0, 0.0]));
    let oscillator = roots_of(&real(&[0.0, 4.0, 0.0, 0.0]));
    assert_eq!(distance(&oscillator[..2], &[Complex::new(0.0, 2.0), Complex::new(0.0, -2.0)]), 0.0);
    assert_eq!(oscillator[2..], [ZERO; 2]);
}

#[test]
fn roots_of_unity() {
    for degree in 1..=100 {
        let mut coefficients = vec![ZERO; degree];
        coefficients[degree - 1].re = -1.0;
        let expected: Vec<_> = (0..degree).map(|i| Complex::from_polar(1.0, TAU * i as f64 / degree as f64)).collect();
        assert!(distance(&roots_of(&coefficients), &expected) < 1e-14 * degree as f64);
    }
}

#[test]
fn small_root_of_a_quadratic_does_not_cancel() {
    let found = roots_of(&real(&[-1e9, 1.0]));
    assert!(distance(&found, &real(&[1e9, 1e-9])) < 1e-15, "{found:?}");
}

#[test]
fn square_roots_are_accurate_in_all_quadrants() {
    for exponent in [-300, -20, 0, 20, 300] {
        for i in 0..64 {
            let z = Complex::from_polar(10f64.powi(exponent), TAU * f64::from(i) / 64.0);
            let root = square_root(z);
            assert!((root * root - z).norm() <= 4.0 * f64::EPSILON * z.norm() && root.re >= 0.0, "{z}: {root}");
        }
    }
    assert_eq!(square_root(Complex::new(-4.0, 0.0)), Complex::new(0.0, 2.0));
    assert_eq!(square_root(Complex::new(-4.0, -0.0)), Complex::new(0.0, -2.0));
}

#[test]
fn multiple_roots_scatter_by_the_root_of_a_rounding() {
    for (centre, others) in [
        (Complex::new(1.0, 0.0), vec![]),
        (Complex::new(-3.0, 4.0), vec![Complex::new(1.0, 1.0)]),
        (Complex::new(0.5, -2e3), vec![Complex::new(0.25, 2e3), Complex::new(1e6, 0.0)]),
    ] {
        for multiplicity in 2..=4 {
            let known: Vec<_> = others.iter().copied().chain(std::iter::repeat_n(centre, multiplicity)).collect();
            let error = distance(&roots_of(&expanded(&known)), &known);
            let limit = 5.0 * f64::EPSILON.powf(1.0 / multiplicity as f64);
            assert!(error < limit, "{multiplicity} times {centre}: {error} is not below {limit}");
        }
    }
}

#[test]
fn clusters_and_ill_conditioned_roots_settle() {
    let wilkinson = expanded(&real(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]));
    assert!(distance(&roots_of(&wilkinson), &real(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0])) < 1e-10);
    let pairs = expanded(&real(&[1.0, 1.0 + 1e-9, -2.0, -2.0 - 1e-9]));
    let cluster = expanded(&real(&[1.0, 1.0 + 1e-9, 1.0 - 1e-9, 1.0 + 2e-9, 1.0 - 2e-9]));
    // Mignotte's z⁹ − 2(100 z − 1)²: two roots near 0.01, some 1e-11 from each other.
    let mignotte = real(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -2e4, 400.0, -2.0]);
    for coefficients in [wilkinson, pairs, cluster, mignotte] {
        for root in roots_of(&coefficients) {
            let limit = 2.0 * coefficients.len() as f64 * f64::EPSILON;
            assert!(residual(&coefficients, root) <= limit, "{root} of {coefficients:?}");
        }
    }
}

#[test]
fn magnitudes_may_differ_by_many_orders() {
    for known in [real(&[1e90, 1.0, -1e-3]), real(&[1.0, 1e-95, -1e-95]), real(&[1e5, 2e-60, 1e-65, -1e-65])] {
        let found = roots_of(&expanded(&known));
        assert!(distance(&found, &known) < 1e-14, "{found:?} are not {known:?}");
    }
}

#[test]
fn powers_of_two_scale_exactly() {
    let plain = [Complex::new(0.3, 1.0), Complex::new(-2.0, 0.5), Complex::new(0.1, 0.0)];
    let found = roots_of(&plain);
    for scale in [2f64.powi(-300), 2f64.powi(300)] {
        let mut power = 1.0;
        let scaled: Vec<_> = (plain.iter().map(|c| {
            power *= scale;
            c * power
        }))
        .collect();
        let expected: Vec<_> = found.iter().map(|root| root * scale).collect();
        assert_eq!(roots_of(&scaled), expected);
    }
}

#[test]
fn unusable_coefficients_give_roots_that_are_not_numbers() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (re, im) in [(bad, 0.0), (0.0, bad)] {
            for degree in 1..5 {
                let mut coefficients = vec![Complex::new(1.0, 1.0); degree];
                coefficients[degree / 2] = Complex::new(re, im);
                assert!(roots_of(&coefficients).iter().all(|root| root.re.is_nan() && root.im.is_nan()));
            }
        }
    }
}

#[test]
fn no_coefficients_have_no_roots() {
    roots(&[], &mut []);
}
