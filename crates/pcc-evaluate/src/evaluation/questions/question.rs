//! What is asked of a surrogate: how many samples, drawn how and from where, and what to count.
//!
//! A [`Question`] is plain text and numbers, as typed and as kept in part files; [`crate::evaluation::Survey`] checks
//! it against a surrogate.

use super::quantity::{DIVERGENCE, FLUTTER, MARGINAL};
use serde::{Deserialize, Serialize};

/// Kinds of instability are numbers, 1 or 0.
const KIND_THRESHOLD: f64 = 0.5;

/// A question. Two runs with equal questions of the same surrogate give the same answer, bit by bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Question {
    /// Number of samples, all replicates together; with sweeps for each of their points.
    pub samples: u64,
    /// Seed of the samples.
    pub seed: u64,
    /// How samples are drawn.
    pub sampler: Sampler,
    /// Independent randomisations that the samples are divided among; 1 for Monte Carlo.
    pub replicates: u32,
    /// Inputs that are confined or fixed.
    pub conditions: Vec<Condition>,
    /// Inputs that are set to values one after the other.
    pub sweeps: Vec<Sweep>,
    /// What to count beside stability.
    pub events: Vec<Event>,
    /// Histograms to make.
    pub histograms: Vec<Bins>,
    /// Probabilities of quantiles.
    pub quantile_levels: Vec<f64>,
    /// Fine histograms that quantiles are read from.
    pub quantile_bins: Vec<Bins>,
}

/// How samples are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sampler {
    /// Independent random points.
    MonteCarlo,
    /// Scrambled Sobol' points: randomised quasi-Monte Carlo.
    Sobol,
    /// Latin hypercubes.
    LatinHypercube,
}

impl Sampler {
    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::MonteCarlo => "monte-carlo",
            Self::Sobol => "sobol",
            Self::LatinHypercube => "latin-hypercube",
        }
    }

    /// Replicates if none are asked for: enough for a standard error.
    pub fn default_replicates(self) -> u32 {
        match self {
            Self::MonteCarlo => 1,
            Self::Sobol | Self::LatinHypercube => 16,
        }
    }
}

/// An input confined to an interval of its domain, in physical units; equal bounds fix it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Condition {
    /// Name of the input.
    pub input: String,
    /// Lower bound.
    pub lower: f64,
    /// Upper bound.
    pub upper: f64,
}

/// An input set to equally spaced values, in physical units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sweep {
    /// Name of the input.
    pub input: String,
    /// First value.
    pub from: f64,
    /// Last value.
    pub to: f64,
    /// Number of values, at least 2.
    pub points: u32,
}

impl Sweep {
    /// Value number `number`, from 0, to 15 digits if steps are much larger: that is how people write it; the last is
    /// exactly `to`.
    pub fn value(&self, number: u32) -> f64 {
        let last = self.points.saturating_sub(1).max(1);
        match number {
            0 => self.from,
            _ if number >= last => self.to,
            _ => {
                let value = self.from + (self.to - self.from) * (f64::from(number) / f64::from(last));
                let rounded = format!("{value:.14e}").parse().unwrap_or(value);
                let step = (self.to - self.from).abs() / f64::from(last);
                if (rounded - value).abs() < 1e-3 * step { rounded } else { value }
            }
        }
    }
}

/// A quantity below or above a threshold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Name of the quantity, see [`crate::evaluation::Quantity`].
    pub quantity: String,
    /// Whether it is to lie below the threshold; otherwise above.
    pub below: bool,
    /// The threshold, in the quantity's unit.
    pub threshold: f64,
}

impl Event {
    /// A kind of instability by its name, `flutter` or `divergence`; `None` if it is no such name.
    pub fn of_kind(name: &str) -> Option<Self> {
        let is_kind = [FLUTTER, DIVERGENCE, MARGINAL].contains(&name);
        is_kind.then(|| Self { quantity: name.to_owned(), below: false, threshold: KIND_THRESHOLD })
    }

    /// As typed: `max_re<-1`.
    pub fn text(&self) -> String {
        if Self::of_kind(&self.quantity).as_ref() == Some(self) {
            return self.quantity.clone();
        }
        let (side, size) = (if self.below { '<' } else { '>' }, self.threshold.abs());
        match size != 0.0 && !(1e-5..1e15).contains(&size) {
            true => format!("{}{side}{:e}", self.quantity, self.threshold),
            false => format!("{}{side}{}", self.quantity, self.threshold),
        }
    }
}

/// Equal bins of a quantity between two edges.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bins {
    /// Name of the quantity, see [`crate::evaluation::Quantity`].
    pub quantity: String,
    /// Lower edge of the first bin.
    pub lower: f64,
    /// Upper edge of the last bin.
    pub upper: f64,
    /// Number of bins.
    pub bins: u32,
}

impl Bins {
    /// Edge number `number` of `bins` + 1.
    pub fn edge(&self, number: u32) -> f64 {
        if number >= self.bins {
            self.upper
        } else {
            self.lower + (self.upper - self.lower) * (f64::from(number) / f64::from(self.bins))
        }
    }
}

impl Question {
    /// Monte Carlo over the whole domain.
    pub fn plain(samples: u64, seed: u64) -> Self {
        Self {
            samples,
            seed,
            sampler: Sampler::MonteCarlo,
            replicates: 1,
            conditions: Vec::new(),
            sweeps: Vec::new(),
            events: Vec::new(),
            histograms: Vec::new(),
            quantile_levels: Vec::new(),
            quantile_bins: Vec::new(),
        }
    }
}
