//! What is recorded of model runs, where, and what of it is used again: one policy for every face.
//!
//! Runs of programs and servers are recorded unless the user forbids it. Runs of `pcc`'s own models are recorded while
//! a build lasts, so that an interrupted one can go on, and thrown away with it unless somebody asked for the journal
//! or it took long to fill.

use super::journal::{Contents, Journal, JournalError};
use super::ledger::{Campaign, Ledger};
use crate::study::{ModelSettings, Study};
use pcc_evaluate::foundation::plural;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;
use thiserror::Error;

/// Runs of pcc's own models that took less time together are run again sooner than resumed.
const WORTH_KEEPING: Duration = Duration::from_secs(10);

/// What the user wants recorded.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Recording {
    /// The journal; by default where [`journal_of_build`] and [`journal_here`] say.
    pub journal: Option<PathBuf>,
    /// Whether what the journal has of the model is used.
    pub resumes: bool,
    /// Whether recorded failures that the study would skip are tried again.
    pub retries_failures: bool,
    /// Whether nothing is recorded.
    pub is_off: bool,
}

/// Why no books were opened.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RecordingError {
    /// The journal cannot be used.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The model is one that others run.
    #[error("pcc cannot run models of kind \"table\", so it cannot sample them, compare with them or certify by them")]
    NotRun,
}

/// What to tell the user about recorded runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Note {
    /// The journal's last record was not whole.
    Torn {
        /// The journal.
        journal: PathBuf,
        /// Bytes that were cut.
        bytes: u64,
    },
    /// Bytes between records are no records.
    Damaged {
        /// The journal.
        journal: PathBuf,
        /// Bytes that were passed over.
        bytes: u64,
    },
    /// All runs are of other models.
    OtherModels {
        /// The journal.
        journal: PathBuf,
        /// Their number.
        runs: usize,
    },
    /// There is nothing to resume from.
    NothingRecorded {
        /// The journal.
        journal: PathBuf,
    },
    /// Runs are known and used.
    Used {
        /// The journal.
        journal: PathBuf,
        /// Their number.
        runs: usize,
    },
    /// Runs are known and not used.
    NotUsed {
        /// The journal.
        journal: PathBuf,
        /// Their number.
        runs: usize,
    },
    /// A file of the program is newer than its last recorded run.
    ChangedProgram {
        /// Name in the study.
        file: String,
    },
    /// The build failed on failures that were recorded earlier.
    FailuresReused,
    /// What an unfinished command has recorded.
    Recorded {
        /// The journal.
        journal: PathBuf,
        /// Runs that answered.
        answers: u64,
        /// Runs that failed.
        failures: u64,
    },
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Torn { journal, bytes } => write!(
                f,
                "{}: cut {} of a run whose record was not complete when an earlier build ended",
                journal.display(),
                plural(*bytes as usize, "byte")
            ),
            Self::Damaged { journal, bytes } => write!(
                f,
                "{}: {} between records are damaged and were passed over; the runs recorded there are lost",
                journal.display(),
                plural(*bytes as usize, "byte")
            ),
            Self::OtherModels { journal, runs } => write!(
                f,
                "{}: has {} of other models and none of this one; model, constants or inputs have changed",
                journal.display(),
                plural(*runs, "run")
            ),
            Self::NothingRecorded { journal } => {
                write!(f, "{}: has no model runs, so there is nothing to resume from", journal.display())
            }
            Self::Used { journal, runs } => {
                write!(f, "{}: {} recorded", journal.display(), plural(*runs, "model run"))
            }
            Self::NotUsed { journal, runs } => write!(
                f,
                "{}: {} recorded earlier are not used; stop and add --resume to use them",
                journal.display(),
                plural(*runs, "model run")
            ),
            Self::ChangedProgram { file } => write!(
                f,
                "{file} has changed since the last recorded run; if it answers otherwise now, change model.version in the study, \
                 so that earlier runs no longer count"
            ),
            Self::FailuresReused => {
                f.write_str("failures were recorded earlier; --resume --retry-failed tries them again")
            }
            Self::Recorded { journal, answers, failures } => {
                let counted = |count: u64, what: &str| (count > 0).then(|| plural(count as usize, what));
                let both = [counted(*answers, "model run"), counted(*failures, "failure")];
                let both: Vec<String> = both.into_iter().flatten().collect();
                write!(f, "{}: {} recorded; --resume goes on from there", journal.display(), both.join(" and "))
            }
        }
    }
}

/// The books of a command's model runs.
#[derive(Debug)]
pub struct Books {
    /// What is known and recorded.
    pub ledger: Ledger,
    /// What to tell the user before the first run.
    pub notes: Vec<Note>,
    journal: Option<PathBuf>,
    /// Whether the journal is of use only until the command ends: pcc runs the model itself, nobody asked for the
    /// journal, and this command began it.
    is_disposable: bool,
}

/// Where a build records its runs unless it is told otherwise: those of programs where other commands look for them;
/// others, which are of use only while the build lasts, beside the surrogate.
pub fn journal_of_build(study: &Study, surrogate: &Path) -> PathBuf {
    match study.model.is_external() {
        true => journal_here(study),
        false => surrogate.with_file_name(journal_name(study)),
    }
}

/// Where other commands look for a journal: in the current folder.
pub fn journal_here(study: &Study) -> PathBuf {
    PathBuf::from(journal_name(study))
}

fn journal_name(study: &Study) -> String {
    format!("{}.journal", study.name)
}

impl Books {
    /// Opens the books of a build whose surrogate goes to `surrogate`.
    ///
    /// # Errors
    ///
    /// [`JournalError`] if a journal that somebody wants cannot be used.
    pub fn of_build(study: &Study, recording: &Recording, surrogate: &Path) -> Result<Self, JournalError> {
        Self::open(study, recording, Some(journal_of_build(study, surrogate)))
    }

    /// Opens the books of work that runs the model at random points: runs of programs are recorded, others only if the
    /// user names a journal.
    ///
    /// # Errors
    ///
    /// [`RecordingError`].
    pub fn of_sampling(study: &Study, recording: &Recording) -> Result<Self, RecordingError> {
        match study.model {
            ModelSettings::Table(_) => Err(RecordingError::NotRun),
            ModelSettings::Command(_) | ModelSettings::UmBridge(_) => {
                Ok(Self::open(study, recording, Some(journal_here(study)))?)
            }
            _ => Ok(Self::open(study, recording, None)?),
        }
    }

    /// Opens the books of work that goes on after a build: the runs of programs that the build has made are in its
    /// journal by now.
    ///
    /// # Errors
    ///
    /// As [`Books::of_build`].
    pub fn after_build(study: &Study, recording: &Recording, surrogate: &Path) -> Result<Self, JournalError> {
        let journal = study.model.is_external().then(|| journal_of_build(study, surrogate));
        let resumes = recording.resumes || journal.is_some();
        Self::open(study, &Recording { resumes, ..recording.clone() }, journal)
    }

    /// Without a `default`, runs are recorded only if the user names a journal.
    fn open(study: &Study, recording: &Recording, default: Option<PathBuf>) -> Result<Self, JournalError> {
        let is_table = matches!(study.model, ModelSettings::Table(_));
        // Given runs are enough; there may be answers to further points.
        let default = default.filter(|path| !is_table || study.data.is_none() || path.exists());
        // Without a journal there is nothing to resume from, and nothing that answers in tables.
        let wants_journal = recording.resumes || (is_table && study.data.is_none());
        let chosen = recording.journal.clone().or(default).or_else(|| wants_journal.then(|| journal_here(study)));
        let Some(path) = chosen.filter(|_| !recording.is_off) else { return Ok(Self::without_journal(study)) };
        let wants_journal = recording.resumes || is_table;
        let is_unasked = recording.journal.is_none() && !wants_journal && !study.model.is_external();
        let (journal, contents) = match Journal::open(&path) {
            // Builds of pcc's own models may run beside each other, as long as nobody asked for a journal.
            Err(_) if is_unasked => return Ok(Self::without_journal(study)),
            opened => opened?,
        };
        let mut notes = notes_on(&path, &contents);
        notes.extend(what_is_known(study, &path, &contents, wants_journal));
        let is_disposable = is_unasked && journal.is_blank();
        let mut ledger = Ledger::recording(study, journal);
        if is_unasked {
            ledger = ledger.optional();
        }
        if recording.retries_failures {
            ledger = ledger.retrying_failures();
        }
        if wants_journal {
            ledger = ledger.knowing(&contents);
        }
        if is_table && study.data.is_none() {
            ledger = ledger.asking();
        }
        Ok(Self { ledger, notes, journal: Some(path), is_disposable })
    }

    fn without_journal(study: &Study) -> Self {
        Self { ledger: Ledger::blank(study), notes: Vec::new(), journal: None, is_disposable: false }
    }

    /// A campaign of `study` with these books.
    pub fn campaign<'b>(&'b self, study: &'b Study) -> Campaign<'b> {
        Campaign { study, ledger: Some(&self.ledger), counts_failures: false }
    }

    /// The journal, if it stays when the command ends.
    pub fn kept_journal(&self) -> Option<&Path> {
        self.journal.as_deref().filter(|_| !self.is_disposable)
    }

    /// What an unfinished command has recorded.
    pub fn recorded(&self) -> Option<Note> {
        let journal = self.journal.as_ref().filter(|_| self.ledger.recorded() > 0)?;
        let failures = self.ledger.recorded_failures();
        Some(Note::Recorded { journal: journal.clone(), answers: self.ledger.recorded() - failures, failures })
    }

    /// Ends work that failed or was interrupted, and says what is recorded of it. A journal that took long to fill is
    /// kept, whatever ended the work.
    pub fn give_up(self) -> Option<Note> {
        let took_long = self.ledger.recorded_time() >= WORTH_KEEPING;
        if took_long || !self.is_disposable {
            return self.recorded();
        }
        self.close();
        None
    }

    /// Keeps a journal that somebody may want, and removes one that nobody does.
    pub fn close(self) {
        if self.is_disposable {
            self.ledger.discard_journal();
        }
    }
}

/// What is wrong with a journal that can be used all the same.
pub fn notes_on(journal: &Path, contents: &Contents) -> Vec<Note> {
    let torn = |bytes| Note::Torn { journal: journal.to_owned(), bytes };
    let damaged = |bytes| Note::Damaged { journal: journal.to_owned(), bytes };
    let positive = |bytes: u64| Some(bytes).filter(|&bytes| bytes > 0);
    positive(contents.torn_bytes).map(torn).into_iter().chain(positive(contents.damaged_bytes).map(damaged)).collect()
}

/// What a journal has of this model, and whether it is used.
fn what_is_known(study: &Study, path: &Path, contents: &Contents, is_used: bool) -> Vec<Note> {
    let model = study.model_hash();
    let runs = contents.records.iter().filter(|record| record.model == model).count();
    let others = contents.records.len() - runs;
    let journal = path.to_owned();
    match (runs, is_used) {
        (0, true) if others > 0 => vec![Note::OtherModels { journal, runs: others }],
        (0, true) if !matches!(study.model, ModelSettings::Table(_)) => vec![Note::NothingRecorded { journal }],
        (0, _) => Vec::new(),
        (_, true) => {
            let mut notes = vec![Note::Used { journal, runs }];
            notes.extend(changed_programs(study, path));
            notes
        }
        (_, false) => vec![Note::NotUsed { journal, runs }],
    }
}

/// The files of the program that are newer than its last recorded run: what they answer now may be something else.
fn changed_programs(study: &Study, journal: &Path) -> Vec<Note> {
    let ModelSettings::Command(command) = &study.model else { return Vec::new() };
    let modified = |path: &Path| path.metadata().and_then(|metadata| metadata.modified()).ok();
    let Some(last_run) = modified(journal) else { return Vec::new() };
    let in_study = command.arguments.iter().filter_map(|argument| argument.strip_prefix("{study}/"));
    let is_newer = |name: &&str| modified(&command.study_folder.join(name)).is_some_and(|changed| changed > last_run);
    in_study.filter(is_newer).map(|name| Note::ChangedProgram { file: name.to_owned() }).collect()
}
