//! The stopping rule: when a design is large enough.
//!
//! A build ends when every component is fitted well enough and, if the study asks for it, the estimated error ε of the
//! share p that is not unstable is small enough, ε ≤ tol √(p (1 − p)), and explains how many runs are undecided
//! (`undecided.rs`). Stable and unstable count alike: an error of tol/2 of a half is one of tol/√p of a small share p,
//! whichever side it is of. Where fewer than three runs lie on the rarer side, no error is small enough
//! (`blindness.rs`). It ends as well when more runs are of no use: when that error has fallen more slowly than 1/√N for
//! [`PATIENCE`] levels, over which the design grew to [`GROWTH`] times its size; when the fits have cost more than a
//! model that is quickly run is worth; or at the largest design.

use super::judgement::Judgement;
use crate::fitting::fit::Fitted;
use crate::study::Study;
use pcc_evaluate::surrogate::StopReason;

/// Levels without a much lower estimate, and growth of the design over them, after which more runs are taken to be of
/// no use: where answers are noisy, stability is within rounding of its limit everywhere, or the model jumps.
const PATIENCE: usize = 4;
const GROWTH: usize = 2;

/// Work of fits ([`super::components::ComponentFit::work`]) after which no further level is begun, if the model is one
/// that `pcc` computes and the study does not say how many runs it is worth: about ten seconds of one processor. A
/// run of such a model takes less than one.
const MOST_WORK: u64 = 12_000_000_000;

/// Levels that are fitted whatever they cost: a first one is not judged, and groups change.
const LEAST_LEVELS: usize = 2;

/// Why a build ended before everything was as good as the study asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum EarlyEnd {
    /// The estimated error of the proportion hardly falls any more.
    ErrorStalled,
    /// The fits cost more than more runs are worth.
    FitsCostMore,
    /// Too few runs lie on the rarer side for an estimate, and more have not found it.
    Blind,
    /// The design is as large as the study allows, and no component asks for a larger one.
    LargestDesign,
    /// The runs that are given are all that there is.
    DataExhausted,
    /// The user asked to stop and to take what there is.
    Interrupted,
}

impl EarlyEnd {
    /// The word of the record.
    pub fn name(self) -> &'static str {
        match self {
            Self::ErrorStalled => "error-stalled",
            Self::FitsCostMore => "fits-cost-more",
            Self::Blind => "blind",
            Self::LargestDesign => "largest-design",
            Self::DataExhausted => "data-exhausted",
            Self::Interrupted => "interrupted",
        }
    }
}

/// Whether a level is good enough, and whether the estimated error of the proportion still falls.
pub(super) struct StoppingRule {
    /// Estimated error of the share that is small enough, relative to √(p (1 − p)); without it the fits alone decide.
    tolerance: Option<f64>,
    /// Work that fits may take.
    most_work: u64,
    /// Size of the design and estimated error of the share, level by level.
    errors: Vec<(usize, f64)>,
    levels: usize,
}

impl StoppingRule {
    pub fn new(study: &Study) -> Self {
        let most_work = if study.model.is_external() || study.limits_runs() { u64::MAX } else { MOST_WORK };
        Self { tolerance: study.fit.proportion_tolerance, most_work, errors: Vec::new(), levels: 0 }
    }

    /// Whether the fits of a level are the last word, whatever the proportion.
    pub fn needs_no_judgement(&self, fitted: &[Fitted]) -> bool {
        are_accurate(fitted) && self.tolerance.is_none()
    }

    /// Takes note of the estimated error at a size of the design.
    pub fn note(&mut self, error: Option<f64>, size: usize) {
        self.levels += 1;
        self.errors.extend(error.map(|error| (size, error)));
    }

    /// Whether a level with these fits and this judgement is good enough.
    pub fn holds(&self, fitted: &[Fitted], judgement: &Judgement) -> bool {
        are_accurate(fitted) && self.tolerance.is_none_or(|tolerance| judgement.is_within(tolerance))
    }

    /// Whether no component asks for a larger design.
    pub fn are_accurate(&self, fitted: &[Fitted]) -> bool {
        are_accurate(fitted)
    }

    /// Why a level that is not good enough is the last nevertheless, after so much work of fits.
    pub fn early_end(&self, fitted: &[Fitted], work: u64) -> Option<EarlyEnd> {
        if are_accurate(fitted) && self.has_stalled() {
            return Some(EarlyEnd::ErrorStalled);
        }
        (self.levels >= LEAST_LEVELS && work > self.most_work).then_some(EarlyEnd::FitsCostMore)
    }

    /// Why the largest design is the last although it is not good enough, unless components say so themselves.
    pub fn end_at_largest_design(&self, fitted: &[Fitted]) -> Option<EarlyEnd> {
        are_accurate(fitted).then_some(EarlyEnd::LargestDesign)
    }

    /// Whether the lowest of the last estimates is above what 1/√N makes of those before.
    fn has_stalled(&self) -> bool {
        let Some((former, last)) = self.errors.len().checked_sub(PATIENCE).map(|at| self.errors.split_at(at)) else {
            return false;
        };
        let Some(&(size, lowest)) = last.iter().min_by(|a, b| a.1.total_cmp(&b.1)) else { return false };
        let newest = last.last().map_or(size, |&(size, _)| size);
        let expected = |&(before, error): &(usize, f64)| error * (before as f64 / size as f64).sqrt();
        former.iter().filter(|(before, _)| newest >= GROWTH * before).map(expected).any(|expected| expected < lowest)
    }
}

/// Whether no component asks for a larger design.
fn are_accurate(fitted: &[Fitted]) -> bool {
    fitted.iter().all(|fit| fit.stop != StopReason::DesignExhausted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compilation::judgement::JudgedShare;

    /// A half, known to this error.
    fn judged(reducible_error: Option<f64>) -> Judgement {
        let share = JudgedShare { value: 0.5, points: 50_000 };
        Judgement { share: Some(share), reducible_error, ..Judgement::default() }
    }

    fn rule(tolerance: Option<f64>) -> StoppingRule {
        StoppingRule { tolerance, most_work: 100, errors: Vec::new(), levels: 0 }
    }

    #[test]
    fn a_small_error_ends_the_build_and_a_large_one_does_not() {
        let mut rule = rule(Some(1e-3));
        rule.note(Some(2e-3), 10);
        assert!(!rule.holds(&[], &judged(Some(2e-3))));
        assert!(rule.holds(&[], &judged(Some(0.5e-3))));
        assert!(!rule.holds(&[], &judged(None)), "what is not known is not small");
        let doubtful = Judgement { is_doubtful: true, ..judged(Some(0.5e-3)) };
        assert!(!rule.holds(&[], &doubtful), "one eigenvalue is not known well enough");
    }

    #[test]
    fn without_a_tolerance_the_fits_decide() {
        assert!(rule(None).needs_no_judgement(&[]) && rule(None).holds(&[], &judged(None)));
        assert!(!rule(Some(1e-3)).needs_no_judgement(&[]));
    }

    #[test]
    fn an_error_that_falls_no_more_ends_the_build_once_the_design_has_doubled() {
        let mut rule = rule(Some(1e-9));
        rule.note(Some(1e-3), 10);
        for size in [12, 14, 16] {
            rule.note(Some(2e-3), size);
            assert_eq!(rule.early_end(&[], 0), None, "{size}");
        }
        rule.note(Some(0.9e-3), 18);
        assert_eq!(rule.early_end(&[], 0), None, "four levels, but not twice the size");
        rule.note(Some(0.95e-3), 20);
        assert_eq!(rule.early_end(&[], 0), Some(EarlyEnd::ErrorStalled), "slower than 1/√N");
        rule.note(Some(5e-4), 22);
        assert_eq!(rule.early_end(&[], 0), None, "it falls again");
    }

    #[test]
    fn fits_that_cost_more_than_they_are_worth_end_the_build_once_it_can_be_judged() {
        let mut rule = rule(Some(1e-9));
        rule.note(None, 10);
        assert_eq!(rule.early_end(&[], 1000), None, "nothing is known yet");
        rule.note(None, 20);
        assert_eq!(rule.early_end(&[], 100), None);
        assert_eq!(rule.early_end(&[], 101), Some(EarlyEnd::FitsCostMore));
    }
}
