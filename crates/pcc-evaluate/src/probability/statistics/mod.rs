//! Estimates from samples: proportions with their intervals, bounds that survive a wrong surrogate, moments that merge.

mod binomial_tail;
mod density;
mod falling_errors;
mod merge_tree;
mod moments;
mod proportion;
mod replicates;
mod stratified_bound;
mod verified_bound;

pub use density::density;
pub use falling_errors::{FarErrors, NoBound, Thinning};
pub use merge_tree::{Merge, MergeTree};
pub use moments::Moments;
pub use proportion::{Interval, Proportion};
pub use replicates::Share;
pub use stratified_bound::{ClassDiscordance, StratifiedCounts, StratumCounts, bound_of_class};
pub use verified_bound::DiscordantCounts;
