//! What can be wrong with a table of results, in the order in which it is found.

use super::results_table::{LARGEST_CELL, LARGEST_ROW};
use thiserror::Error;

/// Why a table of results cannot be used. Lines count from 1 at the header.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum TableError {
    /// The operating system refused.
    #[error("cannot be read: {cause}")]
    Unreadable {
        /// What it said.
        cause: String,
    },
    /// An input has the name of a column with another meaning.
    #[error(
        "an input or constant is called {name}, but that column has another meaning in tables; give it another name"
    )]
    ReservedName {
        /// The name.
        name: String,
    },
    /// There is nothing.
    #[error("is empty; write a header with the columns run, re_1, im_1 and so on")]
    Empty,
    /// Columns of eigenvalues are missing.
    #[error(
        "there is no column {names}; the header is \"{header}\"; add what is missing, and separate columns by commas"
    )]
    MissingColumns {
        /// Names of the first few.
        names: String,
        /// Line 1.
        header: String,
    },
    /// A column is there twice.
    #[error("column {column} is there twice; remove one")]
    RepeatedColumn {
        /// Its name.
        column: String,
    },
    /// Rows say neither which run nor which point they are about.
    #[error("there is no column run, and no column {names} instead; the header is \"{header}\"; add either")]
    NoIdentity {
        /// Names of the inputs that are missing.
        names: String,
        /// Line 1.
        header: String,
    },
    /// There are more columns of eigenvalues than expected.
    #[error(
        "there is a column {column}, but the number of eigenvalues is {expected}; remove the column or correct the \
         number"
    )]
    MoreEigenvalues {
        /// Name of the first column too many.
        column: String,
        /// Eigenvalues of a run.
        expected: usize,
    },
    /// A row is very long, often because a quote is not closed.
    #[error("line {line}: the row is longer than {LARGEST_ROW} bytes; is this a table, and is every quote closed?")]
    RowTooLarge {
        /// Where it starts, or the empty lines before it.
        line: u64,
    },
    /// A row is longer or shorter than the header.
    #[error(
        "line {line}: there are {found} cells, but {expected} columns; write one cell for each, and 0.25, not 0,25"
    )]
    CellCount {
        /// Where the row starts.
        line: u64,
        /// Cells of the row.
        found: usize,
        /// Cells of the header.
        expected: usize,
    },
    /// A cell is very long.
    #[error("line {line}, column {column}: the cell has {length} bytes; at most {LARGEST_CELL} are read")]
    CellTooLarge {
        /// Where the row starts.
        line: u64,
        /// Name of the column.
        column: String,
        /// Bytes of the cell.
        length: usize,
    },
    /// A cell that is needed is empty.
    #[error(
        "line {line}, column {column}: the cell is empty; give its number, or leave out all eigenvalues of the run"
    )]
    EmptyCell {
        /// Where the row starts.
        line: u64,
        /// Name of the column.
        column: String,
    },
    /// A cell is not a number.
    #[error("line {line}, column {column}: \"{found}\" is not a number; write it as 0.25 or 2.5e-1")]
    NotANumber {
        /// Where the row starts.
        line: u64,
        /// Name of the column.
        column: String,
        /// The cell.
        found: String,
    },
    /// A cell is NaN, infinite, or too large for double precision.
    #[error("line {line}, column {column}: \"{found}\" is not finite; say in a column \"error\" why the run failed")]
    NotFinite {
        /// Where the row starts.
        line: u64,
        /// Name of the column.
        column: String,
        /// The cell.
        found: String,
    },
    /// A run is not a whole number.
    #[error("line {line}, column run: \"{found}\" is not the number of a run; write a whole number")]
    NotARun {
        /// Where the row starts.
        line: u64,
        /// The cell.
        found: String,
    },
    /// Two rows are about the same run.
    #[error("line {line}: run {run} is already in line {first}; remove one")]
    RepeatedRun {
        /// Where the second row starts.
        line: u64,
        /// Where the first starts.
        first: u64,
        /// The run.
        run: u64,
    },
}
