//! Second-order systems as first-order ones.

use nalgebra::{DMatrix, Matrix6, Vector6};

/// The state matrix A of ẋ = A x, x = (U, U̇), for M Ü + C U̇ + K U = 0 with a diagonal mass matrix:
///
/// A = \[0, I; −M⁻¹K, −M⁻¹C\], 12 × 12.
pub(super) fn state_matrix(
    mass_diagonal: &Vector6<f64>,
    damping: &Matrix6<f64>,
    stiffness: &Matrix6<f64>,
) -> DMatrix<f64> {
    let size = mass_diagonal.len();
    let mut state = DMatrix::zeros(2 * size, 2 * size);
    for i in 0..size {
        state[(i, size + i)] = 1.0;
        for j in 0..size {
            state[(size + i, j)] = -stiffness[(i, j)] / mass_diagonal[i];
            state[(size + i, size + j)] = -damping[(i, j)] / mass_diagonal[i];
        }
    }
    state
}
