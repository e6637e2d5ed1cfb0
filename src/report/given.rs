//! Runs that a build was given, and what those say that no fit has seen.

use super::fit::share_of_variance;
use super::layout::Facts;
use super::numbers::{share, significant};
use pcc_compile::compilation::GivenUse;
use pcc_evaluate::foundation::{count, plural};
use pcc_evaluate::probability::statistics::{Interval, Proportion};
use pcc_evaluate::surrogate::{SettingValue, Surrogate};
use serde::Serialize;

/// Less of the laws without runs is no news.
const LITTLE: f64 = 0.01;

/// Confidence level of the interval of a share of runs.
const LEVEL: f64 = 0.95;

/// Columns without a meaning that are named.
const NAMED: usize = 6;

/// What became of the runs that a build was given.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GivenReport {
    /// The tables.
    pub files: Vec<String>,
    /// Points that they have.
    pub points: u64,
    /// Runs that entered the fit.
    pub fitted: u64,
    /// Runs that failed.
    pub failed: u64,
    /// Runs that were held out.
    pub held_out: u64,
    /// Rows that said what others say, too, and count once.
    pub repeated_rows: u64,
    /// The first few of them.
    pub repeated: Vec<String>,
    /// Columns that mean nothing.
    pub ignored_columns: Vec<String>,
    /// Share of the inputs' laws where no run is; null if the build made runs of its own.
    pub uncovered_proportion: Option<f64>,
    /// What runs say that no fit has seen; null if there are none.
    pub validation: Option<ValidationReport>,
}

/// A surrogate beside runs that its fits have not seen.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ValidationReport {
    /// Their number.
    pub runs: u64,
    /// How many are unstable.
    pub unstable: u64,
    /// How many the surrogate calls unstable.
    pub predicted_unstable: u64,
    /// How many it calls unstable where they are not, or the other way round.
    pub misjudged: u64,
    /// The share of these, with its Wilson interval.
    pub misjudged_percent: f64,
    /// Of the share.
    pub interval: Interval,
    /// Root of the mean square error of max Re λ, in 1/s.
    pub rms_error: f64,
    /// The largest error of max Re λ, in 1/s.
    pub largest_error: f64,
    /// 1 − mean square error/variance of max Re λ; null if that does not vary.
    pub q2: Option<f64>,
}

impl GivenReport {
    pub(super) fn new(given: &GivenUse) -> Self {
        let validation = given.validation.map(|found| ValidationReport {
            runs: found.runs,
            unstable: found.unstable,
            predicted_unstable: found.predicted_unstable,
            misjudged: found.misjudged,
            misjudged_percent: 100.0 * found.misjudged as f64 / found.runs as f64,
            interval: Proportion { hits: found.misjudged, samples: found.runs }.wilson(LEVEL),
            rms_error: found.rms_error,
            largest_error: found.largest_error,
            q2: found.q2,
        });
        Self {
            files: given.files.clone(),
            points: given.points,
            fitted: given.fitted,
            failed: given.failed,
            held_out: given.held_out,
            repeated_rows: given.repetitions,
            repeated: given.repeated.clone(),
            ignored_columns: given.ignored.clone(),
            uncovered_proportion: given.uncovered.as_ref().map(|uncovered| uncovered.share),
            validation,
        }
    }

    pub(super) fn add_to(&self, facts: &mut Facts) {
        let validating = self.validation.as_ref().map_or(0, |found| found.runs);
        let others = match (self.held_out, validating - self.held_out) {
            (0, 0) => String::new(),
            (held_out, 0) => format!(", {} held out", count(held_out)),
            (0, more) => format!(", {} more than the fit takes", count(more)),
            (held_out, more) => format!(", {} held out, {} more than the fit takes", count(held_out), count(more)),
        };
        facts.add("given runs", format!("{} of {}{others}", count(self.fitted), self.files.join(", ")), "");
        if self.repeated_rows > 0 {
            let more = if self.repeated_rows > self.repeated.len() as u64 { ", …" } else { "" };
            let rows = self.repeated.join("; ");
            facts.add("repeated rows", format!("{}, counted once: {rows}{more}", count(self.repeated_rows)), "");
        }
        if !self.ignored_columns.is_empty() {
            let more = if self.ignored_columns.len() > NAMED { ", …" } else { "" };
            let named: Vec<&str> = self.ignored_columns.iter().take(NAMED).map(String::as_str).collect();
            facts.add("columns not used", format!("{}{more}", named.join(", ")), "");
        }
        if let Some(found) = &self.validation {
            let q2 = found.q2.map_or_else(String::new, |q2| format!(", Q² {}", share_of_variance(Some(q2))));
            let interval = super::numbers::interval(&found.interval);
            facts.add(
                "runs not fitted",
                format!(
                    "{}, {} of them misjudged ({interval}); max Re λ off by {} 1/s rms, at most {} 1/s{q2}",
                    plural(found.runs as usize, "run"),
                    count(found.misjudged),
                    significant(found.rms_error, 2),
                    significant(found.largest_error, 2),
                ),
                "",
            );
        }
    }
}

fn setting<'s>(surrogate: &'s Surrogate, key: &str) -> Option<&'s SettingValue> {
    surrogate.training.settings.iter().find(|setting| setting.key == key).map(|setting| &setting.value)
}

fn whole(surrogate: &Surrogate, key: &str) -> Option<u64> {
    if let SettingValue::Integer(value) = setting(surrogate, key)? { Some(*value) } else { None }
}

/// What to know of a surrogate of runs that were given.
pub(super) fn warnings(surrogate: &Surrogate) -> Vec<String> {
    uncovered(surrogate).into_iter().chain(contradicted(surrogate)).collect()
}

/// Where no run is.
fn uncovered(surrogate: &Surrogate) -> Option<String> {
    let Some(SettingValue::Number(proportion)) = setting(surrogate, "uncovered_share") else { return None };
    let place = match setting(surrogate, "uncovered_place") {
        Some(SettingValue::Text(place)) => words(place),
        _ => String::new(),
    };
    (*proportion >= LITTLE).then(|| {
        format!(
            "no run is near {} of the cases{place}: there the surrogate guesses, and estimated errors do not speak for it; \
             give runs there, or narrow the laws",
            share(*proportion)
        )
    })
}

/// `mu 0.35 0.5, k 1.0 2.0` as people read it.
fn words(place: &str) -> String {
    let of_input = |part: &str| {
        let mut words = part.rsplitn(3, ' ');
        let (upper, lower, name) = (words.next()?.parse().ok()?, words.next()?.parse().ok()?, words.next()?);
        Some(format!("{name} {} to {}", significant(lower, 3), significant(upper, 3)))
    };
    let parts: Vec<String> = place.split(", ").filter_map(of_input).collect();
    if parts.is_empty() { String::new() } else { format!(", {}", parts.join(", ")) }
}

/// Runs that no fit has seen, and that say more of the error than its estimate.
fn contradicted(surrogate: &Surrogate) -> Option<String> {
    let (runs, misjudged) = (whole(surrogate, "validating_runs")?, whole(surrogate, "validating_misjudged")?);
    let found = Proportion { hits: misjudged, samples: runs };
    // Of the stable share, which the estimate is relative to; without an estimate nothing is contradicted.
    let Some(SettingValue::Number(stable)) = setting(surrogate, "stable_share") else { return None };
    let reference = if *stable > 0.0 { *stable } else { 1.0 };
    let estimated = surrogate.decision.proportion_error? * reference;
    (found.wilson(LEVEL).lower > SEVERAL * estimated.max((runs as f64).recip())).then(|| {
        format!(
            "{} of {} that no fit has seen are misjudged, more than the estimated error says; these runs lie where others are \
             few, or the surrogate is poor there",
            count(misjudged),
            plural(runs as usize, "run")
        )
    })
}

/// Misjudged points on both sides of the boundary cancel in a share, and estimates are off by a factor.
const SEVERAL: f64 = 10.0;
