//! Univariate polynomials that are orthonormal under a probability density.

mod recurrence;

pub use recurrence::{Family, Recurrence};
