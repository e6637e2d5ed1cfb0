//! The ways a Matrix Market file can be wrong.

use super::LARGEST_DIMENSION;
use std::fmt;
use thiserror::Error;

/// Characters of a line that errors quote.
const EXCERPT: usize = 60;

/// A line of a file, as errors quote it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Number of the line, from 1.
    pub line: usize,
    /// Its text, shortened.
    pub text: String,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, {:?}", self.line, self.text)
    }
}

/// Why a text is not a Matrix Market file that can be read.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum MatrixMarketError {
    /// The first line is no header.
    #[error(
        "{0}, is not a Matrix Market header; the first line reads \
         \"%%MatrixMarket matrix FORMAT FIELD SYMMETRY\", as in \"%%MatrixMarket matrix coordinate real general\""
    )]
    Header(Place),
    /// A format, field or symmetry that is not read.
    #[error(
        "{place}: {word:?} is not supported; supported are the formats coordinate and array, the fields real and \
         integer, and the symmetries general, symmetric and skew-symmetric"
    )]
    Unsupported {
        /// The word.
        word: String,
        /// The first line.
        place: Place,
    },
    /// There is nothing after the header and the comments.
    #[error("the file ends before the line with the size of the matrix; is it complete?")]
    NoSize,
    /// The line with the size is not made of numbers.
    #[error("{place}: expected {expected}, as whole numbers")]
    Size {
        /// The numbers expected.
        expected: &'static str,
        /// The line.
        place: Place,
    },
    /// The matrix has too many rows or columns.
    #[error("{0}: a matrix may have at most {LARGEST_DIMENSION} rows and columns; reduce the model first")]
    TooLarge(Place),
    /// A symmetric or skew-symmetric matrix with other numbers of rows and columns.
    #[error(
        "{0}: a symmetric or skew-symmetric matrix has as many rows as columns; correct them, or write \"general\""
    )]
    NotSquare(Place),
    /// The line of an entry is not made of the right words.
    #[error("{place}: expected {expected}")]
    Entry {
        /// The words expected.
        expected: &'static str,
        /// The line.
        place: Place,
    },
    /// A value is NaN, infinite, or too large for an f64.
    #[error("{0}: the value is not a finite number; correct it")]
    NotFinite(Place),
    /// A fraction in an integer file.
    #[error("{0}: the first line promises integers; correct the value, or write \"real\" there")]
    NotInteger(Place),
    /// An index is zero or beyond the matrix.
    #[error("{place}: the matrix is {rows} × {columns}, with indices from 1; correct the entry or the size")]
    OutOfRange {
        /// Number of rows of the matrix.
        rows: usize,
        /// Number of columns of the matrix.
        columns: usize,
        /// The line.
        place: Place,
    },
    /// An entry above the diagonal of a symmetric or skew-symmetric matrix.
    #[error(
        "{0}: files of (skew-)symmetric matrices hold the lower triangle, column ≤ row, only; \
         drop the entry, or write \"general\" in the first line and all entries below"
    )]
    AboveDiagonal(Place),
    /// An entry on the diagonal of a skew-symmetric matrix.
    #[error("{0}: the diagonal of a skew-symmetric matrix is zero and not stored; drop the entry")]
    OnDiagonal(Place),
    /// The file ends early.
    #[error("the file ends after {found} entries of {expected}; is it complete?")]
    TooFew {
        /// Number of entries found.
        found: usize,
        /// Number of entries promised.
        expected: usize,
    },
    /// The file goes on after the last entry.
    #[error("{place}: the file must end after {expected} entries; correct the line with the size, or drop the rest")]
    TooMany {
        /// Number of entries promised.
        expected: usize,
        /// The first line too many.
        place: Place,
    },
    /// The values of an entry that appears several times have no finite sum.
    #[error("the values given for row {row}, column {column} add up to more than an f64 can hold; correct them")]
    Overflow {
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
    },
}

/// The beginning of a text.
pub(super) fn excerpt(text: &str) -> String {
    match text.char_indices().nth(EXCERPT) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
