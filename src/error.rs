//! One error for everything that can go wrong.

use crate::reproduce::ReproduceError;
use pcc_compile::ask_and_tell::{AskError, TellError};
use pcc_compile::campaign::journal::JournalError;
use pcc_compile::campaign::{RecordingError, RunError};
use pcc_compile::compilation::{BuildError, BuildFileError};
use pcc_compile::mechanics::model::ModelError;
use pcc_compile::reference::ReferenceError;
use pcc_compile::study::{StudyError, StudyFileError};
use pcc_evaluate::artifact::{LossError, ReadError, SaveError, WriteError};
use pcc_evaluate::evaluation::{EvalError, PointError, SurveyError};
use pcc_evaluate::foundation::{FileError, Interrupted, is_interruption};
use pcc_evaluate::session::SessionError;
use pcc_evaluate::shard_file::PartError;
use thiserror::Error;

/// Whatever can go wrong in the library, with what did as its [`source`](std::error::Error::source).
///
/// # Examples
///
/// ```
/// fn stable_proportion(study: &str) -> Result<f64, pcc::Error> {
///     let study = pcc::Study::read(study)?;
///     let surrogate = pcc::build(&study, &pcc::Silent)?;
///     Ok(pcc::monte_carlo(&surrogate, 100_000, 1, &pcc::Silent)?.stable_proportion().value())
/// }
/// let error = stable_proportion("missing.toml").unwrap_err();
/// assert!(matches!(error, pcc::Error::StudyFile(_)));
/// assert_eq!((error.exit_code(), error.is_interruption()), (2, false));
/// ```
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A study is wrong.
    #[error("{0}")]
    Study(#[from] StudyError),
    /// A file is no study, or the study in it is wrong.
    #[error("{0}")]
    StudyFile(#[from] StudyFileError),
    /// A model cannot be set up or run.
    #[error("{0}")]
    Model(#[from] ModelError),
    /// A model run failed.
    #[error("{0}")]
    Run(#[from] RunError),
    /// A build gave no surrogate.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// A build gave no surrogate file.
    #[error("{0}")]
    BuildFile(#[from] BuildFileError),
    /// A build cannot be stepped.
    #[error("{0}")]
    Ask(#[from] AskError),
    /// Answers were not taken.
    #[error("{0}")]
    Tell(#[from] TellError),
    /// A journal cannot be used.
    #[error("{0}")]
    Journal(#[from] JournalError),
    /// Model runs cannot be recorded.
    #[error("{0}")]
    Recording(#[from] RecordingError),
    /// Surrogate and model were not compared.
    #[error("{0}")]
    Reference(#[from] ReferenceError),
    /// A file is no surrogate.
    #[error("{0}")]
    Read(#[from] ReadError),
    /// A surrogate cannot be encoded.
    #[error("{0}")]
    Write(#[from] WriteError),
    /// A surrogate was not saved.
    #[error("{0}")]
    Save(#[from] SaveError),
    /// A surrogate would not be the same if it were written again.
    #[error("{0}")]
    Loss(#[from] LossError),
    /// A file was not written.
    #[error("{0}")]
    File(#[from] FileError),
    /// A question does not fit a surrogate.
    #[error("{0}")]
    Survey(#[from] SurveyError),
    /// A surrogate cannot be evaluated.
    #[error("{0}")]
    Eval(#[from] EvalError),
    /// A given point has no value.
    #[error("{0}")]
    Point(#[from] PointError),
    /// A request was not answered.
    #[error("{0}")]
    Session(#[from] SessionError),
    /// Parts of an evaluation do not belong together, or are not all of it.
    #[error("{0}")]
    Part(#[from] PartError),
    /// The paper was not reproduced.
    #[error("{0}")]
    Reproduce(#[from] ReproduceError),
    /// The user asked to stop.
    #[error("{0}")]
    Interrupted(#[from] Interrupted),
}

impl Error {
    /// Whether the user asked to stop, and that is why it failed.
    pub fn is_interruption(&self) -> bool {
        is_interruption(self)
    }

    /// The exit code of a program that ends with this error: 130 after an interruption, 2 else.
    pub fn exit_code(&self) -> u8 {
        if self.is_interruption() { INTERRUPTED } else { FAILED }
    }
}

/// Exit code of what went well.
pub(crate) const DONE: u8 = 0;

/// Exit code of a check that did not hold.
pub(crate) const CHECK_FAILED: u8 = 1;

/// Exit code of what the user interrupted, as shells give it to what Ctrl-C ends.
pub(crate) const INTERRUPTED: u8 = 130;

/// Exit code of bad usage and bad input.
pub(crate) const FAILED: u8 = 2;

#[cfg(test)]
mod tests {
    use super::*;
    use std::error::Error as _;

    #[test]
    fn interruptions_are_seen_through_every_layer() {
        let layers: [Error; 5] = [
            Interrupted.into(),
            RunError::from(Interrupted).into(),
            BuildError::from(RunError::from(Interrupted)).into(),
            TellError::from(AskError::from(BuildError::from(Interrupted))).into(),
            SessionError::from(EvalError::from(Interrupted)).into(),
        ];
        for error in layers {
            assert!(error.is_interruption() && error.exit_code() == 130, "{error:?}");
            assert_eq!(error.to_string(), "interrupted");
        }
        assert_eq!(Error::from(EvalError::NoSamples).exit_code(), 2);
    }

    #[test]
    fn causes_are_sources() {
        let error = Error::from(pcc_compile::study::Study::read("no such file").unwrap_err());
        assert!(error.source().is_some_and(|source| source.is::<StudyFileError>()));
        let wrong = pcc_compile::study::Study::from_toml("format = 2").unwrap_err();
        let in_file = StudyFileError::Study { path: "study.toml".to_owned(), cause: wrong.clone() };
        let source = Error::from(in_file).source().and_then(|source| source.source()).map(ToString::to_string);
        assert_eq!(source, Some(wrong.to_string()));
    }
}
