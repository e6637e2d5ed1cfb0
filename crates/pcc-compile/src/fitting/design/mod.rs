//! Experimental designs: the points at which a model is run.

mod latin_hypercube;
mod samples;
mod spread;
mod tensor_gauss;

pub use latin_hypercube::NestedLatinHypercube;
pub use samples::Samples;
pub use tensor_gauss::TensorGauss;
