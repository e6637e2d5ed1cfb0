//! Dependence of uncertain inputs: a Gaussian copula, given by correlations of normal scores.

mod copula;
mod factor;

pub use copula::{CopulaError, Correlation, GaussianCopula, LEAST_LEFT};
pub use factor::Factor;
