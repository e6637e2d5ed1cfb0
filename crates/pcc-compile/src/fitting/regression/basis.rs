//! The set of terms accepted so far, with the least-squares fit of one component on it.
//!
//! The equations are values and perhaps derivatives, each derivative multiplied by a weight and by the unit that makes
//! the derivative of a linear term as large as the term. Residuals, leverages and rank come from one QR factorisation
//! of them all.

use super::equations::{Equations, LeftOut, leave_runs_out};
use super::errors::{ErrorMeasures, Response, leave_one_out_residuals};
use super::tables::BasisTables;
use crate::numerics::qr::ColumnQr;
use nalgebra::{DMatrix, DVector};
use pcc_evaluate::foundation::{Interrupted, Observer};
use pcc_evaluate::polynomials::MultiIndex;

/// Candidates evaluated together: wide enough for fast matrix products, small enough for the cache.
const CANDIDATE_BLOCK: usize = 64;

/// Terms that are orthogonalised between two looks at whether the user asked to stop.
const EXTENSION_BLOCK: usize = 128;

/// A set A of multi-indices with the least-squares fit of one component on it.
#[derive(Clone)]
pub struct ActiveBasis<'a> {
    tables: &'a BasisTables,
    equations: Equations,
    /// What multiplies each equation.
    weights: Vec<f64>,
    /// Values and derivatives, weighted.
    targets: Vec<f64>,
    /// V̂ of the values.
    variance: f64,
    indices: Vec<MultiIndex>,
    qr: ColumnQr,
    residual: DVector<f64>,
    observer: &'a dyn Observer,
}

impl<'a> ActiveBasis<'a> {
    /// A = {0}: the fit by a constant. `response.values[i]` belongs to point i of `tables`; `variance` is their V̂, not
    /// zero. Derivatives are equations with `weight` beside the values.
    ///
    /// # Errors
    ///
    /// [`Interrupted`], like every method that takes long.
    pub fn constant(
        tables: &'a BasisTables,
        response: Response<'_>,
        variance: f64,
        weight: f64,
        observer: &'a dyn Observer,
    ) -> Result<Self, Interrupted> {
        let equations = response.equations(tables.inputs());
        let weights = equation_weights(tables, &equations, weight);
        let targets: Vec<f64> = response.targets().zip(&weights).map(|(target, weight)| target * weight).collect();
        let mut basis = Self {
            qr: ColumnQr::new(targets.len()),
            tables,
            equations,
            weights,
            targets,
            variance,
            indices: Vec::new(),
            residual: DVector::zeros(0),
            observer,
        };
        basis.extend(vec![MultiIndex::constant(tables.inputs())])?;
        Ok(basis)
    }

    /// Number of points N.
    pub fn samples(&self) -> usize {
        self.equations.samples()
    }

    /// Number of equations, values and derivatives.
    pub fn rows(&self) -> usize {
        self.equations.rows()
    }

    /// Ψ with weighted rows.
    fn columns(&self, indices: &[MultiIndex]) -> DMatrix<f64> {
        let mut columns = self.tables.stacked(indices, &self.equations);
        if self.has_derivatives() {
            weigh_rows(&mut columns, &self.weights);
        }
        columns
    }

    /// The accepted multi-indices, in the order of their acceptance; {0} comes first.
    pub fn indices(&self) -> &[MultiIndex] {
        &self.indices
    }

    /// For each candidate α, by how much R² would rise if it alone joined A:
    /// (ψᵀe)²/‖ψ_⊥‖² relative to N V̂, with the residual e and the part ψ_⊥ of ψ orthogonal to A. With derivatives, all
    /// equations count, relative to the sum of their squares about the mean value.
    ///
    /// # Errors
    ///
    /// [`Interrupted`].
    pub fn gains(&self, candidates: &[MultiIndex]) -> Result<Vec<f64>, Interrupted> {
        let total = self.total_variation();
        let mut gains = Vec::with_capacity(candidates.len());
        for block in candidates.chunks(CANDIDATE_BLOCK) {
            self.observer.check()?;
            let columns = self.columns(block);
            let products = columns.tr_mul(&self.residual);
            let lengths = self.qr.orthogonal_lengths_squared(&columns);
            gains.extend(
                products.iter().zip(lengths).map(
                    |(product, length)| {
                        if length > 0.0 { product * product / length / total } else { 0.0 }
                    },
                ),
            );
        }
        Ok(gains)
    }

    /// For each accepted α, by how much R² would fall if it alone left A: β_α²/((ΨᵀΨ)⁻¹)_αα relative to N V̂.
    ///
    /// # Errors
    ///
    /// [`Interrupted`].
    pub fn losses(&self) -> Result<Vec<f64>, Interrupted> {
        let total = self.total_variation();
        let coefficients = self.coefficients();
        let diagonal = self.qr.inverse_gram_diagonal(|| self.observer.check())?;
        Ok(coefficients.iter().zip(diagonal).map(|(beta, inverse)| beta * beta / inverse / total).collect())
    }

    /// Adds `candidates` to A, but for those that depend linearly on what is there.
    ///
    /// # Errors
    ///
    /// [`Interrupted`].
    pub fn extend(&mut self, candidates: Vec<MultiIndex>) -> Result<(), Interrupted> {
        for block in candidates.chunks(EXTENSION_BLOCK) {
            self.observer.check()?;
            let accepted = self.qr.append(&self.columns(block));
            let independent = block.iter().zip(accepted).filter(|(_, accepted)| *accepted);
            self.indices.extend(independent.map(|(alpha, _)| alpha.clone()));
        }
        self.residual = self.qr.residual(&self.targets);
        Ok(())
    }

    /// Keeps the terms for which `keep` holds, given position and multi-index.
    ///
    /// # Errors
    ///
    /// [`Interrupted`].
    pub fn retain(&mut self, keep: impl Fn(usize, &MultiIndex) -> bool) -> Result<(), Interrupted> {
        let Some(first) = (0..self.indices.len()).find(|&k| !keep(k, &self.indices[k])) else { return Ok(()) };
        let rest: Vec<MultiIndex> = self.indices.drain(first..).collect();
        self.qr.truncate(first);
        let kept = rest.into_iter().enumerate().filter(|(k, alpha)| keep(first + k, alpha));
        self.extend(kept.map(|(_, alpha)| alpha).collect())
    }

    /// Least-squares coefficients β, one per index in `indices()`.
    pub fn coefficients(&self) -> Vec<f64> {
        self.qr.coefficients(&self.targets)
    }

    /// R², S² and corrected S², all of the values. With derivatives, S² leaves out whole runs, and there is no
    /// correction for small designs.
    ///
    /// # Errors
    ///
    /// [`Interrupted`].
    pub fn errors(&self) -> Result<ErrorMeasures, Interrupted> {
        if self.has_derivatives() {
            let of_values = &self.residual.as_slice()[..self.samples()];
            let left_out = self.leave_one_out_residuals();
            return Ok(ErrorMeasures::of_residuals(of_values, left_out.as_deref(), self.variance));
        }
        let trace = self.qr.inverse_gram_diagonal(|| self.observer.check())?.iter().sum();
        let leverages = self.qr.leverages();
        Ok(ErrorMeasures::new(self.residual.as_slice(), &leverages, trace, self.indices.len(), self.variance))
    }

    /// S² alone, which needs no inverse.
    pub fn s2(&self) -> Option<f64> {
        let left_out = self.leave_one_out_residuals()?;
        let sum: f64 = left_out.iter().map(|residual| residual * residual).sum();
        Some(1.0 - sum / (self.samples() as f64 * self.variance))
    }

    /// What each point's value differs by from its prediction by all other runs, or `None` where that is undetermined.
    pub fn leave_one_out_residuals(&self) -> Option<Vec<f64>> {
        if self.has_derivatives() {
            return self.left_out().map(|left_out| left_out.residuals);
        }
        leave_one_out_residuals(self.residual.as_slice(), &self.qr.leverages())
    }

    /// Mean leverage h̃ of the values when runs are left out as a whole ([`LeftOut::leverages`]), P/N without
    /// derivatives; one if a run is not determined by the others.
    pub fn mean_leverage(&self) -> f64 {
        let samples = self.samples() as f64;
        if !self.has_derivatives() {
            return self.indices.len() as f64 / samples;
        }
        self.left_out().map_or(1.0, |left_out| left_out.leverages.iter().sum::<f64>() / samples)
    }

    fn left_out(&self) -> Option<LeftOut> {
        leave_runs_out(&self.equations, &self.qr.q(), self.residual.as_slice())
    }

    fn has_derivatives(&self) -> bool {
        self.rows() > self.samples()
    }

    /// The scale of changes in R²: N V̂ and the squares of the weighted derivatives.
    fn total_variation(&self) -> f64 {
        let derivatives: f64 = self.targets[self.samples()..].iter().map(|target| target * target).sum();
        self.samples() as f64 * self.variance + derivatives
    }
}

/// Multiplies each row by its weight.
pub fn weigh_rows(matrix: &mut DMatrix<f64>, weights: &[f64]) {
    for mut column in matrix.column_iter_mut() {
        column.iter_mut().zip(weights).for_each(|(entry, weight)| *entry *= weight);
    }
}

/// What multiplies each equation: one for a value, `weight` in units of the linear term for a derivative.
pub fn equation_weights(tables: &BasisTables, equations: &Equations, weight: f64) -> Vec<f64> {
    let points = equations.points_with_derivatives().len();
    let derivatives = (0..tables.inputs()).flat_map(|j| std::iter::repeat_n(weight * tables.slope_unit(j), points));
    std::iter::repeat_n(1.0, equations.samples()).chain(derivatives).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitting::design::{NestedLatinHypercube, Samples};
    use pcc_evaluate::foundation::Silent;
    use pcc_evaluate::polynomials::{Family, Hyperbolic, Recurrence};
    use pcc_evaluate::probability::statistics::Moments;

    /// Closed forms and explicit refits differ by rounding only.
    const TOLERANCE: f64 = 1e-10;

    struct Problem {
        samples: Samples,
        values: Vec<f64>,
        recurrences: Vec<Recurrence>,
    }

    fn problem(points: usize) -> Problem {
        let mut design = NestedLatinHypercube::new(2, 5);
        design.grow_to(points);
        let samples = design.samples(|_, u| 2.0 * u - 1.0);
        let values = samples.points().map(|x| (2.0 * x[0]).sin() + x[1] * x[1] * x[0] + x[1].exp()).collect();
        Problem { samples, values, recurrences: vec![Family::Legendre.recurrence(6); 2] }
    }

    fn variance(values: &[f64]) -> f64 {
        Moments::of(values).variance()
    }

    fn indices(degree: u16) -> Vec<MultiIndex> {
        let shells = Hyperbolic { inputs: 2, q_norm: 0.8 }.shells(degree).unwrap();
        shells[1..].concat()
    }

    fn fitted<'a>(tables: &'a BasisTables, values: &'a [f64], terms: Vec<MultiIndex>) -> ActiveBasis<'a> {
        let mut basis =
            ActiveBasis::constant(tables, Response::of(values, 0.0), variance(values), 1.0, &Silent).unwrap();
        basis.extend(terms).unwrap();
        basis
    }

    #[test]
    fn leave_one_out_equals_n_explicit_refits() {
        let Problem { samples, values, recurrences } = problem(40);
        let tables = BasisTables::new(&samples, &recurrences, 6);
        let basis = fitted(&tables, &values, indices(4));
        let closed_form = basis.leave_one_out_residuals().unwrap();
        let mut sum_of_squares = 0.0;
        for i in 0..40 {
            let others: Vec<usize> = (0..40).filter(|&other| other != i).collect();
            let points = others.iter().flat_map(|&other| samples.point(other).to_vec()).collect();
            let rest: Vec<f64> = others.iter().map(|&other| values[other]).collect();
            let rest_tables = BasisTables::new(&Samples::new(2, points), &recurrences, 6);
            let beta = fitted(&rest_tables, &rest, indices(4)).coefficients();
            let row = tables.columns(basis.indices());
            let prediction: f64 = beta.iter().zip(row.row(i).iter()).map(|(b, psi)| b * psi).sum();
            assert!((values[i] - prediction - closed_form[i]).abs() < TOLERANCE);
            sum_of_squares += (values[i] - prediction).powi(2);
        }
        let s2 = 1.0 - sum_of_squares / 40.0 / variance(&values);
        assert!((basis.errors().unwrap().s2.unwrap() - s2).abs() < TOLERANCE);
        assert!((basis.s2().unwrap() - s2).abs() < TOLERANCE);
    }

    #[test]
    fn gains_and_losses_equal_explicit_refits() {
        let Problem { samples, values, recurrences } = problem(50);
        let tables = BasisTables::new(&samples, &recurrences, 6);
        let (inside, outside) = (indices(3), indices(5).split_off(indices(3).len()));
        let basis = fitted(&tables, &values, inside.clone());
        for (candidate, gain) in outside.iter().zip(basis.gains(&outside).unwrap()) {
            let mut larger = inside.clone();
            larger.push(candidate.clone());
            let rise = fitted(&tables, &values, larger).errors().unwrap().r2 - basis.errors().unwrap().r2;
            assert!((gain - rise).abs() < TOLERANCE, "{candidate:?}: {gain} against {rise}");
        }
        for (k, loss) in basis.losses().unwrap().into_iter().enumerate().skip(1) {
            let mut smaller = basis.clone();
            smaller.retain(|position, _| position != k).unwrap();
            let fall = basis.errors().unwrap().r2 - smaller.errors().unwrap().r2;
            assert!((loss - fall).abs() < TOLERANCE, "term {k}: {loss} against {fall}");
        }
    }

    #[test]
    fn repeated_terms_are_not_taken_twice() {
        let Problem { samples, values, recurrences } = problem(30);
        let tables = BasisTables::new(&samples, &recurrences, 6);
        let mut basis = fitted(&tables, &values, indices(3));
        let before = basis.indices().to_vec();
        assert!(basis.gains(&before).unwrap().iter().all(|&gain| gain == 0.0));
        basis.extend(before.clone()).unwrap();
        assert_eq!(basis.indices(), before);
    }
}
