//! Estimates from samples: proportions with their intervals, moments that merge.

mod moments;
mod proportion;

pub use moments::Moments;
pub use proportion::{Interval, Proportion};
