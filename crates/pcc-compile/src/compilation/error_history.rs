//! Whether the error of a component has stopped falling.
//!
//! Errors at runs left out fall as the design grows: those of functions that expansions can follow by a factor for each
//! level, those of means like 1/√N. An error that falls more slowly than that is not worth runs: what is left is noise
//! of the model's answers, or detail far beyond designs of this size. The component then asks for no larger design. It
//! is still known no better than that, and its residuals enter every estimate as they are.

/// Growth of the design over which an error is expected to fall.
const GROWTH: usize = 2;

/// The same where nothing but the errors of components decides, or where the model has derivatives, whose answers carry
/// no noise but rounding: the doubt needs more of a proof.
const GROWTH_OF_EXACT: usize = 4;

/// The errors of a component at runs left out, design by design.
#[derive(Debug, Clone, Default)]
pub(super) struct ErrorHistory {
    /// Numbers of runs, which grow, and root mean square errors.
    errors: Vec<(usize, f64)>,
}

impl ErrorHistory {
    /// The same with one more design; an error that is not known adds nothing.
    pub fn with(&self, runs: usize, error: Option<f64>) -> Self {
        let mut errors = self.errors.clone();
        errors.retain(|&(former, _)| former < runs);
        errors.extend(error.map(|error| (runs, error)));
        Self { errors }
    }

    /// Whether the error of the last design is above what 1/√N makes of an earlier one, on a design of half the size or
    /// less. Answers may be `noisy`, and what matters be looked at a second time by the proportion.
    pub fn has_stopped_falling(&self, noisy: bool) -> bool {
        let Some((&(runs, error), former)) = self.errors.split_last() else { return false };
        let growth = if noisy { GROWTH } else { GROWTH_OF_EXACT };
        let expected = |&(size, before): &(usize, f64)| before * (size as f64 / runs as f64).sqrt();
        let lowest =
            former.iter().filter(|(size, _)| growth * size <= runs).map(expected).fold(f64::INFINITY, f64::min);
        lowest < error
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(errors: &[(usize, f64)]) -> ErrorHistory {
        errors.iter().fold(ErrorHistory::default(), |history, &(runs, error)| history.with(runs, Some(error)))
    }

    #[test]
    fn noise_is_seen_once_the_design_has_doubled() {
        assert!(of(&[(18, 1e-6), (36, 0.9e-6)]).has_stopped_falling(true));
        assert!(!of(&[(18, 1e-6), (30, 1.1e-6)]).has_stopped_falling(true), "not yet twice the size");
        assert!(!of(&[(18, 1e-6), (36, 0.9e-6)]).has_stopped_falling(false), "nothing else is looked at");
        assert!(of(&[(18, 1e-6), (36, 0.9e-6), (72, 1e-6)]).has_stopped_falling(false));
    }

    #[test]
    fn errors_that_fall_are_no_noise() {
        assert!(!of(&[(18, 1e-2), (36, 5e-3)]).has_stopped_falling(true), "like 1/N");
        assert!(!of(&[(10, 1.0), (20, 1e-9), (40, 3e-10)]).has_stopped_falling(true));
        assert!(of(&[(10, 1.0), (20, 1e-9), (40, 0.9e-9)]).has_stopped_falling(true), "resolved, then noise");
    }

    #[test]
    fn what_is_not_known_says_nothing() {
        assert!(!ErrorHistory::default().has_stopped_falling(true));
        assert!(!ErrorHistory::default().with(10, None).with(20, Some(1.0)).has_stopped_falling(true));
    }
}
