//! How components become eigenvalues again, and what is summed up of eigenvalues over a sample.

mod recombination;
mod roots;
mod summary;

pub use recombination::{Component, MOST_MODES, Output, OutputKind, is_equal_frequency, spectral_abscissa};
pub use roots::{is_safe_square, roots, square_root};
pub use summary::{Block, ModeSummary, Summary, damping_ratio};
