//! Spectra: which eigenvalues are modes, how they are followed, which belong together, and their derivatives.

mod closed_slopes;
mod clusters;
mod computation;
mod derivatives;
mod groups;
mod labels;
mod modes;
mod nearest;
mod target;

pub use clusters::{CLOSE, ClusterError, clusters};
pub use computation::{Computation, Reductions};
pub use derivatives::ReducedSystem;
pub use groups::{Group, Groups};
pub use labels::{Labels, Vectors};
pub use modes::{Spectrum, SpectrumError};
pub use nearest::nearest;
pub use target::{Modes, Numbers, Target, components, components_of, decompose, output, with_ids};
