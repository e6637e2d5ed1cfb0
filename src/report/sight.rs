//! What is known where no model run, or hardly one, lies on the rarer side of the stability boundary.

use super::numbers::significant;
use pcc_evaluate::components::Margin;
use pcc_evaluate::foundation::plural;
use pcc_evaluate::surrogate::{SettingValue, Surrogate};

/// What a build knows that too few runs on one side leave without an estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sight {
    /// All is on one side, far from the boundary.
    Everywhere {
        /// The excess that is nearest to zero, in 1/s.
        nearest: f64,
        /// The largest left-out error of what decides, in 1/s.
        error: f64,
        /// Whether only Re λ counts.
        is_without_margin: bool,
        /// The number of points that this was looked at, where inputs have tails.
        points: Option<u64>,
    },
    /// How large the rarer share is, is not known.
    Unknown {
        /// Unstable runs.
        unstable: u64,
        /// Runs that answered.
        runs: u64,
    },
}

impl Sight {
    /// What the file says; `None` where enough runs lie on both sides, and of files that do not say.
    pub fn of(surrogate: &Surrogate) -> Option<Self> {
        let setting = |key: &str| surrogate.training.settings.iter().find(|setting| setting.key == key);
        let number = |key: &str| match setting(key)?.value {
            SettingValue::Number(value) => Some(value),
            _ => None,
        };
        let SettingValue::Integer(unstable) = setting("unstable_runs")?.value else { return None };
        let counts = surrogate.training.counts;
        let is_without_margin = surrogate.verdict.margin == Margin::default();
        Some(match number("nearest_excess").zip(number("nearest_error")) {
            Some((nearest, error)) => {
                let points = setting("nearest_points").and_then(|setting| match setting.value {
                    SettingValue::Integer(points) => Some(points),
                    _ => None,
                });
                Self::Everywhere { nearest, error, is_without_margin, points }
            }
            None => Self::Unknown { unstable, runs: counts.direct_computations.saturating_sub(counts.failed) },
        })
    }

    /// Whether the rarer share is not known.
    pub fn is_unknown(self) -> bool {
        matches!(self, Self::Unknown { .. })
    }

    /// The same with `samples` of which max Re λ is from `least` to `largest`: some may come nearer to the boundary.
    pub fn seen_in(self, samples: u64, [least, largest]: [f64; 2]) -> Self {
        match self {
            Self::Everywhere { nearest, error, is_without_margin: true, points } if nearest != 0.0 => {
                let nearest = if nearest < 0.0 { nearest.max(largest) } else { nearest.min(least) };
                let points = points.map(|points| points.saturating_add(samples));
                Self::Everywhere { nearest, error, is_without_margin: true, points }
            }
            other => other,
        }
    }

    /// In words, to follow "is".
    pub fn words(self) -> String {
        match self {
            Self::Everywhere { nearest: 0.0, .. } => "unstable nowhere: what decides is marginal".to_owned(),
            Self::Everywhere { nearest, error, is_without_margin, points } => {
                let (side, which) = if nearest < 0.0 { ("stable", "largest") } else { ("unstable", "smallest") };
                let what = if is_without_margin { "max Re λ" } else { "excess over the margin" };
                let (nearest, error) = (significant(nearest, 3), at_most(error));
                let seen =
                    points.map_or_else(String::new, |points| format!(" in {}", plural(points as usize, "point")));
                format!("{side} everywhere{seen}: {which} {what} {nearest} 1/s, error at most {error} 1/s")
            }
            Self::Unknown { .. } => {
                let (side, seen) = self.seen();
                format!("{side} in a share that is not known; {seen}")
            }
        }
    }

    /// The rarer side, and how many runs have seen it.
    fn seen(self) -> (&'static str, String) {
        match self {
            Self::Everywhere { .. } => ("", String::new()),
            Self::Unknown { unstable, runs } => {
                let (rare, side) =
                    if 2 * unstable <= runs { (unstable, "unstable") } else { (runs - unstable, "stable") };
                let runs = plural(runs as usize, "model run");
                let seen = match rare {
                    0 => format!("none of {runs} was {side}"),
                    1 => format!("only 1 of {runs} was {side}"),
                    few => format!("only {few} of {runs} were {side}"),
                };
                (side, seen)
            }
        }
    }

    /// A sentence to follow what samples say.
    pub fn sentence(self) -> Option<String> {
        let (side, seen) = self.seen();
        self.is_unknown().then(|| format!("How often it is {side} is not known; {seen}."))
    }

    /// What to know before trusting the surrogate.
    pub fn warning(self) -> Option<String> {
        let Self::Unknown { runs, .. } = self else { return None };
        Some(format!(
            "the system is {}: fewer than 3 tell nothing of the error; {}, or bound it with pcc certify",
            self.words(),
            more_runs(runs)
        ))
    }
}

/// How a build that ended after so many runs is made to go on. It may have ended before `design.maximum`: a study that
/// does not say how many runs it is worth has no build that looks for what is rare for long.
pub(super) fn more_runs(runs: u64) -> String {
    format!("let the build make more, as with design.maximum = {}", 2 * runs)
}

/// Two digits, rounded up, but for what rounding adds.
fn at_most(error: f64) -> String {
    const ROUNDING: f64 = 1e-9;
    let unit = 10f64.powf(error.log10().floor() - 1.0);
    let rounded = if error > 0.0 { (error / unit - ROUNDING).ceil() * unit } else { 0.0 };
    significant(rounded, 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_rounded_up() {
        assert_eq!([0.0101, 0.0100, 1.249e-5, 0.0].map(at_most), ["0.011", "0.010", "1.3·10⁻⁵", "0"]);
    }

    #[test]
    fn what_is_not_known_is_said_by_its_runs() {
        let words = |unstable| Sight::Unknown { unstable, runs: 45 }.words();
        assert_eq!(words(0), "unstable in a share that is not known; none of 45 model runs was unstable");
        assert_eq!(words(2), "unstable in a share that is not known; only 2 of 45 model runs were unstable");
        assert_eq!(words(44), "stable in a share that is not known; only 1 of 45 model runs was stable");
        let everywhere = Sight::Everywhere { nearest: -5.2, error: 0.0094, is_without_margin: true, points: None };
        assert_eq!(everywhere.words(), "stable everywhere: largest max Re λ -5.20 1/s, error at most 0.0094 1/s");
        let seen = everywhere.seen_in(1000, [-90.0, -5.1]).words();
        assert_eq!(seen, "stable everywhere: largest max Re λ -5.10 1/s, error at most 0.0094 1/s");
        let tails = Sight::Everywhere { nearest: -5.2, error: 0.0094, is_without_margin: true, points: Some(50_000) };
        assert!(tails.words().starts_with("stable everywhere in 50 000 points: largest max Re λ -5.20 1/s"));
        let more = tails.seen_in(1000, [-90.0, -5.1]).words();
        assert!(more.starts_with("stable everywhere in 51 000 points: largest max Re λ -5.10 1/s"), "{more}");
        assert!(everywhere.warning().is_none() && Sight::Unknown { unstable: 0, runs: 9 }.warning().is_some());
    }
}
