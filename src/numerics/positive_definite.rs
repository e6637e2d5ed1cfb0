//! The inverse of a symmetric positive definite matrix, mostly by matrix products.
//!
//! With A = LLᵀ split in halves, W = L⁻¹ follows from the halves:
//!
//! W₁₁ from A₁₁, L₂₁ = A₂₁W₁₁ᵀ, W₂₂ from A₂₂ − L₂₁L₂₁ᵀ, W₂₁ = −W₂₂L₂₁W₁₁, and A⁻¹ = WᵀW.
//!
//! Nearly all operations are products of large blocks, for which libraries reach the speed of the processor; a fit
//! inverts thousands of matrices with some hundred rows.

use nalgebra::DMatrix;

/// Blocks up to this size are inverted entry by entry.
const SMALL: usize = 24;

/// A⁻¹, or `None` if A is not positive definite in double precision. Only the lower triangle of A is read.
///
/// The error relative to the largest entry of A⁻¹ is about the condition number of A times 1e-16.
///
/// # Examples
///
/// ```
/// use nalgebra::DMatrix;
/// use pcc::numerics::positive_definite::inverse;
/// let matrix = DMatrix::from_row_slice(2, 2, &[4.0, 2.0, 2.0, 3.0]);
/// let expected = DMatrix::from_row_slice(2, 2, &[0.375, -0.25, -0.25, 0.5]);
/// assert!((inverse(&matrix).unwrap() - expected).amax() < 1e-15);
/// assert_eq!(inverse(&-matrix), None);
/// ```
pub fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let factor = inverse_factor(matrix.clone())?;
    Some(factor.transpose() * &factor)
}

/// W = L⁻¹ with A = LLᵀ.
fn inverse_factor(matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let size = matrix.nrows();
    if size <= SMALL {
        return small_inverse_factor(matrix);
    }
    let half = size / 2;
    let rest = size - half;
    let first = inverse_factor(matrix.view((0, 0), (half, half)).into_owned())?;
    let below = matrix.view((half, 0), (rest, half)) * first.transpose();
    let mut schur = matrix.view((half, half), (rest, rest)).into_owned();
    schur.gemm(-1.0, &below, &below.transpose(), 1.0);
    let second = inverse_factor(schur)?;
    let mut factor = DMatrix::zeros(size, size);
    factor.view_mut((half, 0), (rest, half)).copy_from(&(-(&second * (below * &first))));
    factor.view_mut((0, 0), (half, half)).copy_from(&first);
    factor.view_mut((half, half), (rest, rest)).copy_from(&second);
    Some(factor)
}

/// The same by Cholesky's algorithm and forward substitution.
fn small_inverse_factor(mut matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let size = matrix.nrows();
    for k in 0..size {
        let pivot = matrix[(k, k)];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return None;
        }
        let root = pivot.sqrt();
        for i in k..size {
            matrix[(i, k)] /= root;
        }
        for j in k + 1..size {
            let factor = matrix[(j, k)];
            for i in j..size {
                matrix[(i, j)] -= factor * matrix[(i, k)];
            }
        }
    }
    let mut inverse = DMatrix::zeros(size, size);
    for column in 0..size {
        inverse[(column, column)] = 1.0 / matrix[(column, column)];
        for row in column + 1..size {
            let sum: f64 = (column..row).map(|k| matrix[(row, k)] * inverse[(k, column)]).sum();
            inverse[(row, column)] = -sum / matrix[(row, row)];
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn product_with_the_matrix_is_the_identity(size in 1..120usize, seed in 0..1000u64) {
            use crate::random::{Purpose, Stream};
            let mut stream = Stream::new(seed, Purpose::Design, 0);
            let root = DMatrix::from_fn(size, size, |_, _| stream.next_unit() - 0.5);
            let matrix = &root * root.transpose() + DMatrix::identity(size, size);
            let product = inverse(&matrix).unwrap() * &matrix;
            // The condition number is below the largest eigenvalue, at most size²/4 + 1.
            let tolerance = 1e-15 * (size * size + 10) as f64;
            prop_assert!((product - DMatrix::identity(size, size)).amax() < tolerance);
        }
    }

    #[test]
    fn indefinite_and_broken_matrices_have_no_inverse() {
        let mut matrix = DMatrix::<f64>::identity(60, 60);
        matrix[(50, 50)] = -1.0;
        assert_eq!(inverse(&matrix), None);
        matrix[(50, 50)] = f64::NAN;
        assert_eq!(inverse(&matrix), None);
        assert_eq!(inverse(&DMatrix::zeros(3, 3)), None);
    }
}
