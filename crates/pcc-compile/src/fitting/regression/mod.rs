//! Least squares on polynomial bases, with the error measures of section 3.3.2 of the paper.

mod basis;
mod equations;
mod errors;
mod tables;

pub use basis::{ActiveBasis, equation_weights, weigh_rows};
pub use equations::{Equations, Gradients, LeftOut, leave_runs_out};
pub use errors::{ErrorMeasures, Response, leave_one_out_residuals};
pub use tables::BasisTables;
