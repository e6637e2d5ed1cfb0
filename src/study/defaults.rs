//! Defaults of a study: at most one formula in the number of inputs r each.

use super::DesignKind;
use crate::spectrum::{Modes, Target};

pub(super) const SEED: u64 = 1;
pub(super) const MODES: Modes = Modes::All;

/// The paper's accuracy target and highest degree.
pub(super) const S2_TARGET: f64 = 0.999;
pub(super) const MAX_DEGREE: u16 = 15;

pub(super) const Q_NORM: f64 = 0.6;
pub(super) const EPSILON_FORWARD: f64 = 1e-5;
pub(super) const EPSILON_BACKWARD: f64 = 1e-5;

/// Where the paper's table stops; for invariants, where the matrices of the minimum-norm fit begin to cost minutes.
pub(super) fn maximum(target: Target) -> usize {
    match target {
        Target::Eigenvalues => 10_000,
        _ => 2_000,
    }
}

/// For invariants: a tenth of a percent of the proportion, a tenth of what the sampling of a few thousand runs leaves open.
pub(super) const PROPORTION_TOLERANCE: f64 = 1e-3;

/// The paper's designs for its own method, spread ones for invariants.
pub(super) fn design(target: Target) -> DesignKind {
    match target {
        Target::Eigenvalues => DesignKind::NestedLhs,
        _ => DesignKind::NestedMaximinLhs,
    }
}

/// Runs of the first level, and of each enrichment. Eigenvalues need some terms for every pair of inputs at high degree;
/// invariants few, and at least two levels to judge by, the second twice the first.
pub(super) fn level(target: Target, inputs: usize) -> usize {
    match target {
        Target::Eigenvalues => 15 * inputs * inputs,
        _ => (inputs * inputs + 7 * inputs).max(10),
    }
}
