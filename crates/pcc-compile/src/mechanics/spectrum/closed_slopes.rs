//! Derivatives of the elementary symmetric functions of a group of eigenvalues that is closed under conjugation.
//!
//! With the spectral projector P of the group, de_m = Σ_{j<m} (−1)^j e_{m−1−j} tr(P Aʲ dA). Where eigenvalues of the
//! group differ by orders of magnitude, these sums cancel. So the group is cut into parts of eigenvalues that are close
//! to each other, and its polynomial is the product of theirs,
//!
//! p = Π_c p_c,   dp = Σ_c dp_c Π_{b≠c} p_b,
//!
//! with the polynomial of each part from its mean and the coefficients about it, which are regular where the part's
//! eigenvalues coalesce. A part of one eigenvalue has dp_c = −dλ.

use super::derivatives::invariant_slopes;
use super::target::invariants;
use crate::numerics::invariant_subspace::Subspace;
use nalgebra::{Complex, DMatrix};

/// Eigenvalues whose distance is below this share of the larger |λ| belong to one part.
const CLOSE: f64 = 0.1;

const ONE: Complex<f64> = Complex { re: 1.0, im: 0.0 };
const ZERO: Complex<f64> = Complex { re: 0.0, im: 0.0 };

/// A monic polynomial, highest power first, and its derivative by an input.
struct Polynomial {
    coefficients: Vec<Complex<f64>>,
    slopes: Vec<Complex<f64>>,
}

/// de_1, …, de_n for the upper triangular T of the group and W dA V of one input. If the eigenvalues `are_half` of the
/// group, their conjugates are the other half.
pub(super) fn closed_slopes(
    state_matrix: &DMatrix<Complex<f64>>,
    derivative: &DMatrix<Complex<f64>>,
    are_half: bool,
) -> Vec<f64> {
    let one = Polynomial { coefficients: vec![ONE], slopes: vec![ZERO] };
    let parts = parts(state_matrix).into_iter().map(|part| of_part(state_matrix, derivative, &part));
    let mut whole = parts.fold(one, |product, part| product.times(&part));
    if are_half {
        whole = whole.times(&whole.conjugate());
    }
    // λⁿ − e₁ λⁿ⁻¹ + e₂ λⁿ⁻² − …
    let signed = |(m, slope): (usize, &Complex<f64>)| if m % 2 == 0 { slope.re } else { -slope.re };
    whole.slopes.iter().enumerate().skip(1).map(signed).collect()
}

/// Positions on the diagonal of eigenvalues that are close to each other, in chains.
fn parts(state_matrix: &DMatrix<Complex<f64>>) -> Vec<Vec<usize>> {
    let lambda = |at: usize| state_matrix[(at, at)];
    let touches = |a: usize, b: usize| (lambda(a) - lambda(b)).norm() < CLOSE * lambda(a).norm().max(lambda(b).norm());
    let mut parts: Vec<Vec<usize>> = Vec::new();
    for at in 0..state_matrix.nrows() {
        let (mut joined, apart): (Vec<_>, Vec<_>) =
            parts.into_iter().partition(|part| part.iter().any(|&other| touches(at, other)));
        joined.push(vec![at]);
        parts = apart;
        parts.push(joined.concat());
    }
    parts
}

fn of_part(state_matrix: &DMatrix<Complex<f64>>, derivative: &DMatrix<Complex<f64>>, part: &[usize]) -> Polynomial {
    let subspace = Subspace::of_triangular(state_matrix.clone(), part);
    let derivative = &subspace.left * derivative * &subspace.right;
    let lambdas: Vec<Complex<f64>> = subspace.restricted.diagonal().iter().copied().collect();
    if let [lambda] = lambdas[..] {
        return Polynomial { coefficients: vec![ONE, -lambda], slopes: vec![ZERO, -derivative[(0, 0)]] };
    }
    // The mean s and c_{k−2}, …, c_0 of the polynomial in z − s, with their slopes.
    let (values, slopes) = (invariants(&lambdas), invariant_slopes(&subspace.restricted, &derivative));
    let centered = |head: Complex<f64>, parts: &[Complex<f64>]| [&[head, ZERO], &parts[1..]].concat();
    let (mean, mean_slope) = (values[0], slopes[0]);
    let (coefficients, slopes) = (centered(ONE, &values), centered(ZERO, &slopes));
    // d p(z − s) = (dp)(z − s) − ds p′(z − s)
    let degree = coefficients.len() - 1;
    let moved = (0..=degree).map(|k| {
        let of_derivative = if k == 0 { ZERO } else { coefficients[k - 1] * (degree + 1 - k) as f64 };
        slopes[k] - mean_slope * of_derivative
    });
    Polynomial { slopes: shifted(moved.collect(), mean), coefficients: shifted(coefficients, mean) }
}

/// The coefficients in z of a polynomial in z − s, highest power first, by repeated synthetic division.
fn shifted(mut coefficients: Vec<Complex<f64>>, s: Complex<f64>) -> Vec<Complex<f64>> {
    for end in (1..coefficients.len()).rev() {
        for k in 1..=end {
            let carried = coefficients[k - 1] * s;
            coefficients[k] -= carried;
        }
    }
    coefficients
}

impl Polynomial {
    fn times(&self, other: &Self) -> Self {
        let count = self.coefficients.len() + other.coefficients.len() - 1;
        let (mut coefficients, mut slopes) = (vec![ZERO; count], vec![ZERO; count]);
        for (i, (a, da)) in self.coefficients.iter().zip(&self.slopes).enumerate() {
            for (k, (b, db)) in other.coefficients.iter().zip(&other.slopes).enumerate() {
                coefficients[i + k] += a * b;
                slopes[i + k] += a * db + da * b;
            }
        }
        Self { coefficients, slopes }
    }

    fn conjugate(&self) -> Self {
        let conjugated = |list: &[Complex<f64>]| list.iter().map(Complex::conj).collect();
        Self { coefficients: conjugated(&self.coefficients), slopes: conjugated(&self.slopes) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    fn complex(matrix: &DMatrix<f64>) -> DMatrix<Complex<f64>> {
        matrix.map(|entry| Complex::new(entry, 0.0))
    }

    #[test]
    fn slow_eigenvalues_keep_the_digits_of_their_slopes_beside_fast_ones() {
        let (matrix, change) = (dmatrix![-0.3, 5.0; 0.0, -3e9], dmatrix![0.1, 0.0; 0.0, 0.0]);
        let found = closed_slopes(&complex(&matrix), &complex(&change), false);
        // e₁ = λ + μ, e₂ = λμ.
        assert!((found[0] - 0.1).abs() < 1e-15 && (found[1] / -3e8 - 1.0).abs() < 1e-14, "{found:?}");
    }

    #[test]
    fn coalesced_eigenvalues_have_regular_slopes() {
        // det(zI − A) = z² + 2z + 1 − x at x = 0: a double root at −1.
        let (matrix, change) = (dmatrix![-1.0, 1.0; 0.0, -1.0], dmatrix![0.0, 0.0; 1.0, 0.0]);
        assert_eq!(closed_slopes(&complex(&matrix), &complex(&change), false), [0.0, -1.0]);
    }

    #[test]
    fn polynomials_are_shifted_exactly() {
        // (z − 2)² + 3(z − 2) + 1 = z² − z − 1
        let real = |values: &[f64]| values.iter().map(|&value| Complex::new(value, 0.0)).collect::<Vec<_>>();
        assert_eq!(shifted(real(&[1.0, 3.0, 1.0]), Complex::new(2.0, 0.0)), real(&[1.0, -1.0, -1.0]));
    }
}
