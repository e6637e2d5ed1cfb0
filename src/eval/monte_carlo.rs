//! Streaming Monte Carlo on a surrogate.
//!
//! Samples are numbered; sample i is the same whoever computes it. Fixed chunks of samples are summarised on all cores
//! and merged in the order of their numbers, so counts and moments do not depend on the number of threads, and memory not on
//! the number of samples.

use super::chunks::in_chunks;
use super::plan::Plan;
use super::points::Evaluator;
use crate::input::random_point;
use crate::progress::{Interrupted, Observer};
use crate::random::Purpose;
use crate::spectrum::Summary;
use crate::surrogate::Surrogate;
use std::ops::Range;
use thiserror::Error;

/// Samples summarised together, a multiple of [`super::LANES`]: part of the result's definition, since it fixes the order of sums.
const CHUNK: u64 = 4096;

/// More of them where there are many elements, each of which has some points of a chunk to evaluate together.
const SAMPLES_PER_ELEMENT: u64 = 64;
const LARGEST_CHUNK: u64 = 1 << 16;

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
    /// The user asked to stop.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl EvalError {
    /// Whether the user asked to stop.
    pub fn is_interruption(&self) -> bool {
        matches!(self, Self::Interrupted(_))
    }
}

/// Statistics of samples 0 … `samples` − 1 under `seed`, on the current rayon thread pool.
///
/// # Errors
///
/// [`EvalError`].
pub fn monte_carlo(
    surrogate: &Surrogate,
    samples: u64,
    seed: u64,
    observer: &dyn Observer,
) -> Result<Summary, EvalError> {
    let plan = Plan::new(surrogate);
    let mut summary = Summary::new(surrogate.component_count(), surrogate.modes().len());
    let by_elements = SAMPLES_PER_ELEMENT * surrogate.mesh.elements().len() as u64;
    in_chunks(
        samples,
        by_elements.clamp(CHUNK, LARGEST_CHUNK).next_multiple_of(CHUNK),
        observer,
        || Evaluator::new(surrogate, &plan),
        |evaluator, range| summarise(surrogate, evaluator, seed, range),
        |part| summary.merge(&part),
    )?;
    Ok(summary)
}

/// The statistics of one chunk of samples.
fn summarise(
    surrogate: &Surrogate,
    evaluator: &mut Evaluator<'_>,
    seed: u64,
    range: Range<u64>,
) -> Result<Summary, EvalError> {
    let count = (range.end - range.start) as usize;
    let mut block = evaluator.block(count);
    let set_point = |number, point: &mut [f64]| {
        random_point(&surrogate.inputs, seed, Purpose::Evaluation, range.start + number as u64, point);
    };
    evaluator.evaluate(count, set_point, &mut block);
    match block.first_not_finite() {
        None => Ok(Summary::of(&block, surrogate.decision.band_shifts())),
        Some(at) => {
            let mut point = vec![0.0; surrogate.inputs.dimension()];
            random_point(&surrogate.inputs, seed, Purpose::Evaluation, range.start + at as u64, &mut point);
            Err(EvalError::NotFinite { point: surrogate.inputs.describe(&surrogate.inputs.physical(&point)) })
        }
    }
}
