//! One path of orthogonal matching pursuit: each step adds the candidate that lowers the residual most.

use nalgebra::{DMatrix, DVector};

/// Least share of its squared length by which a candidate must differ from the terms before it.
const INDEPENDENT: f64 = 1e-10;

/// A path: the terms so far, their orthonormal columns, and what the next step needs of every candidate.
pub(super) struct Path<'a> {
    columns: &'a DMatrix<f64>,
    pub terms: Vec<usize>,
    orthonormal: Vec<DVector<f64>>,
    pub residual: DVector<f64>,
    /// ψᵀe.
    products: DVector<f64>,
    /// Squared length of the part orthogonal to the terms, and of the whole.
    lengths: DVector<f64>,
    whole_lengths: DVector<f64>,
}

/// The term that joined in a step.
pub(super) struct Step {
    pub candidate: usize,
    /// Its products with the orthonormal columns before it.
    pub coefficients: Vec<f64>,
    /// Length of the rest.
    pub length: f64,
    /// Product of the new orthonormal column with the residual.
    pub part: f64,
}

impl<'a> Path<'a> {
    pub fn new(columns: &'a DMatrix<f64>, values: &[f64]) -> Self {
        let residual = DVector::from_column_slice(values);
        let lengths =
            DVector::from_iterator(columns.ncols(), columns.column_iter().map(|column| column.norm_squared()));
        Self {
            columns,
            terms: Vec::new(),
            orthonormal: Vec::new(),
            products: columns.tr_mul(&residual),
            residual,
            whole_lengths: lengths.clone(),
            lengths,
        }
    }

    /// The constant first, then the candidate that would lower the residual most.
    fn best_candidate(&self) -> Option<usize> {
        if self.terms.is_empty() {
            return Some(0);
        }
        let mut best = (0.0, None);
        for candidate in 0..self.columns.ncols() {
            if self.lengths[candidate] > INDEPENDENT * self.whole_lengths[candidate] {
                let gain = self.products[candidate] * self.products[candidate] / self.lengths[candidate];
                if gain > best.0 {
                    best = (gain, Some(candidate));
                }
            }
        }
        best.1
    }

    /// Lets the best candidate join; `None` if there is none or as many terms as equations.
    pub fn step(&mut self) -> Option<Step> {
        if self.terms.len() + 1 >= self.residual.len() {
            return None;
        }
        let candidate = self.best_candidate()?;
        let mut rest = self.columns.column(candidate).into_owned();
        let mut coefficients = vec![0.0; self.orthonormal.len()];
        for _ in 0..2 {
            for (coefficient, known) in coefficients.iter_mut().zip(&self.orthonormal) {
                let part = known.dot(&rest);
                rest.axpy(-part, known, 1.0);
                *coefficient += part;
            }
        }
        let length = rest.norm();
        rest /= length;
        let part = rest.dot(&self.residual);
        self.residual.axpy(-part, &rest, 1.0);
        let projections = self.columns.tr_mul(&rest);
        self.products.axpy(-part, &projections, 1.0);
        for (left, projection) in self.lengths.iter_mut().zip(projections.iter()) {
            *left -= projection * projection;
        }
        self.lengths[candidate] = 0.0;
        self.orthonormal.push(rest);
        self.terms.push(candidate);
        Some(Step { candidate, coefficients, length, part })
    }
}
