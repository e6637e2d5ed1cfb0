//! Random numbers, statistics, and the laws of uncertain inputs.

pub mod dependence;
pub mod inputs;
pub mod random;
pub mod statistics;
