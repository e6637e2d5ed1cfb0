//! Dependence of uncertain inputs: a Gaussian copula, given by correlations of normal scores.

mod copula;
mod factor;

pub use copula::{CopulaError, Correlation, GaussianCopula};
pub use factor::Factor;
