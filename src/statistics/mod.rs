//! Estimates from samples: proportions with their intervals, bounds that survive a wrong surrogate, moments that merge.

mod discordance;
mod moments;
mod proportion;

pub use discordance::Discordance;
pub use moments::Moments;
pub use proportion::{Interval, Proportion};
