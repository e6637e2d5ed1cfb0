//! Tables of points and of their eigenvalues, as CSV.
//!
//! Points go out with the columns `run`, inputs, constants. Results come back with `run` or the inputs, and `re_1`,
//! `im_1`, `re_2`, `im_2` and so on, in any order of rows and columns, among others that are ignored; a text in a
//! column `error` marks a run that failed. A byte order mark, both kinds of line ends, and spaces around cells are
//! accepted.

use super::printable::{self, SHOWN_CELL};
use super::result_columns::Columns;
use super::row_reader::RowReader;
pub use super::table_error::TableError;
use nalgebra::Complex;
use std::io::{self, Read, Write};

/// Bytes of a cell that are read: far more than a number or a reason has.
pub(super) const LARGEST_CELL: usize = 64 << 10;
/// Bytes of a row that are read, more or less: a hundred thousand eigenvalues. Without limit, a quote that is not
/// closed would bring the rest of the file into memory.
pub(super) const LARGEST_ROW: u64 = 8 << 20;

/// Column with the number of the run.
pub(super) const RUN: &str = "run";
/// Column with the reason why a run failed.
pub(super) const ERROR: &str = "error";

/// One run in a table of results.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultRow {
    /// Where it starts in the file; the header is line 1.
    pub line: u64,
    /// Its number, if there is a column `run`.
    pub run: Option<u64>,
    /// Its point, if there are columns of all inputs, in the order asked for.
    pub inputs: Option<Vec<f64>>,
    /// Its eigenvalues, or the text of the column `error` with control characters escaped.
    pub answer: Result<Vec<Complex<f64>>, String>,
}

impl ResultRow {
    /// The answer to run number `run` of a design, at `point` in physical units: eigenvalues in 1/s. It comes from no
    /// table, so its line is 0.
    pub fn answer(run: u64, point: &[f64], eigenvalues: Vec<Complex<f64>>) -> Self {
        Self { line: 0, run: Some(run), inputs: Some(point.to_vec()), answer: Ok(eigenvalues) }
    }
}

/// Reads the runs of a table that are answered: rows with neither eigenvalues nor an error are left out. A row with an
/// error is a failed run, whatever else it says. A run may have several rows.
///
/// # Errors
///
/// [`TableError`] at the first thing that is wrong: no row is guessed, none is left out for being wrong.
///
/// # Examples
///
/// ```
/// use pcc_compile::mechanics::model::command::results_table::read_results;
///
/// let table = "im_1, re_1, run, error\n2.5, -1, 2,\n,, 1, no convergence\n";
/// let rows = read_results(table.as_bytes(), &[], 1)?;
/// assert_eq!((rows[0].run, rows[0].answer.as_ref().unwrap()[0].im), (Some(2), 2.5));
/// assert_eq!(rows[1].answer, Err("no convergence".to_owned()));
/// # Ok::<(), pcc_compile::mechanics::model::command::results_table::TableError>(())
/// ```
pub fn read_results(reader: impl Read, inputs: &[String], eigenvalues: usize) -> Result<Vec<ResultRow>, TableError> {
    check_names(inputs)?;
    let mut reader = RowReader::new(reader)?;
    let (_, header) = reader.next_row()?.ok_or(TableError::Empty)?;
    let columns = Columns::find(&header, inputs, eigenvalues)?;
    let mut rows = Vec::new();
    while let Some((line, record)) = reader.next_row()? {
        let Some(row) = columns.row(line, &record)? else { continue };
        rows.push(row);
    }
    Ok(rows)
}

/// Writes a table of `points`, numbered from `first_run`, with the constants in every row. Numbers read back with the
/// same bits.
///
/// # Errors
///
/// What `writer` returns, and [`io::ErrorKind::InvalidInput`] for a value that is not finite or a point of another
/// length.
pub fn write_points<P: AsRef<[f64]>>(
    writer: impl Write,
    runs: impl IntoIterator<Item = u64>,
    inputs: &[String],
    constants: &[(String, f64)],
    points: &[P],
) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(writer);
    let names = inputs.iter().chain(constants.iter().map(|(name, _)| name));
    writer.write_record([RUN].into_iter().chain(names.map(String::as_str)))?;
    for (run, point) in runs.into_iter().zip(points) {
        let point = point.as_ref();
        if point.len() != inputs.len() {
            let problem = format!("point {run} has {} values for {} inputs", point.len(), inputs.len());
            return Err(io::Error::new(io::ErrorKind::InvalidInput, problem));
        }
        writer.write_field(run.to_string())?;
        for value in point.iter().chain(constants.iter().map(|(_, value)| value)) {
            if !value.is_finite() {
                let problem = format!("point {run} holds {value}, which is not finite");
                return Err(io::Error::new(io::ErrorKind::InvalidInput, problem));
            }
            writer.write_field(format!("{value:?}"))?;
        }
        writer.write_record(None::<&[u8]>)?;
    }
    writer.flush()
}

/// Whether none of the names of inputs and constants has another meaning in tables.
///
/// # Errors
///
/// [`TableError::ReservedName`].
pub fn check_names<'a>(names: impl IntoIterator<Item = &'a String>) -> Result<(), TableError> {
    let is_reserved = |name: &str| {
        let number = name.strip_prefix("re_").or_else(|| name.strip_prefix("im_"));
        let is_part = number.is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()));
        is_part || [RUN, ERROR].contains(&name)
    };
    match names.into_iter().find(|name| is_reserved(name.trim())) {
        Some(name) => Err(TableError::ReservedName { name: printable::line(name, SHOWN_CELL) }),
        None => Ok(()),
    }
}
