//! Orthogonal matching pursuit: terms join one at a time, cross-validation says how many.
//!
//! Pati, Rezaiifar and Krishnaprasad (1993), <https://doi.org/10.1109/ACSSC.1993.342465>, in the form that judges a
//! candidate by the part of it that is orthogonal to the terms before it (orthogonal least squares; Chen, Billings and
//! Luo 1989, <https://doi.org/10.1080/00207178908953472>).
//!
//! On a set of candidates, each step adds the one that lowers the residual most. How many steps N runs can carry is
//! found by ten-fold cross-validation of the *whole path*, selection included. The leave-one-out error of the selected
//! terms, even corrected for small designs, does not see that they were selected: it falls to rounding as the path
//! nears N terms while the true error rises again.
//!
//! With derivatives a fold leaves out whole runs, and the error is that of values. Their weight is chosen by it, too.
//! As each run gives several equations, few runs can determine an expansion exactly and yet be too few to leave one
//! out; so a whole set of candidates that meets all equations with fewer terms than there are equations is taken at
//! once.
//!
//! Candidate sets {‖α‖_q ≤ p} grow degree by degree for each norm q until degrees bring nothing more or candidates
//! outnumber what N runs can tell apart. The path with the smallest cross-validated error is the fit.

use super::cross_validation::{CrossValidation, Problem};
use super::method::{Entry, FitMethod, FitSize, MAX_DEGREE, MethodFit, Previous, Profile, S2_TARGET, Smooth, Solver};
use super::minimum_norm::fewer_derivatives;
use super::pursuit_path::Path;
use super::{BlindResiduals, Fitted, WEIGHTS};
use crate::fitting::regression::{ActiveBasis, BasisTables, ErrorMeasures, Response};
use pcc_evaluate::foundation::{Interrupted, Observer};
use pcc_evaluate::polynomials::{Hyperbolic, IndexSetError, MultiIndex};
use pcc_evaluate::surrogate::StopReason;

/// Norms q tried, from those that favour single inputs to all interactions.
const Q_NORMS: [f64; 3] = [0.5, 0.75, 1.0];

/// Degrees in a row without improvement after which a norm is given up.
const PATIENCE: usize = 1;

/// Candidates per run beyond which a set is not tried: among too many, some fit by chance.
const CANDIDATES_PER_RUN: usize = 5;

/// Derivatives that allow one more: beside values they bring little that helps to choose.
const DERIVATIVES_PER_CANDIDATE: usize = 4;

/// So many candidates are always tried: they cost nothing.
const FEW_CANDIDATES: usize = 100;

/// Mean square error relative to the variance at which nothing but rounding is left to explain.
const EXACT: f64 = 1e-26;

/// The method in the list.
pub(super) const METHOD: Entry = Entry {
    name: "omp",
    keys: &[&MAX_DEGREE, &S2_TARGET],
    grows: true,
    read: |given, _| Ok(FitMethod::Omp(Smooth::read(given))),
};

pub(super) fn profile(settings: &Smooth) -> Profile {
    settings.profile(METHOD.name, "orthogonal matching pursuit", "of the candidates")
}

/// The method with its candidates.
struct Ready<'s> {
    settings: &'s Smooth,
    candidates: Candidates,
}

pub(super) fn ready(settings: &Smooth, size: FitSize) -> Result<impl Solver, IndexSetError> {
    let FitSize { inputs, maximum, derivatives } = size;
    Ok(Ready { settings, candidates: Candidates::new(inputs, settings.max_degree, maximum, derivatives)? })
}

impl Solver for Ready<'_> {
    fn fit(
        &self,
        tables: &BasisTables,
        response: Response<'_>,
        previous: &Previous,
        _: bool,
        observer: &dyn Observer,
    ) -> Result<Option<MethodFit>, Interrupted> {
        Ok(Some((fit(tables, response, &self.candidates, self.settings, observer)?, METHOD.name, previous.clone())))
    }
}

/// The candidates of every norm, degree by degree.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidates {
    /// Per norm, the sets {α : p − 1 < ‖α‖_q ≤ p} for p = 0, 1, ….
    norms: Vec<Vec<Vec<MultiIndex>>>,
}

impl Candidates {
    /// The candidates for `inputs` variables that up to `largest_design` runs, each with so many `derivatives`, could
    /// use, of degree up to `max_degree`.
    ///
    /// # Errors
    ///
    /// [`IndexSetError`] if even degree 1 is too much.
    pub fn new(
        inputs: usize,
        max_degree: u16,
        largest_design: usize,
        derivatives: usize,
    ) -> Result<Self, IndexSetError> {
        let most = most_candidates(largest_design, largest_design.saturating_mul(derivatives));
        let shells = |&q_norm: &f64| {
            let hyperbolic = Hyperbolic { inputs, q_norm };
            let mut shells = hyperbolic.shells(1)?;
            for degree in 2..=max_degree {
                match hyperbolic.shells(degree) {
                    Ok(larger) if larger.iter().map(Vec::len).sum::<usize>() <= most => shells = larger,
                    _ => break,
                }
            }
            Ok(shells)
        };
        Ok(Self { norms: Q_NORMS.iter().map(shells).collect::<Result<_, _>>()? })
    }
}

fn most_candidates(runs: usize, derivatives: usize) -> usize {
    let carried = CANDIDATES_PER_RUN.saturating_mul(runs);
    FEW_CANDIDATES.max(carried.saturating_add(derivatives / DERIVATIVES_PER_CANDIDATE))
}

/// Fits one component: `response.values[i]` belongs to point i of `tables`.
///
/// The leave-one-out residuals of the result are those of the folds: each point is predicted by a path that never saw
/// it.
///
/// # Errors
///
/// [`Interrupted`] soon after the observer asks to stop.
///
/// # Examples
///
/// ```
/// use pcc_compile::fitting::design::NestedLatinHypercube;
/// use pcc_compile::fitting::fit::omp::{fit, Candidates};
/// use pcc_evaluate::polynomials::Family;
/// use pcc_evaluate::foundation::Silent;
/// use pcc_compile::fitting::regression::{BasisTables, Response};
/// use pcc_compile::fitting::fit::Smooth;
///
/// let mut design = NestedLatinHypercube::new(3, 1);
/// design.grow_to(40);
/// let samples = design.samples(|_, u| 2.0 * u - 1.0);
/// let values: Vec<f64> = samples.points().map(|x| 1.0 + x[0] - 2.0 * x[1] * x[2]).collect();
/// let tables = BasisTables::new(&samples, &vec![Family::Legendre.recurrence(8); 3], 8);
/// let response = Response::of(&values, 1e-13);
/// let settings = Smooth { max_degree: 8, s2_target: 0.999 };
/// let fitted = fit(&tables, response, &Candidates::new(3, 8, 40, 0)?, &settings, &Silent)?;
/// assert_eq!(fitted.indices.len(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit(
    tables: &BasisTables,
    response: Response<'_>,
    candidates: &Candidates,
    settings: &Smooth,
    observer: &dyn Observer,
) -> Result<Fitted, Interrupted> {
    let fewer = fewer_derivatives(response, tables.inputs());
    let response = Response { gradients: fewer.as_ref().or(response.gradients), ..response };
    let Some(variance) = response.variance() else {
        return Ok(Fitted::constant(tables.inputs(), response.values));
    };
    let search = PathSearch { tables, response, candidates, variance, observer };
    let full_weight = if response.gradients.is_some() { WEIGHTS[0] } else { 0.0 };
    let Some(mut best) = (match search.best(full_weight)? {
        Best::Exact(set) => {
            // Nothing was chosen, so the closed-form errors are honest.
            let terms: Vec<usize> = (0..set.len()).collect();
            let fitted = chosen(tables, response, variance, &set, &terms, full_weight, observer)?;
            let s2 = fitted.errors.and_then(|errors| errors.s2);
            let is_accurate = s2.is_some_and(|s2| s2 >= settings.s2_target);
            return Ok(if is_accurate { Fitted { stop: StopReason::Accurate, ..fitted } } else { fitted });
        }
        Best::Validated(best) => best,
    }) else {
        return Fitted::mean(tables, response, variance, observer);
    };
    if response.gradients.is_some() && search.distrusts(&best)? {
        for &weight in &WEIGHTS[1..] {
            if let Best::Validated(Some(other)) = search.best(weight)?
                && other.validation.error < best.validation.error
            {
                best = other;
            }
        }
    }
    let Choice { validation, set, weight } = best;
    let problem = Problem::new(tables, response, &set, weight);
    let mut path = Path::new(&problem.columns, &problem.targets);
    while path.terms.len() < validation.terms && path.step().is_some() {}
    let mut fitted = chosen(tables, response, variance, &set, &path.terms, weight, observer)?;
    let s2 = 1.0 - validation.error / variance;
    fitted.errors = fitted.errors.map(|errors| ErrorMeasures { s2: Some(s2), corrected_s2: None, ..errors });
    fitted.stop = if s2 >= settings.s2_target { StopReason::Accurate } else { StopReason::DesignExhausted };
    fitted.blind_residuals = Some(BlindResiduals { first: 0, values: validation.residuals.clone() });
    fitted.leave_one_out_residuals = Some(validation.residuals);
    Ok(fitted)
}

/// A set of candidates and a weight of derivatives, with what cross-validation says of them.
struct Choice {
    validation: CrossValidation,
    set: Vec<MultiIndex>,
    weight: f64,
}

/// What a search over sets of candidates found.
enum Best {
    /// A set whose terms all together meet every equation.
    Exact(Vec<MultiIndex>),
    /// The set with the smallest cross-validated error, if any could be judged.
    Validated(Option<Choice>),
}

/// The search over sets of candidates.
struct PathSearch<'a> {
    tables: &'a BasisTables,
    response: Response<'a>,
    candidates: &'a Candidates,
    variance: f64,
    observer: &'a dyn Observer,
}

impl PathSearch<'_> {
    /// The best set with this weight of derivatives.
    fn best(&self, weight: f64) -> Result<Best, Interrupted> {
        let Self { tables, response, variance, observer, .. } = *self;
        let exact = (EXACT * variance).max(response.resolution * response.resolution);
        let mut best: Option<Choice> = None;
        for shells in &self.candidates.norms {
            let (mut set, mut best_of_norm, mut stalled) = (shells[0].clone(), f64::INFINITY, 0);
            for shell in &shells[1..] {
                set.extend_from_slice(shell);
                let problem = Problem::new(tables, response, &set, weight);
                let derivatives = problem.equations.rows() - problem.equations.samples();
                if set.len() > most_candidates(response.values.len(), derivatives) || stalled > PATIENCE {
                    break;
                }
                if problem.is_met_by_all_terms(exact) {
                    return Ok(Best::Exact(set));
                }
                let validation = CrossValidation::new(&problem, observer)?;
                stalled = if validation.error < best_of_norm { 0 } else { stalled + 1 };
                best_of_norm = best_of_norm.min(validation.error);
                if best.as_ref().is_none_or(|known| validation.error < known.validation.error) {
                    best = Some(Choice { validation, set: set.clone(), weight });
                }
                if best_of_norm <= exact {
                    break;
                }
            }
        }
        Ok(Best::Validated(best.filter(|best| best.validation.error.is_finite())))
    }

    /// Whether less weight of the derivatives predicts better on the set that is best with full weight.
    fn distrusts(&self, best: &Choice) -> Result<bool, Interrupted> {
        for &weight in &WEIGHTS[1..] {
            let problem = Problem::new(self.tables, self.response, &best.set, weight);
            if CrossValidation::new(&problem, self.observer)?.error < best.validation.error {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

/// The least-squares fit by the `terms` of a set.
fn chosen(
    tables: &BasisTables,
    response: Response<'_>,
    variance: f64,
    set: &[MultiIndex],
    terms: &[usize],
    weight: f64,
    observer: &dyn Observer,
) -> Result<Fitted, Interrupted> {
    let terms = terms.iter().map(|&k| set[k].clone()).filter(|alpha| !alpha.is_constant()).collect();
    let mut basis = ActiveBasis::constant(tables, response.with_weight(weight), variance, weight, observer)?;
    basis.extend(terms)?;
    let degree = basis.indices().iter().map(MultiIndex::total_degree).max().unwrap_or(0) as u16;
    let fitted = Fitted::new(&basis, degree, StopReason::DesignExhausted)?;
    Ok(Fitted { derivative_weight: response.gradients.map(|_| weight), ..fitted })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitting::design::NestedLatinHypercube;
    use pcc_evaluate::foundation::Silent;
    use pcc_evaluate::polynomials::Family;

    const DEGREE: u16 = 8;

    fn fitted(inputs: usize, size: usize, value: impl Fn(&[f64]) -> f64) -> Fitted {
        let mut design = NestedLatinHypercube::new(inputs, 5);
        design.grow_to(size);
        let samples = design.samples(|_, u| 2.0 * u - 1.0);
        let values: Vec<f64> = samples.points().map(value).collect();
        let recurrences = vec![Family::Legendre.recurrence(DEGREE.into()); inputs];
        let tables = BasisTables::new(&samples, &recurrences, DEGREE.into());
        let candidates = Candidates::new(inputs, DEGREE, size, 0).unwrap();
        let settings = Smooth { max_degree: DEGREE, s2_target: 0.999 };
        fit(&tables, Response::of(&values, 1e-13), &candidates, &settings, &Silent).unwrap()
    }

    #[test]
    fn few_terms_among_many_inputs_are_found_exactly() {
        let found = fitted(6, 60, |x| 2.0 + x[0] - 3.0 * x[2] * x[4] + 0.5 * x[5]);
        assert_eq!((found.indices.len(), found.stop), (4, StopReason::Accurate));
    }

    /// The error of the selected terms would fall to rounding; that of the folds does not.
    #[test]
    fn cross_validation_sees_the_selection_of_terms() {
        let found = fitted(4, 40, |x| (3.0 * x[0] + 2.0 * x[1] - x[2] * x[3]).sin());
        let errors = found.errors.unwrap();
        assert!(errors.r2 > errors.s2.unwrap() + 0.01, "{errors:?}");
        assert!(found.indices.len() < 30);
    }

    #[test]
    fn designs_too_small_to_validate_give_the_mean() {
        for size in [2, 3] {
            let found = fitted(2, size, |x| x[0] + x[1] * x[1]);
            let errors = found.errors.unwrap();
            assert!(found.stop == StopReason::DesignExhausted && errors.s2.unwrap() < 0.5, "{errors:?}");
        }
    }
}
