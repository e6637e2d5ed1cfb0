//! The better of two fits, component by component.
//!
//! The weighted minimum-norm fit suits functions that depend smoothly on most inputs, matching pursuit those that have
//! few terms. Both are judged by cross-validation: the former by its closed-form leave-one-out error, the latter by
//! folds, because its leave-one-out error does not see the selection of terms.

use super::method::{Entry, FitMethod, FitSize, MAX_DEGREE, MethodFit, Profile, S2_TARGET, Smooth, Solver};
use super::omp::Candidates;
use super::{Fitted, minimum_norm, omp};
use crate::fitting::regression::{BasisTables, Response};
use pcc_evaluate::foundation::{Interrupted, Observer};
use pcc_evaluate::polynomials::IndexSetError;

/// Pursuit is given up for larger designs once its mean square error is so many times that of the other fit.
const HOPELESS: f64 = 4.0;

/// Fewer values and derivatives say little of either.
const ENOUGH_EQUATIONS: usize = 20;

/// What the fit of a component on one design passes on to the next larger one.
#[derive(Debug, Clone, PartialEq)]
pub struct Previous {
    /// What the minimum-norm fit found.
    pub minimum_norm: minimum_norm::Previous,
    /// Whether pursuit is still worth trying.
    pub tries_pursuit: bool,
}

impl Previous {
    /// Before the first design.
    pub fn new(inputs: usize) -> Self {
        Self { minimum_norm: minimum_norm::Previous::nothing(inputs), tries_pursuit: true }
    }
}

/// The method in the list.
pub(super) const METHOD: Entry = Entry {
    name: "auto",
    keys: &[&MAX_DEGREE, &S2_TARGET],
    grows: true,
    read: |given, _| Ok(FitMethod::Auto(Smooth::read(given))),
};

pub(super) fn profile(settings: &Smooth) -> Profile {
    Profile { chooses: true, ..settings.profile(METHOD.name, "the better of minimum-norm and omp", "in each input") }
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
        fit(tables, response, &self.candidates, self.settings, previous, observer).map(Some)
    }

    /// The trial is the minimum-norm fit.
    fn complete(
        &self,
        (smooth, _, trial): MethodFit,
        tables: &BasisTables,
        response: Response<'_>,
        previous: &Previous,
        _: bool,
        observer: &dyn Observer,
    ) -> Result<Option<MethodFit>, Interrupted> {
        let smooth = (smooth, trial.minimum_norm);
        better(tables, response, (&self.candidates, self.settings), previous, smooth, observer).map(Some)
    }
}

/// Fits one component: `response.values[i]` belongs to point i of `tables`. Returns the fit, the name of its method,
/// and what the next design starts from.
///
/// # Errors
///
/// [`Interrupted`] soon after the observer asks to stop.
pub fn fit(
    tables: &BasisTables,
    response: Response<'_>,
    candidates: &Candidates,
    settings: &Smooth,
    previous: &Previous,
    observer: &dyn Observer,
) -> Result<MethodFit, Interrupted> {
    let smooth = minimum_norm::fit(tables, response, settings, &previous.minimum_norm, observer)?;
    better(tables, response, (candidates, settings), previous, smooth, observer)
}

/// The minimum-norm fit or pursuit.
fn better(
    tables: &BasisTables,
    response: Response<'_>,
    (candidates, settings): (&Candidates, &Smooth),
    previous: &Previous,
    (smooth, minimum_norm): (Fitted, minimum_norm::Previous),
    observer: &dyn Observer,
) -> Result<MethodFit, Interrupted> {
    let mut previous = Previous { minimum_norm, ..*previous };
    if !previous.tries_pursuit || smooth.errors.is_none() {
        return Ok((smooth, minimum_norm::METHOD.name, previous));
    }
    let pursued = omp::fit(tables, response, candidates, settings, observer)?;
    let error = |fitted: &Fitted| 1.0 - fitted.errors.and_then(|errors| errors.s2).unwrap_or(f64::NEG_INFINITY);
    let is_enough = response.equations(tables.inputs()).rows() >= ENOUGH_EQUATIONS;
    let is_hopeless = error(&pursued) >= HOPELESS * error(&smooth) && is_enough;
    previous.tries_pursuit = !is_hopeless;
    if error(&pursued) < error(&smooth) {
        Ok((pursued, omp::METHOD.name, previous))
    } else {
        Ok((smooth, minimum_norm::METHOD.name, previous))
    }
}
