//! Which inputs decide stability, and where one of them does.

use super::table::{Align, Table, significant};
use pcc_evaluate::evaluation::{
    CRITICAL_LEVELS, CriticalValues, Estimate, SENSITIVITY_LEVEL, Sensitivities, Sensitivity,
};
use serde::Serialize;
use std::fmt;

/// Sobol' indices of max Re λ and of the stability indicator.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
pub struct InputSensitivity {
    /// Name.
    pub input: String,
    /// Indices of max Re λ; null if it does not vary.
    pub max_re: Option<IndexPair>,
    /// Indices of the indicator max Re λ < 0; null if it does not vary.
    pub stability: Option<IndexPair>,
}

/// First-order and total index.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct IndexPair {
    /// First order.
    pub first: Bounded,
    /// Total.
    pub total: Bounded,
}

/// A value with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
        let bounded =
            |estimate: Estimate| Bounded { value: estimate.value, lower: estimate.lower, upper: estimate.upper };
        let pair = |indices: &Option<Vec<Sensitivity>>, j: usize| {
            let index = indices.as_ref()?.get(j)?;
            Some(IndexPair { first: bounded(index.first), total: bounded(index.total) })
        };
        let input = |(j, name): (usize, &str)| InputSensitivity {
            input: name.to_owned(),
            max_re: pair(&found.max_re, j),
            stability: pair(&found.stability, j),
        };
        Self { samples: found.samples, level: SENSITIVITY_LEVEL, inputs: names.enumerate().map(input).collect() }
    }
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
        let cell = |value: Option<Bounded>| {
            value.map_or("–".to_owned(), |Bounded { value, lower, upper }| {
                format!("{value:.3} ± {:.3}", (value - lower).max(upper - value))
            })
        };
        for input in &self.inputs {
            table.row([
                input.input.clone(),
                cell(input.max_re.map(|pair| pair.first)),
                cell(input.max_re.map(|pair| pair.total)),
                cell(input.stability.map(|pair| pair.first)),
                cell(input.stability.map(|pair| pair.total)),
            ]);
        }
        let note = "share of what decides stability that an input causes alone / in all, ± at 95 %";
        writeln!(f, "\n{table}{note}; first ≤ total within that")
    }
}

/// The distribution of the critical value of one input.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CriticalReport {
    /// Name of the input.
    pub input: String,
    /// Samples of the other inputs.
    pub samples: u64,
    /// Share that stays stable over the whole domain.
    pub never: f64,
    /// Share that is unstable at the lower bound already.
    pub unstable_from_start: f64,
    /// Mean critical value of those that lose stability; null if none does.
    pub mean: Option<f64>,
    /// Smallest critical value.
    pub minimum: Option<f64>,
    /// Largest critical value.
    pub maximum: Option<f64>,
    /// Quantiles over all samples; null where that share never loses stability.
    pub quantiles: Vec<CriticalQuantile>,
}

/// One quantile of the critical value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CriticalQuantile {
    /// Share of all samples that lose stability at this value or below.
    pub level: f64,
    /// The value.
    pub value: Option<f64>,
}

impl CriticalReport {
    /// The report for the input with this name.
    pub fn new(input: &str, found: &CriticalValues) -> Self {
        let share = |part: u64| part as f64 / found.samples as f64;
        let quantile = |level| CriticalQuantile { level, value: found.quantile(level) };
        Self {
            input: input.to_owned(),
            samples: found.samples,
            never: share(found.never),
            unstable_from_start: share(found.unstable_from_start),
            mean: found.mean(),
            minimum: found.minimum(),
            maximum: found.maximum(),
            quantiles: CRITICAL_LEVELS.map(quantile).to_vec(),
        }
    }
}

impl fmt::Display for CriticalReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = |value: Option<f64>| value.map_or("never".to_owned(), |value| significant(value, 4));
        writeln!(f, "\ncritical {}: the smallest value at which the system is no longer stable", self.input)?;
        writeln!(f, "  stable throughout      {:.3} %", 100.0 * self.never)?;
        writeln!(f, "  unstable from start    {:.3} %", 100.0 * self.unstable_from_start)?;
        let (mean, minimum, maximum) = (value(self.mean), value(self.minimum), value(self.maximum));
        let start = if self.unstable_from_start > 0.0 { "; the lower bound for those unstable from start" } else { "" };
        writeln!(f, "  critical values        mean {mean}, {minimum} to {maximum}{start}\n")?;
        let mut columns = vec![("share unstable at or below", Align::Left)];
        let levels: Vec<String> = self.quantiles.iter().map(|q| format!("{} %", 100.0 * q.level)).collect();
        columns.extend(levels.iter().map(|level| (level.as_str(), Align::Right)));
        let mut table = Table::new(&columns);
        let mut row = vec![self.input.clone()];
        row.extend(self.quantiles.iter().map(|quantile| value(quantile.value)));
        table.row(row);
        write!(f, "{table}")
    }
}
