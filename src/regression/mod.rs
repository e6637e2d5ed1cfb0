//! Least squares on polynomial bases, with the error measures of section 3.3.2 of the paper.

mod basis;
mod errors;

pub use basis::{ActiveBasis, BasisTables};
pub use errors::{ErrorMeasures, Response, leave_one_out_residuals};
