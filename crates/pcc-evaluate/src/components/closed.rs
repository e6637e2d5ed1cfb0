//! Groups of eigenvalues that are closed under conjugation: the roots of a polynomial with real coefficients.
//!
//! A mode that becomes overdamped, or diverges, meets its conjugate on the real axis. There both change like a square
//! root, as any two eigenvalues that coalesce, and the elementary symmetric functions of the group stay smooth:
//!
//! λⁿ − e₁ λⁿ⁻¹ + e₂ λⁿ⁻² − … ± eₙ = 0.
//!
//! They are not centred on the mean: of a slow and a fast real eigenvalue the slow one is the product over the fast
//! one, and keeps its digits.
//!
//! Where all odd functions are zero, the group is undamped.

use super::roots::roots;
use num_complex::Complex;

/// Eigenvalues in one closed group at most: relative errors of e₁ … eₙ are amplified in the roots by 4·10⁶ for eight of
/// like modulus.
pub const MOST_IN_CLOSED_GROUP: usize = 8;

/// Writes the eigenvalues of a group with `symmetric` functions e₁, …, eₙ of which `modes` are modes, in the order of
/// its labels: the modes, their second eigenvalues, the real ones.
///
/// 1. Pairs take the numbers of the modes in turn, by |λ|; of equal ones by Im λ, then Re λ.
/// 2. The real eigenvalues, the largest first, give two to each mode that is left, then fill the real ones.
/// 3. If there are more pairs than modes, both eigenvalues of the last pairs stand among the real ones.
///
/// # Panics
///
/// If `eigenvalues` differ in number from `symmetric`, or are less than twice the `modes` or more than
/// [`MOST_IN_CLOSED_GROUP`].
///
/// # Examples
///
/// ```
/// use num_complex::Complex;
/// use pcc_evaluate::components::closed_eigenvalues;
/// // −1 ± 2i and −5: e₁ = −7, e₂ = 15, e₃ = −25.
/// let mut found = [Complex::default(); 3];
/// closed_eigenvalues(&[-7.0, 15.0, -25.0], 1, &mut found);
/// let expected = [Complex::new(-1.0, 2.0), Complex::new(-1.0, -2.0), Complex::new(-5.0, 0.0)];
/// assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).norm() < 1e-14));
/// ```
pub fn closed_eigenvalues(symmetric: &[f64], modes: usize, eigenvalues: &mut [Complex<f64>]) {
    match *symmetric {
        [e_1] => eigenvalues[0] = Complex::new(e_1, 0.0),
        [e_1, e_2] => eigenvalues.copy_from_slice(&closed_pair(e_1, e_2)),
        _ => {
            match symmetric.iter().step_by(2).all(|&odd| odd == 0.0) {
                true => undamped_eigenvalues(symmetric, eigenvalues),
                false => real_polynomial_roots(symmetric, eigenvalues),
            }
            in_order_of_labels(eigenvalues, modes);
        }
    }
}

/// λ² − e₁ λ + e₂ = 0: a pair, Im λ > 0 first, or two real ones, the larger first.
#[inline(always)]
pub fn closed_pair(e_1: f64, e_2: f64) -> [Complex<f64>; 2] {
    let middle = 0.5 * e_1;
    let discriminant = middle * middle - e_2;
    let root = discriminant.abs().sqrt();
    if discriminant < 0.0 {
        return [Complex::new(middle, root), Complex::new(middle, -root)];
    }
    // The one farther from zero is a sum without cancellation, the other follows from the product of both.
    let far = if middle < 0.0 { middle - root } else { middle + root };
    let near = if far == 0.0 { 0.0 } else { e_2 / far };
    let (larger, smaller) = if far > near { (far, near) } else { (near, far) };
    [Complex::new(larger, 0.0), Complex::new(smaller, 0.0)]
}

/// The roots where all odd functions are zero: those of an undamped system, which come as ±λ. They are found in λ²,
/// so that what neither grows nor decays has Re λ = 0 exactly. In no order.
fn undamped_eigenvalues(symmetric: &[f64], found: &mut [Complex<f64>]) {
    let half = symmetric.len() / 2;
    let (mut of_squares, mut squares) = ([0.0; MOST_IN_CLOSED_GROUP], [Complex::default(); MOST_IN_CLOSED_GROUP]);
    for (m, of_squares) in of_squares[..half].iter_mut().enumerate() {
        // The function of degree m + 1 in λ² is ±e of degree 2m + 2.
        let even = symmetric[2 * m + 1];
        *of_squares = if m % 2 == 0 { -even } else { even };
    }
    real_roots_or_pairs(&of_squares[..half], &mut squares[..half]);
    for (pair, square) in found.chunks_exact_mut(2).zip(&squares[..half]) {
        let root = if square.im != 0.0 {
            square.sqrt()
        } else if square.re < 0.0 {
            Complex::new(0.0, (-square.re).sqrt())
        } else {
            Complex::new(square.re.sqrt(), 0.0)
        };
        // No −0, which is neither equal to its conjugate nor real.
        let other = Complex::new(0.0 - root.re, 0.0 - root.im);
        pair.copy_from_slice(&[root, other]);
    }
    if found.len() % 2 == 1 {
        found[2 * half] = Complex::default();
    }
}

/// The roots for e₁, …, eₙ, exactly conjugate or exactly real, in no order.
pub(super) fn real_roots_or_pairs(symmetric: &[f64], found: &mut [Complex<f64>]) {
    match *symmetric {
        [e_1] => found[0] = Complex::new(e_1, 0.0),
        [e_1, e_2] => found.copy_from_slice(&closed_pair(e_1, e_2)),
        _ => real_polynomial_roots(symmetric, found),
    }
}

/// The same of three or more.
fn real_polynomial_roots(symmetric: &[f64], found: &mut [Complex<f64>]) {
    let mut coefficients = [Complex::default(); MOST_IN_CLOSED_GROUP];
    let coefficients = &mut coefficients[..symmetric.len()];
    for (m, (coefficient, &e)) in coefficients.iter_mut().zip(symmetric).enumerate() {
        coefficient.re = if m % 2 == 0 { -e } else { e };
    }
    roots(coefficients, found);
    // Every root has its conjugate among the others, or is its own but for rounding: the nearest decides. Those that
    // are farthest from the axis come first.
    let mut left = found.len();
    while left > 0 {
        let farthest = (0..left).fold(0, |most, i| if found[i].im.abs() > found[most].im.abs() { i } else { most });
        found.swap(farthest, left - 1);
        let lambda = found[left - 1];
        let distance = |i: &usize| (found[*i] - lambda.conj()).norm();
        let partner = (0..left - 1).reduce(|a, b| if distance(&b) < distance(&a) { b } else { a });
        match partner.filter(|partner| distance(partner) < 2.0 * lambda.im.abs()) {
            Some(partner) => {
                let mean = (lambda + found[partner].conj()) * 0.5;
                found.swap(partner, left - 2);
                (found[left - 1], found[left - 2]) = (mean, mean.conj());
                left -= 2;
            }
            None => {
                // NaN stays, and −0 does not.
                found[left - 1].im = found[left - 1].im * 0.0 + 0.0;
                left -= 1;
            }
        }
    }
}

/// Puts conjugate pairs and real eigenvalues where [`closed_eigenvalues`] says.
fn in_order_of_labels(found: &mut [Complex<f64>], modes: usize) {
    let count = found.len();
    let (mut pairs, mut reals) =
        ([Complex::default(); MOST_IN_CLOSED_GROUP], [Complex::default(); MOST_IN_CLOSED_GROUP]);
    let (mut pair_count, mut real_count) = (0, 0);
    for &lambda in &*found {
        if lambda.im > 0.0 {
            pairs[pair_count] = lambda;
            pair_count += 1;
        } else if lambda.im == 0.0 || lambda.im.is_nan() {
            reals[real_count] = lambda;
            real_count += 1;
        }
    }
    let by_frequency = |a: &Complex<f64>, b: &Complex<f64>| {
        a.norm_sqr().total_cmp(&b.norm_sqr()).then(a.im.total_cmp(&b.im)).then(a.re.total_cmp(&b.re))
    };
    pairs[..pair_count].sort_by(by_frequency);
    for &lambda in &pairs[pair_count.min(modes)..pair_count] {
        (reals[real_count], reals[real_count + 1]) = (lambda, lambda.conj());
        real_count += 2;
    }
    reals[..real_count].sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    let mut reals = reals[..real_count].iter().copied();
    let mut next_real = || reals.next().unwrap_or_default();
    for mode in 0..modes {
        (found[mode], found[modes + mode]) =
            if mode < pair_count { (pairs[mode], pairs[mode].conj()) } else { (next_real(), next_real()) };
    }
    for real in &mut found[2 * modes..count] {
        *real = next_real();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Away from coalescence, rounding moves roots by no more than this share of the largest |λ|.
    const SEPARATED: f64 = 1e-10;

    fn symmetric(lambdas: &[Complex<f64>]) -> Vec<f64> {
        let mut e = vec![Complex::new(1.0, 0.0)];
        for lambda in lambdas {
            e.push(Complex::default());
            for m in (1..e.len()).rev() {
                let lower = e[m - 1] * lambda;
                e[m] += lower;
            }
        }
        e[1..].iter().map(|e| e.re).collect()
    }

    fn found(lambdas: &[Complex<f64>], modes: usize) -> Vec<Complex<f64>> {
        let mut found = vec![Complex::default(); lambdas.len()];
        closed_eigenvalues(&symmetric(lambdas), modes, &mut found);
        found
    }

    fn pair(re: f64, im: f64) -> [Complex<f64>; 2] {
        [Complex::new(re, im), Complex::new(re, -im)]
    }

    fn real(re: f64) -> Complex<f64> {
        Complex::new(re, 0.0)
    }

    proptest! {
        #[test]
        fn eigenvalues_come_back_by_frequency_and_size(
            pairs in prop::collection::vec((-3.0..1.0f64, 0.0..1.0f64), 0..=2),
            reals in prop::collection::vec(0.0..1.0f64, 0..=3),
        ) {
            prop_assume!(pairs.len() + reals.len() > 0);
            let mut pairs: Vec<_> =
                pairs.iter().enumerate().map(|(k, &(re, im))| pair(re, 4.0 + 8.0 * k as f64 + im)).collect();
            pairs.sort_by(|a, b| a[0].norm().total_cmp(&b[0].norm()));
            let reals: Vec<_> = reals.iter().enumerate().map(|(k, x)| real(0.5 - 2.0 * k as f64 - x)).collect();
            let all: Vec<_> = pairs.concat().into_iter().chain(reals.iter().copied()).collect();
            let scale = all.iter().map(|lambda| lambda.norm()).fold(0.0, f64::max);
            let expected: Vec<_> = pairs
                .iter()
                .map(|pair| pair[0])
                .chain(pairs.iter().map(|pair| pair[1]))
                .chain(reals.iter().copied())
                .collect();
            for (found, expected) in found(&all, pairs.len()).iter().zip(&expected) {
                prop_assert!((found - expected).norm() <= SEPARATED * scale, "{found} is not {expected}");
                prop_assert!((found.im == 0.0) == (expected.im == 0.0));
            }
        }
    }

    #[test]
    fn slow_eigenvalues_keep_their_digits_beside_fast_ones() {
        let [slow, fast] = found(&[real(-0.3), real(-3e9)], 1)[..] else { panic!() };
        assert!((slow.re / -0.3 - 1.0).abs() < 1e-15 && (fast.re / -3e9 - 1.0).abs() < 1e-15);
    }

    #[test]
    fn meetings_on_the_axis_are_found_to_the_root_of_rounding() {
        for distance in [0.0, 1e-9, 1e-6, 1e-3] {
            for offset in [Complex::new(distance, 0.0), Complex::new(0.0, distance)] {
                let lambdas = [real(-2.0) + offset, real(-2.0) - offset, real(-7.0), real(-20.0)];
                let found = found(&lambdas, 1);
                let tolerance = if distance > 1e-4 { 1e-10 } else { 1e-6 };
                let expected = if offset.re > 0.0 { lambdas[0] } else { Complex::new(-2.0, distance) };
                assert!((found[0] - expected).norm() < tolerance, "{distance}: {found:?}");
                assert!((found[2] - lambdas[2]).norm() < 1e-10 && found[2].im == 0.0);
            }
        }
    }

    #[test]
    fn overdamped_modes_take_two_real_ones_and_spare_pairs_stand_among_the_real_ones() {
        let group = [pair(-1.0, 5.0).as_slice(), &[real(-0.8), real(-3.0)]].concat();
        let found_two = found(&group, 2);
        let names = |lambdas: &[Complex<f64>]| lambdas.iter().map(|l| (l.re.round(), l.im.round())).collect::<Vec<_>>();
        assert_eq!(names(&found_two), [(-1.0, 5.0), (-1.0, 0.0), (-1.0, -5.0), (-3.0, 0.0)]);
        assert_eq!(names(&found(&group, 0)), [(-1.0, 0.0), (-1.0, 5.0), (-1.0, -5.0), (-3.0, 0.0)]);
    }

    /// Whatever the coefficients are rounded to, what neither grows nor decays has Re λ = 0.
    #[test]
    fn undamped_groups_lie_on_the_axes_exactly() {
        let undamped = [pair(0.0, 3.0), pair(0.0, 7.1), pair(0.0, 11.3)];
        for lambda in found(&undamped.concat(), 3) {
            assert_eq!(lambda.re, 0.0);
        }
        let divergent = [pair(0.0, 3.0).as_slice(), &[real(2.0), real(-2.0)]].concat();
        let found_two = found(&divergent, 2);
        assert!(found_two[0].re == 0.0 && (found_two[0].im - 3.0).abs() < 1e-12);
        assert!(found_two[1].im == 0.0 && (found_two[1].re - 2.0).abs() < 1e-12);
        let flutter = [pair(0.5, 4.0), pair(-0.5, 4.0)].concat();
        let largest = found(&flutter, 2).iter().map(|lambda| lambda.re).fold(0.0, f64::max);
        assert!((largest - 0.5).abs() < 1e-12);
    }

    #[test]
    fn broken_values_give_broken_eigenvalues() {
        for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for symmetric in [&[broken][..], &[1.0, broken], &[1.0, broken, 2.0], &[broken, 1.0, 2.0, 3.0]] {
                let mut found = vec![Complex::default(); symmetric.len()];
                closed_eigenvalues(symmetric, 0, &mut found);
                assert!(found.iter().any(|l| !l.re.is_finite() || !l.im.is_finite()), "{symmetric:?}: {found:?}");
            }
        }
    }
}
