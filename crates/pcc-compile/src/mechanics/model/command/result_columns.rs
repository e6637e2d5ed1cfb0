//! The columns of a table of results that are read, and what their cells say.

use super::printable::{self, SHOWN_CELL};
use super::results_table::{ERROR, RUN, ResultRow};
use super::table_error::TableError;
use csv::StringRecord;
use nalgebra::Complex;
use std::collections::HashMap;

/// Missing columns that a message names.
const NAMED: usize = 4;
/// Characters of the header in a message.
const SHOWN_HEADER: usize = 200;

/// Whole numbers below this are exact in double precision.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// A column that is read: its name and its place.
struct Column {
    name: String,
    place: usize,
}

/// The columns that are read.
pub(super) struct Columns {
    /// Columns of the header.
    count: usize,
    run: Option<Column>,
    inputs: Option<Vec<Column>>,
    /// Real and imaginary part of each eigenvalue.
    eigenvalues: Vec<[Column; 2]>,
    error: Option<Column>,
}

impl Columns {
    /// Finds the columns of `expected` eigenvalues, and of the run or the inputs.
    pub(super) fn find(header: &StringRecord, inputs: &[String], expected: usize) -> Result<Self, TableError> {
        let places = Places::new(header);
        let eigenvalues = places.eigenvalues(expected)?;
        let run = places.column(RUN)?;
        let error = places.column(ERROR)?;
        let mut missing = Vec::new();
        let mut found = Vec::new();
        for name in inputs {
            match places.column(name.trim())? {
                Some(column) => found.push(column),
                None => missing.push(name.as_str()),
            }
        }
        let are_inputs_there = missing.is_empty() && !inputs.is_empty();
        if run.is_none() && !are_inputs_there {
            return Err(TableError::NoIdentity { names: listed(&missing), header: places.shown() });
        }
        Ok(Self { count: header.len(), run, inputs: are_inputs_there.then_some(found), eigenvalues, error })
    }

    /// What a row says, or `None` if it is not answered yet.
    pub(super) fn row(&self, line: u64, record: &StringRecord) -> Result<Option<ResultRow>, TableError> {
        if record.len() != self.count {
            return Err(TableError::CellCount { line, found: record.len(), expected: self.count });
        }
        let error = self.error.as_ref().map_or("", |column| cell(record, column));
        if error.is_empty() && self.eigenvalues.iter().flatten().all(|column| cell(record, column).is_empty()) {
            return Ok(None);
        }
        let run = self.run.as_ref().map(|column| run_number(line, record, column)).transpose()?;
        let inputs = self.inputs.as_ref().map(|columns| columns.iter().map(|column| number(line, record, column)));
        let inputs = inputs.map(Iterator::collect).transpose()?;
        let answer = if error.is_empty() {
            let pair = |[re, im]: &[Column; 2]| Ok(Complex::new(number(line, record, re)?, number(line, record, im)?));
            Ok(self.eigenvalues.iter().map(pair).collect::<Result<_, TableError>>()?)
        } else {
            Err(printable::line(error, printable::MESSAGE_LENGTH))
        };
        Ok(Some(ResultRow { line, run, inputs, answer }))
    }
}

/// Where columns are, by name.
struct Places<'a> {
    header: &'a StringRecord,
    /// Place of the first of this name, and whether there is another.
    by_name: HashMap<&'a str, (usize, bool)>,
}

impl<'a> Places<'a> {
    fn new(header: &'a StringRecord) -> Self {
        let mut by_name = HashMap::new();
        for (place, name) in header.iter().enumerate() {
            by_name.entry(name).and_modify(|(_, is_repeated)| *is_repeated = true).or_insert((place, false));
        }
        Self { header, by_name }
    }

    fn column(&self, name: &str) -> Result<Option<Column>, TableError> {
        match self.by_name.get(name) {
            Some((_, true)) => Err(TableError::RepeatedColumn { column: printable::line(name, SHOWN_CELL) }),
            Some(&(place, false)) => Ok(Some(Column { name: name.to_owned(), place })),
            None => Ok(None),
        }
    }

    /// The columns of all eigenvalues, no fewer and no more: with others, the table belongs to another study.
    fn eigenvalues(&self, expected: usize) -> Result<Vec<[Column; 2]>, TableError> {
        let mut columns = Vec::new();
        let mut missing = Vec::new();
        for number in 1..=expected {
            let [re, im] = [format!("re_{number}"), format!("im_{number}")];
            match (self.column(&re)?, self.column(&im)?) {
                (Some(re), Some(im)) => columns.push([re, im]),
                (re_column, im_column) => {
                    missing.extend(re_column.is_none().then_some(re));
                    missing.extend(im_column.is_none().then_some(im));
                }
            }
            if missing.len() > NAMED {
                break;
            }
        }
        if !missing.is_empty() {
            return Err(TableError::MissingColumns { names: listed(&missing), header: self.shown() });
        }
        let next = expected.saturating_add(1);
        match [format!("re_{next}"), format!("im_{next}")].into_iter().find(|name| self.by_name.contains_key(&**name)) {
            Some(column) => Err(TableError::MoreEigenvalues { column, expected }),
            None => Ok(columns),
        }
    }

    fn shown(&self) -> String {
        printable::line(&self.header.iter().collect::<Vec<_>>().join(", "), SHOWN_HEADER)
    }
}

fn listed(names: &[impl AsRef<str>]) -> String {
    let mut shown: Vec<String> =
        names.iter().take(NAMED).map(|name| printable::line(name.as_ref(), SHOWN_CELL)).collect();
    if names.len() > NAMED {
        shown.push("…".to_owned());
    }
    shown.join(", ")
}

fn cell<'a>(record: &'a StringRecord, column: &Column) -> &'a str {
    record.get(column.place).unwrap_or_default()
}

fn number(line: u64, record: &StringRecord, column: &Column) -> Result<f64, TableError> {
    let text = cell(record, column);
    let name = || printable::line(&column.name, SHOWN_CELL);
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(TableError::NotFinite { line, column: name(), found: printable::line(text, SHOWN_CELL) }),
        Err(_) if text.is_empty() => Err(TableError::EmptyCell { line, column: name() }),
        Err(_) => Err(TableError::NotANumber { line, column: name(), found: printable::line(text, SHOWN_CELL) }),
    }
}

/// Also 3.0 and 3e0, because some programs write all columns in the same way.
fn run_number(line: u64, record: &StringRecord, column: &Column) -> Result<u64, TableError> {
    let text = cell(record, column);
    let whole = |number: &f64| number.fract() == 0.0 && (0.0..EXACT).contains(number);
    match text.parse().ok().or_else(|| text.parse::<f64>().ok().filter(whole).map(|number| number as u64)) {
        Some(run) => Ok(run),
        None if text.is_empty() => Err(TableError::EmptyCell { line, column: column.name.clone() }),
        None => Err(TableError::NotARun { line, found: printable::line(text, SHOWN_CELL) }),
    }
}
