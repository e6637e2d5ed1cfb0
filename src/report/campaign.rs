//! Model runs that others make, and what is recorded of runs.

use super::table::{Align, Table};
use pcc_evaluate::foundation::count;
use serde::Serialize;
use std::fmt;

/// What a build waits for.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DesignReport {
    /// Name of the study.
    pub study: String,
    /// The study's file.
    #[serde(skip)]
    pub source: String,
    /// Table of the points.
    pub file: String,
    /// Points that wait for an answer.
    pub points: u64,
    /// Points that are answered.
    pub answered: u64,
    /// Whether the build needs no more.
    pub complete: bool,
}

impl fmt::Display for DesignReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { study, source, file, points, answered, complete } = self;
        if *complete {
            writeln!(f, "{study}: all {} model runs are answered; {file} has no rows\n", count(*answered))?;
            return writeln!(f, "the surrogate: pcc build {source} --resume");
        }
        writeln!(
            f,
            "{study}: {} points to run, {} answered already\n\nwritten to {file}; hand the answers over with\n\n    \
             pcc ingest {source} RESULTS.csv",
            count(*points),
            count(*answered)
        )
    }
}

/// What a table of results brought.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct IngestReport {
    /// Name of the study.
    pub study: String,
    /// The study's file.
    #[serde(skip)]
    pub source: String,
    /// Where the answers are now.
    pub journal: String,
    /// Rows of the table.
    pub rows: u64,
    /// New answers.
    pub answered: u64,
    /// New failures.
    pub failed: u64,
    /// Rows that said what was known.
    pub repeated: u64,
    /// Points that the build waits for now.
    pub missing: u64,
    /// Whether the build needs no more.
    pub complete: bool,
}

impl fmt::Display for IngestReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { study, source, journal, rows, answered, failed, repeated, missing, complete } = self;
        writeln!(
            f,
            "{study}: {} rows: {} new answers, {} failed runs, {} known already; recorded in {journal}\n",
            count(*rows),
            count(*answered),
            count(*failed),
            count(*repeated)
        )?;
        match complete {
            true => writeln!(f, "nothing is missing; the surrogate: pcc build {source} --resume"),
            false => {
                writeln!(f, "{} points wait for an answer: pcc design {source} --emit ROWS.csv", count(*missing))
            }
        }
    }
}

/// Runs of one model.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JournalModel {
    /// Hash of the model.
    pub hash: String,
    /// Number of its inputs.
    pub inputs: u64,
    /// Runs that answered.
    pub answered: u64,
    /// Runs that failed.
    pub failed: u64,
    /// Time of all runs.
    pub seconds: f64,
}

/// What is in a journal.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JournalReport {
    /// The file.
    pub journal: String,
    /// Models whose runs it has.
    pub models: Vec<JournalModel>,
    /// Bytes at its end that are no whole record.
    pub torn_bytes: u64,
    /// Bytes between records that are none.
    pub damaged_bytes: u64,
    /// Where the table was written.
    pub csv: Option<String>,
}

impl fmt::Display for JournalReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let runs: u64 = self.models.iter().map(|model| model.answered + model.failed).sum();
        writeln!(f, "{}: {} model runs\n", self.journal, count(runs))?;
        let right = Align::Right;
        let columns =
            [("model", Align::Left), ("inputs", right), ("answered", right), ("failed", right), ("seconds", right)];
        let mut table = Table::new(&columns);
        for JournalModel { hash, inputs, answered, failed, seconds } in &self.models {
            let hash: String = hash.chars().take(12).collect();
            table.row([hash, count(*inputs), count(*answered), count(*failed), format!("{seconds:.2}")]);
        }
        if !self.models.is_empty() {
            writeln!(f, "{table}")?;
        }
        if self.torn_bytes > 0 {
            writeln!(
                f,
                "{} bytes at the end are no whole record; the next build cuts them off",
                count(self.torn_bytes)
            )?;
        }
        match &self.csv {
            Some(csv) => writeln!(f, "written to {csv}"),
            None => writeln!(f, "--csv FILE writes every run with its inputs and eigenvalues"),
        }
    }
}
