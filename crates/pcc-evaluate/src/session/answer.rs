//! A question put to a surrogate, and everything that is said in answer.

use super::error::SessionError;
use crate::evaluation::{
    Answer, CriticalValues, EvalError, Question, Sampler, Sensitivities, ShapleyEffects, Survey, Surveyed, Unanswered,
    critical_values_in, sensitivities_in, shapley_effects_in, unanswered_in,
};
use crate::foundation::{InstructionSet, Interrupted, Observer, is_interruption};
use crate::shard_file::Part;
use crate::surrogate::Surrogate;
use std::time::Instant;

/// Samples of the surrogate whose indices are estimated by pick-freeze: they cost r + 2 evaluations each, and their
/// intervals are narrow enough.
const SENSITIVITY_SAMPLES: u64 = 16_384;

/// Samples at which it is looked up whether the model would have answered: each is compared with all runs.
const COVERAGE_SAMPLES: u64 = 100_000;

/// Samples at all points of a sweep together, and at each of them at least: larger maps are not looked at.
const COVERAGE_SAMPLES_OF_SWEEP: u64 = 1_000_000;
const LEAST_COVERAGE_SAMPLES: u64 = 1_000;

/// A surrogate, what was asked of it, and what it answers.
#[derive(Debug, Clone)]
pub struct Evaluation<'s> {
    /// The surrogate.
    pub surrogate: &'s Surrogate,
    /// The question.
    pub question: &'s Question,
    /// What the samples say: one cell, or one for each point of the sweeps.
    pub answer: Answer,
    /// Sensitivities of stability to independent inputs; none of sweeps, and none after an interruption.
    pub sensitivities: Option<Sensitivities>,
    /// Shapley effects on it where inputs depend on each other; none of sweeps, of inputs confined to an interval that
    /// others depend on, and after an interruption.
    pub effects: Option<ShapleyEffects>,
    /// What rests on answers, if the model did not answer everywhere; none of sweeps, and none after an interruption.
    pub unanswered: Option<Unanswered>,
    /// The same at every point of a sweep; empty if the model answered everywhere, of very large sweeps, and after an
    /// interruption.
    pub unanswered_at: Vec<Unanswered>,
    /// The critical values of an input, by its number, if asked for.
    pub critical: Option<(usize, CriticalValues)>,
    /// Whether this is all that was asked for; false after an interruption.
    pub is_complete: bool,
    /// How many parts were put together, if the samples were not evaluated here.
    pub merged_parts: Option<usize>,
    /// Wall-clock time of the samples.
    pub elapsed_seconds: f64,
}

/// A question that fits a surrogate, ready to be answered whole or in shards.
#[derive(Debug)]
pub struct Session<'s> {
    surrogate: &'s Surrogate,
    question: &'s Question,
    survey: Survey<'s>,
    critical: Option<usize>,
}

impl<'s> Session<'s> {
    /// Checks the question against the surrogate. `critical` is the input whose critical values are looked for besides.
    ///
    /// # Errors
    ///
    /// [`SessionError`] names what does not fit.
    pub fn new(
        surrogate: &'s Surrogate,
        question: &'s Question,
        critical: Option<&str>,
        instructions: InstructionSet,
    ) -> Result<Self, SessionError> {
        let survey = Survey::new(surrogate, question, instructions)?;
        let critical = critical.map(|name| critical_input(surrogate, &survey, question, name)).transpose()?;
        Ok(Self { surrogate, question, survey, critical })
    }

    /// Samples the surrogate on the current rayon thread pool, then finds what else was asked for. After an
    /// interruption the answer has what there was by then.
    ///
    /// # Errors
    ///
    /// [`EvalError::NotFinite`] names a point; [`EvalError::Interrupted`] if the user asked to stop before there were
    /// samples.
    pub fn run(&self, observer: &dyn Observer) -> Result<Evaluation<'s>, EvalError> {
        let start = Instant::now();
        let (Surveyed::Complete(findings) | Surveyed::Interrupted(findings)) =
            self.survey.run(0..self.survey.division().chunks(), observer)?;
        let answer = findings.answer(self.survey.division());
        self.complete(answer, start.elapsed().as_secs_f64(), observer)
    }

    /// Samples shard `number` of `of`, for [`crate::shard_file::merge`].
    ///
    /// # Errors
    ///
    /// [`SessionError::NoSuchShard`] if `number` is not below `of`; [`EvalError`] as of the whole. An interrupted shard
    /// is of no use.
    pub fn run_shard(&self, number: u64, of: u64, observer: &dyn Observer) -> Result<Part, SessionError> {
        if number >= of {
            return Err(SessionError::NoSuchShard { number, of });
        }
        let chunks = self.survey.division().shard(number, of);
        let Surveyed::Complete(findings) = self.survey.run(chunks, observer)? else {
            return Err(EvalError::from(Interrupted).into());
        };
        Ok(Part { surrogate: self.surrogate.clone(), question: self.question.clone(), findings })
    }

    /// Adds to the samples' answer what takes all of them.
    fn complete(
        &self,
        answer: Answer,
        elapsed_seconds: f64,
        observer: &dyn Observer,
    ) -> Result<Evaluation<'s>, EvalError> {
        let Self { surrogate, question, ref survey, critical } = *self;
        let mut evaluation = Evaluation {
            surrogate,
            question,
            is_complete: answer.is_complete,
            sensitivities: None,
            effects: None,
            unanswered: None,
            unanswered_at: Vec::new(),
            critical: None,
            merged_parts: None,
            elapsed_seconds,
            answer,
        };
        if !question.sweeps.is_empty() {
            let coverage = surrogate.coverage.as_ref().filter(|_| evaluation.is_complete);
            let regions = survey.regions();
            let each = COVERAGE_SAMPLES_OF_SWEEP / regions.count().max(1);
            if let Some(coverage) = coverage.filter(|_| each >= LEAST_COVERAGE_SAMPLES) {
                let samples = (question.samples.min(each).min(COVERAGE_SAMPLES), question.seed);
                let at = |cell: u64| unanswered_in(surrogate, coverage, &regions.at(cell as usize), samples, observer);
                let found = in_time((0..regions.count()).map(at).collect())?;
                evaluation.is_complete = found.is_some();
                evaluation.unanswered_at = found.unwrap_or_default();
            }
            return Ok(evaluation);
        }
        if evaluation.answer.cells.is_empty() {
            return Err(Interrupted.into());
        }
        let (region, seed) = (&survey.regions().at(0), question.seed);
        if let Some(coverage) = surrogate.coverage.as_ref().filter(|_| evaluation.is_complete) {
            let samples = (question.samples.min(COVERAGE_SAMPLES), seed);
            evaluation.unanswered = in_time(unanswered_in(surrogate, coverage, region, samples, observer))?;
            evaluation.is_complete = evaluation.unanswered.is_some();
        }
        let base = question.samples.min(SENSITIVITY_SAMPLES);
        match surrogate.inputs.dependence() {
            None if evaluation.is_complete => {
                evaluation.sensitivities = in_time(sensitivities_in(surrogate, region, base, seed, observer))?;
                evaluation.is_complete = evaluation.sensitivities.is_some();
            }
            Some(_) if evaluation.is_complete && region.has_effects() => {
                evaluation.effects = in_time(shapley_effects_in(surrogate, region, base, seed, observer))?;
                evaluation.is_complete = evaluation.effects.is_some();
            }
            _ => {}
        }
        if let Some(input) = critical.filter(|_| evaluation.is_complete) {
            let found = in_time(critical_values_in(surrogate, region, input, question.samples, seed, observer))?;
            evaluation.is_complete = found.is_some();
            evaluation.critical = found.map(|found| (input, found));
        }
        Ok(evaluation)
    }
}

/// The number of the input whose critical values are looked for: at random values of the others, in all of its domain.
pub(super) fn critical_input(
    surrogate: &Surrogate,
    survey: &Survey<'_>,
    question: &Question,
    name: &str,
) -> Result<usize, SessionError> {
    let input = name.to_owned();
    let Some(position) = surrogate.inputs.names().position(|known| known == name) else {
        return Err(SessionError::NoSuchInput { input, known: surrogate.inputs.names().map(str::to_owned).collect() });
    };
    if question.conditions.iter().any(|condition| condition.input == name) {
        return Err(SessionError::ConfinedInput { input });
    }
    if question.sampler != Sampler::MonteCarlo {
        return Err(SessionError::CriticalSampler);
    }
    if !question.sweeps.is_empty() {
        return Err(SessionError::CriticalOfSweep);
    }
    let region = survey.regions().at(0);
    if region.score_alone(&surrogate.inputs, position).is_none() {
        let is_free = |other: &&usize| **other != position && !region.is_fixed(**other);
        let others = surrogate.inputs.correlated_with(position).iter().filter(is_free);
        let others = others.map(|&other| surrogate.inputs.inputs()[other].name.clone()).collect();
        return Err(SessionError::CriticalOfDependent { input, others });
    }
    Ok(position)
}

/// `None` for an interruption.
fn in_time<T>(result: Result<T, EvalError>) -> Result<Option<T>, EvalError> {
    match result {
        Ok(found) => Ok(Some(found)),
        Err(error) if is_interruption(&error) => Ok(None),
        Err(error) => Err(error),
    }
}

impl<'s> Evaluation<'s> {
    /// What the merged parts `whole`, put together from `parts` of them, say: what one evaluation of all samples would
    /// have said.
    ///
    /// # Errors
    ///
    /// [`crate::shard_file::PartError::Gap`] if the first or the last shards are missing; else as [`Session::run`].
    pub fn of_parts(whole: &'s Part, parts: usize, observer: &dyn Observer) -> Result<Self, SessionError> {
        let start = Instant::now();
        whole.check_complete()?;
        let session = Session::new(&whole.surrogate, &whole.question, None, InstructionSet::best())?;
        let answer = whole.findings.answer(session.survey.division());
        let elapsed_seconds = start.elapsed().as_secs_f64();
        Ok(Self { merged_parts: Some(parts), ..session.complete(answer, elapsed_seconds, observer)? })
    }
}
