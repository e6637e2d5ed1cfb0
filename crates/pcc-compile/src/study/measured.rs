//! Measured values of an input: a column of a table beside the study.

use super::error::StudyError;
use super::raw;
use super::validate::Lines;
use pcc_evaluate::probability::inputs::{Marginal, MarginalError, Smoothing, Source};
use std::path::Path;
use thiserror::Error;
use toml::Spanned;

/// Why a table gives no values.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum TableError {
    /// It cannot be read.
    #[error("{file} cannot be read: {cause}")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system says.
        cause: String,
    },
    /// It has several columns, and none is named.
    #[error("{file} has {} columns; add column = {:?}, or another of {}", columns.len(), columns[0], columns.join(", "))]
    Columns {
        /// The file.
        file: String,
        /// What they are called.
        columns: Vec<String>,
    },
    /// It has no such column.
    #[error("{file} has no column {column:?}; it has {}", columns.join(", "))]
    NoColumn {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// What they are called.
        columns: Vec<String>,
    },
    /// A cell is no number.
    #[error("{file}, line {line}: {found:?} is no finite number; correct it, or remove the line")]
    NotANumber {
        /// The file.
        file: String,
        /// Its line.
        line: u64,
        /// What stands there.
        found: String,
    },
}

impl Lines<'_> {
    /// The law of measured values; the inner error says why they have none.
    pub(super) fn measured(
        &self,
        key: &str,
        input: &raw::Input,
        given: &[(&'static str, f64)],
        folder: &Path,
    ) -> Result<Result<Marginal, MarginalError>, StudyError> {
        let file = input.file.as_ref();
        let is_bound = |(name, _): &(&str, f64)| ["lower", "upper"].contains(name);
        let Some(file) = file.filter(|_| given.iter().all(is_bound) && input.values.is_none()) else {
            return Ok(Marginal::named("data", &pcc_evaluate::probability::inputs::Parameters::of([])));
        };
        if input.polynomials.is_some() {
            return Ok(Err(MarginalError::NoChoice { law: "data" }));
        }
        let smoothing = input.smoothing.as_ref();
        let smoothing = smoothing
            .map(|word| self.word(&format!("{key}.smoothing"), word, &Smoothing::ALL))
            .transpose()?
            .unwrap_or(Smoothing::Kernel);
        let values = values(file, input.column.as_deref(), folder).map_err(|cause| StudyError::Table {
            place: self.place(format!("{key}.file"), file),
            cause: Box::new(cause),
        })?;
        let bound = |wanted: &str| given.iter().find(|(name, _)| *name == wanted).map(|(_, value)| *value);
        let source = Source { file: file.get_ref().clone(), column: input.column.clone() };
        Ok(Marginal::measured(&values, [bound("lower"), bound("upper")], smoothing, Some(source)))
    }
}

/// The numbers of a column. Columns end at commas, or at semicolons or tabs if the first line has some and no comma.
fn values(file: &Spanned<String>, column: Option<&str>, folder: &Path) -> Result<Vec<f64>, TableError> {
    let name = || file.get_ref().clone();
    let unreadable = |cause: String| TableError::Unreadable { file: name(), cause };
    let text = std::fs::read_to_string(folder.join(file.get_ref())).map_err(|error| unreadable(error.to_string()))?;
    let text = text.trim_start_matches('\u{feff}');
    let first = text.lines().next().unwrap_or_default();
    let delimiter = [b',', b';', b'\t'].into_iter().find(|byte| first.as_bytes().contains(byte)).unwrap_or(b',');
    let mut reader = csv::ReaderBuilder::new();
    let reader = reader.delimiter(delimiter).has_headers(false).trim(csv::Trim::All);
    let mut rows = reader.from_reader(text.as_bytes()).into_records().enumerate();
    let head: Vec<String> = match rows.next() {
        Some((_, Ok(row))) => row.iter().map(str::to_owned).collect(),
        Some((_, Err(error))) => return Err(unreadable(error.to_string())),
        None => Vec::new(),
    };
    let position = match column {
        Some(column) => head.iter().position(|known| known == column).ok_or_else(|| TableError::NoColumn {
            file: name(),
            column: column.to_owned(),
            columns: head.clone(),
        })?,
        None if head.len() > 1 => return Err(TableError::Columns { file: name(), columns: head }),
        None => 0,
    };
    // A column without a name begins with its first value.
    let mut values: Vec<f64> =
        if column.is_none() { head.iter().filter_map(|cell| number(cell)).collect() } else { Vec::new() };
    for (at, row) in rows {
        let row = row.map_err(|error| unreadable(error.to_string()))?;
        let cell = row.get(position).unwrap_or_default();
        let line = row.position().map_or(at as u64 + 1, csv::Position::line);
        let wrong = || TableError::NotANumber { file: name(), line, found: cell.to_owned() };
        values.push(number(cell).ok_or_else(wrong)?);
    }
    Ok(values)
}

fn number(cell: &str) -> Option<f64> {
    cell.parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, column: Option<&str>) -> Result<Vec<f64>, TableError> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("m.csv"), text).unwrap();
        values(&Spanned::new(0..0, "m.csv".to_owned()), column, folder.path())
    }

    #[test]
    fn columns_are_found_with_and_without_names() {
        assert_eq!(read("1.0\n2\n3e0\n", None), Ok(vec![1.0, 2.0, 3.0]));
        assert_eq!(read("k\n1.0\n2\n", None), Ok(vec![1.0, 2.0]));
        assert_eq!(read("\u{feff}a; k\n5;1.0\n6;2\n\n", Some("k")), Ok(vec![1.0, 2.0]));
        assert_eq!(read("a\tk\r\n5\t1.0\r\n", Some("a")), Ok(vec![5.0]));
        assert_eq!(read("", None), Ok(vec![]));
    }

    #[test]
    fn what_is_no_number_is_named_by_its_line() {
        let message = |text, column| read(text, column).unwrap_err().to_string();
        assert_eq!(
            message("a,k\n1,2\n3,\n", Some("k")),
            "m.csv, line 3: \"\" is no finite number; correct it, or remove the line"
        );
        assert!(message("k\n1\n2,5\n", None).contains("m.csv"));
        assert!(message("k\n1\nnan\n", None).contains("line 3: \"nan\""));
        assert!(message("a,k\n1,2\n", None).contains("add column = \"a\", or another of a, k"));
        assert!(message("a,k\n1,2\n", Some("b")).contains("no column \"b\"; it has a, k"));
    }
}
