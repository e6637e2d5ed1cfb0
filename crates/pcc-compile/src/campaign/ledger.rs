//! The books of model runs: what is known already, what is recorded, and which points were asked for.

use crate::campaign::journal::{Contents, HASH_BYTES, Journal, JournalError, Record, RunOutcome};
use crate::study::{ModelSettings, Study};
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Runs that take microseconds are synced together, at least this often.
const SYNC_INTERVAL: Duration = Duration::from_millis(100);

/// What may be done for a point that is not known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Unknown {
    /// The model is run.
    Run,
    /// Nothing: the points are written down for others to run.
    Ask,
    /// Nothing: the build makes do with what it has.
    Settle,
}

/// A point the design asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignPoint {
    /// The inputs, in physical units.
    pub point: Vec<f64>,
    /// Whether its answer, or its failure if the study skips those, is known.
    pub is_known: bool,
}

/// A run without an answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// The inputs, in physical units.
    pub point: Vec<f64>,
    /// Why.
    pub cause: String,
}

/// Keeps the books of the runs of one model, in a journal if there is one.
#[derive(Debug)]
pub struct Ledger {
    model: [u8; HASH_BYTES],
    /// By the bits of the inputs: the best that was recorded of each point, and of equals the last.
    known: HashMap<Vec<u64>, RunOutcome>,
    unknown: Unknown,
    journal: Option<Journal>,
    /// Whether runs go on if they cannot be recorded, because nobody asked for a journal.
    is_optional: bool,
    /// Whether recorded failures are tried again even if they are to be skipped.
    retries_failures: bool,
    pages: Mutex<Pages>,
}

/// What changes while models run.
#[derive(Debug)]
struct Pages {
    asked: Vec<DesignPoint>,
    failures: Vec<Failure>,
    reused: u64,
    recorded: u64,
    /// Of those, failures.
    recorded_failures: u64,
    recorded_time: Duration,
    pending: Vec<Record>,
    last_sync: Instant,
}

impl Ledger {
    /// A model that is nothing but the runs that are given cannot be run: builds make do with what there is.
    fn new(study: &Study, journal: Option<Journal>) -> Self {
        let is_given = study.data.is_some() && matches!(study.model, ModelSettings::Table(_));
        let pages = Pages {
            asked: Vec::new(),
            failures: Vec::new(),
            reused: 0,
            recorded: 0,
            recorded_failures: 0,
            recorded_time: Duration::ZERO,
            pending: Vec::new(),
            last_sync: Instant::now(),
        };
        Self {
            model: study.model_hash(),
            known: HashMap::new(),
            unknown: if is_given { Unknown::Settle } else { Unknown::Run },
            journal,
            is_optional: false,
            retries_failures: false,
            pages: Mutex::new(pages),
        }
    }

    /// Nothing is known and nothing recorded.
    pub fn blank(study: &Study) -> Self {
        Self::new(study, None)
    }

    /// Every run is recorded in `journal`.
    pub fn recording(study: &Study, journal: Journal) -> Self {
        Self::new(study, Some(journal))
    }

    /// What `contents` has of this model is known, and need not be run again. Answers with derivatives stand above
    /// those without, and these above failures.
    #[must_use]
    pub fn knowing(mut self, contents: &Contents) -> Self {
        for record in contents.records.iter().filter(|record| record.model == self.model) {
            let known = self.known.entry(bits(&record.point)).or_insert_with(|| record.outcome.clone());
            if rank(&record.outcome) >= rank(known) {
                *known = record.outcome.clone();
            }
        }
        self
    }

    /// Runs go on if they cannot be recorded.
    #[must_use]
    pub fn optional(mut self) -> Self {
        self.is_optional = true;
        self
    }

    /// Recorded failures are tried again, even if the study skips them.
    #[must_use]
    pub fn retrying_failures(mut self) -> Self {
        self.retries_failures = true;
        self
    }

    /// Whether a recorded failure may be left out instead of being tried again.
    pub(super) fn may_skip(&self, by_circumstances: bool) -> bool {
        !(by_circumstances || self.retries_failures)
    }

    /// The journal is of no use to anybody: it is removed when the books are closed.
    pub fn discard_journal(&self) {
        if let Some(journal) = &self.journal {
            journal.discard();
        }
    }

    /// The model is not run: a build that needs more than what is known ends with
    /// [`super::RunError::Unanswered`].
    #[must_use]
    pub fn asking(mut self) -> Self {
        self.unknown = Unknown::Ask;
        self
    }

    /// Whether a build gives the best that it has, where it needs more than what is known.
    pub fn settles(&self) -> bool {
        self.unknown == Unknown::Settle
    }

    /// What is known of a point.
    pub fn find(&self, point: &[f64]) -> Option<&RunOutcome> {
        self.known.get(&bits(point))
    }

    /// Whether the model may be run.
    pub fn may_run(&self) -> bool {
        self.unknown == Unknown::Run
    }

    /// Every point asked for so far, in the order of the design, if the model is not run.
    pub fn asked(&self) -> Vec<DesignPoint> {
        self.pages().asked.clone()
    }

    /// Runs that failed and were left out.
    pub fn failures(&self) -> Vec<Failure> {
        self.pages().failures.clone()
    }

    /// Runs whose answers were known already.
    pub fn reused(&self) -> u64 {
        self.pages().reused
    }

    /// Failures that were recorded in the journal.
    pub fn recorded_failures(&self) -> u64 {
        self.pages().recorded_failures
    }

    /// Runs that were recorded in the journal, whether they answered or failed.
    pub fn recorded(&self) -> u64 {
        self.pages().recorded
    }

    /// The time they took together.
    pub fn recorded_time(&self) -> Duration {
        self.pages().recorded_time
    }

    /// Writes down that these points were asked for.
    pub(super) fn note(&self, points: &[Vec<f64>], is_known: impl Fn(usize) -> bool) {
        let mut pages = self.pages();
        for (i, point) in points.iter().enumerate() {
            let is_known = is_known(i);
            pages.reused += u64::from(is_known);
            if !self.may_run() {
                pages.asked.push(DesignPoint { point: point.clone(), is_known });
            }
        }
    }

    /// Writes down that a run failed and is left out.
    pub(super) fn note_failure(&self, point: &[f64], cause: String) {
        self.pages().failures.push(Failure { point: point.to_vec(), cause });
    }

    /// Records a run. It counts once [`Ledger::sync`] or, for `at_once`, this call has returned.
    pub(super) fn record(
        &self,
        point: &[f64],
        outcome: impl FnOnce() -> RunOutcome,
        duration: Duration,
        at_once: bool,
    ) -> Result<(), JournalError> {
        if self.journal.is_none() {
            return Ok(());
        }
        let (model, seconds) = (self.model, duration.as_secs_f64());
        let record = Record { model, point: point.to_vec(), outcome: outcome(), seconds };
        let mut pages = self.pages();
        pages.pending.push(record);
        pages.recorded_time += duration;
        if at_once || pages.last_sync.elapsed() >= SYNC_INTERVAL { self.write(&mut pages) } else { Ok(()) }
    }

    /// Sees to it that all that was recorded is on the disk.
    pub(super) fn sync(&self) -> Result<(), JournalError> {
        self.write(&mut self.pages())
    }

    fn write(&self, pages: &mut Pages) -> Result<(), JournalError> {
        if let Some(journal) = self.journal.as_ref().filter(|_| !pages.pending.is_empty()) {
            match journal.append(&pages.pending.iter().collect::<Vec<_>>()) {
                Ok(()) => {
                    let is_failure = |record: &&Record| matches!(record.outcome, RunOutcome::Failed { .. });
                    pages.recorded_failures += pages.pending.iter().filter(is_failure).count() as u64;
                    pages.recorded += pages.pending.len() as u64;
                }
                Err(_) if self.is_optional => {}
                Err(error) => return Err(error),
            }
        }
        pages.pending.clear();
        pages.last_sync = Instant::now();
        Ok(())
    }

    fn pages(&self) -> MutexGuard<'_, Pages> {
        self.pages.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What says more of a point stands higher.
fn rank(outcome: &RunOutcome) -> u8 {
    match outcome {
        RunOutcome::Failed { .. } => 0,
        RunOutcome::Answered(computation) => 1 + u8::from(computation.reductions.is_some()),
    }
}

/// What tells points from each other.
pub(super) fn bits(point: &[f64]) -> Vec<u64> {
    point.iter().map(|value| value.to_bits()).collect()
}

/// A study, and where the books of its model runs are kept.
///
/// A study alone will do: then nothing is recorded.
#[derive(Debug, Clone, Copy)]
pub struct Campaign<'a> {
    /// What is asked.
    pub study: &'a Study,
    /// The books.
    pub ledger: Option<&'a Ledger>,
    /// Whether comparisons and certificates count runs that fail, as disagreement, instead of ending at the first.
    pub counts_failures: bool,
}

impl<'a> From<&'a Study> for Campaign<'a> {
    fn from(study: &'a Study) -> Self {
        Self { study, ledger: None, counts_failures: false }
    }
}
