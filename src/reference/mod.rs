//! Direct computations on many points: the paper's MCIM, and surrogates judged against it.

mod compare;
mod monte_carlo;

pub use compare::{Comparison, ComponentError, compare};
pub use monte_carlo::{Reference, ReferenceError, monte_carlo};
