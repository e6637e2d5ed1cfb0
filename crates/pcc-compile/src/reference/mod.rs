//! Direct computations on many points: the paper's MCIM, and surrogates judged and certified against it.

mod certify;
mod compare;
mod direct_computations;
mod sample;

pub use certify::certify;
pub use compare::{Comparison, ComponentError, compare};
pub use direct_computations::{Reference, ReferenceError, check_problem, monte_carlo};
pub use sample::ModelSample;
