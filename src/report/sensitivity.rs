//! Which inputs decide stability, and where one of them does.

use super::layout::{Facts, width, wrapped};
use super::numbers::{share, significant};
use super::table::{Align, Table};
use pcc_evaluate::components::Label;
use pcc_evaluate::evaluation::{
    CRITICAL_LEVELS, CriticalValues, Crossing, Estimate, SENSITIVITY_LEVEL, Sensitivities, Sensitivity,
};
use pcc_evaluate::probability::inputs::Input;
use serde::Serialize;
use std::fmt;

/// Sobol' indices of max Re λ and of the stability indicator.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SensitivityReport {
    /// Samples of the pick-freeze estimate.
    pub samples: u64,
    /// Level of the intervals.
    pub level: f64,
    /// One entry per input.
    pub inputs: Vec<InputSensitivity>,
}

/// Indices of one input.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InputSensitivity {
    /// Name.
    pub input: String,
    /// Indices of max Re λ; null if it does not vary.
    pub max_re: Option<IndexPair>,
    /// Indices of the indicator of samples that are not unstable; null if it does not vary.
    pub stability: Option<IndexPair>,
}

/// First-order and total index.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct IndexPair {
    /// First order.
    pub first: Bounded,
    /// Total.
    pub total: Bounded,
}

/// A value with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Bounded {
    /// Estimate.
    pub value: f64,
    /// Lower end.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
}

impl SensitivityReport {
    /// The report for inputs with these names.
    pub fn new<'a>(names: impl Iterator<Item = &'a str>, found: &Sensitivities) -> Self {
        let pair = |indices: &Option<Vec<Sensitivity>>, j: usize| {
            let index = indices.as_ref()?.get(j)?;
            Some(IndexPair { first: index.first.into(), total: index.total.into() })
        };
        let input = |(j, name): (usize, &str)| InputSensitivity {
            input: name.to_owned(),
            max_re: pair(&found.max_re, j),
            stability: pair(&found.stability, j),
        };
        Self { samples: found.samples, level: SENSITIVITY_LEVEL, inputs: names.enumerate().map(input).collect() }
    }

    /// How much of what decides stability an input has a part in.
    fn total(&self, j: usize) -> f64 {
        self.inputs[j].stability.or(self.inputs[j].max_re).map_or(0.0, |pair| pair.total.value)
    }

    /// Numbers of the inputs, the one that decides most first.
    pub(super) fn order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.inputs.len()).collect();
        order.sort_by(|&a, &b| self.total(b).total_cmp(&self.total(a)));
        order
    }

    /// Their names and total indices of stability, if those are known well enough to tell one from another.
    pub(super) fn ranked_for_stability(&self) -> Option<Vec<(&str, f64)>> {
        let known = |j: usize| {
            let total = self.inputs[j].stability?.total;
            total.says_something().then_some((self.inputs[j].input.as_str(), total.value))
        };
        self.order().into_iter().map(known).collect()
    }

    /// The inputs that decide most; `None` if nothing varies.
    pub(super) fn causes(&self, most: usize) -> Option<Table> {
        let right = Align::Right;
        let is_of_stability = self.inputs.iter().all(|input| input.stability.is_some());
        let head = if is_of_stability { "what decides" } else { "what max Re λ depends on" };
        let mut table = Table::new(&[(head, Align::Left), ("alone", right), ("in all", right)]);
        for j in self.order().into_iter().take(most) {
            let pair = self.inputs[j].stability.or(self.inputs[j].max_re)?;
            table.row([self.inputs[j].input.clone(), cell(Some(pair.first)), cell(Some(pair.total))]);
        }
        Some(table)
    }
}

/// Indices with a wider interval say nothing.
const VAGUE: f64 = 0.25;

impl Bounded {
    fn half_width(&self) -> f64 {
        (self.value - self.lower).max(self.upper - self.value)
    }

    /// Whether the interval is narrow enough.
    pub(super) fn says_something(&self) -> bool {
        self.half_width() <= VAGUE
    }
}

impl From<Estimate> for Bounded {
    fn from(Estimate { value, lower, upper }: Estimate) -> Self {
        Self { value, lower, upper }
    }
}

/// An index with its interval, if it says something.
pub(super) fn cell(value: Option<Bounded>) -> String {
    value
        .filter(Bounded::says_something)
        .map_or("–".to_owned(), |found| format!("{:.3} ± {:.3}", found.value, found.half_width()))
}

impl fmt::Display for SensitivityReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.inputs.iter().all(|input| input.max_re.is_none() && input.stability.is_none()) {
            return Ok(());
        }
        let right = Align::Right;
        let mut table = Table::new(&[
            ("Sobol' index", Align::Left),
            ("max Re λ, first", right),
            ("total", right),
            ("stability, first", right),
            ("total", right),
        ]);
        for input in &self.inputs {
            table.row([
                input.input.clone(),
                cell(input.max_re.map(|pair| pair.first)),
                cell(input.max_re.map(|pair| pair.total)),
                cell(input.stability.map(|pair| pair.first)),
                cell(input.stability.map(|pair| pair.total)),
            ]);
        }
        let note = "share of the variance that an input causes alone (first) and in all (total), ± at 95 %";
        let columns = width(f);
        writeln!(f, "\n{table:columns$}{}", wrapped(note, columns, 0))
    }
}

/// The distribution of the critical value of one input.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CriticalReport {
    /// Name of the input.
    pub input: String,
    /// Its name with its unit.
    #[serde(skip)]
    pub head: String,
    /// Samples of the other inputs.
    pub samples: u64,
    /// Where values are looked for: the lower bound, or the quantile at 1/8192 of an input that lacks a bound.
    pub from: f64,
    /// The upper bound, or the quantile at 8191/8192.
    pub to: f64,
    /// What of the law lies below `from`, and above `to`.
    #[serde(skip)]
    pub tail: f64,
    /// Share that stays stable from `from` to `to`.
    pub never: f64,
    /// Share that is unstable at `from` already.
    pub unstable_from_start: f64,
    /// Mean critical value of those that lose stability; null if none does.
    pub mean: Option<f64>,
    /// Smallest critical value.
    pub minimum: Option<f64>,
    /// Largest critical value.
    pub maximum: Option<f64>,
    /// Quantiles over all samples; null where that share never loses stability.
    pub quantiles: Vec<CriticalQuantile>,
    /// Every change of stability along the input, in order.
    pub crossings: Vec<CrossingReport>,
}

/// A change of stability along an input, of the samples in which the same mode decides it in the same way.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CrossingReport {
    /// Number of the change, from 1, upwards from the smallest value that is looked at.
    pub order: u32,
    /// `lost` or `regained`: what happens to stability as the input grows.
    pub stability: &'static str,
    /// What decides on the unstable side: a mode, or a real eigenvalue that belongs to none.
    pub mode: String,
    /// `flutter` or `divergence`.
    pub kind: &'static str,
    /// Share of all samples.
    pub share: f64,
    /// Mean value of the input there.
    pub mean: f64,
    /// Smallest value.
    pub minimum: f64,
    /// Largest value.
    pub maximum: f64,
    /// Quantiles over these crossings.
    pub quantiles: Vec<CriticalQuantile>,
}

impl CrossingReport {
    fn new(crossing: &Crossing, samples: u64) -> Self {
        let quantile = |level| CriticalQuantile { level, value: Some(crossing.quantile(level)) };
        Self {
            order: crossing.order,
            stability: if crossing.loses { "lost" } else { "regained" },
            mode: match crossing.label {
                Label::Mode(mode) | Label::Second(mode) => mode.to_string(),
                label @ Label::Real(_) => label.growth_rate(),
            },
            kind: crossing.verdict.name(),
            share: crossing.samples as f64 / samples as f64,
            mean: crossing.mean,
            minimum: crossing.range[0],
            maximum: crossing.range[1],
            quantiles: CRITICAL_LEVELS.map(quantile).to_vec(),
        }
    }
}

/// All crossings; nothing if each sample loses stability once, in the same way.
fn crossings_table(crossings: &[CrossingReport]) -> Option<Table> {
    let is_plain = crossings.iter().all(|crossing| crossing.order == 1 && crossing.stability == "lost");
    if is_plain && crossings.len() < 2 {
        return None;
    }
    let right = Align::Right;
    let mut table = Table::new(&[
        ("crossing", Align::Left),
        ("stability", Align::Left),
        ("mode", Align::Left),
        ("kind", Align::Left),
        ("share", right),
        ("mean", right),
        ("minimum", right),
        ("maximum", right),
    ]);
    for crossing in crossings {
        let values = [crossing.mean, crossing.minimum, crossing.maximum].map(|value| significant(value, 5));
        let words = [
            crossing.order.to_string(),
            crossing.stability.to_owned(),
            crossing.mode.clone(),
            crossing.kind.to_owned(),
            share(crossing.share),
        ];
        table.row(words.into_iter().chain(values));
    }
    Some(table)
}

/// One quantile of the critical value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CriticalQuantile {
    /// Share of all samples that lose stability at this value or below.
    pub level: f64,
    /// The value.
    pub value: Option<f64>,
}

impl CriticalReport {
    /// The report for this input.
    pub fn new(input: &Input, found: &CriticalValues) -> Self {
        let share = |part: u64| part as f64 / found.samples as f64;
        let quantile = |level| CriticalQuantile { level, value: found.quantile(level) };
        let [from, to] = found.looked_for();
        Self {
            from,
            to,
            tail: found.tail(),
            input: input.name.clone(),
            head: input.name_with_unit(),
            samples: found.samples,
            never: share(found.never),
            unstable_from_start: share(found.unstable_from_start),
            mean: found.mean(),
            minimum: found.minimum(),
            maximum: found.maximum(),
            quantiles: CRITICAL_LEVELS.map(quantile).to_vec(),
            crossings: found.crossings().iter().map(|crossing| CrossingReport::new(crossing, found.samples)).collect(),
        }
    }
}

impl fmt::Display for CriticalReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = |value: Option<f64>| value.map_or("never".to_owned(), |value| significant(value, 4));
        let columns = width(f);
        let title = format!("critical {}: the smallest value at which the system is unstable", self.head);
        writeln!(f, "\n{}", wrapped(&title, columns, 0))?;
        let mut facts = Facts::default();
        if self.tail > 0.0 {
            let [from, to] = [self.from, self.to].map(|end| significant(end, 4));
            let words = format!("its quantiles of {} and {}", share(self.tail), share(1.0 - self.tail));
            facts.add("looked for", format!("from {from} to {to}"), words);
        }
        facts.add("stable throughout", share(self.never), "");
        facts.add("unstable from start", share(self.unstable_from_start), "");
        let (mean, minimum, maximum) = (value(self.mean), value(self.minimum), value(self.maximum));
        let start = match (self.unstable_from_start > 0.0, self.tail > 0.0) {
            (false, _) => String::new(),
            (true, false) => "; the lower bound for those unstable from start".to_owned(),
            (true, true) => format!("; {} for those unstable from start", significant(self.from, 4)),
        };
        match self.mean {
            Some(_) => facts.add("critical values", format!("mean {mean}, {minimum} to {maximum}{start}"), ""),
            None => facts.add("critical values", "none", ""),
        }
        writeln!(f, "{facts:columns$}")?;
        let mut heads = vec![("share unstable at or below", Align::Left)];
        let levels: Vec<String> = self.quantiles.iter().map(|q| super::numbers::level(q.level)).collect();
        heads.extend(levels.iter().map(|level| (level.as_str(), Align::Right)));
        let mut table = Table::new(&heads);
        let mut row = vec![self.head.clone()];
        row.extend(self.quantiles.iter().map(|quantile| value(quantile.value)));
        table.row(row);
        write!(f, "{table:columns$}")?;
        match crossings_table(&self.crossings) {
            Some(crossings) => write!(f, "\n{crossings:columns$}"),
            None => Ok(()),
        }
    }
}
