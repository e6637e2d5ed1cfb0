//! How many eigenvalues of a matrix are zero by its structure.
//!
//! Zero is a defective eigenvalue of a body that is free to move, and its computed copies scatter: their size says
//! little. The null space says more. Its dimension is found by an orthogonal factorisation with pivots; the matrix
//! without it is looked at in turn, because each step of a Jordan chain shows up as a null space of what is left (a
//! staircase: Kublanovskaya 1966, <https://doi.org/10.1016/0041-5553(66)90168-3>; Golub and Wilkinson 1976,
//! <https://doi.org/10.1137/1018113>).

use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{ColPivQR, DMatrix};

/// Pivots up to this many roundings per row, relative to the norm of the balanced matrix, are zero.
const ROUNDINGS: f64 = 10.0;

/// The algebraic multiplicity of the eigenvalue zero of a real square matrix, whose entries are exact but for a few
/// roundings.
///
/// # Examples
///
/// ```
/// use nalgebra::dmatrix;
/// use pcc_compile::numerics::zero_eigenvalues::zero_eigenvalues;
/// // Two masses that hang together: one eigenvalue zero of multiplicity two, with a single eigenvector.
/// let free = dmatrix![
///     0.0, 0.0, 1.0, 0.0;
///     0.0, 0.0, 0.0, 1.0;
///     -1e6, 1e6, 0.0, 0.0;
///     2e6, -2e6, 0.0, 0.0
/// ];
/// assert_eq!(zero_eigenvalues(free), 2);
/// // A slow mode beside a fast one is no zero.
/// assert_eq!(zero_eigenvalues(dmatrix![0.0, 1.0, 0.0; -1e-4, 0.0, 0.0; 0.0, 0.0, -1e6]), 0);
/// ```
pub fn zero_eigenvalues(mut matrix: DMatrix<f64>) -> usize {
    let size = matrix.nrows();
    balance_parlett_reinsch(&mut matrix);
    // What is left of the matrix has the rounding errors of the whole.
    let zero = ROUNDINGS * size as f64 * f64::EPSILON * matrix.norm();
    loop {
        let left = matrix.nrows();
        if left == 0 {
            return size;
        }
        // Aᵀ P = Q R: the last columns of Q are the null space of A.
        let (q, r) = {
            let factors = ColPivQR::new(matrix.transpose());
            (factors.q(), factors.r())
        };
        let rank = (0..left).take_while(|&i| r[(i, i)].abs() > zero).count();
        if rank == left {
            return size - left;
        }
        let rest = q.columns(0, rank);
        matrix = rest.transpose() * &matrix * rest;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    /// x″ of a chain of masses with these stiffnesses between neighbours, and dampers of the first and the last mass to
    /// the ground.
    fn chain(masses: &[f64], springs: &[f64], damping: f64, to_ground: f64) -> DMatrix<f64> {
        let n = masses.len();
        let mut state = DMatrix::zeros(2 * n, 2 * n);
        for i in 0..n {
            state[(i, n + i)] = 1.0;
        }
        for (i, &k) in springs.iter().enumerate() {
            for (row, sign) in [(i, -1.0), (i + 1, 1.0)] {
                state[(n + row, i)] += sign * k / masses[row];
                state[(n + row, i + 1)] -= sign * k / masses[row];
            }
        }
        state[(n, n)] -= damping / masses[0];
        state[(2 * n - 1, n - 1)] -= to_ground / masses[n - 1];
        state
    }

    #[test]
    fn free_chains_have_two_zeros_one_with_a_damper_to_the_ground_and_none_with_a_spring() {
        let masses = [1.0, 2.0, 0.5, 3.0];
        let springs = [1e5, 2e5, 3e5];
        assert_eq!(zero_eigenvalues(chain(&masses, &springs, 0.0, 0.0)), 2);
        assert_eq!(zero_eigenvalues(chain(&masses, &springs, 0.1, 0.0)), 1);
        assert_eq!(zero_eigenvalues(chain(&masses, &springs, 0.0, 1e-3)), 0);
        assert_eq!(zero_eigenvalues(chain(&masses, &[1e5, 0.0, 3e5], 0.0, 0.0)), 4);
    }

    #[test]
    fn slow_modes_beside_fast_ones_are_no_zeros() {
        // The slow mode lies at 1e-6 of the largest eigenvalue.
        let wide = dmatrix![
            0.0, 0.0, 1.0, 0.0;
            0.0, 0.0, 0.0, 1.0;
            -0.08, 0.0, -1e-3, 0.0;
            0.0, -1.42e11, 0.0, -40.0
        ];
        assert_eq!(zero_eigenvalues(wide), 0);
    }

    #[test]
    fn small_and_empty_matrices_are_counted() {
        assert_eq!(zero_eigenvalues(DMatrix::zeros(0, 0)), 0);
        assert_eq!(zero_eigenvalues(DMatrix::zeros(3, 3)), 3);
        assert_eq!(zero_eigenvalues(dmatrix![0.0, 1.0, 0.0; 0.0, 0.0, 1.0; 0.0, 0.0, 0.0]), 3);
        assert_eq!(zero_eigenvalues(dmatrix![2.0]), 0);
    }
}
