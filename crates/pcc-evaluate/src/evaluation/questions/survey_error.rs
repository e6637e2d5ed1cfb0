//! Why a question cannot be put to a surrogate.

use super::quantity::Quantity;
use super::question::{Bins, Condition, Sampler, Sweep};
use crate::probability::inputs::InputSpace;
use crate::surrogate::Surrogate;
use thiserror::Error;

/// Why a question cannot be put to a surrogate.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SurveyError {
    /// Nothing to evaluate.
    #[error("no samples were asked for; use at least 1")]
    NoSamples,
    /// Independent samples need no replicates.
    #[error("Monte Carlo needs no replicates; leave them out, or choose the sampler sobol or latin-hypercube")]
    ReplicatesOfMonteCarlo,
    /// One randomisation, whose error nobody knows.
    #[error("a single randomisation says nothing of its own error; use 2 replicates or more")]
    TooFewReplicates,
    /// Probabilities outside 0 and 1.
    #[error("a quantile is at a probability from 0 to 1, not {level}")]
    Level {
        /// As asked.
        level: f64,
    },
    /// More replicates than memory should hold.
    #[error("{replicates} replicates are more than {most}; use fewer, 16 for example")]
    TooManyReplicates {
        /// Number of replicates.
        replicates: u32,
        /// The limit.
        most: u32,
    },
    /// More samples than can be numbered.
    #[error("the sweeps have {cells} points with {samples} samples each, more than can be numbered; use fewer samples")]
    TooManySamples {
        /// Points of all sweeps.
        cells: u64,
        /// Samples of each.
        samples: u64,
    },
    /// Replicates of different size.
    #[error("{samples} samples cannot be divided among {replicates} replicates; use a multiple, {better} for example")]
    NotDivisible {
        /// Number of samples.
        samples: u64,
        /// Number of replicates.
        replicates: u64,
        /// A number that can be, and that suits the sampler.
        better: u64,
    },
    /// More points or dimensions than the sampler has.
    #[error(
        "the sampler {} cannot draw {samples} points of {dimension} inputs; it is made for 2^52 points and, if it is sobol, 256 inputs",
        sampler.name()
    )]
    SamplerTooSmall {
        /// The sampler.
        sampler: Sampler,
        /// Points per replicate.
        samples: u64,
        /// Number of inputs.
        dimension: usize,
    },
    /// No such input.
    #[error("the surrogate has no input {input}; it has {known}")]
    UnknownInput {
        /// As typed.
        input: String,
        /// Those there are.
        known: String,
    },
    /// No such quantity.
    #[error("the surrogate has no quantity {quantity}; it has {known}")]
    UnknownQuantity {
        /// As typed.
        quantity: String,
        /// Those there are.
        known: String,
    },
    /// An input confined, fixed or swept more than once.
    #[error("{input} is confined, fixed or swept twice; name it once")]
    InputTwice {
        /// Name of the input.
        input: String,
    },
    /// Intervals of two inputs that depend on each other.
    #[error(
        "{one} and {other} depend on each other, and only one of them can be confined to an interval; fix one of them, or \
         widen its interval to all of its range"
    )]
    Intervals {
        /// One input.
        one: String,
        /// The other.
        other: String,
    },
    /// An interval in which a correlated input has no probability where others are fixed.
    #[error(
        "with the inputs that are fixed, {input} practically never lies in its interval; fix them or it somewhere else"
    )]
    Improbable {
        /// The input that is confined to an interval.
        input: String,
    },
    /// A value outside the domain, where the surrogate knows nothing.
    #[error("{input} = {value:?} lies outside [{lower:?}, {upper:?}], where the surrogate knows nothing")]
    Outside {
        /// Name of the input.
        input: String,
        /// Its value.
        value: f64,
        /// Lower bound of the domain.
        lower: f64,
        /// Upper bound of the domain.
        upper: f64,
    },
    /// Values between those that an input can take.
    #[error("{input} takes single values, and none of {:?} to {:?}; `pcc inspect` lists them", values[0], values[1])]
    NoLevel {
        /// Name of the input.
        input: String,
        /// From where to where.
        values: [f64; 2],
    },
    /// An interval upside down.
    #[error("{}={:?}..{:?}: the lower bound comes first; swap them", condition.input, condition.lower, condition.upper)]
    Inverted {
        /// The condition.
        condition: Condition,
    },
    /// A sweep that goes nowhere.
    #[error("{}={:?}:{:?}:{}: a sweep has at least 2 points, its first and its last value", sweep.input, sweep.from, sweep.to, sweep.points)]
    TooFewSteps {
        /// The sweep.
        sweep: Sweep,
    },
    /// More points than memory should hold.
    #[error("the sweeps have more than {most} points together{}; use fewer", of_replicates(*replicates))]
    TooManyCells {
        /// Replicates of each point.
        replicates: u32,
        /// The limit.
        most: u64,
    },
    /// A threshold that is no number.
    #[error("{what}: the threshold must be a finite number")]
    NotANumber {
        /// As typed.
        what: String,
    },
    /// Bins that hold nothing.
    #[error(
        "histogram of {} from {:?} to {:?} in {} bins: the lower edge must be below the upper, both finite, with 1 to {most} bins",
        bins.quantity, bins.lower, bins.upper, bins.bins
    )]
    Bins {
        /// The bins.
        bins: Bins,
        /// The limit.
        most: u32,
    },
    /// A histogram for each point of a sweep.
    #[error("histograms and quantiles are of one set of samples, not of a sweep; ask for them without it")]
    HistogramOfSweep,
}

fn of_replicates(replicates: u32) -> String {
    if replicates > 1 { format!(", with {replicates} replicates each") } else { String::new() }
}

impl SurveyError {
    pub(crate) fn unknown_input(name: &str, inputs: &InputSpace) -> Self {
        Self::UnknownInput { input: name.to_owned(), known: inputs.names().collect::<Vec<_>>().join(", ") }
    }

    /// The error for a quantity that the surrogate does not have.
    pub fn unknown_quantity(name: &str, surrogate: &Surrogate) -> Self {
        let known: Vec<String> =
            Quantity::all(surrogate).into_iter().map(|quantity| quantity.name(surrogate)).collect();
        Self::UnknownQuantity { quantity: name.to_owned(), known: known.join(", ") }
    }
}
