//! Monte Carlo on the initial model.

use crate::campaign::{Campaign, Run, RunError, Runner, agree_on_rigid_body_motion};
use crate::mechanics::model::ModelError;
use crate::mechanics::spectrum::{Spectrum, Target};
use crate::study::Study;
use nalgebra::Complex;
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
    /// A certificate on so few runs says nothing.
    #[error("{runs} model runs are too few for a certificate; use at least {least}")]
    TooFewRuns {
        /// Runs that were asked for.
        runs: u64,
        /// The fewest that are made.
        least: u64,
    },
    /// No number of runs makes a bound so narrow.
    #[error(
        "no number of model runs makes a bound {width} wide: by {samples} samples of the surrogate its own share is known \
         to {known:.1e} only; use a larger width"
    )]
    TooNarrow {
        /// The width that was asked for.
        width: f64,
        /// Samples of the surrogate.
        samples: u64,
        /// How far the upper end of its own share lies above it.
        known: f64,
    },
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
    let is_same =
        surrogate.provenance.problem_hash == study.problem_hash() && surrogate.inputs.is_same_as(&study.inputs);
    if is_same { Ok(()) } else { Err(ReferenceError::other_problem(surrogate, study)) }
}

/// Runs the model at samples 0 … `samples` − 1 of the study's input space for `purpose`, for evaluation the points that
/// [`pcc_evaluate::evaluation::monte_carlo`] takes, and gives them to `consume` chunk by chunk, in order: standardized
/// points and runs, then the points at which runs failed, if the campaign counts those.
pub(super) fn for_each_chunk(
    campaign: Campaign<'_>,
    samples: u64,
    seed: u64,
    purpose: Purpose,
    observer: &dyn Observer,
    mut consume: impl FnMut(&[Vec<f64>], &[Run], &[Vec<f64>]) -> Result<(), ReferenceError>,
) -> Result<(), ReferenceError> {
    let inputs = &campaign.study.inputs;
    let point = |index| {
        let mut point = vec![0.0; inputs.dimension()];
        random_point(inputs, seed, purpose, index, &mut point);
        point
    };
    for_each_chunk_of(campaign, samples, point, observer, |chunk| consume(&chunk.points, &chunk.runs, &chunk.failed))
}

/// Points with what the model answered.
pub(super) struct Chunk {
    /// Standardized points with an answer.
    pub points: Vec<Vec<f64>>,
    /// Their numbers.
    pub numbers: Vec<u64>,
    /// Their runs.
    pub runs: Vec<Run>,
    /// Standardized points at which runs failed.
    pub failed: Vec<Vec<f64>>,
    /// Their numbers.
    pub failed_numbers: Vec<u64>,
}

/// The same at `count` standardized points that `point` gives by number.
pub(super) fn for_each_chunk_of(
    campaign: Campaign<'_>,
    count: u64,
    point: impl Fn(u64) -> Vec<f64>,
    observer: &dyn Observer,
    mut consume: impl FnMut(&Chunk) -> Result<(), ReferenceError>,
) -> Result<(), ReferenceError> {
    if count == 0 {
        return Err(ReferenceError::NoSamples);
    }
    let study = campaign.study;
    // Whether a system is stable takes no numbers of modes.
    let mut runner = Runner::new(campaign)?.without_ranks();
    let mut rigid_body_modes = usize::MAX;
    observer.begin("model runs", count);
    for start in (0..count).step_by(CHUNK as usize) {
        let numbers = start..count.min(start + CHUNK);
        let standardized: Vec<Vec<f64>> = numbers.clone().map(&point).collect();
        let physical: Vec<Vec<f64>> = standardized.iter().map(|point| study.inputs.physical(point)).collect();
        let found = match campaign.counts_failures {
            true => runner.run_counting(&physical, observer)?,
            false => runner.run(&physical, observer)?.into_iter().map(Some).collect(),
        };
        let mut chunk = Chunk {
            points: Vec::new(),
            numbers: Vec::new(),
            runs: Vec::new(),
            failed: Vec::new(),
            failed_numbers: Vec::new(),
        };
        for ((point, run), number) in standardized.into_iter().zip(found).zip(numbers) {
            match run {
                Some(run) => {
                    chunk.points.push(point);
                    chunk.numbers.push(number);
                    chunk.runs.push(run);
                }
                None => {
                    chunk.failed.push(point);
                    chunk.failed_numbers.push(number);
                }
            }
        }
        rigid_body_modes = agree_on_rigid_body_motion(&mut chunk.runs, rigid_body_modes);
        consume(&chunk)?;
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
    /// Re λ and Im λ of every mode of the study, by frequency rank. None if their number changes from point to point,
    /// or one that the study lists does not exist everywhere: shares need no numbers, statistics of modes do.
    pub outputs: Vec<Output>,
    /// Statistics.
    pub summary: Summary,
    /// Number of eigenvalues that are rigid-body motion.
    pub rigid_body_modes: usize,
    /// Whether all eigenvalues lie on the imaginary axis or symmetric to it, at every point.
    pub is_undamped: bool,
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
    let campaign = campaign.into();
    let mut reference: Option<(Reference, Ranks)> = None;
    // A share of the model's own takes all runs.
    let campaign = Campaign { counts_failures: false, ..campaign };
    for_each_chunk(campaign, samples, seed, Purpose::Evaluation, observer, |_, runs, _| {
        let (reference, ranks) = reference.get_or_insert_with(|| {
            let ranks = Ranks::of(campaign.study, runs.first());
            let outputs = mode_outputs(ranks.modes());
            let summary = Summary::new(2 * outputs.len(), outputs.len());
            (Reference { outputs, summary, rigid_body_modes: 0, is_undamped: true }, ranks)
        });
        if !ranks.hold_for(runs) {
            ranks.give_up();
            reference.outputs.clear();
            reference.summary.components.clear();
            reference.summary.eigenvalues.clear();
        }
        reference.rigid_body_modes = runs.first().map_or(0, |run| run.spectrum.rigid_body_modes());
        reference.is_undamped = reference.is_undamped && runs.iter().all(|run| run.spectrum.is_undamped());
        let mut block = Block::with_capacity(2 * ranks.modes().len(), ranks.modes().len(), runs.len());
        for run in runs {
            let lambdas = ranks.eigenvalues(&run.spectrum);
            let components: Vec<f64> = lambdas.iter().flat_map(|lambda| [lambda.re, lambda.im]).collect();
            block.push(&components, &lambdas, run.spectrum.top());
        }
        // What cannot be told from zero is zero in a spectrum.
        let margin = campaign.study.spectrum.margin;
        reference.summary.merge(&Summary::of(&block, margin, 0.0, [0.0; 2]));
        Ok(())
    })?;
    reference.map(|(reference, _)| reference).ok_or(ReferenceError::NoSamples)
}

/// Frequency ranks of a study's modes, as long as the same number of modes oscillates at every point.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ranks {
    count: usize,
    modes: Vec<usize>,
}

impl Ranks {
    /// By the first run; none if a mode that the study lists does not exist.
    pub fn of(study: &Study, first: Option<&Run>) -> Self {
        let count = first.map_or(0, |run| run.spectrum.count());
        Self { count, modes: study.spectrum.modes.ranks(count).unwrap_or_default() }
    }

    /// Ranks from 1, ascending.
    pub fn modes(&self) -> &[usize] {
        &self.modes
    }

    /// Whether as many modes oscillate in all of these runs.
    pub fn hold_for(&self, runs: &[Run]) -> bool {
        self.modes.is_empty() || runs.iter().all(|run| run.spectrum.count() == self.count)
    }

    /// No mode has a rank any more.
    pub fn give_up(&mut self) {
        self.modes.clear();
    }

    /// The eigenvalues of the modes.
    pub fn eigenvalues(&self, spectrum: &Spectrum) -> Vec<Complex<f64>> {
        self.modes.iter().filter_map(|&mode| spectrum.mode(mode).ok()).collect()
    }
}

/// Re λ and Im λ of every mode: the components of a reference, whatever a surrogate expands.
pub(super) fn mode_outputs(modes: &[usize]) -> Vec<Output> {
    // Eigenvalues are not grouped, so no spectrum is needed and nothing can be wrong with one.
    Target::Eigenvalues.outputs(modes, &[]).unwrap_or_default()
}
