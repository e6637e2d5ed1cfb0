//! Orthonormal polynomials by their three-term recurrence.

use super::own::OwnPolynomials;
use std::sync::Arc;

/// Families of orthogonal polynomials, one per density of a standardized variable (table 1 of the paper).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Family {
    /// Legendre polynomials: uniform density ½ on [−1, 1].
    Legendre,
    /// Hermite polynomials: standard normal density.
    Hermite,
    /// Polynomials of a law that is neither.
    Own(Arc<OwnPolynomials>),
}

impl Family {
    /// Name in tables.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Legendre => "legendre",
            Self::Hermite => "hermite",
            Self::Own(own) => own.name(),
        }
    }

    /// The orthonormal recurrence up to `degree`.
    ///
    /// Legendre: a_k = 0, √b_k = k/√(4k² − 1). Hermite: a_k = 0, √b_k = √k. Others by sums over a fine rule.
    pub fn recurrence(&self, degree: usize) -> Recurrence {
        match self {
            Self::Legendre => Recurrence {
                diagonal: vec![0.0; degree],
                off_diagonal: (1..=degree).map(|k| k as f64 / ((4 * k * k - 1) as f64).sqrt()).collect(),
            },
            Self::Hermite => Recurrence {
                diagonal: vec![0.0; degree],
                off_diagonal: (1..=degree).map(|k| (k as f64).sqrt()).collect(),
            },
            Self::Own(own) => own.recurrence(degree),
        }
    }
}

/// Coefficients of √b_{k+1} φ_{k+1}(x) = (x − a_k) φ_k(x) − √b_k φ_{k−1}(x) with φ_0 = 1.
///
/// The polynomials have unit variance: E\[φ_j φ_k\] = δ_jk. So the mean of an expansion is its first coefficient and
/// its variance the sum of the other squares.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::polynomials::Family;
/// let mut values = [0.0; 3];
/// Family::Legendre.recurrence(2).evaluate(0.5, &mut values);
/// // φ_1 = √3 x, φ_2 = √5 (3x² − 1)/2
/// assert!((values[1] - 3f64.sqrt() * 0.5).abs() < 1e-15);
/// assert!((values[2] + 5f64.sqrt() * 0.125).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Recurrence {
    /// a_0, a_1, …: one per degree above 0.
    pub diagonal: Vec<f64>,
    /// √b_1, √b_2, …: one per degree above 0, none of them zero.
    pub off_diagonal: Vec<f64>,
}

impl Recurrence {
    /// Highest degree this recurrence reaches.
    pub fn degree(&self) -> usize {
        self.off_diagonal.len()
    }

    /// Writes φ_0(x), φ_1(x), … into `values`, at most `degree() + 1` of them.
    pub fn evaluate(&self, x: f64, values: &mut [f64]) {
        let (mut before, mut current) = (0.0, 1.0);
        let mut coupling = 0.0;
        for (k, value) in values.iter_mut().enumerate() {
            if k > 0 {
                let next = ((x - self.diagonal[k - 1]) * current - coupling * before) / self.off_diagonal[k - 1];
                coupling = self.off_diagonal[k - 1];
                (before, current) = (current, next);
            }
            *value = current;
        }
    }

    /// Writes φ_0(x), φ_1(x), … into `values` and φ′_0(x), φ′_1(x), … into `slopes`, at most `degree() + 1` of each:
    /// √b_{k+1} φ′_{k+1} = φ_k + (x − a_k) φ′_k − √b_k φ′_{k−1}.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::polynomials::Family;
    /// let (mut values, mut slopes) = ([0.0; 3], [0.0; 3]);
    /// Family::Legendre.recurrence(2).evaluate_with_slopes(0.5, &mut values, &mut slopes);
    /// // φ_1′ = √3, φ_2′ = 3√5 x
    /// assert!((slopes[1] - 3f64.sqrt()).abs() < 1e-15 && (slopes[2] - 1.5 * 5f64.sqrt()).abs() < 1e-14);
    /// ```
    pub fn evaluate_with_slopes(&self, x: f64, values: &mut [f64], slopes: &mut [f64]) {
        self.evaluate(x, values);
        let (mut before, mut current, mut coupling) = (0.0, 0.0, 0.0);
        for (k, slope) in slopes.iter_mut().enumerate() {
            if k > 0 {
                let next = (values[k - 1] + (x - self.diagonal[k - 1]) * current - coupling * before)
                    / self.off_diagonal[k - 1];
                coupling = self.off_diagonal[k - 1];
                (before, current) = (current, next);
            }
            *slope = current;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polynomials::gauss;

    /// Rounding of recurrence and quadrature at degree 40 stays below this.
    const TOLERANCE: f64 = 1e-12;

    #[test]
    fn legendre_is_orthonormal_under_exact_quadrature() {
        const DEGREE: usize = 40;
        let recurrence = Family::Legendre.recurrence(DEGREE + 1);
        let (nodes, weights) = gauss(&recurrence.diagonal, &recurrence.off_diagonal);
        let mut gram = vec![0.0; (DEGREE + 1) * (DEGREE + 1)];
        let mut values = [0.0; DEGREE + 1];
        for (&node, &weight) in nodes.iter().zip(&weights) {
            recurrence.evaluate(node, &mut values);
            for (k, entry) in gram.iter_mut().enumerate() {
                *entry += weight * values[k / (DEGREE + 1)] * values[k % (DEGREE + 1)];
            }
        }
        for (k, entry) in gram.iter().enumerate() {
            let expected = f64::from(k / (DEGREE + 1) == k % (DEGREE + 1));
            assert!((entry - expected).abs() < TOLERANCE, "E[φ_{} φ_{}] = {entry}", k / (DEGREE + 1), k % (DEGREE + 1));
        }
    }

    /// Against the trapezoidal rule, which is exact to rounding for entire functions that decay.
    #[test]
    fn hermite_is_orthonormal_under_an_independent_quadrature() {
        const DEGREE: usize = 15;
        let recurrence = Family::Hermite.recurrence(DEGREE);
        let mut gram = [[0.0; DEGREE + 1]; DEGREE + 1];
        let mut values = [0.0; DEGREE + 1];
        let step = 1.0 / 64.0;
        for k in -1280..=1280 {
            let xi = f64::from(k) * step;
            let weight = step * (-0.5 * xi * xi).exp() / std::f64::consts::TAU.sqrt();
            recurrence.evaluate(xi, &mut values);
            for (i, row) in gram.iter_mut().enumerate() {
                row.iter_mut().enumerate().for_each(|(j, entry)| *entry += weight * values[i] * values[j]);
            }
        }
        for (i, row) in gram.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                assert!((entry - f64::from(i == j)).abs() < 1e-10, "E[φ_{i} φ_{j}] = {entry}");
            }
        }
    }

    #[test]
    fn legendre_at_one_is_the_square_root_of_2k_plus_1() {
        let mut values = [0.0; 31];
        Family::Legendre.recurrence(30).evaluate(1.0, &mut values);
        for (k, value) in values.iter().enumerate() {
            assert!((value - ((2 * k + 1) as f64).sqrt()).abs() < TOLERANCE * value);
        }
    }

    /// φ_k′(1) of Legendre polynomials is k(k + 1)/2 √(2k + 1), and symmetric or antisymmetric at −1.
    #[test]
    fn legendre_slopes_at_the_ends() {
        let (mut values, mut slopes) = ([0.0; 31], [0.0; 31]);
        for end in [1.0, -1.0_f64] {
            Family::Legendre.recurrence(30).evaluate_with_slopes(end, &mut values, &mut slopes);
            for (k, slope) in slopes.iter().enumerate() {
                let expected = 0.5 * (k * (k + 1)) as f64 * ((2 * k + 1) as f64).sqrt() * end.powi(k as i32 + 1);
                assert!((slope - expected).abs() <= TOLERANCE * (1.0 + expected.abs()), "degree {k}: {slope}");
            }
        }
    }
}
