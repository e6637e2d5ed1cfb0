//! Spectra: which eigenvalues are modes, how they are followed, which belong together, and their derivatives.

mod closed_slopes;
mod clusters;
mod component_errors;
mod computation;
mod derivatives;
mod free_motion;
mod groups;
mod labels;
mod modes;
mod nearest;
mod printed_digits;
mod refinement;
mod solution;
mod target;

pub use clusters::{CLOSE, ClusterError, clusters};
pub use component_errors::component_errors;
pub use computation::{Computation, Reductions, Slopes};
pub use derivatives::ReducedSystem;
pub use free_motion::free_motion;
pub use groups::{Group, Groups};
pub use labels::{Labels, Vectors};
pub use modes::{Spectrum, SpectrumError};
pub use nearest::{largest_difference, nearest};
pub use solution::Solution;
pub use target::{Modes, Numbers, Target, components, components_of, decompose, output, with_ids};
