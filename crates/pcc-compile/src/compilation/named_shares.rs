//! Shares that a study names, beside those of stable and unstable points: how often points are marginal, flutter or
//! diverge.
//!
//! They are estimated like the share that is not unstable, from the same residuals at the same points (`decision.rs`).
//! A share counts if it *varies*: some points or runs are of it, and some are not. Then an estimate takes three runs of
//! either kind, as for the rarer side of the boundary.

use super::blindness::LEAST_RARE;
use super::judgement::JudgedShare;
use pcc_evaluate::components::Verdict;

/// A share that a study names, as a level knows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct NamedShare {
    /// What its points have in common.
    pub verdict: Verdict,
    /// The share.
    pub share: JudgedShare,
    /// Runs that are of it, and that are not.
    pub runs: [usize; 2],
    /// Its estimated error, in points of probability.
    pub error: Option<f64>,
    /// The same without the parts that more runs do not lower, or are not worth.
    pub reducible_error: Option<f64>,
}

impl NamedShare {
    /// Whether some points or runs are of it, and some are not.
    fn varies(&self) -> bool {
        let is_part = self.share.value > 0.0 && self.share.value < 1.0;
        is_part || self.runs.iter().all(|&runs| runs > 0)
    }

    /// Whether too few runs are of it, or are not, for an estimate.
    pub fn is_blind(&self) -> bool {
        self.varies() && self.runs.iter().any(|&runs| runs < LEAST_RARE)
    }

    /// Whether it is known to this tolerance: error ≤ tol √(p (1 − p)).
    pub fn is_within(&self, tolerance: f64) -> bool {
        let small = tolerance * self.share.deviation();
        !self.varies() || (!self.is_blind() && self.reducible_error.is_some_and(|error| error <= small))
    }

    /// Its error relative to √(p (1 − p)), if it varies and that is known.
    pub fn relative_error(&self) -> Option<f64> {
        let error = self.reducible_error.or(self.error).filter(|_| self.varies())?;
        Some(error / self.share.deviation())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(value: f64, runs: [usize; 2], error: f64) -> NamedShare {
        let share = JudgedShare { value, points: 50_000 };
        NamedShare { verdict: Verdict::Divergence, share, runs, error: None, reducible_error: Some(error) }
    }

    #[test]
    fn a_share_is_known_by_three_runs_of_either_kind_and_a_small_error() {
        let small = 1e-3 * (0.1_f64 * 0.9).sqrt();
        assert!(named(0.1, [3, 20], 0.99 * small).is_within(1e-3));
        assert!(!named(0.1, [3, 20], 1.01 * small).is_within(1e-3));
        assert!(!named(0.1, [2, 20], 0.0).is_within(1.0) && !named(0.1, [20, 2], 0.0).is_within(1.0));
        assert!(!NamedShare { reducible_error: None, ..named(0.1, [3, 20], 0.0) }.is_within(1.0));
    }

    #[test]
    fn a_share_that_does_not_occur_asks_for_nothing() {
        for share in [named(0.0, [0, 20], 1.0), named(1.0, [20, 0], 1.0)] {
            assert!(share.is_within(1e-5) && !share.is_blind() && share.relative_error().is_none());
        }
        assert!(named(0.0, [1, 20], 0.0).is_blind(), "a run was of it");
        assert!(named(1e-4, [0, 20], 0.0).is_blind(), "points are of it");
    }
}
