//! Defaults of a study: at most one formula in the number of inputs r each.

use crate::spectrum::Modes;

pub(super) const SEED: u64 = 1;
pub(super) const MODES: Modes = Modes::All;

/// The paper's accuracy target and highest degree.
pub(super) const S2_TARGET: f64 = 0.999;
pub(super) const MAX_DEGREE: u16 = 15;

pub(super) const Q_NORM: f64 = 0.6;
pub(super) const EPSILON_FORWARD: f64 = 1e-5;
pub(super) const EPSILON_BACKWARD: f64 = 1e-5;

/// Where the paper's table stops.
pub(super) const MAXIMUM: usize = 10_000;

pub(super) fn initial(inputs: usize) -> usize {
    15 * inputs * inputs
}

pub(super) fn step(inputs: usize) -> usize {
    15 * inputs * inputs
}
