//! Models whose answers come in tables, and what runs of programs have in common with them.

use crate::study::defaults;
use crate::study::error::StudyError;
use crate::study::print::Printer;
use crate::study::raw;
use crate::study::validate::Lines;
use std::fmt::Write;
use toml::Spanned;

/// The keys that say what a run answers.
pub(super) const KEYS: [&str; 3] = ["eigenvalues", "on_failure", "version"];

/// A run answers at most so many eigenvalues: two for each degree of freedom of a large model.
const MOST_EIGENVALUES: i64 = 100_000;

/// Answers in numbers: what is asked, and how many eigenvalues each run answers.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Eigenvalues of each run, at least 1.
    pub eigenvalues: usize,
    /// Handed along with the inputs: by name, sorted.
    pub constants: Vec<(String, f64)>,
    /// Set by the user when the program begins to answer otherwise: earlier runs then no longer count.
    pub version: String,
    /// Whether runs that fail are left out.
    pub skips_failures: bool,
}

impl Lines<'_> {
    /// Given runs may have `found` how many eigenvalues there are.
    pub(super) fn table(
        &self,
        raw: &mut raw::Model,
        constants: Vec<(String, f64)>,
        found: Option<usize>,
    ) -> Result<Table, StudyError> {
        let line = self.place("model.kind", &raw.kind).line;
        let stated = raw.eigenvalues.take();
        let stated = stated.map(|count| self.integer("model.eigenvalues", count, 1..=MOST_EIGENVALUES)).transpose()?;
        let meaning = "how many eigenvalues each run answers";
        let missing = StudyError::MissingKey { line, key: "eigenvalues", meaning };
        Ok(Table {
            eigenvalues: stated.map(|count| count as usize).or(found).ok_or(missing)?,
            constants,
            version: raw.version.take().map_or(defaults::VERSION.to_owned(), Spanned::into_inner),
            skips_failures: self.skips_failures(raw)?,
        })
    }

    /// Whether runs that fail are left out.
    pub(super) fn skips_failures(&self, raw: &mut raw::Model) -> Result<bool, StudyError> {
        match raw.on_failure.take() {
            None => Ok(false),
            Some(word) => self.word("model.on_failure", &word, &[("stop", false), ("skip", true)]),
        }
    }
}

pub(super) fn print(file: &mut Printer, settings: &Table) {
    file.line("eigenvalues", settings.eigenvalues, "that each run answers");
    print_policy(file, settings.skips_failures);
    file.line("version", super::quoted(&settings.version), "change it when the program answers otherwise");
}

pub(super) fn print_policy(file: &mut Printer, skips_failures: bool) {
    let policy = if skips_failures { "skip" } else { "stop" };
    file.line("on_failure", format!("{policy:?}"), "of a run: \"stop\" the build, or \"skip\" the run and report it");
}

/// What is asked and answered, as text for hashes.
pub(super) fn identify(text: &mut String, table: &Table) {
    let _ = writeln!(text, "eigenvalues {}\nversion {:?}", table.eigenvalues, table.version);
    for (name, value) in &table.constants {
        let _ = writeln!(text, "constant {name} {value:?}");
    }
}
