//! The inverse of a symmetric positive definite matrix, mostly by matrix products.
//!
//! A = LLᵀ by Cholesky's algorithm, block column by block column; then W = L⁻¹ by halves,
//!
//! W₁₁ = L₁₁⁻¹, W₂₂ = L₂₂⁻¹, W₂₁ = −W₂₂L₂₁W₁₁, and A⁻¹ = WᵀW.
//!
//! Most operations are products of large blocks, for which libraries reach the speed of the processor; a fit inverts
//! thousands of matrices with some hundred rows. The rows below a diagonal block are divided by it by substitution, which
//! is backward stable: products with its inverse would be faster still, but fail on matrices near the limit of positive
//! definiteness in double precision, which kernels are.

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
    let inverse = triangular_inverse(&cholesky(matrix.clone())?);
    Some(inverse.transpose() * &inverse)
}

/// The lower triangular L with A = LLᵀ; what is above its diagonal has no meaning.
fn cholesky(mut matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let size = matrix.nrows();
    for start in (0..size).step_by(SMALL) {
        let end = size.min(start + SMALL);
        for k in start..end {
            let pivot = matrix[(k, k)];
            if !(pivot > 0.0 && pivot.is_finite()) {
                return None;
            }
            // Column k below the diagonal, then its share of the later columns of this block.
            let root = pivot.sqrt();
            matrix.view_mut((k, k), (size - k, 1)).unscale_mut(root);
            let column = matrix.view((k + 1, k), (size - k - 1, 1)).into_owned();
            for later in k + 1..end {
                let factor = column[later - k - 1];
                let rows = size - later;
                let share = column.rows(later - k - 1, rows);
                matrix.view_mut((later, later), (rows, 1)).zip_apply(&share, |entry, part| *entry -= factor * part);
            }
        }
        let panel = matrix.view((end, start), (size - end, end - start)).into_owned();
        matrix.view_mut((end, end), (size - end, size - end)).gemm(-1.0, &panel, &panel.transpose(), 1.0);
    }
    Some(matrix)
}

/// L⁻¹ of a lower triangular matrix with a diagonal that is not zero.
fn triangular_inverse(factor: &DMatrix<f64>) -> DMatrix<f64> {
    let size = factor.nrows();
    let mut inverse = DMatrix::zeros(size, size);
    if size <= SMALL {
        for column in 0..size {
            inverse[(column, column)] = 1.0 / factor[(column, column)];
            for row in column + 1..size {
                let sum: f64 = (column..row).map(|k| factor[(row, k)] * inverse[(k, column)]).sum();
                inverse[(row, column)] = -sum / factor[(row, row)];
            }
        }
        return inverse;
    }
    let half = size / 2;
    let rest = size - half;
    let first = triangular_inverse(&factor.view((0, 0), (half, half)).into_owned());
    let second = triangular_inverse(&factor.view((half, half), (rest, rest)).into_owned());
    let below = -(&second * (factor.view((half, 0), (rest, half)) * &first));
    inverse.view_mut((0, 0), (half, half)).copy_from(&first);
    inverse.view_mut((half, half), (rest, rest)).copy_from(&second);
    inverse.view_mut((half, 0), (rest, half)).copy_from(&below);
    inverse
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
