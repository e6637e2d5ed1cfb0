//! Monte Carlo on the initial model.

use crate::design::{ModeCount, RunError, direct_computation};
use crate::input::random_point;
use crate::model::{Model, ModelError};
use crate::progress::Observer;
use crate::random::Purpose;
use crate::spectrum::{Block, Output, Spectrum, SpectrumError, Summary};
use crate::study::Study;
use nalgebra::Complex;
use rayon::prelude::*;
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
        "the surrogate was built for another problem (its hash is {surrogate}, the study's is {study}): model, \
         constants, inputs or spectrum differ; give the study it was built from"
    )]
    OtherProblem {
        /// Hash in the surrogate.
        surrogate: String,
        /// Hash of the study.
        study: String,
    },
    /// The user asked to stop.
    #[error("interrupted")]
    Interrupted,
}

/// One sample of the model, seen as the study asks.
pub(super) struct Run {
    /// Standardized coordinates.
    pub standardized: Vec<f64>,
    /// All modes.
    pub spectrum: Spectrum,
    /// Values of the study's components, by id.
    pub components: Vec<f64>,
    /// Eigenvalues of the study's modes.
    pub eigenvalues: Vec<Complex<f64>>,
}

/// Runs the model at samples 0 … `samples` − 1 of the study's input space, the points that
/// [`crate::eval::monte_carlo`] takes, and gives them to `consume` chunk by chunk, in order.
pub(super) fn for_each_chunk(
    study: &Study,
    samples: u64,
    seed: u64,
    observer: &dyn Observer,
    mut consume: impl FnMut(&[Run]),
) -> Result<(), ReferenceError> {
    if samples == 0 {
        return Err(ReferenceError::NoSamples);
    }
    let model = study.model()?;
    let mut mode_count = ModeCount::default();
    observer.begin("model runs", samples);
    for start in (0..samples).step_by(CHUNK as usize) {
        let runs: Result<Vec<Run>, RunError> = (start..samples.min(start + CHUNK))
            .into_par_iter()
            .map(|index| random_run(study, model.as_ref(), seed, index))
            .collect();
        let runs = runs?;
        for run in &runs {
            mode_count.check(&study.inputs, &study.inputs.physical(&run.standardized), &run.spectrum)?;
        }
        consume(&runs);
        observer.advance(runs.len() as u64);
        if observer.interrupted() {
            return Err(ReferenceError::Interrupted);
        }
    }
    observer.finish();
    Ok(())
}

fn random_run(study: &Study, model: &dyn Model, seed: u64, index: u64) -> Result<Run, RunError> {
    let mut standardized = vec![0.0; study.inputs.dimension()];
    random_point(&study.inputs, seed, Purpose::Evaluation, index, &mut standardized);
    run(study, model, standardized)
}

/// One direct computation at a standardized point.
fn run(study: &Study, model: &dyn Model, standardized: Vec<f64>) -> Result<Run, RunError> {
    let physical = study.inputs.physical(&standardized);
    let spectrum = direct_computation(model, &study.inputs, &physical)?;
    let selected = || -> Result<_, SpectrumError> {
        let modes = study.spectrum.modes.ranks(spectrum.count())?;
        let components = study.spectrum.target.components(&modes, &spectrum)?;
        let eigenvalues: Result<Vec<_>, _> = modes.iter().map(|&mode| spectrum.mode(mode)).collect();
        Ok((components, eigenvalues?))
    };
    let (components, eigenvalues) =
        selected().map_err(|source| RunError::Spectrum { point: study.inputs.describe(&physical), source })?;
    Ok(Run { standardized, spectrum, components, eigenvalues })
}

/// Statistics of the model itself on samples 0 … `samples` − 1 under `seed`, the paper's MCIM, on the current rayon
/// thread pool.
///
/// # Errors
///
/// [`ReferenceError`]; a failed run is reported with its parameters.
pub fn monte_carlo(
    study: &Study,
    samples: u64,
    seed: u64,
    observer: &dyn Observer,
) -> Result<Reference, ReferenceError> {
    let mut reference: Option<Reference> = None;
    for_each_chunk(study, samples, seed, observer, |runs| {
        let reference = reference.get_or_insert_with(|| Reference::new(study, &runs[0]));
        let (components, modes) = (reference.summary.components.len(), reference.modes.len());
        let mut block = Block::with_capacity(components, modes, runs.len());
        for run in runs {
            block.push(&run.components, &run.eigenvalues, run.spectrum.max_re());
        }
        reference.summary.merge(&Summary::of(&block));
    })?;
    reference.ok_or(ReferenceError::NoSamples)
}

/// What direct computations say.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Frequency ranks of the study's modes.
    pub modes: Vec<usize>,
    /// The study's outputs: what the components form.
    pub outputs: Vec<Output>,
    /// Statistics.
    pub summary: Summary,
}

impl Reference {
    fn new(study: &Study, run: &Run) -> Self {
        // A first run with these modes exists, so the ranks are known to be valid.
        let modes = study.spectrum.modes.ranks(run.spectrum.count()).unwrap_or_default();
        let outputs = study.spectrum.target.outputs(&modes);
        Self { summary: Summary::new(run.components.len(), modes.len()), modes, outputs }
    }
}

/// The model at given physical points: per point the eigenvalues of the study's modes and max Re λ over all modes.
///
/// # Errors
///
/// [`ReferenceError`]; a failed run is reported with its parameters.
pub fn at_points(study: &Study, points: &[Vec<f64>]) -> Result<Vec<(Vec<Complex<f64>>, f64)>, ReferenceError> {
    let model = study.model()?;
    let runs: Result<Vec<Run>, RunError> =
        points.par_iter().map(|point| run(study, model.as_ref(), study.inputs.standardized(point))).collect();
    Ok(runs?.into_iter().map(|run| (run.eigenvalues, run.spectrum.max_re())).collect())
}
