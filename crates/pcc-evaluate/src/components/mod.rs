//! How components become eigenvalues again, and what is summed up of eigenvalues over a sample.

mod closed;
mod label;
mod recombination;
mod roots;
mod summary;
mod verdict;

pub use closed::{MOST_IN_CLOSED_GROUP, closed_eigenvalues, closed_pair};
pub use label::{Label, is_result_column};
pub use recombination::{Component, MOST_MODES, Output, OutputKind, is_equal_frequency, spectral_abscissa};
pub use roots::{is_safe_square, roots, square_root};
pub use summary::{Block, EigenvalueSummary, Summary, Top, damping_ratio};
pub use verdict::{Margin, Verdict, beyond_rounding};
