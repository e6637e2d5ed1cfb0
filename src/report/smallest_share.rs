//! The smallest of the stable and the unstable share and those that a study names: what errors are told of, since
//! larger ones hide them.

use super::confidence::{is_of_modes_left_out, known_error};
use super::numbers::{share, significant};
use super::sight::more_runs;
use pcc_compile::reference::Comparison;
use pcc_compile::study::NAMED_SHARES;
use pcc_evaluate::components::Verdict;
use pcc_evaluate::foundation::plural;
use pcc_evaluate::surrogate::{SettingValue, Surrogate};
use serde::Serialize;

/// Points at which a build judges a share, at least: errors below one of them are not seen.
const JUDGED_POINTS: f64 = 50_000.0;

/// The smallest share as a build has judged it: of stable, unstable, and those that `fit.shares` names.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SmallestShare {
    /// Its name: stable, unstable, not unstable where nothing is damped, marginal, flutter or divergence.
    pub name: &'static str,
    /// Its value.
    pub share: f64,
    /// Its estimated error, in percent of itself; null if unknown, or if the share is 0.
    pub estimated_error_percent: Option<f64>,
    /// The same in points of probability.
    #[serde(skip)]
    error: Option<f64>,
    /// What the build was asked for, relative to √(p (1 − p)).
    #[serde(skip)]
    tolerance: Option<f64>,
}

impl SmallestShare {
    /// The smallest that occurs; `None` of files that do not say which share was judged.
    pub fn of(surrogate: &Surrogate) -> Option<Self> {
        let smaller = |one: Self, other: Self| if one.share == 0.0 || other.share < one.share { other } else { one };
        Self::all(surrogate).into_iter().reduce(smaller)
    }

    /// What the file says of the smaller of stable and unstable, and of those that the study names and that occur.
    pub(super) fn all(surrogate: &Surrogate) -> Vec<Self> {
        let named = named(surrogate).into_iter().filter_map(|verdict| Self::of_verdict(surrogate, verdict));
        Self::of_side(surrogate).into_iter().chain(named).collect()
    }

    /// Of a share that the study names, if it occurs.
    fn of_verdict(surrogate: &Surrogate, verdict: Verdict) -> Option<Self> {
        let name = verdict.name();
        let share = number(surrogate, &format!("{name}_share")).filter(|&share| share > 0.0)?;
        let error = number(surrogate, &format!("{name}_share_error"));
        Some(Self {
            name,
            share,
            estimated_error_percent: error.map(|error| 100.0 * error / share),
            error,
            tolerance: number(surrogate, "proportion_tolerance"),
        })
    }

    /// The smaller of stable and unstable.
    fn of_side(surrogate: &Surrogate) -> Option<Self> {
        let number = |key: &str| number(surrogate, key);
        let not_unstable = number("stable_share")?;
        let (name, share) = match (not_unstable <= 0.5, surrogate.is_undamped()) {
            (true, true) => ("not unstable", not_unstable),
            (true, false) => ("stable", not_unstable),
            (false, _) => ("unstable", 1.0 - not_unstable),
        };
        let reference = if not_unstable > 0.0 { not_unstable } else { 1.0 };
        let error = known_error(surrogate).map(|error| error * reference);
        Some(Self {
            name,
            share,
            estimated_error_percent: error.filter(|_| share > 0.0).map(|error| 100.0 * error / share),
            error,
            tolerance: number("proportion_tolerance"),
        })
    }

    /// Whether the estimated error is larger than the build was asked for, and than what its points resolve.
    pub(super) fn is_off(&self) -> bool {
        let (Some(error), Some(tolerance)) = (self.error, self.tolerance) else { return false };
        error > (tolerance * (self.share * (1.0 - self.share)).sqrt()).hypot(1.0 / JUDGED_POINTS)
    }

    /// What to know of an error that is larger than asked for.
    pub(super) fn warning(&self) -> Option<String> {
        let off = match self.estimated_error_percent {
            Some(percent) => format!("{} % of itself", significant(percent, 2)),
            None => share(self.error?),
        };
        Some(format!(
            "the {} share, {}, may be off by {off}; raise design.maximum or choose another fit.method, and check with pcc \
             compare or certify",
            self.name,
            share(self.share)
        ))
    }
}

fn value<'s>(surrogate: &'s Surrogate, key: &str) -> Option<&'s SettingValue> {
    surrogate.training.settings.iter().find(|setting| setting.key == key).map(|setting| &setting.value)
}

fn number(surrogate: &Surrogate, key: &str) -> Option<f64> {
    if let SettingValue::Number(number) = value(surrogate, key)? { Some(*number) } else { None }
}

/// The shares that the study of a surrogate names.
fn named(surrogate: &Surrogate) -> Vec<Verdict> {
    let Some(SettingValue::Text(names)) = value(surrogate, "shares") else { return Vec::new() };
    NAMED_SHARES.into_iter().filter(|verdict| names.split(' ').any(|name| name == verdict.name())).collect()
}

/// What to know of shares that too few runs are of, or too few are not.
pub(super) fn hardly_seen(surrogate: &Surrogate) -> Vec<String> {
    let counts = surrogate.training.counts;
    let answered = counts.direct_computations.saturating_sub(counts.failed);
    let runs = plural(answered as usize, "model run");
    let of = |verdict: Verdict| {
        let name = verdict.name();
        let Some(SettingValue::Integer(seen)) = value(surrogate, &format!("{name}_runs")) else { return None };
        let share = share(number(surrogate, &format!("{name}_share"))?);
        Some(format!(
            "the {name} share, {share} by the surrogate, is not known: {seen} of {runs} were of it; fewer than 3 on either \
             side tell nothing of its error; {}",
            more_runs(answered)
        ))
    };
    named(surrogate).into_iter().filter_map(of).collect()
}

/// The estimated error of a surrogate in words; `None` if it is unknown.
pub(super) fn estimated_error(surrogate: &Surrogate) -> Option<String> {
    let relative = 100.0 * surrogate.decision.proportion_error?;
    let by = if is_of_modes_left_out(surrogate) { "by left-out modes" } else { "by left-out points" };
    let (percent, of) = match SmallestShare::of(surrogate) {
        Some(SmallestShare { name: "not unstable", estimated_error_percent: Some(percent), .. }) => {
            (percent, "of the share that is not unstable".to_owned())
        }
        Some(SmallestShare { name, estimated_error_percent: Some(percent), .. }) => {
            (percent, format!("of the {name} share"))
        }
        Some(SmallestShare { error: Some(error), .. }) => (100.0 * error, "of all cases".to_owned()),
        _ if surrogate.is_undamped() => (relative, "of the share that is not unstable".to_owned()),
        _ => (relative, "of the stable share".to_owned()),
    };
    Some(format!("{} % {of}, {by}", significant(percent, 2)))
}

/// The smallest of the stable and the unstable share and those that `fit.shares` names, of those that occur, by model
/// and surrogate at the same points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ComparedShare {
    /// Its name: stable, unstable, marginal, flutter or divergence.
    pub name: &'static str,
    /// By the model.
    pub model: f64,
    /// By the surrogate.
    pub surrogate: f64,
    /// Its relative error; null if the model's is zero and the surrogate's is not.
    pub relative_error_percent: Option<f64>,
}

impl ComparedShare {
    pub(super) fn of(surrogate: &Surrogate, comparison: &Comparison) -> Self {
        let named = named(surrogate).into_iter().map(|verdict| {
            let [model, surrogate] = comparison.shares_of(verdict);
            let relative_error_percent = comparison.relative_error_of_verdict_percent(verdict);
            Self { name: verdict.name(), model, surrogate, relative_error_percent }
        });
        let occurring = named.filter(|share| share.model > 0.0 || share.surrogate > 0.0);
        let smaller = |one: Self, other: Self| if other.model < one.model { other } else { one };
        occurring.fold(Self::of_side(comparison), smaller)
    }

    /// The smaller of stable and unstable.
    fn of_side(comparison: &Comparison) -> Self {
        let stable = Self {
            name: "stable",
            model: comparison.proportion_model(),
            surrogate: comparison.proportion_surrogate(),
            relative_error_percent: comparison.relative_error_percent(),
        };
        let [model, surrogate] = comparison.unstable();
        let relative_error_percent = comparison.relative_error_of_unstable_percent();
        let unstable = Self { name: "unstable", model, surrogate, relative_error_percent };
        let occurs = |share: &Self| share.model > 0.0 || share.surrogate > 0.0;
        match (occurs(&stable), occurs(&unstable)) {
            (true, true) if unstable.model < stable.model => unstable,
            (false, true) => unstable,
            _ => stable,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::artifact::decode;
    use pcc_evaluate::surrogate::Setting;

    fn judged(not_unstable: f64, relative_error: f64) -> Surrogate {
        let mut surrogate = decode(include_bytes!("../../surrogates/clutch-r1.pcc")).unwrap().surrogate;
        let number = |key: &str, value| Setting { key: key.to_owned(), value: SettingValue::Number(value) };
        surrogate.training.settings = vec![number("proportion_tolerance", 1e-3), number("stable_share", not_unstable)];
        surrogate.decision.proportion_error = Some(relative_error);
        surrogate
    }

    #[test]
    fn errors_are_told_of_the_smaller_share() {
        let rare = judged(0.99, 0.001 / 0.99);
        let share = SmallestShare::of(&rare).unwrap();
        assert_eq!(share.name, "unstable");
        assert!((share.share - 0.01).abs() < 1e-12 && (share.estimated_error_percent.unwrap() - 10.0).abs() < 1e-9);
        assert_eq!(estimated_error(&rare).unwrap(), "10 % of the unstable share, by left-out points");
        assert_eq!(estimated_error(&judged(0.2, 0.01)).unwrap(), "1.0 % of the stable share, by left-out points");
        assert_eq!(estimated_error(&judged(1.0, 1e-5)).unwrap(), "0.0010 % of all cases, by left-out points");
    }

    #[test]
    fn what_is_asked_for_is_the_same_of_both_sides() {
        for (rare, error, is_off) in [(0.2, 3.9e-4, false), (0.2, 4.1e-4, true), (0.01, 0.9e-4, false)] {
            for share in [rare, 1.0 - rare] {
                assert_eq!(SmallestShare::of(&judged(share, error / share)).unwrap().is_off(), is_off, "{share}");
            }
        }
    }
}
