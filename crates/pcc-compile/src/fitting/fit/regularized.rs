//! The inverse of a regularised covariance, and the predictions of each run by all others that it holds.

use crate::fitting::regression::Equations;
use crate::numerics::positive_definite::{Inverse, inverse};
use nalgebra::{DMatrix, DVector};

/// ν relative to the mean diagonal of K: enough for a Cholesky factorisation in double precision, and far below the
/// errors that matter.
const NUGGET: f64 = 1e-11;

/// Sizes of ν that are tried, each ten times the one before, where rounding makes K indefinite.
const NUGGETS: i32 = 5;

/// A = (K + diag ν)⁻¹. Values and derivatives have a ν each, relative to the mean of their diagonal of K.
pub(super) struct Regularized {
    /// A.
    pub inverse: DMatrix<f64>,
    /// ln det(K + diag ν).
    pub log_determinant: f64,
    /// ν of each equation.
    pub nuggets: DVector<f64>,
    /// ν by the mean diagonal of K, for values and for derivatives.
    shares: [f64; 2],
}

impl Regularized {
    /// The inverse with the smallest ν that allows it; ν of derivatives is larger by 1/`weight`²,
    /// which must not be zero if there are any.
    pub fn new(kernel: &DMatrix<f64>, equations: &Equations, weight: f64) -> Option<Self> {
        let means = means(kernel.diagonal().as_slice(), equations);
        (0..NUGGETS).find_map(|k| {
            let share = NUGGET * 10f64.powi(k);
            let shares = [share, share / (weight * weight)];
            let nuggets = DVector::from_fn(equations.rows(), |row, _| {
                let group = usize::from(row >= equations.samples());
                shares[group] * means[group]
            });
            let mut matrix = kernel.clone();
            (0..equations.rows()).for_each(|row| matrix[(row, row)] += nuggets[row]);
            let Inverse { matrix: inverse, log_determinant } = inverse(&matrix)?;
            Some(Self { inverse, log_determinant, nuggets, shares })
        })
    }

    /// For a function f of K + diag ν with df = Σ G_ab d(K + diag ν)_ab, the same by K alone, on which ν depends.
    pub fn by_kernel(&self, mut by_matrix: DMatrix<f64>, equations: &Equations) -> DMatrix<f64> {
        let means = means(by_matrix.diagonal().as_slice(), equations);
        for row in 0..equations.rows() {
            let group = usize::from(row >= equations.samples());
            by_matrix[(row, row)] += self.shares[group] * means[group];
        }
        by_matrix
    }

    /// What the fits without each run miss at its value: the first entry of Δ_i = A_i⁻¹ c_i, where A_i is the block of
    /// run i and c = A y. `None` if a block cannot be solved for.
    pub fn left_out(&self, equations: &Equations, weighted: &DVector<f64>) -> Option<DVector<f64>> {
        let residuals: Option<Vec<f64>> = (0..equations.samples())
            .map(|i| {
                let run = equations.block(i);
                let block = self.inverse.select_rows(&run).select_columns(&run).cholesky()?;
                Some(block.solve(&weighted.select_rows(&run))[0])
            })
            .collect();
        residuals.map(DVector::from_vec)
    }
}

/// The mean of numbers that belong to values, and of those that belong to derivatives.
fn means(numbers: &[f64], equations: &Equations) -> [f64; 2] {
    let (values, derivatives) = numbers.split_at(equations.samples());
    [values, derivatives].map(|part| part.iter().sum::<f64>() / part.len().max(1) as f64)
}
