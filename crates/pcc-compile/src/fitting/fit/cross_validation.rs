//! How many terms of a path a design can carry: cross-validation of the whole path, selection included.
//!
//! With derivatives a fold leaves out whole runs, and the error is that of their values.

use super::pursuit_path::Path;
use crate::fitting::regression::{BasisTables, Equations, Response, equation_weights, weigh_rows};
use crate::numerics::qr::ColumnQr;
use nalgebra::{DMatrix, DVector};
use pcc_evaluate::foundation::{Interrupted, Observer};
use pcc_evaluate::polynomials::MultiIndex;

/// Parts of the design that are left out in turn; with derivatives, which make paths long, fewer.
const FOLDS: usize = 10;
const FOLDS_WITH_DERIVATIVES: usize = 5;

/// A path ends so many terms after its best one, as a share of that, and at least.
const STALL_SHARE: f64 = 0.3;
const LEAST_STALL: usize = 6;

/// Weighted equations on a set of candidates.
pub(super) struct Problem {
    pub equations: Equations,
    pub columns: DMatrix<f64>,
    pub targets: Vec<f64>,
}

impl Problem {
    pub fn new(tables: &BasisTables, response: Response<'_>, set: &[MultiIndex], weight: f64) -> Self {
        let response = response.with_weight(weight);
        let equations = response.equations(tables.inputs());
        let weights = equation_weights(tables, &equations, weight);
        let mut columns = tables.stacked(set, &equations);
        weigh_rows(&mut columns, &weights);
        let targets = response.targets().zip(&weights).map(|(target, weight)| target * weight).collect();
        Self { equations, columns, targets }
    }

    /// Whether all terms of the set together, none of them chosen, meet all equations to a mean square residual of
    /// `exact` although there are fewer terms than equations.
    pub fn is_met_by_all_terms(&self, exact: f64) -> bool {
        let (rows, terms) = self.columns.shape();
        if rows == self.equations.samples() || terms >= rows {
            return false;
        }
        let mut qr = ColumnQr::new(rows);
        qr.append(&self.columns);
        qr.columns() == terms && qr.residual(&self.targets).norm_squared() <= exact * rows as f64
    }
}

/// What cross-validation says of the paths on one set of candidates.
pub(super) struct CrossValidation {
    /// The number of terms with the smallest error.
    pub terms: usize,
    /// Mean square of the residuals of values.
    pub error: f64,
    /// What paths of so many terms miss at the values they did not see.
    pub residuals: Vec<f64>,
}

impl CrossValidation {
    pub fn new(problem: &Problem, observer: &dyn Observer) -> Result<Self, Interrupted> {
        let samples = problem.equations.samples();
        let has_derivatives = problem.equations.rows() > samples;
        let folds = if has_derivatives { FOLDS_WITH_DERIVATIVES } else { FOLDS }.min(samples);
        let mut by_fold = Vec::with_capacity(folds);
        for fold in 0..folds {
            observer.check()?;
            by_fold.push(left_out(problem, fold, folds, observer)?);
        }
        let longest = by_fold.iter().map(Vec::len).min().unwrap_or(0);
        let error = |terms: usize| -> f64 {
            by_fold.iter().map(|path| path[terms - 1].norm_squared()).sum::<f64>() / samples as f64
        };
        let (terms, error) = (1..=longest)
            .map(|terms| (terms, error(terms)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((1, f64::INFINITY));
        let mut residuals = vec![0.0; samples];
        for (fold, path) in by_fold.iter().enumerate().filter(|_| longest > 0) {
            let points = (fold..samples).step_by(folds);
            points.zip(path[terms - 1].iter()).for_each(|(i, &residual)| residuals[i] = residual);
        }
        Ok(Self { terms, error, residuals })
    }
}

/// The residuals at the values of one fold after each term of the path on the other runs.
fn left_out(
    problem: &Problem,
    fold: usize,
    folds: usize,
    observer: &dyn Observer,
) -> Result<Vec<DVector<f64>>, Interrupted> {
    let Problem { equations, columns, targets } = problem;
    let (inside, others): (Vec<usize>, Vec<usize>) = (0..equations.samples()).partition(|i| i % folds == fold);
    let mut outside: Vec<usize> = others.iter().flat_map(|&i| equations.block(i)).collect();
    outside.sort_unstable();
    let (seen, unseen) = (columns.select_rows(&outside), columns.select_rows(&inside));
    let seen_targets: Vec<f64> = outside.iter().map(|&i| targets[i]).collect();
    let mut residual = DVector::from_iterator(inside.len(), inside.iter().map(|&i| targets[i]));
    let mut path = Path::new(&seen, &seen_targets);
    let mut continued: Vec<DVector<f64>> = Vec::new();
    let mut history: Vec<DVector<f64>> = Vec::new();
    let mut best = (0, f64::INFINITY);
    while history.len() < best.0 + LEAST_STALL.max((STALL_SHARE * best.0 as f64) as usize) {
        observer.check()?;
        let Some(step) = path.step() else { break };
        // The new orthonormal column, continued to the points of the fold.
        let mut column = unseen.column(step.candidate).into_owned();
        for (known, coefficient) in continued.iter().zip(&step.coefficients) {
            column.axpy(-coefficient, known, 1.0);
        }
        column /= step.length;
        residual.axpy(-step.part, &column, 1.0);
        continued.push(column);
        history.push(residual.clone());
        if residual.norm_squared() < best.1 {
            best = (history.len(), residual.norm_squared());
        }
    }
    Ok(history)
}
