//! The study's fitting method on components of a design.

use super::error_history::ErrorHistory;
use crate::fitting::design::Samples;
use crate::fitting::fit::method::{FitSize, Previous, Solver};
use crate::fitting::fit::{Fitted, minimum_norm};
use crate::fitting::regression::{BasisTables, Response};
use crate::study::Study;
use pcc_evaluate::foundation::{Interrupted, Observer, try_map};
use pcc_evaluate::polynomials::{IndexSetError, Recurrence};
use pcc_evaluate::surrogate::StopReason;
use std::sync::atomic::{AtomicU64, Ordering};

/// Work per entry of a matrix that does not grow with it, in rows.
const WORK_PER_ENTRY: u64 = 400;

fn work_of(response: Response<'_>, inputs: usize) -> u64 {
    let rows = response.equations(inputs).rows().min(minimum_norm::most_equations(inputs)) as u64;
    rows * rows * (rows + WORK_PER_ENTRY)
}

/// Where errors no longer fall, expansions that explain no more of the variance than this give way to the mean.
const MOSTLY_NOISE: f64 = 0.5;

/// A fitted component and the name of the method that fitted it.
#[derive(Debug, Clone)]
pub(super) struct ComponentResult {
    pub result: Fitted,
    pub solver: &'static str,
}

/// The method, ready for components of any design of the study.
pub(super) struct ComponentFit<'a> {
    study: &'a Study,
    recurrences: Vec<Recurrence>,
    solver: Box<dyn Solver + 'a>,
    /// What trials are fitted by.
    trial: Option<Box<dyn Solver + 'a>>,
    /// What all fits have cost.
    work: AtomicU64,
}

/// What the fits of a component on smaller designs have taught.
#[derive(Debug, Clone)]
pub(super) struct Learnt {
    /// What the method starts from.
    method: Previous,
    /// Its errors.
    errors: ErrorHistory,
}

/// Where the fit of a component begins.
#[derive(Debug, Clone)]
pub(super) struct Start {
    /// What smaller designs have taught.
    pub previous: Learnt,
    /// What a trial on the same design has found already, and what it has taught.
    pub trial: Option<(ComponentResult, Learnt)>,
}

impl From<&Learnt> for Start {
    fn from(previous: &Learnt) -> Self {
        Self { previous: previous.clone(), trial: None }
    }
}

/// How thoroughly components are fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Care {
    /// Well enough to compare groupings: by one method, where the study's chooses among several.
    Trial,
    /// By the study's method.
    Full,
}

impl<'a> ComponentFit<'a> {
    pub fn new(study: &'a Study) -> Result<Self, IndexSetError> {
        let inputs = study.inputs.dimension();
        let degree = usize::from(study.fit.method.max_degree());
        let derivatives = if study.uses_derivatives() { inputs } else { 0 };
        let solver = study.fit.method.solver(FitSize { inputs, maximum: study.design.maximum, derivatives })?;
        let recurrences =
            study.inputs.inputs().iter().map(|input| input.marginal.family().recurrence(degree)).collect();
        Ok(Self { study, recurrences, solver, trial: study.fit.method.trial_solver(), work: AtomicU64::new(0) })
    }

    /// What all fits have cost, as operations on matrices of all equations of a component; the same on every machine.
    /// 10⁹ take about a second of one processor.
    pub fn work(&self) -> u64 {
        self.work.load(Ordering::Relaxed)
    }

    /// Whether trials are fitted as everything else.
    pub fn trials_are_full(&self) -> bool {
        self.trial.is_none()
    }

    /// What a component starts from that was fitted on no smaller design.
    pub fn nothing(&self) -> Learnt {
        Learnt { method: Previous::new(self.study.inputs.dimension()), errors: ErrorHistory::default() }
    }

    /// The polynomials at the points of a design, and their slopes if some responses have derivatives.
    pub fn tables(&self, samples: &Samples, with_slopes: bool) -> BasisTables {
        let degree = usize::from(self.study.fit.method.max_degree());
        match with_slopes {
            true => BasisTables::with_slopes(samples, &self.recurrences, degree),
            false => BasisTables::new(samples, &self.recurrences, degree),
        }
    }

    /// Fits `responses`, one per component, to what the model answered at the points of `tables`, from its own of
    /// `starts` each. `None` if the method asks for a larger design, as long as the design
    /// `can_grow`; else each component settles for what the design carries.
    pub fn fit(
        &self,
        tables: &BasisTables,
        responses: &[Response<'_>],
        starts: Vec<Start>,
        (care, can_grow): (Care, bool),
        observer: &dyn Observer,
    ) -> Result<Option<Vec<(ComponentResult, Learnt)>>, Interrupted> {
        let trial = self.trial.as_ref().filter(|_| care == Care::Trial);
        let solver = trial.unwrap_or(&self.solver);
        observer.begin("fitting components", responses.len() as u64);
        let found = try_map(responses.len(), |id| {
            let (response, Start { previous, trial: known }) = (responses[id], &starts[id]);
            let found = match known.clone() {
                Some((fit, learnt)) => {
                    let known = (fit.result, fit.solver, learnt.method);
                    solver.complete(known, tables, response, &previous.method, can_grow, observer)?
                }
                None => solver.fit(tables, response, &previous.method, can_grow, observer)?,
            };
            observer.advance(1);
            let Some((mut result, solver, method)) = found else { return Ok(None) };
            if result.stop != StopReason::Constant && known.is_none() {
                self.work.fetch_add(work_of(response, tables.inputs()), Ordering::Relaxed);
            }
            let errors = previous.errors.with(tables.samples(), result.left_out_error());
            // Trials are to be compared as they are.
            if trial.is_none() {
                result = self.unless_stalled(result, (tables, response), &errors, observer)?;
            }
            Ok(Some((ComponentResult { result, solver }, Learnt { method, errors })))
        });
        observer.finish();
        Ok(found?.into_iter().collect())
    }

    /// The same fit, which asks for no larger design if its error has stopped falling. Where noise is most of what
    /// varies, the mean is known better than the rest.
    fn unless_stalled(
        &self,
        fitted: Fitted,
        (tables, response): (&BasisTables, Response<'_>),
        errors: &ErrorHistory,
        observer: &dyn Observer,
    ) -> Result<Fitted, Interrupted> {
        let asks_for_more = fitted.stop == StopReason::DesignExhausted;
        let may_be_noisy = self.study.fit.proportion_tolerance.is_some() && response.gradients.is_none();
        if !asks_for_more || !errors.has_stopped_falling(may_be_noisy) {
            return Ok(fitted);
        }
        let is_mostly_noise = fitted.errors.and_then(|errors| errors.s2).is_some_and(|s2| s2 < MOSTLY_NOISE);
        let best = if is_mostly_noise { Fitted::mean_of(tables, response, observer)? } else { fitted };
        Ok(Fitted { stop: StopReason::Stalled, ..best })
    }

    /// The value of a fit in the middle of the inputs, where all have their medians.
    pub fn value_at_center(&self, fitted: &Fitted) -> f64 {
        let univariate: Vec<Vec<f64>> = self
            .recurrences
            .iter()
            .zip(self.study.inputs.middle())
            .map(|(recurrence, middle)| {
                let mut values = vec![0.0; usize::from(self.study.fit.method.max_degree()) + 1];
                recurrence.evaluate(middle, &mut values);
                values
            })
            .collect();
        let term = |alpha: &pcc_evaluate::polynomials::MultiIndex| -> f64 {
            univariate.iter().enumerate().map(|(j, values)| values[usize::from(alpha[j])]).product()
        };
        fitted.indices.iter().zip(&fitted.coefficients).map(|(alpha, c)| c * term(alpha)).sum()
    }
}
