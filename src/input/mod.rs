//! Uncertain inputs: their distributions, and the map between physical and standardized variables.

mod marginal;
mod monte_carlo;
mod space;

pub use marginal::{Marginal, MarginalError, Uniform};
pub use monte_carlo::random_point;
pub use space::{Input, InputError, InputSpace};
