//! Weighted minimum-norm fit: more terms than runs, tamed by how coefficients of smooth functions fall.
//!
//! Among all expansions that meet the values, the fit takes the one with the smallest Σ c_α²/s_α, where s_α falls with
//! the degree ([`super::Prior`]):
//!
//! c = S Ψᵀ (K + νI)⁻¹ y,   K = Ψ S Ψᵀ,   S = diag s_α,
//!
//! the posterior mean of a Gaussian process with the polynomial kernel K (Rasmussen and Williams 2006, chapters 2 and
//! 5, <https://gaussianprocess.org/gpml/>). Where least squares must leave out all but some N/2 terms, and choosing
//! them costs accuracy, this uses every run for every term.
//!
//! What a fit without run i misses there is known in closed form: with A = (K + νI)⁻¹, its block A_i for the equations
//! of run i, and c = A y,
//!
//! Δ_i = A_i⁻¹ c_i,
//!
//! so a design of N runs is judged without a single refit. Without derivatives a run is one value and Δ_i = c_i/A_ii.
//! How the r + 1 parameters of the prior are found is said in `prior_search`; being tuned on the same runs makes this
//! error look up to twice smaller than it is. At the points that a design has grown by since, a prior is judged
//! blindly.
//!
//! Derivatives are equations like values: K holds their covariances (Solak, Murray-Smith, Leithead, Leith and Rasmussen
//! 2003, *Derivative observations in Gaussian process models of dynamic systems*). Where they are not as good as the
//! values, ν of theirs grows by the inverse square of a weight.
//!
//! Finally terms too small to matter beside that error are dropped: the expansion is sparse.

use super::method::{self, Entry, FitMethod, MAX_DEGREE, MethodFit, Profile, S2_TARGET, Smooth, Solver};
use super::prior_search::{Found, Search, most_runs};
use super::regularized::Regularized;
use super::{BlindResiduals, FLATTERY, Fitted};
use crate::fitting::regression::{BasisTables, Equations, ErrorMeasures, Gradients, Response};
use nalgebra::{DMatrix, DVector};
use pcc_evaluate::foundation::{Interrupted, Observer};
use pcc_evaluate::polynomials::{IndexSet, MultiIndex};
use pcc_evaluate::probability::statistics::Moments;
use pcc_evaluate::surrogate::StopReason;

/// Candidates per equation: prior variances beyond them are negligible (2, 4 and 8 gave the same results).
const CANDIDATES_PER_EQUATION: usize = 2;

/// Dropped terms together are below this share of the leave-one-out error.
const DROPPED_SHARE: f64 = 0.1;

/// With derivatives, which determine many small terms, below this: a third fewer terms for 4 % more error.
const DROPPED_SHARE_WITH_DERIVATIVES: f64 = 0.3;

/// A prior with a smaller leave-one-out error, relative to the standard deviation, is kept: a better one would change
/// nothing that matters.
const SETTLED: f64 = 3e-5;

/// Growth of the points a search can use that is worth another search.
const WORTH_A_SEARCH: f64 = 1.3;

/// γ, minus the mean logarithm of a variable with an exponential distribution.
const EULER_GAMMA: f64 = 0.577_215_664_901_532_9;

/// So many new blind residuals need no older ones beside them.
const ENOUGH_BLIND: usize = 40;

/// Equations of a fit at most, of few and of many inputs: each fit costs the cube of their number, and systems with
/// many inputs have many components. Beyond it the last runs give their values alone.
const MOST_EQUATIONS: (usize, usize) = (3_000, 800);

/// The product of equations and inputs between them.
const EQUATIONS_BY_INPUTS: usize = 24_000;

/// Equations with derivatives that a fit takes at most.
pub fn most_equations(inputs: usize) -> usize {
    (EQUATIONS_BY_INPUTS / inputs.max(1)).clamp(MOST_EQUATIONS.1, MOST_EQUATIONS.0)
}

/// The derivatives of the first runs where all are more than a fit can take; `None` if it can take all.
pub(super) fn fewer_derivatives(response: Response<'_>, inputs: usize) -> Option<Gradients> {
    response.gradients?.within(response.values.len(), most_equations(inputs))
}

/// Refinements of the coefficients: each gains about five digits of the sixteen.
const REFINEMENTS: usize = 3;

/// The method in the list.
pub(super) const METHOD: Entry = Entry {
    name: "minimum-norm",
    keys: &[&MAX_DEGREE, &S2_TARGET],
    grows: true,
    read: |given, _| Ok(FitMethod::MinimumNorm(Smooth::read(given))),
};

pub(super) fn profile(settings: &Smooth) -> Profile {
    settings.profile(METHOD.name, "weighted minimum norm", "in each input")
}

/// The method, which takes all terms.
struct Ready<'s>(&'s Smooth);

pub(super) fn ready(settings: &Smooth) -> impl Solver {
    Ready(settings)
}

impl Solver for Ready<'_> {
    fn fit(
        &self,
        tables: &BasisTables,
        response: Response<'_>,
        previous: &method::Previous,
        _: bool,
        observer: &dyn Observer,
    ) -> Result<Option<MethodFit>, Interrupted> {
        let (fitted, minimum_norm) = fit(tables, response, self.0, &previous.minimum_norm, observer)?;
        Ok(Some((fitted, METHOD.name, method::Previous { minimum_norm, ..*previous })))
    }
}

/// What the fit of a component on one design leaves for the next larger one.
#[derive(Debug, Clone, PartialEq)]
pub struct Previous {
    /// The prior and weight of derivatives that were best, and their error; the next search starts from them.
    found: Found,
    /// Number of points of the design on which it was searched for; to later ones it is blind.
    points: usize,
    /// Blind residuals of the last points.
    blind: Option<BlindResiduals>,
}

impl Previous {
    /// Before the first design.
    pub fn nothing(inputs: usize) -> Self {
        Self { found: Found::nothing(inputs), points: 0, blind: None }
    }
}

/// Fits one component. `previous` is what a smaller design taught, [`Previous::nothing`] at first; what this one
/// teaches comes back for the next.
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
/// use pcc_compile::fitting::design::NestedLatinHypercube;
/// use pcc_compile::fitting::fit::minimum_norm::{fit, Previous};
/// use pcc_evaluate::polynomials::Family;
/// use pcc_evaluate::foundation::Silent;
/// use pcc_compile::fitting::regression::{BasisTables, Response};
/// use pcc_compile::fitting::fit::Smooth;
///
/// let mut design = NestedLatinHypercube::new(2, 1);
/// design.grow_to(30);
/// let samples = design.samples(|_, u| 2.0 * u - 1.0);
/// let values: Vec<f64> = samples.points().map(|x| (0.5 * x[0] + 0.2 * x[1]).exp()).collect();
/// let tables = BasisTables::new(&samples, &vec![Family::Legendre.recurrence(10); 2], 10);
/// let response = Response::of(&values, 1e-13);
/// let settings = Smooth { max_degree: 10, s2_target: 0.999 };
/// let (fitted, _) = fit(&tables, response, &settings, &Previous::nothing(2), &Silent)?;
/// assert!(fitted.errors.unwrap().s2.unwrap() > 1.0 - 1e-8);
/// # Ok::<(), pcc_evaluate::foundation::Interrupted>(())
/// ```
pub fn fit(
    tables: &BasisTables,
    response: Response<'_>,
    settings: &Smooth,
    previous: &Previous,
    observer: &dyn Observer,
) -> Result<(Fitted, Previous), Interrupted> {
    let inputs = tables.inputs();
    let fewer = fewer_derivatives(response, inputs);
    let response = Response { gradients: fewer.as_ref().or(response.gradients), ..response };
    let Some(variance) = response.variance() else {
        return Ok((Fitted::constant(inputs, response.values), previous.clone()));
    };
    let problem = Problem::new(tables, response, variance.sqrt(), settings.max_degree);
    let (found, points) = problem.best_prior(previous, observer)?;
    observer.check()?;
    let Some(solution) = problem.solve(&found) else {
        let mean = Fitted::mean(tables, response, variance, observer)?;
        return Ok((mean, Previous::nothing(inputs)));
    };
    let is_unchanged = (&found.prior, found.weight) == (&previous.found.prior, previous.found.weight);
    let blind = problem.blind_residuals(previous, &solution, is_unchanged, found.error);
    let found_before = Previous { found, points, blind };
    let dropped_share = if response.gradients.is_some() { DROPPED_SHARE_WITH_DERIVATIVES } else { DROPPED_SHARE };
    let Sparse { indices, mut coefficients, residuals, left_out, dropped } =
        solution.without_negligible_terms(dropped_share, problem.resolution);
    let mut blind_residuals = found_before.blind.clone();
    if let Some(BlindResiduals { first, values }) = &mut blind_residuals {
        values.iter_mut().zip(dropped.iter().skip(*first)).for_each(|(rest, dropped)| *rest += dropped * problem.scale);
    }
    coefficients.iter_mut().for_each(|coefficient| *coefficient *= problem.scale);
    coefficients[0] += problem.mean;
    // Standardized values have unit variance.
    let errors = ErrorMeasures::of_residuals(&residuals, Some(&left_out), 1.0);
    let is_accurate = errors.s2.is_some_and(|s2| s2 >= settings.s2_target);
    let degree = indices.iter().map(MultiIndex::total_degree).max().unwrap_or(0) as u16;
    let fitted = Fitted {
        indices: IndexSet::from_unsorted(indices),
        coefficients,
        errors: Some(errors),
        blind_residuals,
        leave_one_out_residuals: Some(left_out.iter().map(|residual| residual * problem.scale).collect()),
        derivative_weight: response.gradients.map(|_| found_before.found.weight),
        degree,
        stop: if is_accurate { StopReason::Accurate } else { StopReason::DesignExhausted },
    };
    Ok((fitted, found_before))
}

/// Standardized values and derivatives on a design.
struct Problem<'a> {
    tables: &'a BasisTables,
    equations: Equations,
    /// (y − mean)/scale, then the derivatives divided by the scale.
    targets: DVector<f64>,
    mean: f64,
    scale: f64,
    /// Rounding of the values, relative to `scale`.
    resolution: f64,
    degree: u16,
}

/// Coefficients of the standardized values, and what is known of their errors.
struct Solution {
    indices: Vec<MultiIndex>,
    /// Of the values alone, as are the residuals.
    columns: DMatrix<f64>,
    coefficients: DVector<f64>,
    residuals: DVector<f64>,
    left_out: DVector<f64>,
}

impl<'a> Problem<'a> {
    fn new(tables: &'a BasisTables, response: Response<'_>, scale: f64, degree: u16) -> Self {
        let mean = Moments::of(response.values).mean();
        let samples = response.values.len();
        let centered = response.targets().enumerate().map(|(row, y)| if row < samples { y - mean } else { y });
        let targets: Vec<f64> = centered.map(|y| y / scale).collect();
        let equations = response.equations(tables.inputs());
        let resolution = response.resolution / scale;
        Self { tables, equations, targets: DVector::from_vec(targets), mean, scale, resolution, degree }
    }

    /// The prior found from the previous one, unless that is good enough or there is too little new to search with, and
    /// the number of points that it was searched for on.
    fn best_prior(&self, previous: &Previous, observer: &dyn Observer) -> Result<(Found, usize), Interrupted> {
        let Self { tables, equations, targets, resolution, degree, .. } = self;
        let search = Search { tables, equations, targets, resolution: *resolution, degree: *degree };
        let kept = |known: &Found| {
            let error = search.error_of(&known.prior, known.weight);
            Found { error, ..known.clone() }
        };
        let inputs = tables.inputs();
        if !search.is_determined() {
            return Ok((kept(&Found::nothing(inputs)), equations.samples()));
        }
        let is_settled = previous.found.error < SETTLED.ln();
        let used = |points: usize| points.min(most_runs(equations, inputs)) as f64;
        if is_settled || used(equations.samples()) < WORTH_A_SEARCH * used(previous.points) {
            return Ok((kept(&previous.found), previous.points));
        }
        Ok((search.best(&previous.found, observer)?, equations.samples()))
    }

    /// What the previous prior, which was chosen without the last points, misses at each of them. Residuals of points
    /// that were blind to priors before are kept while there are few, scaled by how far errors fell since; but what
    /// `solution`, the present one, misses there flatters by [`FLATTERY`] at most.
    fn blind_residuals(
        &self,
        previous: &Previous,
        solution: &Solution,
        is_unchanged: bool,
        error: f64,
    ) -> Option<BlindResiduals> {
        let first = previous.points;
        if first == 0 || first >= self.equations.samples() {
            return previous.blind.clone();
        }
        let other = if is_unchanged { None } else { Some(self.solve(&previous.found)?) };
        let left_out = &other.as_ref().unwrap_or(solution).left_out;
        let new = left_out.iter().skip(first).map(|residual| residual * self.scale);
        let before = previous.blind.as_ref().filter(|_| new.len() < ENOUGH_BLIND);
        let Some(before) = before.filter(|before| before.first < first) else {
            return Some(BlindResiduals { first, values: new.collect() });
        };
        let fallen = if previous.found.error.is_finite() { (error - previous.found.error).exp() } else { 1.0 };
        let kept = before.values.iter().zip(before.first..first).map(|(residual, i)| {
            let most = (FLATTERY * solution.left_out[i] * self.scale).abs();
            (fallen * residual).clamp(-most, most)
        });
        Some(BlindResiduals { first: before.first, values: kept.chain(new).collect() })
    }

    /// The weighted minimum-norm coefficients on the likeliest terms, refined: with B = Ψ S^{1/2}, residuals of
    /// (B, diag √ν)(x, t) = y are formed at full precision and solved for again by the explicit inverse.
    fn solve(&self, Found { prior, weight, .. }: &Found) -> Option<Solution> {
        let weight = *weight;
        let samples = self.equations.samples();
        let alone = Equations::values_alone(samples);
        let equations = if weight > 0.0 { &self.equations } else { &alone };
        let targets = self.targets.rows(0, equations.rows());
        let indices = prior.likeliest(CANDIDATES_PER_EQUATION * equations.rows(), self.degree);
        let deviations: Vec<f64> = indices.iter().map(|alpha| prior.variance(alpha).sqrt()).collect();
        let mut weighted = self.tables.stacked(&indices, equations);
        for (mut column, &deviation) in weighted.column_iter_mut().zip(&deviations) {
            column.scale_mut(deviation);
        }
        let kernel = &weighted * weighted.transpose();
        let regularized = Regularized::new(&kernel, equations, weight)?;
        let roots = regularized.nuggets.map(f64::sqrt);
        let (mut x, mut t) = (DVector::zeros(indices.len()), DVector::zeros(equations.rows()));
        for _ in 0..=REFINEMENTS {
            let rest = targets - &weighted * &x - t.component_mul(&roots);
            let correction = &regularized.inverse * rest;
            x += weighted.tr_mul(&correction);
            t += correction.component_mul(&roots);
        }
        let left_out = regularized.left_out(equations, &t.component_div(&roots))?;
        let coefficients = DVector::from_iterator(indices.len(), x.iter().zip(&deviations).map(|(x, s)| x * s));
        let columns = self.tables.columns(&indices);
        let residuals = self.targets.rows(0, samples) - &columns * &coefficients;
        let is_finite = coefficients.iter().chain(left_out.iter()).all(|value| value.is_finite());
        is_finite.then_some(Solution { indices, columns, coefficients, residuals, left_out })
    }
}

/// A solution without negligible terms.
struct Sparse {
    indices: Vec<MultiIndex>,
    coefficients: Vec<f64>,
    /// With what was dropped, as are those left out.
    residuals: Vec<f64>,
    left_out: Vec<f64>,
    /// What was dropped, at the runs.
    dropped: Vec<f64>,
}

impl Solution {
    /// Drops the smallest terms as long as they are together a small share of the leave-one-out error; {0} stays.
    fn without_negligible_terms(self, dropped_share: f64, resolution: f64) -> Sparse {
        let error = typical(&self.left_out, resolution).max(resolution);
        let mut order: Vec<usize> = (0..self.indices.len()).filter(|&k| !self.indices[k].is_constant()).collect();
        order.sort_by(|&a, &b| self.coefficients[a].abs().total_cmp(&self.coefficients[b].abs()).then(a.cmp(&b)));
        let (mut kept, mut dropped) = (vec![true; self.indices.len()], DVector::zeros(self.residuals.len()));
        let mut square = 0.0;
        for k in order {
            square += self.coefficients[k] * self.coefficients[k];
            if square > (dropped_share * error).powi(2) {
                break;
            }
            kept[k] = false;
            dropped.axpy(self.coefficients[k], &self.columns.column(k), 1.0);
        }
        let residuals = (self.residuals + &dropped).iter().copied().collect();
        let left_out = (self.left_out + &dropped).iter().copied().collect();
        let terms = self.indices.into_iter().zip(self.coefficients.iter().copied()).zip(kept);
        let (indices, coefficients) = terms.filter(|(_, kept)| *kept).map(|(term, _)| term).unzip();
        Sparse { indices, coefficients, residuals, left_out, dropped: dropped.iter().copied().collect() }
    }
}

/// The size of residuals where few are much larger than all others, which have nothing to say of the rest: their
/// geometric mean, brought to the standard deviation of a normal distribution, e^((γ + ln 2)/2) times as large; or
/// their root mean square, if that is smaller.
fn typical(residuals: &DVector<f64>, resolution: f64) -> f64 {
    let count = residuals.len() as f64;
    let root_mean_square = (residuals.norm_squared() / count).sqrt();
    // One that happens to be zero says nothing.
    let least = resolution.max(f64::MIN_POSITIVE);
    let logarithm = residuals.iter().map(|rest| rest.abs().max(least).ln()).sum::<f64>() / count;
    let to_deviation = 0.5 * (EULER_GAMMA + std::f64::consts::LN_2);
    root_mean_square.min((logarithm + to_deviation).exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitting::design::{NestedLatinHypercube, Samples};
    use pcc_evaluate::foundation::Silent;
    use pcc_evaluate::polynomials::Family;

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

    #[test]
    fn smooth_functions_are_found_from_fewer_runs_than_terms() {
        let samples = samples(2, &[30]);
        let values: Vec<f64> = samples.points().map(smooth).collect();
        let response = Response::of(&values, 0.0);
        let (fitted, _) = fit(&tables(&samples), response, &settings(), &Previous::nothing(2), &Silent).unwrap();
        assert!(fitted.errors.unwrap().s2.unwrap() > 1.0 - 1e-8 && fitted.stop == StopReason::Accurate);
        assert!(fitted.blind_residuals.is_none(), "a first design has chosen everything itself");
    }

    /// Many points of few inputs make K singular to working precision; the fit must not give up.
    #[test]
    fn designs_much_larger_than_the_basis_are_fitted_as_well() {
        for size in [200, 500, 1000] {
            let samples = samples(1, &[size]);
            let values: Vec<f64> = samples.points().map(|x| (1.3 * x[0]).sin()).collect();
            let response = Response::of(&values, 1e-13);
            let (fitted, _) = fit(&tables(&samples), response, &settings(), &Previous::nothing(1), &Silent).unwrap();
            assert_eq!(fitted.stop, StopReason::Accurate, "{size} points");
        }
    }

    #[test]
    fn new_points_are_judged_by_the_prior_that_has_not_seen_them() {
        let small = samples(2, &[20]);
        let large = samples(2, &[20, 40]);
        let values: Vec<f64> = large.points().map(smooth).collect();
        let response = |values| Response::of(values, 0.0);
        let (_, found_before) =
            fit(&tables(&small), response(&values[..20]), &settings(), &Previous::nothing(2), &Silent).unwrap();
        let (fitted, _) = fit(&tables(&large), response(&values), &settings(), &found_before, &Silent).unwrap();
        let blind = fitted.blind_residuals.unwrap();
        assert_eq!((blind.first, blind.values.len()), (20, 20));
    }

    /// A peak in a corner, which fits of few points miss wherever they do not know it.
    fn peaked(point: &[f64]) -> f64 {
        (6.0 * (point[0] + point[1] - 2.0)).exp()
    }

    #[test]
    fn blind_residuals_fall_with_what_the_present_fit_misses_at_their_points() {
        let sizes = [6, 15, 18, 21, 24];
        let mut previous = Previous::nothing(2);
        for (level, size) in sizes.into_iter().enumerate() {
            let samples = samples(2, &sizes[..=level]);
            let values: Vec<f64> = samples.points().map(peaked).collect();
            let response = Response::of(&values, 0.0);
            let (fitted, next) = fit(&tables(&samples), response, &settings(), &previous, &Silent).unwrap();
            let left_out = fitted.leave_one_out_residuals.unwrap();
            let largest = left_out.iter().fold(0.0, |largest: f64, rest| largest.max(rest.abs()));
            for (i, residual) in fitted.blind_residuals.iter().flat_map(|blind| (blind.first..).zip(&blind.values)) {
                // Terms that were dropped are in one of them alone.
                let most = FLATTERY * left_out[i].abs() + 0.1 * largest;
                assert!(i >= previous.points || residual.abs() <= most, "{size} points, {i}: {residual:e}, {most:e}");
            }
            previous = next;
        }
        assert!(previous.points < 24, "a prior is found again only where a design has grown");
    }

    /// Noise is not called accurate, however few points there are.
    #[test]
    fn noise_is_not_fitted() {
        use pcc_evaluate::probability::random::{Purpose, Stream};
        let mut stream = Stream::new(1, Purpose::Evaluation, 0);
        for size in [2, 3, 5, 10, 40] {
            let samples = samples(2, &[size]);
            let values: Vec<f64> = (0..size).map(|_| stream.next_unit()).collect();
            let response = Response::of(&values, 0.0);
            let (fitted, _) = fit(&tables(&samples), response, &settings(), &Previous::nothing(2), &Silent).unwrap();
            assert_ne!(fitted.stop, StopReason::Accurate, "{size} points: {:?}", fitted.errors);
        }
    }
}
