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
//! about twice smaller than it is; at the points that a grown design adds, the prior of the smaller one is judged blindly.
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

/// Candidates per run: prior variances beyond them are negligible (2, 4 and 8 gave the same results).
const CANDIDATES_PER_RUN: usize = 3;

/// The prior is found on so many points at most, the first ones: each step of the search costs the cube of their number.
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
    /// Number of points of the design on which it was found.
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
    let unchanged = (prior == former.prior).then_some(&solution);
    let blind = problem.blind_residuals(former, unchanged, error);
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
    /// `unchanged` is the solution with the former prior, if it is known.
    fn blind_residuals(&self, former: &Learnt, unchanged: Option<&Solution>, error: f64) -> Option<BlindResiduals> {
        let first = former.points;
        if first == 0 || first >= self.values.len() {
            return former.blind.clone();
        }
        let left_out = match unchanged {
            Some(solution) => solution.left_out.clone(),
            None => self.solve(&former.prior)?.left_out,
        };
        let new = left_out.iter().skip(first).map(|residual| residual * self.scale);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::{NestedLatinHypercube, Samples};
    use crate::polynomial::Family;
    use crate::progress::Silent;

    const DEGREE: u16 = 10;

    fn samples(inputs: usize, sizes: &[usize]) -> Samples {
        let mut design = NestedLatinHypercube::new(inputs, 3);
        sizes.iter().for_each(|&size| design.grow_to(size));
        design.samples(|_, u| 2.0 * u - 1.0)
    }

    fn tables(samples: &Samples) -> BasisTables {
        BasisTables::new(samples, &vec![Family::Legendre.recurrence(DEGREE.into()); samples.dimension()], DEGREE.into())
    }

    fn settings() -> Smooth {
        Smooth { max_degree: DEGREE, s2_target: 0.999 }
    }

    fn smooth(point: &[f64]) -> f64 {
        (0.6 * point[0]).exp() / (1.5 + 0.4 * point[1]) + 0.1 * point.iter().sum::<f64>()
    }

    /// A = (K + νI)⁻¹: predictions without a point, by N explicit solutions.
    #[test]
    fn closed_form_residuals_equal_explicit_refits() {
        let samples = samples(2, &[15]);
        let tables = tables(&samples);
        let values: Vec<f64> = samples.points().map(smooth).collect();
        let problem = Problem::new(&tables, Response { values: &values, resolution: 0.0 }, 1.0, DEGREE);
        let prior = Prior::start(2);
        let kernel = prior.kernel(&tables, 15, DEGREE).matrix;
        let (inverse, nugget) = regularized_inverse(&kernel).unwrap();
        let closed = (&inverse * &problem.values).component_div(&inverse.diagonal());
        for left in 0..15 {
            let others: Vec<usize> = (0..15).filter(|&i| i != left).collect();
            let mut matrix = kernel.select_rows(&others).select_columns(&others);
            (0..14).for_each(|i| matrix[(i, i)] += nugget);
            let weights = matrix.lu().solve(&problem.values.select_rows(&others)).unwrap();
            let predicted = kernel.row(left).transpose().select_rows(&others).dot(&weights);
            // The condition number of K, some 10¹⁰, times rounding.
            assert!((problem.values[left] - predicted - closed[left]).abs() < 1e-5, "point {left}");
        }
    }

    #[test]
    fn gradient_is_that_of_the_leave_one_out_error() {
        let samples = samples(3, &[25]);
        let tables = tables(&samples);
        let values: Vec<f64> = samples.points().map(smooth).collect();
        let problem = Problem::new(&tables, Response { values: &values, resolution: 1e-12 }, 1.0, DEGREE);
        let at = [0.9, 1.1, 1.6, -0.7];
        let (_, gradient) = problem.leave_one_out_error(&Prior::with(&at)).unwrap();
        for (k, slope) in gradient.iter().enumerate() {
            let shifted = |step: f64| {
                let mut moved = at;
                moved[k] += step;
                problem.leave_one_out_error(&Prior::with(&moved)).unwrap().0
            };
            let difference = (shifted(1e-4) - shifted(-1e-4)) / 2e-4;
            assert!((slope - difference).abs() < 1e-4 * (1.0 + slope.abs()), "{k}: {slope} against {difference}");
        }
    }

    #[test]
    fn smooth_functions_are_found_from_fewer_runs_than_terms() {
        let samples = samples(2, &[30]);
        let values: Vec<f64> = samples.points().map(smooth).collect();
        let response = Response { values: &values, resolution: 0.0 };
        let (fitted, _) = fit(&tables(&samples), response, &settings(), &Learnt::nothing(2), &Silent).unwrap();
        assert!(fitted.errors.unwrap().s2.unwrap() > 1.0 - 1e-8 && fitted.stop == Stop::Accurate);
        assert!(fitted.blind_residuals.is_none(), "a first design has chosen everything itself");
    }

    /// Many points of few inputs make K singular to working precision; the fit must not give up.
    #[test]
    fn designs_much_larger_than_the_basis_are_fitted_as_well() {
        for size in [200, 500, 1000] {
            let samples = samples(1, &[size]);
            let values: Vec<f64> = samples.points().map(|x| (1.3 * x[0]).sin()).collect();
            let response = Response { values: &values, resolution: 1e-13 };
            let (fitted, _) = fit(&tables(&samples), response, &settings(), &Learnt::nothing(1), &Silent).unwrap();
            assert_eq!(fitted.stop, Stop::Accurate, "{size} points");
        }
    }

    #[test]
    fn new_points_are_judged_by_the_prior_that_has_not_seen_them() {
        let small = samples(2, &[20]);
        let large = samples(2, &[20, 40]);
        let values: Vec<f64> = large.points().map(smooth).collect();
        let response = |values| Response { values, resolution: 0.0 };
        let (_, learnt) =
            fit(&tables(&small), response(&values[..20]), &settings(), &Learnt::nothing(2), &Silent).unwrap();
        let (fitted, _) = fit(&tables(&large), response(&values), &settings(), &learnt, &Silent).unwrap();
        let blind = fitted.blind_residuals.unwrap();
        assert_eq!((blind.first, blind.values.len()), (20, 20));
    }

    /// Noise is not called accurate, however few points there are.
    #[test]
    fn noise_is_not_fitted() {
        use crate::random::{Purpose, Stream};
        let mut stream = Stream::new(1, Purpose::Evaluation, 0);
        for size in [2, 3, 5, 10, 40] {
            let samples = samples(2, &[size]);
            let values: Vec<f64> = (0..size).map(|_| stream.next_unit()).collect();
            let response = Response { values: &values, resolution: 0.0 };
            let (fitted, _) = fit(&tables(&samples), response, &settings(), &Learnt::nothing(2), &Silent).unwrap();
            assert_ne!(fitted.stop, Stop::Accurate, "{size} points: {:?}", fitted.errors);
        }
    }
}
