//! Spectra: which eigenvalues are modes, in which order, which belong together, and their derivatives.

mod clusters;
mod computation;
mod derivatives;
mod modes;
mod target;

pub use clusters::{ClusterError, clusters};
pub use computation::{Computation, Reduction};
pub use derivatives::ReducedSystem;
pub use modes::{Spectrum, SpectrumError};
pub use target::{Modes, Target, components, decompose};
