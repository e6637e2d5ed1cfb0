//! A surrogate compiled into a plan, and the plan at a block of points in vector lanes.

pub(super) mod chunks;
pub(super) mod inner_loops;
pub(super) mod lanes;
pub(super) mod operations;
pub(super) mod plan;
pub(super) mod points;
pub(super) mod recombination;
pub(super) mod results;
