//! Tables that people and programs have written: their text, their numbers, and the runs of a model in them.

mod columns;
mod error;
mod runs;
#[cfg(test)]
mod tests;
mod text;

pub use error::{DataError, RowProblem, RowProblemKind};
pub use runs::{Answer, DataFile, GivenRun, GivenRuns, RunsReader};
pub use text::{Decimal, Dialect, TextError, separator};
pub(crate) use text::{delimiter, is_decimal_comma, line, number, read_text};
