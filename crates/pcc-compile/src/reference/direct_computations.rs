//! Monte Carlo on the initial model.

use crate::campaign::{Campaign, Run, RunError, Runner};
use crate::mechanics::model::ModelError;
use crate::mechanics::spectrum::{SpectrumError, Target};
use crate::study::Study;
use pcc_evaluate::components::{Block, Output, Summary};
use pcc_evaluate::evaluation::{EvalError, Plan, evaluate_points};
use pcc_evaluate::foundation::Observer;
use pcc_evaluate::probability::inputs::random_point;
use pcc_evaluate::probability::random::Purpose;
use pcc_evaluate::probability::statistics::Merge;
use pcc_evaluate::surrogate::Surrogate;
use thiserror::Error;

/// Samples summarised together, in the order of their numbers.
const CHUNK: u64 = 4096;

/// Why no reference was computed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ReferenceError {
    /// Nothing to compute.
    #[error("no samples were asked for; use at least 1")]
    NoSamples,
    /// The model could not be set up.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A model run failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The surrogate answers another question than the study asks.
    #[error(
        "the surrogate was built for another problem (hash {surrogate:.12}…, the study's is {study:.12}…): model, \
         constants, inputs or spectrum differ; give the study it was built from"
    )]
    OtherProblem {
        /// Hash in the surrogate.
        surrogate: String,
        /// Hash of the study.
        study: String,
    },
    /// A mode of the surrogate is missing at a point.
    #[error("{cause}; found at {point}")]
    Spectrum {
        /// Where: the inputs with their values.
        point: String,
        /// Why.
        #[source]
        cause: SpectrumError,
    },
    /// The surrogate could not be sampled.
    #[error(transparent)]
    Surrogate(EvalError),
    /// The surrogate has no finite value at a point.
    #[error("the surrogate's value at {point} is not a finite number; the file is of no use there")]
    NotFinite {
        /// Where: the inputs with their values.
        point: String,
    },
}

impl ReferenceError {
    /// The refusal of a study that asks another question than the surrogate answers.
    pub(super) fn other_problem(surrogate: &Surrogate, study: &Study) -> Self {
        Self::OtherProblem { surrogate: surrogate.provenance.problem_hash.clone(), study: study.problem_hash() }
    }
}

/// Whether `surrogate` answers what `study` asks.
///
/// # Errors
///
/// [`ReferenceError::OtherProblem`] if model, constants, inputs or spectrum differ.
pub fn check_problem(surrogate: &Surrogate, study: &Study) -> Result<(), ReferenceError> {
    let is_same = surrogate.provenance.problem_hash == study.problem_hash() && surrogate.inputs == study.inputs;
    if is_same { Ok(()) } else { Err(ReferenceError::other_problem(surrogate, study)) }
}

/// Runs the model at samples 0 … `samples` − 1 of the study's input space for `purpose`, for evaluation the points that
/// [`pcc_evaluate::evaluation::monte_carlo`] takes, and gives them to `consume` chunk by chunk, in order: standardized
/// points and runs.
pub(super) fn for_each_chunk(
    campaign: Campaign<'_>,
    samples: u64,
    seed: u64,
    purpose: Purpose,
    observer: &dyn Observer,
    mut consume: impl FnMut(&Runner<'_>, &[Vec<f64>], &[Run]) -> Result<(), ReferenceError>,
) -> Result<(), ReferenceError> {
    if samples == 0 {
        return Err(ReferenceError::NoSamples);
    }
    let study = campaign.study;
    let mut runner = Runner::new(campaign)?;
    observer.begin("model runs", samples);
    for start in (0..samples).step_by(CHUNK as usize) {
        let standardized: Vec<Vec<f64>> = (start..samples.min(start + CHUNK))
            .map(|index| {
                let mut point = vec![0.0; study.inputs.dimension()];
                random_point(&study.inputs, seed, purpose, index, &mut point);
                point
            })
            .collect();
        let physical: Vec<Vec<f64>> = standardized.iter().map(|point| study.inputs.physical(point)).collect();
        let runs = runner.run(&physical, observer)?;
        consume(&runner, &standardized, &runs)?;
    }
    observer.finish();
    Ok(())
}

/// The surrogate at these standardized points, all of its values finite.
pub(super) fn surrogate_block(
    surrogate: &Surrogate,
    plan: &Plan,
    points: &[Vec<f64>],
) -> Result<Block, ReferenceError> {
    let block = evaluate_points(surrogate, plan, &points.iter().map(Vec::as_slice).collect::<Vec<_>>());
    match block.first_not_finite() {
        None => Ok(block),
        Some(at) => {
            let point = surrogate.inputs.describe(&surrogate.inputs.physical(&points[at]));
            Err(ReferenceError::NotFinite { point })
        }
    }
}

/// What direct computations say.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Re λ and Im λ of every mode of the study.
    pub outputs: Vec<Output>,
    /// Statistics.
    pub summary: Summary,
}

/// Statistics of the model itself on samples 0 … `samples` − 1 under `seed`, the paper's MCIM, on the current rayon
/// thread pool.
///
/// # Errors
///
/// [`ReferenceError`]; a failed run is reported with its parameters.
pub fn monte_carlo<'a>(
    campaign: impl Into<Campaign<'a>>,
    samples: u64,
    seed: u64,
    observer: &dyn Observer,
) -> Result<Reference, ReferenceError> {
    let mut reference: Option<Reference> = None;
    for_each_chunk(campaign.into(), samples, seed, Purpose::Evaluation, observer, |runner, _, runs| {
        let outputs = mode_outputs(runner.modes());
        let mut block = Block::with_capacity(2 * outputs.len(), outputs.len(), runs.len());
        for run in runs {
            block.push(&mode_components(run), &run.eigenvalues, run.spectrum.max_re());
        }
        let empty = || Reference { summary: Summary::new(2 * outputs.len(), outputs.len()), outputs };
        reference.get_or_insert_with(empty).summary.merge(&Summary::of(&block, [0.0; 2]));
        Ok(())
    })?;
    reference.ok_or(ReferenceError::NoSamples)
}

/// Re λ and Im λ of every mode: the components of a reference, whatever a surrogate expands.
pub(super) fn mode_outputs(modes: &[usize]) -> Vec<Output> {
    // Eigenvalues are not grouped, so no spectrum is needed and nothing can be wrong with one.
    Target::Eigenvalues.outputs(modes, &[]).unwrap_or_default()
}

/// The values of these components at one point.
pub(super) fn mode_components(run: &Run) -> Vec<f64> {
    run.eigenvalues.iter().flat_map(|lambda| [lambda.re, lambda.im]).collect()
}
