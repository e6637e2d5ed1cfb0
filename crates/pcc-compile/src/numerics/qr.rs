//! Thin QR factorisation Ψ = QR that grows by columns.
//!
//! Stepwise regression asks three things of the columns it has accepted: by how much a further column would lower the
//! residual, by how much the residual would rise without one of them, and the leverage of each row. Q answers the first
//! and the last, R⁻¹ the second. Columns are appended in blocks by classical Gram–Schmidt done twice ("twice is
//! enough", Giraud, Langou and Rozložník 2005, <https://doi.org/10.1007/s00211-005-0615-4>), so the work is matrix
//! products.

use nalgebra::{DMatrix, DMatrixView, DVector};

/// A column whose part orthogonal to the accepted ones is below this share of its length counts as dependent: its
/// square is far above the rounding error of ‖ψ‖² − ‖Qᵀψ‖², some 1e-15 ‖ψ‖².
const DEPENDENT: f64 = 1e-6;

/// Columns that are orthogonalised together: wide enough for fast matrix products, narrow enough for the cache.
const BLOCK: usize = 32;

/// Thin QR factorisation of a matrix with a fixed number of rows and a growing number of columns.
#[derive(Debug, Clone)]
pub struct ColumnQr {
    rows: usize,
    /// Column-major, `rows` × `columns()`, orthonormal columns.
    q: Vec<f64>,
    /// Column k of the upper triangle, `k + 1` entries each.
    r: Vec<Vec<f64>>,
}

impl ColumnQr {
    /// A factorisation without columns.
    pub fn new(rows: usize) -> Self {
        Self { rows, q: Vec::new(), r: Vec::new() }
    }

    /// Number of accepted columns.
    pub fn columns(&self) -> usize {
        self.r.len()
    }

    /// Q, `rows` × `columns()`.
    pub fn q(&self) -> DMatrixView<'_, f64> {
        DMatrixView::from_slice(&self.q, self.rows, self.columns())
    }

    /// Forgets all columns from `columns` on.
    pub fn truncate(&mut self, columns: usize) {
        self.r.truncate(columns);
        self.q.truncate(self.rows * self.r.len());
    }

    /// Appends the columns of `block`, in order, and says of each whether it was accepted; a column that depends
    /// linearly on those before it is left out.
    pub fn append(&mut self, block: &DMatrix<f64>) -> Vec<bool> {
        let mut accepted = Vec::with_capacity(block.ncols());
        let mut start = 0;
        while start < block.ncols() {
            let width = BLOCK.min(block.ncols() - start);
            self.append_block(block.columns(start, width).into_owned(), &mut accepted);
            start += width;
        }
        accepted
    }

    fn append_block(&mut self, mut block: DMatrix<f64>, accepted: &mut Vec<bool>) {
        let lengths: Vec<f64> = block.column_iter().map(|column| column.norm()).collect();
        let before = self.columns();
        let coefficients = self.project_out_twice(&mut block);
        for (k, &length) in lengths.iter().enumerate() {
            let mut column: Vec<f64> = coefficients.column(k).iter().copied().collect();
            let mut rest = block.column(k).into_owned();
            column.extend(self.project_out_of_new(&mut rest, before));
            let norm = rest.norm();
            if norm.is_nan() || norm <= DEPENDENT * length {
                accepted.push(false);
                continue;
            }
            column.push(norm);
            self.q.extend(rest.iter().map(|entry| entry / norm));
            self.r.push(column);
            accepted.push(true);
        }
    }

    /// C ← (I − QQᵀ)²C; returns the coefficients QᵀC of both passes together.
    fn project_out_twice(&self, block: &mut DMatrix<f64>) -> DMatrix<f64> {
        let q = self.q();
        let transposed = q.transpose();
        let mut total = DMatrix::zeros(q.ncols(), block.ncols());
        for _ in 0..2 {
            let part = &transposed * &*block;
            block.gemm(-1.0, &q, &part, 1.0);
            total += part;
        }
        total
    }

    /// The same for one column against the columns of Q from `before` on, those accepted from its own block.
    fn project_out_of_new(&self, column: &mut DVector<f64>, before: usize) -> Vec<f64> {
        let q = self.q();
        let new = q.columns(before, q.ncols() - before);
        let mut total = DVector::zeros(new.ncols());
        for _ in 0..2 {
            let part = new.tr_mul(column);
            column.gemv(-1.0, &new, &part, 1.0);
            total += part;
        }
        total.iter().copied().collect()
    }

    /// For each column ψ of `candidates`, ‖ψ_⊥‖², the squared length of its part orthogonal to the accepted columns, or
    /// zero if it depends on them.
    pub fn orthogonal_lengths_squared(&self, candidates: &DMatrix<f64>) -> Vec<f64> {
        let projections = self.q().transpose() * candidates;
        candidates
            .column_iter()
            .zip(projections.column_iter())
            .map(|(column, projection)| {
                let whole = column.norm_squared();
                let rest = whole - projection.norm_squared();
                if rest > DEPENDENT * DEPENDENT * whole { rest } else { 0.0 }
            })
            .collect()
    }

    /// The residual (I − QQᵀ)y of the least-squares fit to `values`.
    pub fn residual(&self, values: &[f64]) -> DVector<f64> {
        let mut block = DMatrix::from_column_slice(self.rows, 1, values);
        self.project_out_twice(&mut block);
        block.column(0).into_owned()
    }

    /// Coefficients β = R⁻¹Qᵀy of the least-squares fit to `values`, one per accepted column.
    pub fn coefficients(&self, values: &[f64]) -> Vec<f64> {
        let mut block = DMatrix::from_column_slice(self.rows, 1, values);
        let mut solution: Vec<f64> = self.project_out_twice(&mut block).column(0).iter().copied().collect();
        for k in (0..solution.len()).rev() {
            solution[k] /= self.r[k][k];
            let (above, from_k) = solution.split_at_mut(k);
            for (entry, factor) in above.iter_mut().zip(&self.r[k]) {
                *entry -= factor * from_k[0];
            }
        }
        solution
    }

    /// Leverages h_i, the diagonal of QQᵀ: one per row, each in [0, 1], `columns()` in sum.
    pub fn leverages(&self) -> Vec<f64> {
        let mut leverages = vec![0.0; self.rows];
        for column in self.q.chunks_exact(self.rows.max(1)) {
            for (leverage, entry) in leverages.iter_mut().zip(column) {
                *leverage += entry * entry;
            }
        }
        leverages
    }

    /// Diagonal of (ΨᵀΨ)⁻¹ = R⁻¹R⁻ᵀ: the squared lengths of the rows of R⁻¹. The work grows with the cube of the number
    /// of columns, so `proceed` is asked before each.
    ///
    /// # Errors
    ///
    /// What `proceed` says.
    pub fn inverse_gram_diagonal<E>(&self, mut proceed: impl FnMut() -> Result<(), E>) -> Result<Vec<f64>, E> {
        let size = self.columns();
        let mut diagonal = vec![0.0; size];
        let mut inverse_column = vec![0.0; size];
        for k in 0..size {
            proceed()?;
            inverse_column[..=k].fill(0.0);
            inverse_column[k] = 1.0;
            for i in (0..=k).rev() {
                let entry = inverse_column[i] / self.r[i][i];
                inverse_column[i] = entry;
                for (above, factor) in inverse_column[..i].iter_mut().zip(&self.r[i]) {
                    *above -= factor * entry;
                }
                diagonal[i] += entry * entry;
            }
        }
        Ok(diagonal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::probability::random::{Purpose, Stream};

    /// Agreement with normal-equation formulas on well-conditioned matrices of order one.
    const TOLERANCE: f64 = 1e-11;

    fn matrix(rows: usize, columns: usize) -> DMatrix<f64> {
        let mut stream = Stream::new(1, Purpose::Design, 0);
        DMatrix::from_fn(columns, rows, |_, _| stream.next_unit() - 0.3).transpose()
    }

    fn inverse_gram_diagonal(qr: &ColumnQr) -> Vec<f64> {
        qr.inverse_gram_diagonal(|| Ok::<(), ()>(())).unwrap()
    }

    fn factorised(psi: &DMatrix<f64>) -> ColumnQr {
        let mut qr = ColumnQr::new(psi.nrows());
        assert!(qr.append(psi).into_iter().all(|accepted| accepted));
        qr
    }

    #[test]
    fn q_is_orthonormal_and_spans_the_columns_also_over_several_blocks() {
        let psi = matrix(120, 2 * BLOCK + 5);
        let qr = factorised(&psi);
        let gram = qr.q().transpose() * qr.q();
        assert!((gram - DMatrix::identity(psi.ncols(), psi.ncols())).amax() < TOLERANCE);
        for column in psi.column_iter() {
            assert!(qr.residual(column.as_slice()).amax() < TOLERANCE);
        }
    }

    #[test]
    fn coefficients_leverages_and_inverse_diagonal_equal_the_normal_equations() {
        let psi = matrix(40, 7);
        let values: Vec<f64> = (0..40).map(|i| (i as f64).cos()).collect();
        let qr = factorised(&psi);
        let inverse = (psi.transpose() * &psi).try_inverse().unwrap();
        let expected = &inverse * psi.transpose() * DVector::from_column_slice(&values);
        let hat = &psi * &inverse * psi.transpose();
        for (k, coefficient) in qr.coefficients(&values).iter().enumerate() {
            assert!((coefficient - expected[k]).abs() < TOLERANCE);
            assert!((inverse_gram_diagonal(&qr)[k] - inverse[(k, k)]).abs() < TOLERANCE);
        }
        for (i, leverage) in qr.leverages().iter().enumerate() {
            assert!((leverage - hat[(i, i)]).abs() < TOLERANCE);
        }
    }

    #[test]
    fn dependent_columns_are_left_out() {
        let psi = matrix(30, 4);
        let mut qr = factorised(&psi);
        let combination = psi.column(0) * 2.0 - psi.column(3);
        let doubled = DMatrix::from_columns(&[combination, matrix(31, 4).column(0).rows(1, 30).into_owned()]);
        assert_eq!(qr.orthogonal_lengths_squared(&doubled)[0], 0.0);
        assert_eq!(qr.append(&doubled), [false, true]);
        assert_eq!(qr.columns(), 5);
    }

    #[test]
    fn truncation_forgets_the_last_columns_only() {
        let psi = matrix(30, 6);
        let mut qr = factorised(&psi);
        qr.truncate(4);
        let four = factorised(&psi.columns(0, 4).into_owned());
        assert_eq!(qr.q(), four.q());
        assert_eq!(inverse_gram_diagonal(&qr), inverse_gram_diagonal(&four));
    }
}
