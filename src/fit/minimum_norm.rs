//! Weighted minimum-norm fit: more terms than runs, tamed by how coefficients of smooth functions fall.
//!
//! Among all expansions that meet the values, the fit takes the one with the smallest Σ c_α²/s_α, where s_α falls with
//! the degree ([`Prior`]):
//!
//! c = S Ψᵀ (K + νI)⁻¹ y,   K = Ψ S Ψᵀ,   S = diag s_α,
//!
//! the posterior mean of a Gaussian process with the polynomial kernel K (Rasmussen and Williams 2006, chapters 2 and 5,
//! <https://gaussianprocess.org/gpml/>). Where least squares must leave out all but some N/2 terms, and choosing them
//! costs accuracy, this uses every run for every term.
//!
//! The r + 1 parameters of the prior minimise the leave-one-out error, known in closed form,
//!
//! Δ_i = (A y)_i/A_ii,   A = (K + νI)⁻¹,
//!
//! so a design of N runs is judged without a single refit. That the parameters were chosen by it makes the error look
//! up to twice smaller than it is; at the points that a grown design adds, the prior of the smaller one is judged blindly.
//!
//! Finally terms too small to matter beside that error are dropped: the expansion is sparse.

use super::prior::Prior;
use super::{BlindResiduals, Fitted, Stop};
use crate::index_set::{IndexSet, MultiIndex};
use crate::numerics::minimize::{Limits, minimize};
use crate::numerics::positive_definite::inverse;
use crate::progress::{Interrupted, Observer};
use crate::regression::{BasisTables, ErrorMeasures, Response};
use crate::statistics::Moments;
use crate::study::Smooth;
use nalgebra::{DMatrix, DVector};

/// ν relative to the mean diagonal of K: enough for a Cholesky factorisation in double precision, and far below the
/// errors that matter.
const NUGGET: f64 = 1e-11;

/// Powers of ten by which ν may rise where rounding makes K indefinite.
const NUGGETS: i32 = 5;

/// Candidates per run: prior variances beyond them are negligible (2 gave the same results as 8).
const CANDIDATES_PER_RUN: usize = 3;

/// More points than this do not improve the prior; it is found on the first ones, which are a Latin hypercube, too.
const PRIOR_POINTS: usize = 300;

/// Dropped terms together are below this share of the leave-one-out error.
const DROPPED_SHARE: f64 = 0.1;

/// A prior with a smaller leave-one-out error, relative to the standard deviation, is kept: a better one would change
/// nothing that matters.
const SETTLED: f64 = 3e-5;

/// So many new blind residuals need no older ones beside them.
const ENOUGH_BLIND: usize = 40;

/// So many more points than parameters of the prior are needed for a search; with fewer, it would fit noise.
const LEAST_SURPLUS: usize = 3;

/// A larger design is expected to lower ½ ln of the mean square error by this.
const EXPECTED_GAIN: f64 = 0.1;

/// Refinements of the coefficients: each gains about five digits of the sixteen.
const REFINEMENTS: usize = 3;

/// The search for the prior ends when ½ ln of the mean square error falls by less, one per mille of the error.
const LIMITS: Limits = Limits { iterations: 60, decrease: 1e-3 };

/// What the fit of a component on one design leaves for the next larger one.
#[derive(Debug, Clone, PartialEq)]
pub struct Learnt {
    /// The prior that was best; the next search starts from it.
    pub prior: Prior,
    /// ½ ln of the mean square leave-one-out error, relative to the variance.
    error: Option<f64>,
    /// Number of points that chose the prior.
    points: usize,
    /// Blind residuals of the last points.
    blind: Option<BlindResiduals>,
}

impl Learnt {
    /// Before the first design.
    pub fn nothing(inputs: usize) -> Self {
        Self { prior: Prior::start(inputs), error: None, points: 0, blind: None }
    }
}

/// Fits one component. `former` is what a smaller design taught, [`Learnt::nothing`] at first; what this one teaches comes
/// back for the next.
///
/// `response.values[i]` is the component at point i of `tables`, in its own unit.
///
/// # Errors
///
/// [`Interrupted`] soon after the observer asks to stop.
///
/// # Examples
///
/// ```
/// use pcc::design::NestedLatinHypercube;
/// use pcc::fit::minimum_norm::{Learnt, fit};
/// use pcc::polynomial::Family;
/// use pcc::progress::Silent;
/// use pcc::regression::{BasisTables, Response};
/// use pcc::study::Smooth;
///
/// let mut design = NestedLatinHypercube::new(2, 1);
/// design.grow_to(30);
/// let samples = design.samples(|_, u| 2.0 * u - 1.0);
/// let values: Vec<f64> = samples.points().map(|x| (0.5 * x[0] + 0.2 * x[1]).exp()).collect();
/// let tables = BasisTables::new(&samples, &vec![Family::Legendre.recurrence(10); 2], 10);
/// let response = Response { values: &values, resolution: 1e-13 };
/// let settings = Smooth { max_degree: 10, s2_target: 0.999 };
/// let (fitted, _) = fit(&tables, response, &settings, &Learnt::nothing(2), &Silent)?;
/// assert!(fitted.errors.unwrap().s2.unwrap() > 1.0 - 1e-8);
/// # Ok::<(), pcc::progress::Interrupted>(())
/// ```
pub fn fit(
    tables: &BasisTables,
    response: Response<'_>,
    settings: &Smooth,
    former: &Learnt,
    observer: &dyn Observer,
) -> Result<(Fitted, Learnt), Interrupted> {
    let inputs = former.prior.inputs();
    let Some(variance) = response.variance() else {
        return Ok((Fitted::constant(inputs, response.values), former.clone()));
    };
    let problem = Problem::new(tables, response, variance.sqrt(), settings.max_degree);
    let (prior, error) = problem.best_prior(former, observer)?;
    observer.check()?;
    let Some(solution) = problem.solve(&prior) else {
        let mean = Fitted::mean(tables, inputs, response.values, variance, observer)?;
        return Ok((mean, Learnt::nothing(inputs)));
    };
    let blind = problem.blind_residuals(former, error);
    let learnt = Learnt { prior, error: Some(error), points: response.values.len(), blind };
    let (indices, mut coefficients, residuals, left_out) = solution.without_negligible_terms(problem.resolution);
    coefficients.iter_mut().for_each(|coefficient| *coefficient *= problem.scale);
    coefficients[0] += problem.mean;
    let mean_square = |values: &[f64]| values.iter().map(|e| e * e).sum::<f64>() / values.len() as f64;
    let s2 = 1.0 - mean_square(&left_out);
    let degree = indices.iter().map(MultiIndex::total_degree).max().unwrap_or(0) as u16;
    let fitted = Fitted {
        indices: IndexSet::from_unsorted(indices),
        coefficients,
        errors: Some(ErrorMeasures { r2: 1.0 - mean_square(&residuals), s2: Some(s2), corrected_s2: None }),
        blind_residuals: learnt.blind.clone(),
        leave_one_out_residuals: Some(left_out.iter().map(|residual| residual * problem.scale).collect()),
        degree,
        stop: if s2 >= settings.s2_target { Stop::Accurate } else { Stop::DesignExhausted },
    };
    Ok((fitted, learnt))
}

/// Standardized values on a design.
struct Problem<'a> {
    tables: &'a BasisTables,
    /// (y − mean)/scale.
    values: DVector<f64>,
    mean: f64,
    scale: f64,
    /// Rounding of the values, relative to `scale`.
    resolution: f64,
    degree: u16,
}

/// Coefficients of the standardized values, and what is known of their errors.
struct Solution {
    indices: Vec<MultiIndex>,
    columns: DMatrix<f64>,
    coefficients: DVector<f64>,
    residuals: DVector<f64>,
    left_out: DVector<f64>,
}

impl<'a> Problem<'a> {
    fn new(tables: &'a BasisTables, response: Response<'_>, scale: f64, degree: u16) -> Self {
        let mean = Moments::of(response.values).mean();
        let standardized = response.values.iter().map(|value| (value - mean) / scale);
        Self {
            tables,
            values: DVector::from_iterator(response.values.len(), standardized),
            mean,
            scale,
            resolution: response.resolution / scale,
            degree,
        }
    }

    /// The prior with the smallest leave-one-out error found from the former one, and that error. A start that led into a
    /// side valley on a smaller design is recognised by an error that no longer falls; then the search is repeated from the
    /// neutral prior.
    fn best_prior(&self, former: &Learnt, observer: &dyn Observer) -> Result<(Prior, f64), Interrupted> {
        if self.values.len() < former.prior.parameters().len() + LEAST_SURPLUS {
            let neutral = Prior::start(former.prior.inputs());
            return Ok((neutral.clone(), self.error_of(&neutral)));
        }
        if former.points >= PRIOR_POINTS || former.error.is_some_and(|error| error < SETTLED.ln()) {
            return Ok((former.prior.clone(), self.error_of(&former.prior)));
        }
        let found = self.search(&former.prior, observer)?;
        if former.error.is_none_or(|before| found.1 < before - EXPECTED_GAIN) {
            return Ok(found);
        }
        let neutral = self.search(&Prior::start(former.prior.inputs()), observer)?;
        Ok(if neutral.1 < found.1 { neutral } else { found })
    }

    /// What the prior of a former design, chosen without the points that are new here, misses at each of them. Residuals
    /// of points that were new on designs before are kept while there are few, scaled by how far errors fell since.
    fn blind_residuals(&self, former: &Learnt, error: f64) -> Option<BlindResiduals> {
        let first = former.points;
        if first == 0 || first >= self.values.len() {
            return former.blind.clone();
        }
        let solution = self.solve(&former.prior)?;
        let new = solution.left_out.iter().skip(first).map(|residual| residual * self.scale);
        if new.len() >= ENOUGH_BLIND {
            return Some(BlindResiduals { first, values: new.collect() });
        }
        let fallen = former.error.map_or(1.0, |before| (error - before).exp());
        let mut blind = former.blind.clone().unwrap_or(BlindResiduals { first, values: Vec::new() });
        blind.values.iter_mut().for_each(|residual| *residual *= fallen);
        blind.values.extend(new);
        Some(blind)
    }

    /// A local minimum, rounded, and ½ ln of the mean square error there.
    fn search(&self, start: &Prior, observer: &dyn Observer) -> Result<(Prior, f64), Interrupted> {
        let lowest = minimize(start.parameters(), &Prior::bounds(start.inputs()), LIMITS, |parameters| {
            observer.check()?;
            Ok(self.leave_one_out_error(&Prior::with(parameters)))
        })?;
        let prior = Prior::rounded(&lowest);
        let error = self.error_of(&prior);
        Ok((prior, error))
    }

    /// ½ ln of the mean square error, infinite if it cannot be computed.
    fn error_of(&self, prior: &Prior) -> f64 {
        self.leave_one_out_error(prior).map_or(f64::INFINITY, |(error, _)| error)
    }

    /// ½ ln of the mean of Δ², no smaller than rounding, with its derivatives by the parameters of the prior.
    ///
    /// With A = (K + νI)⁻¹, c = Ay and Δ_i = c_i/A_ii: ΣΔdΔ = Σ G_ab dK_ab with
    /// G = −(A u) cᵀ + A diag(t) A, u_i = Δ_i/A_ii, t_i = Δ_i c_i/A_ii².
    fn leave_one_out_error(&self, prior: &Prior) -> Option<(f64, Vec<f64>)> {
        let samples = self.values.len().min(PRIOR_POINTS);
        let values = self.values.rows(0, samples);
        let kernel = prior.kernel(self.tables, samples, self.degree);
        let (inverse, nugget) = regularized_inverse(&kernel.matrix)?;
        let weighted = &inverse * values;
        let diagonal = inverse.diagonal();
        let left_out = weighted.component_div(&diagonal);
        let floor = samples as f64 * self.resolution.max(f64::EPSILON).powi(2);
        let square = left_out.norm_squared() + floor;
        let direct = &inverse * left_out.component_div(&diagonal);
        let mut scaled = inverse.clone();
        for (k, mut column) in scaled.column_iter_mut().enumerate() {
            column.scale_mut(left_out[k] * weighted[k] / (diagonal[k] * diagonal[k]));
        }
        let mut by_matrix = scaled * inverse;
        by_matrix.ger(-1.0, &direct, &weighted, 1.0);
        // ν is proportional to the trace of K.
        let nugget_part = nugget / kernel.matrix.trace() * by_matrix.trace();
        for k in 0..samples {
            by_matrix[(k, k)] += nugget_part;
        }
        let value = 0.5 * (square / samples as f64).ln();
        let gradient = kernel.gradient(&by_matrix).into_iter().map(|slope| slope / square).collect();
        Some((value, gradient)).filter(|(value, _): &(f64, Vec<f64>)| value.is_finite())
    }

    /// The weighted minimum-norm coefficients on the likeliest terms, refined: with B = Ψ S^{1/2}, residuals of
    /// (B, √ν I)(x, t) = y are formed at full precision and solved for again by the explicit inverse.
    fn solve(&self, prior: &Prior) -> Option<Solution> {
        let samples = self.values.len();
        let indices = prior.likeliest(CANDIDATES_PER_RUN * samples, self.degree);
        let columns = self.tables.columns(&indices);
        let deviations: Vec<f64> = indices.iter().map(|alpha| prior.variance(alpha).sqrt()).collect();
        let mut weighted = columns.clone();
        for (mut column, &deviation) in weighted.column_iter_mut().zip(&deviations) {
            column.scale_mut(deviation);
        }
        let kernel = &weighted * weighted.transpose();
        let (inverse, nugget) = regularized_inverse(&kernel)?;
        let root_nugget = nugget.sqrt();
        let (mut x, mut t) = (DVector::zeros(indices.len()), DVector::zeros(samples));
        for _ in 0..=REFINEMENTS {
            let rest = &self.values - &weighted * &x - &t * root_nugget;
            let correction = &inverse * rest;
            x += weighted.tr_mul(&correction);
            t += correction * root_nugget;
        }
        let left_out = (&t / root_nugget).component_div(&inverse.diagonal());
        let coefficients = DVector::from_iterator(indices.len(), x.iter().zip(&deviations).map(|(x, s)| x * s));
        let residuals = &self.values - &columns * &coefficients;
        let is_finite = coefficients.iter().chain(left_out.iter()).all(|value| value.is_finite());
        is_finite.then_some(Solution { indices, columns, coefficients, residuals, left_out })
    }
}

impl Solution {
    /// Drops the smallest terms as long as they are together a small share of the leave-one-out error; {0} stays. Returns
    /// indices, coefficients, residuals, and leave-one-out residuals, to which the dropped terms are added.
    fn without_negligible_terms(self, resolution: f64) -> (Vec<MultiIndex>, Vec<f64>, Vec<f64>, Vec<f64>) {
        let samples = self.residuals.len() as f64;
        let error = (self.left_out.norm_squared() / samples).sqrt().max(resolution);
        let mut order: Vec<usize> = (0..self.indices.len()).filter(|&k| !self.indices[k].is_constant()).collect();
        order.sort_by(|&a, &b| self.coefficients[a].abs().total_cmp(&self.coefficients[b].abs()).then(a.cmp(&b)));
        let (mut kept, mut dropped) = (vec![true; self.indices.len()], DVector::zeros(self.residuals.len()));
        let mut square = 0.0;
        for k in order {
            square += self.coefficients[k] * self.coefficients[k];
            if square > (DROPPED_SHARE * error).powi(2) {
                break;
            }
            kept[k] = false;
            dropped.axpy(self.coefficients[k], &self.columns.column(k), 1.0);
        }
        let residuals = (self.residuals + &dropped).iter().copied().collect();
        let left_out = (self.left_out + dropped).iter().copied().collect();
        let terms = self.indices.into_iter().zip(self.coefficients.iter().copied()).zip(kept);
        let (indices, coefficients) = terms.filter(|(_, kept)| *kept).map(|(term, _)| term).unzip();
        (indices, coefficients, residuals, left_out)
    }
}

/// (K + νI)⁻¹ with the smallest ν that allows it, and ν.
fn regularized_inverse(kernel: &DMatrix<f64>) -> Option<(DMatrix<f64>, f64)> {
    let mean = kernel.trace() / kernel.nrows() as f64;
    (0..NUGGETS).find_map(|k| {
        let nugget = NUGGET * 10f64.powi(k) * mean;
        let mut matrix = kernel.clone();
        for i in 0..matrix.nrows() {
            matrix[(i, i)] += nugget;
        }
        Some((inverse(&matrix)?, nugget))
    })
}
