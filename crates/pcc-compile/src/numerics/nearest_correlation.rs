//! The correlation matrix that is nearest to a symmetric one.
//!
//! Higham (2002), <https://doi.org/10.1093/imanum/22.3.329>, algorithm 3.3: projections onto the matrices whose
//! eigenvalues are not below a bound and onto those with a unit diagonal in turn, with Dykstra's correction of the
//! first. The nearest is that of the Frobenius norm.

use nalgebra::{DMatrix, SymmetricEigen};

/// Projections and iterations of an eigenvalue solve, at most.
const MOST_STEPS: usize = 10_000;

/// Both projections agree to this.
const CLOSE: f64 = 1e-9;

/// The smallest eigenvalue of a symmetric matrix; `None` if it is not found.
pub fn smallest_eigenvalue(matrix: &DMatrix<f64>) -> Option<f64> {
    let eigen = SymmetricEigen::try_new(matrix.clone(), f64::EPSILON, MOST_STEPS)?;
    eigen.eigenvalues.iter().copied().reduce(f64::min)
}

/// The matrix with a unit diagonal and no eigenvalue below `least` that is nearest to `matrix`, symmetric with entries
/// of −1 to 1; `None` if it is not found.
pub fn nearest_correlation(matrix: &DMatrix<f64>, least: f64) -> Option<DMatrix<f64>> {
    let mut near = matrix.clone();
    let mut correction = DMatrix::zeros(matrix.nrows(), matrix.ncols());
    for _ in 0..MOST_STEPS {
        let corrected = &near - &correction;
        let bounded = with_eigenvalues_from(&corrected, least)?;
        correction = &bounded - corrected;
        near.copy_from(&bounded);
        near.fill_diagonal(1.0);
        if (&near - bounded).norm() <= CLOSE * near.norm() {
            return Some(near);
        }
    }
    None
}

/// The nearest symmetric matrix with no eigenvalue below `least`.
fn with_eigenvalues_from(matrix: &DMatrix<f64>, least: f64) -> Option<DMatrix<f64>> {
    let mut eigen = SymmetricEigen::try_new(matrix.clone(), f64::EPSILON, MOST_STEPS)?;
    eigen.eigenvalues.apply(|value| *value = value.max(least));
    let found = eigen.recompose();
    Some(0.5 * (&found + found.transpose()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of section 4 of the paper: eigenvalues 1 − √2, 1, 1 + √2, and the nearest to the digits it prints.
    #[test]
    fn the_example_of_the_paper() {
        let matrix = DMatrix::from_row_slice(3, 3, &[1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0]);
        assert!((smallest_eigenvalue(&matrix).unwrap() - (1.0 - 2f64.sqrt())).abs() < 1e-14);
        let near = nearest_correlation(&matrix, 0.0).unwrap();
        let expected = [1.0, 0.7607, 0.1573, 0.7607, 1.0, 0.7607, 0.1573, 0.7607, 1.0];
        assert!(near.iter().zip(expected).all(|(a, b)| (a - b).abs() < 5e-5), "{near}");
        assert!(smallest_eigenvalue(&near).unwrap() > -1e-8);
        assert!(smallest_eigenvalue(&nearest_correlation(&matrix, 1e-3).unwrap()).unwrap() > 0.999e-3);
    }

    #[test]
    fn a_correlation_matrix_is_its_own_nearest() {
        let matrix = DMatrix::from_row_slice(2, 2, &[1.0, 0.6, 0.6, 1.0]);
        assert!((nearest_correlation(&matrix, 1e-3).unwrap() - matrix).norm() < 1e-14);
    }
}
