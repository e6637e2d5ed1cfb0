//! A build whose runs are recorded and whose surrogate goes to a file.

use super::{BuildError, Built, GivenUse, built};
use crate::campaign::journal::JournalError;
use crate::campaign::{Books, Failure, Note, Recording};
use crate::study::Study;
use pcc_evaluate::artifact::{self, Format, WriteError, decode, encode};
use pcc_evaluate::foundation::{FileError, Observer, check_writable, save};
use pcc_evaluate::surrogate::{Certificate, Surrogate};
use std::path::{Path, PathBuf};
use std::time::Instant;
use thiserror::Error;

/// Why there is no surrogate file.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BuildFileError {
    /// The file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A journal that somebody wants cannot be used.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The build failed.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The surrogate cannot be encoded.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// A surrogate in a file, and what became of the model runs.
#[derive(Debug, Clone, PartialEq)]
pub struct BuiltFile {
    /// The surrogate.
    pub surrogate: Surrogate,
    /// Number of eigenvalues that are rigid-body motion, which a file need not say.
    pub rigid_body_modes: usize,
    /// Length of its file.
    pub bytes: u64,
    /// The journal of the runs, if it stays.
    pub journal: Option<PathBuf>,
    /// Runs that were known and not made again.
    pub reused: u64,
    /// Runs that failed and were skipped.
    pub failures: Vec<Failure>,
    /// What became of runs that were given, if some were.
    pub given: Option<GivenUse>,
    /// Wall-clock time of the build.
    pub elapsed_seconds: f64,
}

/// Builds the surrogate of `study` and writes it to `path`, which is tried before the first model run. `tell` is given
/// what the user should know of recorded runs, when it is known. Certificates of a surrogate that is replaced stay if
/// the new one has the same content.
///
/// # Errors
///
/// [`BuildFileError`]; an existing file is then unchanged, and the journal has what is worth keeping.
pub fn build_to_file(
    study: &Study,
    path: &Path,
    format: Format,
    recording: &Recording,
    observer: &dyn Observer,
    tell: &dyn Fn(&Note),
) -> Result<BuiltFile, BuildFileError> {
    check_writable(path)?;
    let books = Books::of_build(study, recording, path)?;
    books.notes.iter().for_each(tell);
    let start = Instant::now();
    let model = study.model().map_err(BuildError::from)?;
    let Built { mut surrogate, rigid_body_modes, given } = match built(books.campaign(study), model, observer) {
        Ok(built) => built,
        Err(error) => {
            if matches!(error, BuildError::TooManyFailures { .. }) && books.ledger.reused() > 0 {
                tell(&Note::FailuresReused);
            }
            books.give_up().iter().for_each(tell);
            return Err(error.into());
        }
    };
    let elapsed_seconds = start.elapsed().as_secs_f64();
    let mut bytes = encode(&surrogate, format)?;
    surrogate.certificates = certificates_that_hold(path, &surrogate, &bytes);
    if !surrogate.certificates.is_empty() {
        bytes = encode(&surrogate, format)?;
    }
    save(path, &bytes)?;
    let file = BuiltFile {
        surrogate,
        rigid_body_modes,
        bytes: bytes.len() as u64,
        journal: books.kept_journal().map(Path::to_owned),
        reused: books.ledger.reused(),
        failures: books.ledger.failures(),
        given,
        elapsed_seconds,
    };
    match observer.interrupted() {
        // The build could go on.
        true => books.give_up().iter().for_each(tell),
        false => books.close(),
    }
    Ok(file)
}

/// Certificates of the surrogate at `path`, if `built` computes and asks the same to the last bit.
fn certificates_that_hold(path: &Path, built: &Surrogate, bytes: &[u8]) -> Vec<Certificate> {
    let known = path.is_file().then(|| artifact::read(path).ok()).flatten();
    let Some(known) = known.filter(|known| !known.surrogate.certificates.is_empty()) else { return Vec::new() };
    let asks_the_same = known.surrogate.provenance.problem_hash == built.provenance.problem_hash;
    match decode(bytes) {
        Ok(new) if asks_the_same && new.content_id == known.content_id => known.surrogate.certificates,
        _ => Vec::new(),
    }
}
