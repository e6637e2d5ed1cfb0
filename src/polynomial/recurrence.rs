//! Orthonormal polynomials by their three-term recurrence.

/// Families of orthogonal polynomials, one per density of a standardized variable (table 1 of the paper).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Family {
    /// Legendre polynomials: uniform density ½ on [−1, 1].
    Legendre,
}

impl Family {
    /// Name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Legendre => "legendre",
        }
    }

    /// The orthonormal recurrence up to `degree`.
    ///
    /// Legendre: a_k = 0, √b_k = k/√(4k² − 1).
    pub fn recurrence(self, degree: usize) -> Recurrence {
        match self {
            Self::Legendre => Recurrence {
                diagonal: vec![0.0; degree],
                off_diagonal: (1..=degree).map(|k| k as f64 / ((4 * k * k - 1) as f64).sqrt()).collect(),
            },
        }
    }
}

/// Coefficients of √b_{k+1} φ_{k+1}(x) = (x − a_k) φ_k(x) − √b_k φ_{k−1}(x) with φ_0 = 1.
///
/// The polynomials have unit variance: E\[φ_j φ_k\] = δ_jk. So the mean of an expansion is its first coefficient and its
/// variance the sum of the other squares.
///
/// # Examples
///
/// ```
/// use pcc::polynomial::Family;
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::quadrature::gauss;

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

    #[test]
    fn legendre_at_one_is_the_square_root_of_2k_plus_1() {
        let mut values = [0.0; 31];
        Family::Legendre.recurrence(30).evaluate(1.0, &mut values);
        for (k, value) in values.iter().enumerate() {
            assert!((value - ((2 * k + 1) as f64).sqrt()).abs() < TOLERANCE * value);
        }
    }
}
