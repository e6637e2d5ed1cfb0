//! Spectra: which eigenvalues are modes, in which order, and how components become eigenvalues again.

mod clusters;
mod computation;
mod derivatives;
mod modes;
mod recombination;
mod summary;
mod target;

pub use clusters::{ClusterError, clusters};
pub use computation::{Computation, Reduction};
pub use derivatives::ReducedSystem;
pub use modes::{Spectrum, SpectrumError};
pub use recombination::{Component, Output, OutputKind, is_equal_frequency, spectral_abscissa};
pub use summary::{Block, ModeSummary, Summary, damping_ratio};
pub use target::{Modes, Target, components};
