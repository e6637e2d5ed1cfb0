//! Estimates from samples: proportions with their intervals, bounds that survive a wrong surrogate, moments that merge.

mod binomial_tail;
mod density;
mod merge_tree;
mod moments;
mod proportion;
mod replicates;
mod verified_bound;

pub use density::density;
pub use merge_tree::{Merge, MergeTree};
pub use moments::Moments;
pub use proportion::{Interval, Proportion};
pub use replicates::Share;
pub use verified_bound::DiscordantCounts;
