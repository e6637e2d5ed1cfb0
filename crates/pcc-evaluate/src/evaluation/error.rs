//! Why an evaluation gave no result.

use crate::foundation::Interrupted;
use thiserror::Error;

/// Why an evaluation gave no result.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum EvalError {
    /// Nothing to evaluate.
    #[error("no samples were asked for; use at least 1")]
    NoSamples,
    /// A component is too large for double precision, or NaN.
    #[error("the surrogate's value at {point} is not a finite number; the file is of no use there")]
    NotFinite {
        /// Where: the inputs with their values.
        point: String,
    },
    /// An input was asked for that does not exist.
    #[error("input number {input} was asked for, but there are only {inputs}; they are numbered from 0")]
    NoSuchInput {
        /// Number asked for, from 0.
        input: usize,
        /// Number of inputs.
        inputs: usize,
    },
    /// What is known of independent inputs alone was asked of one that others depend on.
    #[error("other inputs depend on {input}, so that nothing can be said of it alone")]
    Dependent {
        /// Name of the input.
        input: String,
    },
    /// Shapley effects where an input that others depend on is confined to an interval.
    #[error("others depend on {input}, which is confined to an interval: there are no Shapley effects then")]
    ConfinedDependent {
        /// Name of the input.
        input: String,
    },
    /// The user asked to stop.
    #[error("{0}")]
    Interrupted(#[from] Interrupted),
}
