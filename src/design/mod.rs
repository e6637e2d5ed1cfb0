//! Experimental designs: where the model is run, and what it answered.

mod latin_hypercube;
mod ledger;
mod results;
mod run;
mod samples;
mod spread;
mod tensor_gauss;

pub use latin_hypercube::NestedLatinHypercube;
pub use ledger::{Asked, Campaign, Failure, Ledger};
pub use results::{Harvest, RowProblem, harvest};
pub use run::{Run, RunError, Runner};
pub use samples::Samples;
pub use tensor_gauss::TensorGauss;
