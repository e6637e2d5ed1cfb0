//! Runs that somebody has made already: the tables a study names, or a command line in its place.

use super::error::StudyError;
use super::print::{Printer, float};
use super::raw;
use super::validate::Lines;
use crate::tables::{DataError, DataFile, Decimal, Dialect, GivenRuns, RunsReader, separator};
use pcc_evaluate::probability::inputs::InputSpace;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A larger share of the runs leaves too few for a fit.
const MOST_HELD_OUT: f64 = 0.9;

/// Runs that a study is given, and how they are used.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenData {
    /// The tables, as they were named.
    pub files: Vec<String>,
    /// How they are written.
    pub dialect: Dialect,
    /// The share of the runs that no fit sees: they validate the surrogate.
    pub holdout: f64,
    /// What they hold.
    pub runs: Arc<GivenRuns>,
}

/// What a command line says of given runs, in place of the study.
///
/// # Examples
///
/// ```
/// use pcc_compile::study::{DataOptions, Study};
/// let study = "format = 1\nname = \"t\"\n[model]\nkind = \"table\"\n[inputs]\n\
///              x = { distribution = \"uniform\", lower = 0.0, upper = 1.0 }";
/// let options = DataOptions { files: vec!["missing.csv".into()], ..DataOptions::default() };
/// let error = Study::from_toml_with(study, ".".as_ref(), &options).unwrap_err();
/// assert!(error.to_string().starts_with("missing.csv cannot be read"));
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DataOptions {
    /// Tables, in the current folder unless they say otherwise; if there are none, those of the study.
    pub files: Vec<PathBuf>,
    /// What separates columns.
    pub delimiter: Option<char>,
    /// What numbers have for a decimal point.
    pub decimal: Option<Decimal>,
    /// The share of the runs that no fit sees.
    pub holdout: Option<f64>,
}

/// What the reader of tables must know of the model.
pub(super) struct Expected<'i> {
    pub inputs: &'i InputSpace,
    pub noise: f64,
}

impl Lines<'_> {
    /// The runs that the study is given, if it is given any.
    pub(super) fn data(
        &self,
        raw: &mut raw::Model,
        options: &DataOptions,
        folder: &Path,
        expected: &Expected<'_>,
    ) -> Result<Option<GivenData>, StudyError> {
        let place = raw.data.as_ref().map(|files| self.place("model.data", files));
        let delimiter = raw.delimiter.take().map(|word| self.delimiter(&word)).transpose()?;
        let decimal = raw.decimal.take().map(|word| self.word("model.decimal", &word, &Decimal::ALL)).transpose()?;
        let holdout = raw.holdout.take().map(|share| self.holdout(&share)).transpose()?;
        let named = match raw.data.take().map(toml::Spanned::into_inner) {
            None => Vec::new(),
            Some(raw::Files::One(file)) => vec![file],
            Some(raw::Files::Several(files)) => files,
        };
        let (files, place): (Vec<DataFile>, _) = match options.files.is_empty() {
            true => (named.into_iter().map(|name| DataFile { path: folder.join(&name), shown: name }).collect(), place),
            false => {
                let shown = |path: &PathBuf| DataFile { path: path.clone(), shown: path.display().to_string() };
                (options.files.iter().map(shown).collect(), None)
            }
        };
        if files.is_empty() {
            let is_said = options.delimiter.is_some() || options.decimal.is_some() || options.holdout.is_some();
            let is_written = delimiter.is_some() || decimal.is_some() || holdout.is_some() || place.is_some();
            return if is_said || is_written { Err(StudyError::NoData) } else { Ok(None) };
        }
        let dialect = Dialect {
            delimiter: options.delimiter.or(delimiter),
            decimal: options.decimal.or(decimal).unwrap_or_default(),
        };
        let reader = RunsReader {
            inputs: expected.inputs,
            dialect,
            eigenvalues: raw.eigenvalues.as_ref().and_then(|count| usize::try_from(*count.get_ref()).ok()),
            skips_failures: raw.on_failure.as_ref().is_some_and(|word| word.get_ref() == "skip"),
            noise: expected.noise,
        };
        let runs = reader.read(&files).map_err(|cause| StudyError::Data { place, cause: Box::new(cause) })?;
        Ok(Some(GivenData {
            files: files.into_iter().map(|file| file.shown).collect(),
            dialect,
            holdout: options.holdout.or(holdout).unwrap_or(0.0),
            runs: Arc::new(runs),
        }))
    }

    fn delimiter(&self, word: &toml::Spanned<String>) -> Result<char, StudyError> {
        let expected = "\"comma\", \"semicolon\", \"tab\", \"space\" or \"bar\", or the character itself";
        separator(word.get_ref()).ok_or_else(|| self.out_of_range("model.delimiter", word, expected))
    }

    fn holdout(&self, share: &toml::Spanned<f64>) -> Result<f64, StudyError> {
        match *share.get_ref() {
            share if is_holdout(share) => Ok(share),
            _ => Err(self.out_of_range("model.holdout", share, HOLDOUT)),
        }
    }
}

/// What a share of runs to hold out is.
pub const HOLDOUT: &str = "a share of the runs from 0 to 0.9, like 0.2";

/// Whether so large a share of runs can be held out.
pub fn is_holdout(share: f64) -> bool {
    (0.0..=MOST_HELD_OUT).contains(&share)
}

/// Refuses runs that say nothing of an input, where there are no others.
pub(super) fn check_alone(data: &GivenData, inputs: &InputSpace) -> Result<(), DataError> {
    data.runs.constant_input(inputs).map_or(Ok(()), Err)
}

pub(super) fn print(file: &mut Printer, data: &GivenData) {
    let files: Vec<String> = data.files.iter().map(|name| super::model::quoted(name)).collect();
    let files = if let [one] = &files[..] { one.clone() } else { format!("[{}]", files.join(", ")) };
    file.line("data", files, "runs that have been made already");
    if let Some(delimiter) = data.dialect.delimiter {
        file.line("delimiter", super::model::quoted(&delimiter.to_string()), "what separates columns");
    }
    file.line("decimal", format!("{:?}", data.dialect.decimal.name()), "\"point\", or \"comma\" as in 0,25");
    file.line("holdout", float(data.holdout), "share of these runs that no fit sees; they validate the surrogate");
}
