//! Why a session gave no answer.

use crate::evaluation::{EvalError, PilotError, SurveyError};
use crate::shard_file::PartError;
use thiserror::Error;

/// Why a request could not be answered.
#[derive(Debug, Error)]
pub enum SessionError {
    /// The question does not fit the surrogate.
    #[error(transparent)]
    Survey(#[from] SurveyError),
    /// The surrogate cannot be evaluated, or the user asked to stop before there was anything to say.
    #[error(transparent)]
    Eval(#[from] EvalError),
    /// Parts of an evaluation are not all of it.
    #[error(transparent)]
    Part(#[from] PartError),
    /// Critical values of an input that does not exist.
    #[error("critical value of {input}: the surrogate has no such input; it has {}", known.join(", "))]
    NoSuchInput {
        /// Name asked for.
        input: String,
        /// Names there are.
        known: Vec<String>,
    },
    /// Critical values of an input that is confined.
    #[error("critical value of {input}: it is looked for in all of the domain, so {input} must not be confined")]
    ConfinedInput {
        /// The input.
        input: String,
    },
    /// Critical values of an input that others depend on which are not fixed.
    #[error(
        "critical value of {input}: {} and {input} depend on each other, so that {input} cannot be varied alone; \
         fix the others, or sweep {input}, and they follow",
        others.join(", ")
    )]
    CriticalOfDependent {
        /// The input.
        input: String,
        /// Those that depend on it.
        others: Vec<String>,
    },
    /// Critical values from other than random samples.
    #[error("critical values are found from random samples, with no other sampler")]
    CriticalSampler,
    /// Critical values along a sweep.
    #[error("critical values are found over all of the domain, not along a sweep")]
    CriticalOfSweep,
    /// A shard beyond the last.
    #[error("there is no shard {number} of {of}; they are numbered from 0")]
    NoSuchShard {
        /// Number asked for.
        number: u64,
        /// Number of shards.
        of: u64,
    },
}

impl From<PilotError> for SessionError {
    fn from(error: PilotError) -> Self {
        match error {
            PilotError::Survey(error) => error.into(),
            PilotError::Eval(error) => error.into(),
        }
    }
}
