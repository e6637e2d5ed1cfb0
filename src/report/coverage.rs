//! Where the model did not answer, and what of the shares rests on answers.

use super::significant;
use pcc_evaluate::evaluation::Unanswered;
use pcc_evaluate::probability::statistics::Interval;
use pcc_evaluate::surrogate::Surrogate;
use serde::Serialize;

/// Inputs whose values at failed runs span at most this share of their domain are named.
const NARROW: f64 = 0.6;

/// Failures that have a place at least.
const FEWEST_NAMED: usize = 4;

/// Between what shares lie, whatever the model would have answered where it did not.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Bounds {
    /// Of stable samples.
    pub stable: Interval,
    /// Of unstable ones.
    pub unstable: Interval,
}

impl Bounds {
    /// Those that are known of samples.
    pub fn of(unanswered: &Unanswered) -> Self {
        Self { stable: unanswered.stable_bounds(), unstable: unanswered.unstable_bounds() }
    }
}

/// What to know of a surrogate whose model did not answer everywhere.
pub(super) fn warning(surrogate: &Surrogate) -> Option<String> {
    let coverage = surrogate.coverage.as_ref()?;
    let (failed, all) = (coverage.unanswered.len(), coverage.unanswered.len() + coverage.answered.len());
    let standardized = coverage.ranges();
    let ends = |k: usize| surrogate.inputs.physical(&standardized.iter().map(|range| range[k]).collect::<Vec<_>>());
    let (lower, upper) = (ends(0), ends(1));
    let names: Vec<&str> = surrogate.inputs.names().collect();
    let range = |j: usize| format!("{} {} to {}", names[j], significant(lower[j], 3), significant(upper[j], 3));
    let is_narrow = |j: &usize| standardized[*j][1] - standardized[*j][0] <= 2.0 * NARROW;
    let places: Vec<String> = (0..names.len()).filter(is_narrow).map(range).collect();
    // So few lie close together by chance.
    let places = if places.is_empty() || failed < FEWEST_NAMED {
        String::new()
    } else {
        format!(", all at {}", places.join(", "))
    };
    Some(format!(
        "the model did not answer in {failed} of {all} runs of the design{places}; there the surrogate extrapolates"
    ))
}
