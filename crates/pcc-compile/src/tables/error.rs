//! What can be wrong with a table of runs, in the order in which it is found.

use super::text::TextError;
use pcc_evaluate::foundation::plural;
use pcc_evaluate::probability::inputs::InputError;
use std::fmt;
use thiserror::Error;

/// Rows that are named when they cannot be taken.
const SHOWN_ROWS: usize = 10;

/// Names of a list that a message shows.
const SHOWN_NAMES: usize = 4;

/// Why a table gives no runs.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DataError {
    /// It cannot be read.
    #[error(transparent)]
    Text(#[from] TextError),
    /// There is nothing, not even a header.
    #[error("{file} is empty; write a header with the names of the inputs and re_1, im_1 and so on")]
    Empty {
        /// The file.
        file: String,
    },
    /// Columns of inputs are missing.
    #[error(
        "{file} has no column {}; the header is {header:?}; name every input in the first line, as the study does, and \
         separate columns by commas, semicolons or tabs, or say --delimiter",
        listed(names)
    )]
    NoInputs {
        /// The file.
        file: String,
        /// Names of the inputs.
        names: Vec<String>,
        /// The first line.
        header: String,
    },
    /// There are no eigenvalues.
    #[error(
        "{file} has no eigenvalues; the header is {header:?}; call them re_1, im_1, re_2, im_2 and so on (real_1 and so on \
         for some that are real in every row)"
    )]
    NoEigenvalues {
        /// The file.
        file: String,
        /// The first line.
        header: String,
    },
    /// A column is there, but not the one that belongs to it.
    #[error("{file} has a column {has}, but none {misses}; {remedy}")]
    NoPartner {
        /// The file.
        file: String,
        /// The column that is there.
        has: String,
        /// The column that is missing.
        misses: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A column is there more than once.
    #[error("{file} has {column:?} as the name of several columns; rename all but one of them")]
    SeveralTimes {
        /// The file.
        file: String,
        /// Its name.
        column: String,
    },
    /// There are more or fewer eigenvalues than there should be.
    #[error("{file} has columns of {found} eigenvalues; {expected} in {by}")]
    OtherEigenvalues {
        /// The file.
        file: String,
        /// Eigenvalues of its columns.
        found: usize,
        /// How many there should be.
        expected: usize,
        /// Who says so.
        by: String,
    },
    /// There are no rows below the header.
    #[error("{files} has no rows below the header; give the runs, a row each")]
    NoRows {
        /// The files.
        files: String,
    },
    /// Rows cannot be taken.
    #[error("{} cannot be taken, so none was:\n{}", plural(.0.len(), "row"), shown(.0))]
    Rows(Vec<RowProblem>),
    /// An input has the same value in every row, and the model cannot be run.
    #[error(
        "{name} is {value:?} in every row, so that nothing is known of its influence; give runs in which it varies, or remove it \
         from [inputs]"
    )]
    ConstantInput {
        /// Name of the input.
        name: String,
        /// Its value.
        value: f64,
    },
}

/// Why a row cannot be taken.
#[derive(Debug, Clone, PartialEq)]
pub struct RowProblem {
    /// The file.
    pub file: String,
    /// Its line, from 1 at the first of the file.
    pub line: u64,
    /// What is wrong.
    pub kind: RowProblemKind,
}

/// What is wrong with a row.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RowProblemKind {
    /// It is longer or shorter than the header.
    #[error(
        "there are {found} cells, but {expected} columns; write one cell for each column; of numbers with decimal commas, \
         separate columns by semicolons"
    )]
    CellCount {
        /// Cells of the row.
        found: usize,
        /// Cells of the header.
        expected: usize,
    },
    /// A cell that is needed is empty.
    #[error("{column} is empty; fill it in, or remove the line")]
    EmptyCell {
        /// Name of the column.
        column: String,
    },
    /// A cell is no number.
    #[error("{column} is {found:?}, no finite number; correct it, or remove the line")]
    NotANumber {
        /// Name of the column.
        column: String,
        /// The cell.
        found: String,
    },
    /// A number with a comma for the point.
    #[error("{column} is {found:?}, with a decimal comma; say --decimal comma, or in the study decimal = \"comma\"")]
    DecimalComma {
        /// Name of the column.
        column: String,
        /// The cell.
        found: String,
    },
    /// A number with a point, where commas are decimal points.
    #[error("{column} is {found:?}, with a point, where decimal commas were announced; write one or the other")]
    DecimalPoint {
        /// Name of the column.
        column: String,
        /// The cell.
        found: String,
    },
    /// The point is none of the inputs' domain.
    #[error("{0}; remove the line, or widen the law")]
    Outside(InputError),
    /// The run failed.
    #[error("the run failed ({cause}); remove the line, or say on_failure = \"skip\" in the study")]
    Failed {
        /// Why.
        cause: String,
    },
    /// All eigenvalues are zero.
    #[error("all eigenvalues are zero; correct them, or remove the line")]
    OnlyZeros,
    /// There are more or fewer eigenvalues than in the first row, conjugates counted.
    #[error(
        "there are {found} eigenvalues, conjugates counted, but {expected} in the first row; where a mode has two real eigenvalues \
         instead of a pair, give both"
    )]
    Eigenvalues {
        /// Eigenvalues here.
        found: usize,
        /// Eigenvalues in the first row.
        expected: usize,
    },
    /// Another row has the same point and another answer.
    #[error(
        "the same point as {other}, but eigenvalues differ by {difference:.1e} 1/s; remove the wrong one, or give the mean of \
         repeated measurements"
    )]
    Contradiction {
        /// The other row.
        other: String,
        /// Largest difference of an eigenvalue, in 1/s.
        difference: f64,
    },
}

impl fmt::Display for RowProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, line {}: {}", self.file, self.line, self.kind)
    }
}

fn shown(problems: &[RowProblem]) -> String {
    let lines: Vec<String> = problems.iter().take(SHOWN_ROWS).map(|problem| format!("  {problem}")).collect();
    let more = match problems.len().saturating_sub(SHOWN_ROWS) {
        0 => String::new(),
        more => format!("\n  and {}", plural(more, "other row")),
    };
    lines.join("\n") + &more
}

fn listed(names: &[String]) -> String {
    let more = if names.len() > SHOWN_NAMES { ", …" } else { "" };
    names.iter().take(SHOWN_NAMES).map(String::as_str).collect::<Vec<_>>().join(", ") + more
}
