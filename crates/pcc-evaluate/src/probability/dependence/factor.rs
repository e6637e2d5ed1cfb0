//! Cholesky factors of correlation matrices.

/// A lower triangular L with L Lᵀ = R, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    size: usize,
    /// Row k has k + 1 entries and begins at k (k + 1)/2.
    entries: Vec<f64>,
}

impl Factor {
    /// The factor of the matrix with these entries below and on the diagonal. What rounding leaves of a pivot that is
    /// none counts as a tiny one: nothing is divided by zero.
    pub fn of(size: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let mut factor = Self { size, entries: Vec::with_capacity(size * (size + 1) / 2) };
        for k in 0..size {
            let mut row = Vec::with_capacity(k + 1);
            for i in 0..k {
                let known: f64 = factor.row(i)[..i].iter().zip(&row).map(|(a, b): (&f64, &f64)| a * b).sum();
                row.push((entry(k, i) - known) / factor.row(i)[i]);
            }
            let square: f64 = row.iter().map(|entry| entry * entry).sum();
            row.push((entry(k, k) - square).max(f64::MIN_POSITIVE).sqrt());
            factor.entries.extend(row);
        }
        factor
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Row k, up to the diagonal.
    #[inline]
    pub fn row(&self, k: usize) -> &[f64] {
        let start = k * (k + 1) / 2;
        &self.entries[start..=start + k]
    }

    /// The smallest reciprocal of a diagonal entry of R⁻¹: the least variance that one variable has, given all others.
    pub(super) fn least_variance_left(&self) -> f64 {
        // Columns of L⁻¹ by forward substitution; the diagonal of R⁻¹ has their squares.
        let squares = |j: usize| {
            let mut column = vec![0.0; self.size];
            column[j] = 1.0 / self.row(j)[j];
            for k in j + 1..self.size {
                let row = self.row(k);
                let known: f64 = row[j..k].iter().zip(&column[j..k]).map(|(a, b)| a * b).sum();
                column[k] = -known / row[k];
            }
            column.iter().map(|entry| entry * entry).sum::<f64>()
        };
        (0..self.size).map(|j| 1.0 / squares(j)).fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of [[1, .5, .2], [.5, 1, −.3], [.2, −.3, 1]], by NumPy.
    #[test]
    fn a_factor_of_three_and_what_each_variable_has_left() {
        let matrix = [[1.0, 0.5, 0.2], [0.5, 1.0, -0.3], [0.2, -0.3, 1.0]];
        let factor = Factor::of(3, |k, i| matrix[k][i]);
        for (k, row) in matrix.iter().enumerate() {
            for (i, entry) in row.iter().enumerate() {
                let product: f64 = factor.row(k).iter().zip(factor.row(i)).map(|(a, b)| a * b).sum();
                assert!((product - entry).abs() < 1e-15, "{k} {i}");
            }
        }
        // det R = 0.56; the minors of the diagonal are 0.91, 0.96 and 0.75.
        assert!((factor.least_variance_left() - 0.56 / 0.96).abs() < 1e-15);
    }
}
