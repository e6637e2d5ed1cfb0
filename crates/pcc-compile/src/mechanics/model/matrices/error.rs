//! What can be wrong with matrices in a study.

use super::matrix_market::MatrixMarketError;
use pcc_expressions::ExpressionError;
use thiserror::Error;

/// Why matrices cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MatricesError {
    /// A value of another shape.
    #[error("is {found}; write {expected}")]
    Shape {
        /// What is there.
        found: String,
        /// What should be.
        expected: &'static str,
    },
    /// A word for a form that does not exist.
    #[error("form {found} is not known; choose \"general\", \"symmetric\" or \"skew-symmetric\"")]
    UnknownForm {
        /// The word.
        found: String,
    },
    /// A term without entries.
    #[error("a term has one of the keys rows, diagonal, entries and file; add it")]
    NoLayout,
    /// A term with two lists of entries.
    #[error("a term has either {first} or {second}; make two terms of them")]
    TwoLayouts {
        /// One key.
        first: &'static str,
        /// The other.
        second: &'static str,
    },
    /// A key that terms do not have.
    #[error("{key} is not known; a term has rows, diagonal, entries with size, or file, and may have form and factor")]
    UnknownKey {
        /// The key.
        key: String,
    },
    /// A key of other layouts.
    #[error("{key} belongs to {layout}; remove it")]
    KeyOfLayout {
        /// The key.
        key: &'static str,
        /// Where it belongs.
        layout: &'static str,
    },
    /// A form where there is nothing to mirror.
    #[error("form belongs to rows and entries, not to {layout}; remove it")]
    FormOfLayout {
        /// The layout.
        layout: &'static str,
    },
    /// A list of entries without the size of the matrix.
    #[error("entries need a size, the number of rows; add size = …")]
    NoSize,
    /// A file cannot be read.
    #[error("{file} cannot be read: {cause}")]
    Unreadable {
        /// Its name.
        file: String,
        /// Why.
        cause: String,
    },
    /// A file is no Matrix Market file.
    #[error("{file}: {cause}")]
    MatrixMarket {
        /// Its name.
        file: String,
        /// Why.
        #[source]
        cause: Box<MatrixMarketError>,
    },
    /// A needed matrix is missing.
    #[error("{0}")]
    Incomplete(&'static str),
    /// A matrix without rows, or too large.
    #[error("{matrix} has {size} rows; matrices have 1 to {most}")]
    Size {
        /// Name of the matrix.
        matrix: &'static str,
        /// Its rows.
        size: usize,
        /// The most it may have.
        most: usize,
    },
    /// A row of the wrong length.
    #[error("{matrix}: row {row} has {found} entries, but should have {expected}{hint}")]
    RowLength {
        /// Name of the matrix.
        matrix: &'static str,
        /// Row, from 1.
        row: usize,
        /// Its entries.
        found: usize,
        /// What it should have.
        expected: usize,
        /// Why, if that is not plain.
        hint: &'static str,
    },
    /// Matrices or terms of different sizes, or a file that is not square.
    #[error("{matrix}: a term is {rows} × {columns}, but the system has {size} rows")]
    TermSize {
        /// Name of the matrix.
        matrix: &'static str,
        /// Rows of the term.
        rows: usize,
        /// Columns of the term.
        columns: usize,
        /// Rows of the first term of the first matrix.
        size: usize,
    },
    /// An entry outside the matrix.
    #[error("{matrix}: there is no entry ({row}, {column}) in a matrix with {size} rows")]
    NoSuchEntry {
        /// Name of the matrix.
        matrix: &'static str,
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// Rows of the matrix.
        size: usize,
    },
    /// An entry is written twice.
    #[error("{matrix}: entry ({row}, {column}) is written twice in a term; add them up, or make two terms of them")]
    Repeated {
        /// Name of the matrix.
        matrix: &'static str,
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
    },
    /// A skew-symmetric matrix with something on its diagonal.
    #[error("{matrix}: entry ({row}, {row}) of a skew-symmetric term must be 0")]
    SkewDiagonal {
        /// Name of the matrix.
        matrix: &'static str,
        /// Row, from 1.
        row: usize,
    },
    /// An entry that is no expression.
    #[error("{matrix}, row {row}, column {column}: {cause}")]
    Entry {
        /// Name of the matrix.
        matrix: &'static str,
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// Why.
        #[source]
        cause: Box<ExpressionError>,
    },
    /// A factor that is no expression.
    #[error("{matrix}, factor of term {term}: {cause}")]
    Factor {
        /// Name of the matrix.
        matrix: &'static str,
        /// Term, from 1.
        term: usize,
        /// Why.
        #[source]
        cause: Box<ExpressionError>,
    },
    /// A name that cannot be used, or a helper that is no expression.
    #[error("{table}.{name}: {cause}")]
    Name {
        /// `inputs`, `model.constants` or `model.let`.
        table: &'static str,
        /// The name.
        name: String,
        /// Why.
        #[source]
        cause: Box<ExpressionError>,
    },
    /// An entry that is no number: at a point, or whatever the inputs.
    #[error("{matrix}, row {row}, column {column}: {text} is {value}; entries must be finite numbers")]
    NotFinite {
        /// Name of the matrix.
        matrix: &'static str,
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// The entry as it is written.
        text: String,
        /// Its value.
        value: f64,
    },
    /// A factor that is no number: at a point, or whatever the inputs.
    #[error("{matrix}, factor of term {term}: {text} is {value}; factors must be finite numbers")]
    FactorNotFinite {
        /// Name of the matrix.
        matrix: &'static str,
        /// Term, from 1.
        term: usize,
        /// The factor as it is written.
        text: String,
        /// Its value.
        value: f64,
    },
    /// An entry or factor that is a number, but has no finite derivative.
    #[error(
        "{matrix}, {place}: the derivative of {text} by {input} is {value}; keep the input away from there, or set fit.derivatives = \
         false"
    )]
    Slope {
        /// Name of the matrix.
        matrix: &'static str,
        /// Row and column, or the term whose factor it is.
        place: String,
        /// The expression as it is written.
        text: String,
        /// The input.
        input: String,
        /// The derivative.
        value: f64,
    },
    /// All expressions together are too long.
    #[error(transparent)]
    Program(Box<ExpressionError>),
    /// An input that nothing depends on.
    #[error("input {name} is in no matrix; use it in an entry, or remove it from inputs")]
    UnusedInput {
        /// The input.
        name: String,
    },
    /// A constant mass matrix without an inverse.
    #[error("M is singular; every degree of freedom needs a mass, so condense those without")]
    SingularMass,
}

impl MatricesError {
    /// Name of the matrix that is wrong, if it is one.
    pub fn matrix(&self) -> Option<&'static str> {
        match self {
            Self::Size { matrix, .. }
            | Self::RowLength { matrix, .. }
            | Self::TermSize { matrix, .. }
            | Self::NoSuchEntry { matrix, .. }
            | Self::Repeated { matrix, .. }
            | Self::SkewDiagonal { matrix, .. }
            | Self::Entry { matrix, .. }
            | Self::Factor { matrix, .. }
            | Self::NotFinite { matrix, .. }
            | Self::FactorNotFinite { matrix, .. }
            | Self::Slope { matrix, .. } => Some(matrix),
            Self::SingularMass => Some("M"),
            _ => None,
        }
    }
}
