//! What every command is given: where to print, whom to ask whether to stop, and work that several commands begin with.

use super::about;
use super::messages::{self, print, print_report};
use super::overwrite::certificates_to_keep;
use super::terminal::Terminal;
use crate::report::{EvalReport, WIDTH};
use pcc_compile::campaign::{Books, Note, Recording, RunError};
use pcc_compile::compilation::{BuildFileError, BuiltFile, build_to_file};
use pcc_compile::reference::ReferenceError;
use pcc_compile::study::Study;
use pcc_evaluate::artifact::Format;
use pcc_evaluate::evaluation::Question;
use pcc_evaluate::foundation::{InstructionSet, Interrupted};
use pcc_evaluate::session::Session;
use pcc_evaluate::surrogate::Surrogate;
use serde::Serialize;
use std::fmt::Display;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Columns of text that are easily read, where a terminal is wider.
const MOST_COLUMNS: usize = 120;

/// How wide text may be.
fn columns() -> usize {
    terminal_size::terminal_size_of(std::io::stdout())
        .map_or(WIDTH, |(width, _)| usize::from(width.0).min(MOST_COLUMNS))
}

/// What every command is given.
pub(super) struct Context {
    pub json: bool,
    /// Whether reports are to have every detail.
    pub details: bool,
    pub quiet: bool,
    pub terminal: Terminal,
    /// What is said after an error: it loses nothing.
    pub afterwards: Mutex<Vec<String>>,
}

impl Context {
    /// A remark on standard error, beside a report.
    pub fn say(&self, remark: &str) {
        if !self.quiet {
            messages::remark(remark);
        }
    }

    /// Prints a report: text for people, or one JSON document.
    pub fn print<R: Serialize + Display>(&self, report: &R) -> anyhow::Result<()> {
        let columns = columns();
        match (self.json, self.details) {
            (true, _) => print(&format!("{}\n", serde_json::to_string_pretty(report)?)),
            (false, true) => print_report(&format!("{report:#columns$}")),
            (false, false) => print_report(&format!("{report:columns$}")),
        }
    }

    /// What the user should know of recorded runs.
    pub fn note(&self, note: &Note) {
        match note {
            Note::Recorded { .. } | Note::FailuresReused => {
                self.afterwards.lock().unwrap_or_else(PoisonError::into_inner).push(note.to_string());
            }
            _ => self.say(&note.to_string()),
        }
    }

    /// Says what was to be said at the end.
    pub fn say_afterwards(&self) {
        let remarks = std::mem::take(&mut *self.afterwards.lock().unwrap_or_else(PoisonError::into_inner));
        remarks.iter().for_each(|remark| self.say(remark));
    }

    /// Says what unfinished work has recorded.
    pub fn say_recorded(&self, books: &Books) {
        books.recorded().iter().for_each(|note| self.note(note));
    }

    /// The same of work that compares with the model, and what can be done about runs that fail.
    pub fn say_recorded_of(&self, books: &Books, error: &ReferenceError) {
        self.say_recorded(books);
        if matches!(error, ReferenceError::Run(RunError::Model { .. })) {
            let remark = "--failures count goes on where runs fail, and counts them as disagreement";
            self.afterwards.lock().unwrap_or_else(PoisonError::into_inner).push(remark.to_owned());
        }
    }

    /// Opens the books of work that runs the model at random points.
    pub fn books_of_sampling(&self, study: &Study, recording: &Recording) -> anyhow::Result<Books> {
        let books = Books::of_sampling(study, recording)?;
        books.notes.iter().for_each(|note| self.note(note));
        Ok(books)
    }

    /// Builds the surrogate of `study`, read from `source`, and writes it; over one with certificates only if it
    /// `may_replace` them.
    pub fn build_to_file(
        &self,
        study: &Study,
        source: &str,
        path: &Path,
        format: Format,
        recording: &Recording,
        may_replace: bool,
    ) -> anyhow::Result<BuiltFile> {
        let certificates = certificates_to_keep(path, may_replace)?;
        let built = build_to_file(study, path, format, recording, &self.terminal, &|note| self.note(note));
        let built = built.map_err(|error| match error {
            BuildFileError::Build(error) => about(source, error),
            other => other.into(),
        })?;
        match built.surrogate.certificates.len() {
            _ if certificates == 0 => {}
            0 => self.say(&format!("{} is another surrogate than before; its certificates are gone", path.display())),
            _ => self.say(&format!("{} is the same surrogate as before and keeps its certificates", path.display())),
        }
        Ok(built)
    }

    /// The plain question: random samples of the whole domain, all of them.
    pub fn sample(&self, surrogate: &Surrogate, samples: u64, seed: u64) -> anyhow::Result<EvalReport> {
        let question = Question::plain(samples, seed);
        let session = Session::new(surrogate, &question, None, InstructionSet::best())?;
        let found = session.run(&self.terminal).map_err(|error| about(&surrogate.provenance.study_name, error))?;
        let report = EvalReport::of_surrogate(&found).filter(|report| report.complete);
        Ok(report.ok_or(Interrupted)?)
    }
}
