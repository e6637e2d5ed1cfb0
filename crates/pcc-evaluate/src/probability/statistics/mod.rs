//! Estimates from samples: proportions with their intervals, bounds that survive a wrong surrogate, moments that merge.

mod density;
mod discordance;
mod forest;
mod moments;
mod proportion;
mod replicates;

pub use density::density;
pub use discordance::Discordance;
pub use forest::{Forest, Merge};
pub use moments::Moments;
pub use proportion::{Interval, Proportion};
pub use replicates::Share;
