//! Streaming Monte Carlo on a surrogate.
//!
//! Samples are numbered; sample i is the same whoever computes it. Fixed chunks of samples are summarised on all cores
//! and combined in a fixed order, so counts and moments do not depend on the number of threads, and memory not on the
//! number of samples.

use super::question::Question;
use super::survey::{Survey, Surveyed};
use crate::components::Summary;
use crate::evaluation::error::EvalError;
use crate::foundation::{InstructionSet, Interrupted, Observer};
use crate::surrogate::Surrogate;

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
    match survey.run(0..survey.division().chunks(), observer)? {
        Surveyed::Interrupted(_) => Err(Interrupted.into()),
        Surveyed::Complete(findings) => findings.total().map(|tally| tally.summary).ok_or(EvalError::NoSamples),
    }
}
