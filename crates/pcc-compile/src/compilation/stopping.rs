//! The stopping rule: when a design is large enough.
//!
//! A build ends when every component is fitted well enough and, if the study asks for it, the estimated error of the
//! stability proportion is small enough and explains how many runs are undecided (`undecided.rs`); or when that error
//! has not fallen for [`PATIENCE`] levels while the design grew to [`GROWTH`] times its size; or at the largest design.

use super::decision::Judgement;
use crate::fitting::fit::Fitted;
use crate::study::Study;
use pcc_evaluate::surrogate::StopReason;

/// Levels without a lower estimate, and growth of the design over them, after which more runs are taken to be of no
/// use: where stability is within rounding of its limit everywhere, or where the model jumps.
const PATIENCE: usize = 4;
const GROWTH: usize = 2;

/// Whether a level is good enough, and whether the estimated error of the proportion still falls.
pub(super) struct StoppingRule {
    /// Estimated relative error of the proportion that is small enough; without it the fits alone decide.
    tolerance: Option<f64>,
    lowest: f64,
    /// Size of the design at the lowest estimate.
    at_size: usize,
    levels_since: usize,
}

impl StoppingRule {
    pub fn new(study: &Study) -> Self {
        Self {
            tolerance: study.fit.proportion_tolerance,
            lowest: f64::INFINITY,
            at_size: study.design.initial,
            levels_since: 0,
        }
    }

    /// Whether the fits of a level are the last word, whatever the proportion.
    pub fn needs_no_judgement(&self, fitted: &[Fitted]) -> bool {
        are_accurate(fitted) && self.tolerance.is_none()
    }

    /// Takes note of the estimated error at a size of the design.
    pub fn note(&mut self, error: Option<f64>, size: usize) {
        match error {
            Some(error) if error < self.lowest => {
                (self.lowest, self.at_size, self.levels_since) = (error, size, 0);
            }
            Some(_) => self.levels_since += 1,
            // Too few blind residuals yet: nothing is known to have stalled.
            None => {}
        }
    }

    /// Whether a level with these fits and this judgement is the last.
    pub fn holds(&self, fitted: &[Fitted], judgement: &Judgement, size: usize) -> bool {
        let is_small =
            |tolerance| !judgement.is_doubtful && judgement.reducible_error.is_some_and(|error| error <= tolerance);
        are_accurate(fitted) && (self.tolerance.is_none_or(is_small) || self.has_stalled(size))
    }

    fn has_stalled(&self, size: usize) -> bool {
        self.levels_since >= PATIENCE && size >= GROWTH * self.at_size
    }
}

/// Whether no component asks for a larger design.
fn are_accurate(fitted: &[Fitted]) -> bool {
    fitted.iter().all(|fit| fit.stop != StopReason::DesignExhausted)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(reducible_error: Option<f64>) -> Judgement {
        Judgement { reducible_error, ..Judgement::default() }
    }

    fn rule(tolerance: Option<f64>) -> StoppingRule {
        StoppingRule { tolerance, lowest: f64::INFINITY, at_size: 10, levels_since: 0 }
    }

    #[test]
    fn a_small_error_ends_the_build_and_a_large_one_does_not() {
        let mut rule = rule(Some(1e-3));
        rule.note(Some(2e-3), 10);
        assert!(!rule.holds(&[], &judged(Some(2e-3)), 10));
        assert!(rule.holds(&[], &judged(Some(1e-3)), 20));
        assert!(!rule.holds(&[], &judged(None), 20), "what is not known is not small");
        let doubtful = Judgement { is_doubtful: true, ..judged(Some(1e-3)) };
        assert!(!rule.holds(&[], &doubtful, 20), "one eigenvalue is not known well enough");
    }

    #[test]
    fn without_a_tolerance_the_fits_decide() {
        assert!(rule(None).needs_no_judgement(&[]) && rule(None).holds(&[], &judged(None), 10));
        assert!(!rule(Some(1e-3)).needs_no_judgement(&[]));
    }

    #[test]
    fn an_error_that_falls_no_more_ends_the_build_once_the_design_has_doubled() {
        let mut rule = rule(Some(1e-9));
        rule.note(Some(1e-3), 10);
        for size in [12, 14, 16] {
            rule.note(Some(2e-3), size);
            assert!(!rule.holds(&[], &judged(Some(2e-3)), size), "{size}");
        }
        rule.note(Some(2e-3), 18);
        assert!(!rule.holds(&[], &judged(Some(2e-3)), 18), "four levels, but not twice the size");
        assert!(rule.holds(&[], &judged(Some(2e-3)), 20));
        rule.note(Some(5e-4), 20);
        assert!(!rule.holds(&[], &judged(Some(5e-4)), 20), "it falls again");
    }
}
