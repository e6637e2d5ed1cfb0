//! Streaming Monte Carlo on a surrogate.
//!
//! Samples are numbered; sample i is the same whoever computes it. Fixed chunks of samples are summarised on all cores
//! and combined in a fixed order, so counts and moments do not depend on the number of threads, and memory not on the number of
//! samples.

use super::question::Question;
use super::survey::{Progress, Survey};
use crate::numerics::InstructionSet;
use crate::progress::{Interrupted, Observer};
use crate::spectrum::Summary;
use crate::surrogate::Surrogate;
use thiserror::Error;

/// Why an evaluation gave no result.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum EvalError {
    /// Nothing to evaluate.
    #[error("no samples were asked for; use at least 1")]
    NoSamples,
    /// A component is too large for double precision, or NaN.
    #[error("the surrogate's value at {point} is not a finite number; the file is of no use there")]
    NotFinite {
        /// Where: the inputs with their values.
        point: String,
    },
    /// An input was asked for that does not exist.
    #[error("input number {input} was asked for, but there are only {inputs}; they are numbered from 0")]
    NoSuchInput {
        /// Number asked for, from 0.
        input: usize,
        /// Number of inputs.
        inputs: usize,
    },
    /// The user asked to stop.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl EvalError {
    /// Whether the user asked to stop.
    pub fn is_interruption(&self) -> bool {
        matches!(self, Self::Interrupted(_))
    }
}

/// Statistics of samples 0 … `samples` − 1 under `seed`, on the current rayon thread pool: the plainest [`Question`].
///
/// # Errors
///
/// [`EvalError`].
pub fn monte_carlo(
    surrogate: &Surrogate,
    samples: u64,
    seed: u64,
    observer: &dyn Observer,
) -> Result<Summary, EvalError> {
    let question = Question::plain(samples, seed);
    // The plain question fits every surrogate, if only it asks for samples.
    let survey = Survey::new(surrogate, &question, InstructionSet::best()).map_err(|_| EvalError::NoSamples)?;
    match survey.run(0..survey.layout().chunks(), observer)? {
        Progress::Interrupted(_) => Err(Interrupted.into()),
        Progress::Complete(findings) => findings.total().map(|tally| tally.summary).ok_or(EvalError::NoSamples),
    }
}
