//! The inverse of a symmetric positive definite matrix, mostly by matrix products.
//!
//! A = LLᵀ by Cholesky's algorithm, block column by block column; then W = L⁻¹ by halves,
//!
//! W₁₁ = L₁₁⁻¹, W₂₂ = L₂₂⁻¹, W₂₁ = −W₂₂L₂₁W₁₁, and A⁻¹ = WᵀW.
//!
//! Most operations are products of large blocks, for which libraries reach the speed of the processor; a fit inverts
//! thousands of matrices with some hundred rows. The rows below a diagonal block are divided by it by substitution,
//! which is backward stable: products with its inverse would be faster still, but fail on matrices near the limit of
//! positive definiteness in double precision, which kernels are.

use nalgebra::{DMatrix, DMatrixViewMut};

/// Blocks up to this size are inverted entry by entry.
const SMALL: usize = 24;

/// Columns to the right of a block column that are brought up to date together.
const TRAILING: usize = 96;

/// Blocks up to this size are multiplied as a whole.
const GRAM_SMALL: usize = 64;

/// A⁻¹ and ln det A.
#[derive(Debug, Clone, PartialEq)]
pub struct Inverse {
    /// A⁻¹.
    pub matrix: DMatrix<f64>,
    /// ln det A.
    pub log_determinant: f64,
}

/// A⁻¹ and ln det A, or `None` if A is not positive definite in double precision. Only the lower triangle of A is read.
///
/// The error relative to the largest entry of A⁻¹ is about the condition number of A times 1e-16.
///
/// # Examples
///
/// ```
/// use nalgebra::DMatrix;
/// use pcc_compile::numerics::positive_definite::inverse;
/// let matrix = DMatrix::from_row_slice(2, 2, &[4.0, 2.0, 2.0, 3.0]);
/// let expected = DMatrix::from_row_slice(2, 2, &[0.375, -0.25, -0.25, 0.5]);
/// let found = inverse(&matrix).unwrap();
/// assert!((found.matrix - expected).amax() < 1e-15 && (found.log_determinant - 8f64.ln()).abs() < 1e-15);
/// assert_eq!(inverse(&-matrix), None);
/// ```
pub fn inverse(matrix: &DMatrix<f64>) -> Option<Inverse> {
    let size = matrix.nrows();
    let factor = cholesky(matrix.clone())?;
    let log_determinant = 2.0 * factor.diagonal().iter().map(|pivot| pivot.ln()).sum::<f64>();
    let mut inverse_factor = DMatrix::zeros(size, size);
    invert_triangular(&factor, inverse_factor.columns_mut(0, size), 0, size);
    let mut product = factor;
    gram(&inverse_factor, 0, size, &mut product);
    product.fill_upper_triangle_with_lower_triangle();
    Some(Inverse { matrix: product, log_determinant })
}

/// The lower triangular L with A = LLᵀ; what is above its diagonal has no meaning.
fn cholesky(mut matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let size = matrix.nrows();
    for start in (0..size).step_by(SMALL) {
        let end = size.min(start + SMALL);
        let (panel, mut rest) = matrix.columns_range_pair_mut(start..end, end..);
        let mut panel = panel;
        factor_panel(&mut panel, start)?;
        // The share of this block column in those to its right, on and below their diagonal.
        for first in (end..size).step_by(TRAILING) {
            let last = size.min(first + TRAILING);
            let beside = panel.rows(first, size - first);
            let above = beside.rows(0, last - first).transpose();
            let mut part = rest.view_mut((first, first - end), (size - first, last - first));
            part.gemm(-1.0, &beside, &above, 1.0);
        }
    }
    Some(matrix)
}

/// Cholesky's algorithm on some columns, of which the first has its diagonal in row `start`.
fn factor_panel(panel: &mut DMatrixViewMut<'_, f64>, start: usize) -> Option<()> {
    let (size, width) = panel.shape();
    for k in 0..width {
        let pivot = panel[(start + k, k)];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return None;
        }
        let root = pivot.sqrt();
        panel.view_mut((start + k, k), (size - start - k, 1)).unscale_mut(root);
        let (column, mut later) = panel.columns_range_pair_mut(k..=k, k + 1..);
        for (offset, mut other) in later.column_iter_mut().enumerate() {
            let row = start + k + 1 + offset;
            let share = column.rows(row, size - row);
            other.rows_mut(row, size - row).axpy(-share[0], &share.column(0), 1.0);
        }
    }
    Some(())
}

/// L⁻¹ of the block of a lower triangular L from `start` to `end`, whose diagonal is not zero, by halves: into the same
/// rows of `inverse`, which holds the columns from `start` on.
fn invert_triangular(factor: &DMatrix<f64>, mut inverse: DMatrixViewMut<'_, f64>, start: usize, end: usize) {
    let size = end - start;
    if size <= SMALL {
        for (offset, mut column) in inverse.column_iter_mut().enumerate() {
            let at = start + offset;
            column[at] = 1.0;
            for row in at..end {
                column[row] /= factor[(row, row)];
                let (known, below) = (column[row], factor.column(row));
                column.rows_mut(row + 1, end - row - 1).axpy(-known, &below.rows(row + 1, end - row - 1), 1.0);
            }
        }
        return;
    }
    let half = size / 2;
    let middle = start + half;
    let (mut left, right) = inverse.columns_range_pair_mut(0..half, half..size);
    let mut right = right;
    invert_triangular(factor, left.columns_mut(0, half), start, middle);
    invert_triangular(factor, right.columns_mut(0, size - half), middle, end);
    let known = factor.view((middle, start), (end - middle, half)) * left.rows(start, half);
    left.rows_mut(middle, end - middle).gemm(-1.0, &right.rows(middle, end - middle), &known, 0.0);
}

/// WᵀW of the block of a lower triangular W from `start` to `end`, by halves, as half of W is zero: on and below the
/// diagonal.
fn gram(factor: &DMatrix<f64>, start: usize, end: usize, product: &mut DMatrix<f64>) {
    let size = end - start;
    if size <= GRAM_SMALL {
        let block = factor.view((start, start), (size, size));
        product.view_mut((start, start), (size, size)).gemm(1.0, &block.transpose(), &block, 0.0);
        return;
    }
    let middle = start + size / 2;
    let (half, rest) = (middle - start, end - middle);
    gram(factor, start, middle, product);
    gram(factor, middle, end, product);
    let below = factor.view((middle, start), (rest, half));
    product.view_mut((start, start), (half, half)).gemm(1.0, &below.transpose(), &below, 1.0);
    let corner = factor.view((middle, middle), (rest, rest)).transpose();
    product.view_mut((middle, start), (rest, half)).gemm(1.0, &corner, &below, 0.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn product_with_the_matrix_is_the_identity(size in 1..120usize, seed in 0..1000u64) {
            use pcc_evaluate::probability::random::{Purpose, Stream};
            let mut stream = Stream::new(seed, Purpose::Design, 0);
            let root = DMatrix::from_fn(size, size, |_, _| stream.next_unit() - 0.5);
            let matrix = &root * root.transpose() + DMatrix::identity(size, size);
            let product = inverse(&matrix).unwrap().matrix * &matrix;
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
