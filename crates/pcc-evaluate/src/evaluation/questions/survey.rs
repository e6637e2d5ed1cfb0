//! A question put to a surrogate, worked off in chunks of samples.
//!
//! Samples are addressed by number, counts are integers, and moments are combined along a fixed tree
//! ([`crate::probability::statistics::MergeTree`]), so the answer depends neither on the number of threads nor on
//! shards.

use super::division::Division;
use super::extrapolated::Sides;
use super::findings::Findings;
use super::histogram::Histogram;
use super::quantity::Quantity;
use super::question::{Bins, Event, Question, Sampler};
use super::region::{Region, Regions};
use super::source::{Drawing, Source};
use super::survey_error::SurveyError;
use super::tally::{Adding, Gathering, Tally, Watch};
use crate::evaluation::error::EvalError;
use crate::evaluation::kernel::lanes::{BLOCK_POINTS, Lanes};
use crate::evaluation::kernel::plan::Plan;
use crate::evaluation::kernel::points::Evaluator;
use crate::evaluation::kernel::results::Results;
use crate::foundation::{InstructionSet, Observer};
use crate::surrogate::Surrogate;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Chunks whose results are held in memory before they are combined.
const CHUNKS_IN_FLIGHT: u64 = 1024;

/// A question that fits a surrogate, ready to be worked off.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::artifact;
/// use pcc_evaluate::evaluation::{Surveyed, Question, Survey, Sweep};
/// use pcc_evaluate::foundation::{InstructionSet, Silent};
/// let surrogate = artifact::decode(include_bytes!("../../../../../surrogates/clutch-r2.pcc"))?.surrogate;
/// let friction = Sweep { input: "mu".to_owned(), from: 0.0, to: 0.5, points: 6 };
/// let question = Question { sweeps: vec![friction], ..Question::plain(10_000, 1) };
/// let survey = Survey::new(&surrogate, &question, InstructionSet::best())?;
/// // Two shards, one after the other; they could be on two machines.
/// let shards = [0, 1].map(|shard| survey.run(survey.division().shard(shard, 2), &Silent));
/// let [Ok(Surveyed::Complete(mut all)), Ok(Surveyed::Complete(rest))] = shards else { panic!() };
/// assert!(all.append(rest, survey.division()));
/// let shares: Vec<f64> = all
///     .answer(survey.division())
///     .cells
///     .iter()
///     .map(|cell| cell.share(0.95, |tally| tally.summary.stable).value)
///     .collect();
/// assert!(shares[0] > 0.99 && shares[5] < 0.01, "{shares:?}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Survey<'a> {
    surrogate: &'a Surrogate,
    plan: Plan,
    division: Division,
    /// One box per point of the sweeps.
    regions: Regions,
    /// One per replicate.
    sources: Vec<Source>,
    watches: Vec<Watch>,
    /// The box that the model runs spanned.
    trained: Option<Sides>,
    /// What the histograms are of: those asked for, then those for quantiles.
    binned: Vec<(Quantity, &'a Bins)>,
}

/// The end of a survey: all that was asked for, or what there was when the user asked to stop.
#[derive(Debug, Clone, PartialEq)]
pub enum Surveyed {
    /// All chunks of the range.
    Complete(Findings),
    /// The chunks before the first that was not done; without histograms.
    Interrupted(Findings),
}

impl<'a> Survey<'a> {
    /// Bins of one histogram, at most.
    pub const MOST_BINS: u32 = 1_000_000;

    /// Replicates, at most: each has scrambled direction numbers of its own.
    pub const MOST_REPLICATES: u32 = 1000;

    /// Checks `question` against `surrogate`.
    ///
    /// # Errors
    ///
    /// [`SurveyError`]: an input or a quantity that does not exist, bounds outside the domain, numbers that do not fit
    /// each other.
    pub fn new(
        surrogate: &'a Surrogate,
        question: &'a Question,
        instructions: InstructionSet,
    ) -> Result<Self, SurveyError> {
        let regions = Regions::new(&surrogate.inputs, question)?;
        if let Some(&level) = question.quantile_levels.iter().find(|level| !(0.0..=1.0).contains(*level)) {
            return Err(SurveyError::Level { level });
        }
        let (cells, samples) = (regions.count(), question.samples);
        if samples.checked_mul(cells).is_none() {
            return Err(SurveyError::TooManySamples { cells, samples });
        }
        let (sources, samples_per_series) = sources(surrogate, question)?;
        let (watches, binned) = (watches(surrogate, question)?, binned(surrogate, question)?);
        let is_sweep = !question.sweeps.is_empty();
        let kept = |count| if is_sweep { 0 } else { count };
        let division = Division {
            cells,
            replicates: sources.len() as u64,
            samples_per_series,
            chunk: Division::chunk_size(surrogate.mesh.elements().len()),
            components: kept(surrogate.component_count()),
            eigenvalues: kept(surrogate.labels().len()),
            events: watches.len(),
            counts_extrapolated: surrogate.trained_domain.is_some(),
            bins: binned.iter().map(|(_, bins)| bins.bins as usize).collect(),
            is_sweep,
        };
        let plan = Plan::with_instructions(surrogate, instructions);
        let trained = surrogate.trained_domain.as_ref().map(Sides::of);
        Ok(Self { surrogate, plan, division, regions, sources, watches, trained, binned })
    }

    /// How the samples are divided.
    pub fn division(&self) -> &Division {
        &self.division
    }

    /// The boxes that samples are drawn from: one, or one for each point of the sweeps.
    pub fn regions(&self) -> &Regions {
        &self.regions
    }

    /// Works off a range of chunks on the current rayon thread pool.
    ///
    /// # Errors
    ///
    /// [`EvalError::NotFinite`] for the first sample whose max Re λ is not a finite number.
    pub fn run(&self, chunks: Range<u64>, observer: &dyn Observer) -> Result<Surveyed, EvalError> {
        observer.begin("samples", self.division.samples_in(&chunks));
        let result = self.run_observed(chunks, observer);
        observer.finish();
        result
    }

    fn run_observed(&self, chunks: Range<u64>, observer: &dyn Observer) -> Result<Surveyed, EvalError> {
        let mut findings = Findings::new(chunks.start);
        let unused = Mutex::new(Vec::new());
        let mut next = chunks.start;
        while next < chunks.end {
            let batch = next..chunks.end.min(next + CHUNKS_IN_FLIGHT);
            next = batch.end;
            let tallies: Vec<Result<Tally, EvalError>> = batch
                .into_par_iter()
                .map_init(|| Worker::new(self, &unused), |worker, chunk| worker.run(chunk, observer))
                .collect();
            for tally in tallies {
                match tally {
                    Ok(tally) => findings.push(tally, &self.division),
                    Err(EvalError::Interrupted(_)) => return Ok(Surveyed::Interrupted(findings)),
                    Err(error) => return Err(error),
                }
            }
        }
        let mut histograms = self.empty_histograms();
        for found in unused.into_inner().unwrap_or_else(PoisonError::into_inner) {
            histograms.iter_mut().zip(&found).for_each(|(own, added)| own.merge(added));
        }
        findings.set_histograms(histograms);
        Ok(Surveyed::Complete(findings))
    }

    fn empty_histograms(&self) -> Vec<Histogram> {
        self.binned.iter().map(|(_, bins)| Histogram::new(bins.bins)).collect()
    }

    /// Writes the coordinates of samples into lanes.
    fn draw(&self, region: &Region, replicate: usize, first: u64, points: &mut [Lanes]) {
        let source = &self.sources[replicate];
        self.plan.instructions().run(Drawing { source, region, first, points });
    }
}

/// Evaluates chunks, with memory of its own.
struct Worker<'s> {
    survey: &'s Survey<'s>,
    evaluator: Evaluator<'s>,
    /// Taken from those that are not in use, and given back: integers, so it does not matter which chunks are counted
    /// where.
    histograms: Vec<Histogram>,
    unused: &'s Mutex<Vec<Vec<Histogram>>>,
}

impl<'s> Worker<'s> {
    fn new(survey: &'s Survey<'s>, unused: &'s Mutex<Vec<Vec<Histogram>>>) -> Self {
        let taken = unused.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let histograms = taken.unwrap_or_else(|| survey.empty_histograms());
        Self { survey, evaluator: Evaluator::new(survey.surrogate, &survey.plan), histograms, unused }
    }

    fn run(&mut self, chunk: u64, observer: &dyn Observer) -> Result<Tally, EvalError> {
        observer.check()?;
        let (survey, histograms) = (self.survey, &mut self.histograms);
        let (cell, replicate, samples) = survey.division.locate(chunk);
        let count = (samples.end - samples.start) as usize;
        let Division { components, eigenvalues, .. } = survey.division;
        let (shifts, has_reals) = (survey.surrogate.decision.band_shifts(), survey.surrogate.has_real_eigenvalues());
        let judged = (survey.surrogate.verdict, shifts);
        let mut gathering =
            Gathering::new((components, eigenvalues), has_reals, judged, &survey.watches, survey.trained.as_ref());
        let region = survey.regions.at(cell);
        let draw = |start, points: &mut [_]| survey.draw(&region, replicate, samples.start + start as u64, points);
        let add = |points: &[Lanes], results: &Results, lanes| {
            survey.plan.instructions().run(Adding { gathering: &mut gathering, points, results, lanes });
            for (histogram, (quantity, bins)) in histograms.iter_mut().zip(&survey.binned) {
                histogram.add(&quantity.values(results), lanes, bins);
            }
        };
        self.evaluator.each_block(count, draw, add);
        if !gathering.is_finite() {
            return Err(self.not_finite(&region, replicate, samples));
        }
        observer.advance(count as u64);
        Ok(gathering.tally())
    }

    /// Names the first sample whose max Re λ is not finite.
    fn not_finite(&mut self, region: &Region, replicate: usize, samples: Range<u64>) -> EvalError {
        let (survey, inputs) = (self.survey, &self.survey.surrogate.inputs);
        let count = (samples.end - samples.start) as usize;
        let (mut seen, mut found) = (0, None);
        let draw = |start, points: &mut [_]| survey.draw(region, replicate, samples.start + start as u64, points);
        self.evaluator.each_block(count, draw, |_, results, lanes| {
            let bad = results.max_re.0[..lanes].iter().position(|max_re| !max_re.is_finite());
            found = found.or(bad.map(|lane| seen + lane));
            seen += BLOCK_POINTS;
        });
        let mut points = vec![Lanes::splat(0.0); inputs.dimension()];
        survey.draw(region, replicate, samples.start + found.unwrap_or(0) as u64, &mut points);
        let point: Vec<f64> = points.iter().map(|coordinate| coordinate.0[0]).collect();
        EvalError::NotFinite { point: inputs.describe(&inputs.physical(&point)) }
    }
}

impl Drop for Worker<'_> {
    fn drop(&mut self) {
        let histograms = std::mem::take(&mut self.histograms);
        self.unused.lock().unwrap_or_else(PoisonError::into_inner).push(histograms);
    }
}

/// Of the two powers of two around `number` the nearer one.
fn nearest_power_of_two(number: u64) -> u64 {
    let below = 1u64 << number.max(1).ilog2();
    if number - below > below / 2 { below.saturating_mul(2) } else { below }
}

/// One source per replicate, and the number of points of each.
fn sources(surrogate: &Surrogate, question: &Question) -> Result<(Vec<Source>, u64), SurveyError> {
    let Question { samples, sampler, replicates, seed, .. } = *question;
    let replicates = replicates.max(1);
    if samples == 0 {
        return Err(SurveyError::NoSamples);
    }
    if sampler == Sampler::MonteCarlo && replicates > 1 {
        return Err(SurveyError::ReplicatesOfMonteCarlo);
    }
    if sampler != Sampler::MonteCarlo && replicates < 2 {
        return Err(SurveyError::TooFewReplicates);
    }
    if replicates > Survey::MOST_REPLICATES {
        return Err(SurveyError::TooManyReplicates { replicates, most: Survey::MOST_REPLICATES });
    }
    if !samples.is_multiple_of(u64::from(replicates)) {
        let replicates = u64::from(replicates);
        let each = samples.div_ceil(replicates);
        let each = if sampler == Sampler::Sobol { nearest_power_of_two(each) } else { each };
        return Err(SurveyError::NotDivisible { samples, replicates, better: each.saturating_mul(replicates) });
    }
    let (samples, dimension) = (samples / u64::from(replicates), surrogate.inputs.dimension());
    let too_small = || SurveyError::SamplerTooSmall { sampler, samples, dimension };
    let source = |replicate| Source::new(sampler, seed, replicate, samples, dimension).ok_or_else(too_small);
    Ok(((0..replicates).map(source).collect::<Result<_, _>>()?, samples))
}

fn quantity(name: &str, surrogate: &Surrogate) -> Result<Quantity, SurveyError> {
    Quantity::named(name, surrogate).ok_or_else(|| SurveyError::unknown_quantity(name, surrogate))
}

fn watches(surrogate: &Surrogate, question: &Question) -> Result<Vec<Watch>, SurveyError> {
    let watch = |event: &Event| {
        if !event.threshold.is_finite() {
            return Err(SurveyError::NotANumber { what: event.text() });
        }
        let quantity = quantity(&event.quantity, surrogate)?;
        Ok(Watch { quantity, below: event.below, threshold: event.threshold })
    };
    question.events.iter().map(watch).collect()
}

fn binned<'q>(surrogate: &Surrogate, question: &'q Question) -> Result<Vec<(Quantity, &'q Bins)>, SurveyError> {
    let all = || question.histograms.iter().chain(&question.quantile_bins);
    if !question.sweeps.is_empty() && all().next().is_some() {
        return Err(SurveyError::HistogramOfSweep);
    }
    let checked = |bins: &'q Bins| {
        let width = bins.upper - bins.lower;
        let is_usable = (1..=Survey::MOST_BINS).contains(&bins.bins) && width > 0.0 && width.is_finite();
        if !is_usable {
            return Err(SurveyError::Bins { bins: bins.clone(), most: Survey::MOST_BINS });
        }
        Ok((quantity(&bins.quantity, surrogate)?, bins))
    };
    all().map(checked).collect()
}
