//! Stepwise construction of a sparse polynomial chaos basis.
//!
//! Kieu, Bergeot and Berger (2017), section 3.3.3, after Blatman and Sudret (2010),
//! <https://doi.org/10.1016/j.probengmech.2009.10.003>.
//!
//! Degree by degree, every candidate multi-index with p − 1 < ‖α‖_q ≤ p is tried alone on the set accepted at degree p
//! − 1 and kept if it raises R² by at least ε₁ (forward step). Then every term with ‖α‖_q ≤ p − 1 but {0} is tried
//! alone for removal and dropped if that lowers R² by less than ε₂ (backward step). If then N < 2 card(A), the design
//! must grow and the search starts again from {0} (step 4). The search ends when the leave-one-out S² reaches its
//! target or at the highest degree (step 5).
//!
//! One case the paper leaves open: if the forward step accepts as many terms as there are points, least squares has no
//! unique solution and no backward step can be taken; this counts as a failed size test.
//!
//! With derivatives each run gives several equations, and counting says little: values and derivatives at few points
//! can be dependent (Alexander and Hirschowitz 1995). N < 2 card(A) says that the mean leverage of a value is above ½;
//! this is what is tested then, with runs left out as a whole ([`ActiveBasis::mean_leverage`]), and terms that depend
//! on others fail the test, too. R² of the two steps is that of all equations, S² that of the values. The search is
//! made for several weights of the derivatives; the one with the best S² counts.

#[cfg(test)]
mod tests;

use crate::fitting::fit::method::{
    DEFAULT_DEGREE, DEFAULT_S2, Design, Domain, Entry, FitMethod, FitSize, Key, MAX_DEGREE, MethodFit, Previous,
    Profile, S2_TARGET, Solver, number_setting, s2_setting,
};
use crate::fitting::fit::{Fitted, WEIGHTS};
use crate::fitting::regression::{ActiveBasis, BasisTables, Response};
use pcc_evaluate::foundation::{Interrupted, Observer};
use pcc_evaluate::polynomials::{Hyperbolic, IndexSetError, MultiIndex};
use pcc_evaluate::surrogate::StopReason;
use std::collections::HashSet;

/// Mean leverage of a value beyond which there are too few points: P/N for N < 2 card(A) (step 4 of the paper).
const LARGEST_LEVERAGE: f64 = 0.5;

const Q_NORM: Key = Key::share("q_norm");
const EPSILON_FORWARD: Key = Key { name: "epsilon_forward", domain: EPSILON };
const EPSILON_BACKWARD: Key = Key { name: "epsilon_backward", domain: EPSILON };
const EPSILON: Domain =
    Domain::Number { expected: "a number from 0 to below 1", holds: |value| (0.0..1.0).contains(&value) };

/// Chosen so that table 2 of the paper is reproduced for all numbers of inputs.
const DEFAULT_Q: f64 = 0.6;
const DEFAULT_EPSILON: f64 = 1e-5;

/// The method in the list.
pub(super) const METHOD: Entry = Entry {
    name: "stepwise",
    keys: &[&MAX_DEGREE, &Q_NORM, &S2_TARGET, &EPSILON_FORWARD, &EPSILON_BACKWARD],
    grows: true,
    read: |given, _| {
        Ok(FitMethod::Stepwise(Stepwise {
            max_degree: given.degree(DEFAULT_DEGREE),
            q_norm: given.number(&Q_NORM).unwrap_or(DEFAULT_Q),
            s2_target: given.number(&S2_TARGET).unwrap_or(DEFAULT_S2),
            epsilon_forward: given.number(&EPSILON_FORWARD).unwrap_or(DEFAULT_EPSILON),
            epsilon_backward: given.number(&EPSILON_BACKWARD).unwrap_or(DEFAULT_EPSILON),
        }))
    },
};

/// Settings of the stepwise construction of a sparse basis (section 3.3.3 of the paper).
#[derive(Debug, Clone, PartialEq)]
pub struct Stepwise {
    /// p_max, at least 1.
    pub max_degree: u16,
    /// q of the index sets, in (0, 1].
    pub q_norm: f64,
    /// S² at which a component is accurate enough, in (0, 1\].
    pub s2_target: f64,
    /// ε₁: the rise of R² from which a candidate is kept, not negative.
    pub epsilon_forward: f64,
    /// ε₂: the fall of R² below which a term is dropped, not negative.
    pub epsilon_backward: f64,
}

impl Stepwise {
    pub(super) fn profile(&self) -> Profile {
        let backward = "ε₂: a term is dropped if that lowers R² by less";
        Profile {
            name: METHOD.name,
            explanation: "the paper's algorithm",
            degree: "p_max",
            max_degree: self.max_degree,
            settings: vec![
                number_setting(&Q_NORM, self.q_norm, "q of the hyperbolic index sets, above 0 and at most 1"),
                s2_setting(self.s2_target),
                number_setting(&EPSILON_FORWARD, self.epsilon_forward, "ε₁: a term is kept if it raises R² by this"),
                number_setting(&EPSILON_BACKWARD, self.epsilon_backward, backward),
            ],
            design: Design::Growing,
            is_least_squares: true,
            chooses: false,
        }
    }
}

/// The method with the candidates of every degree.
struct Ready<'s> {
    settings: &'s Stepwise,
    shells: Vec<Vec<MultiIndex>>,
}

pub(super) fn ready(settings: &Stepwise, size: FitSize) -> Result<impl Solver, IndexSetError> {
    let hyperbolic = Hyperbolic { inputs: size.inputs, q_norm: settings.q_norm };
    Ok(Ready { settings, shells: hyperbolic.shells(settings.max_degree)? })
}

impl Solver for Ready<'_> {
    fn fit(
        &self,
        tables: &BasisTables,
        response: Response<'_>,
        previous: &Previous,
        can_grow: bool,
        observer: &dyn Observer,
    ) -> Result<Option<MethodFit>, Interrupted> {
        let fitted = match fit(tables, response, &self.shells, self.settings, observer)? {
            Outcome::Fitted(fitted) => fitted,
            Outcome::TooFewSamples { .. } if can_grow => return Ok(None),
            Outcome::TooFewSamples { indices, degree } => settle(tables, response, &indices, degree, observer)?,
        };
        Ok(Some((fitted, METHOD.name, previous.clone())))
    }
}

/// What came of a fit on one design.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// The search ended.
    Fitted(Fitted),
    /// The design is too small for the terms that matter.
    TooFewSamples {
        /// The terms of the last degree that passed the size test: what [`settle`] fits if the design cannot grow.
        indices: Vec<MultiIndex>,
        /// That degree.
        degree: u16,
    },
}

/// Fits one component.
///
/// `response.values[i]` is the component at point i of `tables`, in its own unit. `shells[p]` holds the candidates with
/// p − 1 < ‖α‖_q ≤ p, as [`pcc_evaluate::polynomials::Hyperbolic::shells`] gives them for `settings.q_norm` and
/// `settings.max_degree`.
///
/// # Errors
///
/// [`Interrupted`] soon after the observer asks to stop.
///
/// # Examples
///
/// ```
/// use pcc_compile::fitting::design::NestedLatinHypercube;
/// use pcc_compile::fitting::fit::stepwise::{fit, Outcome};
/// use pcc_evaluate::polynomials::{Hyperbolic, Family};
/// use pcc_evaluate::foundation::Silent;
/// use pcc_compile::fitting::regression::{BasisTables, Response};
/// use pcc_compile::fitting::fit::stepwise::Stepwise;
///
/// let settings = Stepwise {
///     max_degree: 8, q_norm: 1.0, s2_target: 0.9999, epsilon_forward: 1e-6, epsilon_backward: 1e-6,
/// };
/// let mut design = NestedLatinHypercube::new(2, 1);
/// design.grow_to(60);
/// let samples = design.samples(|_, u| 2.0 * u - 1.0);
/// let values: Vec<f64> = samples.points().map(|x| 1.0 + x[0] * x[1]).collect();
/// let tables = BasisTables::new(&samples, &vec![Family::Legendre.recurrence(8); 2], 8);
/// let shells = Hyperbolic { inputs: 2, q_norm: 1.0 }.shells(8)?;
/// let response = Response::of(&values, 1e-13);
/// let outcome = fit(&tables, response, &shells, &settings, &Silent)?;
/// assert!(matches!(outcome, Outcome::Fitted(fitted) if fitted.errors.unwrap().r2 > 0.9999));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit(
    tables: &BasisTables,
    response: Response<'_>,
    shells: &[Vec<MultiIndex>],
    settings: &Stepwise,
    observer: &dyn Observer,
) -> Result<Outcome, Interrupted> {
    let Some(variance) = response.variance() else {
        return Ok(Outcome::Fitted(Fitted::constant(tables.inputs(), response.values)));
    };
    if response.gradients.is_none() {
        return search(tables, response, variance, 0.0, shells, settings, observer);
    }
    let (mut best, mut wants_points): (Option<(f64, Outcome)>, bool) = (None, false);
    for weight in WEIGHTS {
        let outcome = search(tables, response.with_weight(weight), variance, weight, shells, settings, observer)?;
        let s2 = match &outcome {
            // A design that is too small for full weight is not made large enough by a poor fit with less.
            Outcome::Fitted(fitted) if best.is_some() && wants_points && fitted.stop != StopReason::Accurate => {
                continue;
            }
            Outcome::Fitted(fitted) => fitted.errors.and_then(|errors| errors.s2).unwrap_or(f64::NEG_INFINITY),
            Outcome::TooFewSamples { .. } => f64::NEG_INFINITY,
        };
        wants_points |= best.is_none() && matches!(outcome, Outcome::TooFewSamples { .. });
        if best.as_ref().is_none_or(|(known, _)| s2 > *known) {
            best = Some((s2, weighed(outcome, weight)));
        }
    }
    Ok(best.map(|(_, outcome)| outcome).expect("there are weights"))
}

fn weighed(outcome: Outcome, weight: f64) -> Outcome {
    match outcome {
        Outcome::Fitted(fitted) => Outcome::Fitted(Fitted { derivative_weight: Some(weight), ..fitted }),
        too_few => too_few,
    }
}

/// The search with one weight of the derivatives.
fn search(
    tables: &BasisTables,
    response: Response<'_>,
    variance: f64,
    weight: f64,
    shells: &[Vec<MultiIndex>],
    settings: &Stepwise,
    observer: &dyn Observer,
) -> Result<Outcome, Interrupted> {
    let mut basis = ActiveBasis::constant(tables, response, variance, weight, observer)?; // step 2: A = {0}
    for degree in 1..=settings.max_degree {
        let before = basis.indices().to_vec();
        let candidates = &shells[usize::from(degree)];
        let is_determined = forward_step(&mut basis, candidates, settings.epsilon_forward)?;
        if is_determined {
            backward_step(&mut basis, candidates, settings.epsilon_backward)?;
        }
        if !is_determined || basis.mean_leverage() > LARGEST_LEVERAGE {
            return Ok(Outcome::TooFewSamples { indices: before, degree: degree - 1 }); // step 4
        }
        if basis.s2().is_some_and(|s2| s2 >= settings.s2_target) {
            return Ok(Outcome::Fitted(Fitted::new(&basis, degree, StopReason::Accurate)?)); // step 5
        }
    }
    Ok(Outcome::Fitted(Fitted::new(&basis, settings.max_degree, StopReason::HighestDegree)?))
}

/// The fit on given terms, {0} first, for a design that cannot grow to what [`fit`] asked for; derivatives have full
/// weight, with which the search that gave the terms began.
///
/// # Errors
///
/// [`Interrupted`] soon after the observer asks to stop.
pub fn settle(
    tables: &BasisTables,
    response: Response<'_>,
    indices: &[MultiIndex],
    degree: u16,
    observer: &dyn Observer,
) -> Result<Fitted, Interrupted> {
    let Some(variance) = response.variance() else {
        return Ok(Fitted::constant(tables.inputs(), response.values));
    };
    let mut basis = ActiveBasis::constant(tables, response, variance, 1.0, observer)?;
    basis.extend(indices[1..].to_vec())?;
    let fitted = Fitted::new(&basis, degree, StopReason::DesignExhausted)?;
    Ok(Fitted { derivative_weight: response.gradients.map(|_| 1.0), ..fitted })
}

/// Adds the candidates that, each alone, raise R² by at least `epsilon`. If that would be as many terms as equations,
/// adds nothing and returns false; so it does if terms depend on each other beside derivatives.
fn forward_step(basis: &mut ActiveBasis<'_>, candidates: &[MultiIndex], epsilon: f64) -> Result<bool, Interrupted> {
    let gains = basis.gains(candidates)?;
    let significant = candidates.iter().zip(gains).filter(|&(_, gain)| gain > 0.0 && gain >= epsilon);
    let significant: Vec<MultiIndex> = significant.map(|(alpha, _)| alpha.clone()).collect();
    let expected = basis.indices().len() + significant.len();
    if expected >= basis.rows() {
        return Ok(false);
    }
    basis.extend(significant)?;
    Ok(basis.indices().len() == expected || basis.rows() == basis.samples())
}

/// Drops the terms of lower degree, never {0}, that each alone lower R² by less than `epsilon`.
fn backward_step(basis: &mut ActiveBasis<'_>, of_this_degree: &[MultiIndex], epsilon: f64) -> Result<(), Interrupted> {
    let losses = basis.losses()?;
    let protected: HashSet<&MultiIndex> = of_this_degree.iter().collect();
    basis.retain(|k, alpha| alpha.is_constant() || protected.contains(alpha) || losses[k] >= epsilon)
}
