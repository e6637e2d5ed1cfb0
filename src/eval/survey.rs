//! A question put to a surrogate, worked off in chunks of samples.
//!
//! All samples of one *series* share a region and a randomisation: every point of a sweep has a series for each replicate.
//! Series are divided into chunks; chunks are numbered through all series, and a shard is a range of numbers. Samples
//! are addressed by number, counts are integers, and moments are combined along a fixed tree ([`Forest`]), so the answer
//! depends neither on the number of threads nor on the shards.

use super::histogram::Histogram;
use super::monte_carlo::EvalError;
use super::plan::Plan;
use super::points::Evaluator;
use super::quantity::Quantity;
use super::question::{Bins, Question, Sampler};
use super::region::Region;
use super::source::{Drawing, Source};
use super::survey_error::SurveyError;
use super::tally::{Adding, Gathering, Tally, Watch};
use crate::input::InputSpace;
use crate::numerics::InstructionSet;
use crate::progress::Observer;
use crate::statistics::{Forest, Merge};
use crate::surrogate::Surrogate;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Samples summarised together, a multiple of [`super::LANES`]: part of the result's definition, since it fixes the order of sums.
const CHUNK: u64 = 4096;

/// More of them where there are many elements, each of which has some points of a chunk to evaluate together.
const SAMPLES_PER_ELEMENT: u64 = 64;
const LARGEST_CHUNK: u64 = 1 << 16;

/// Chunks whose results are held in memory before they are combined.
const CHUNKS_IN_FLIGHT: u64 = 1024;

/// Points of all sweeps together, at most: their counts are kept in memory.
const MOST_CELLS: u64 = 1_000_000;

/// A question that fits a surrogate, ready to be worked off.
#[derive(Debug)]
pub struct Survey<'a> {
    surrogate: &'a Surrogate,
    question: &'a Question,
    plan: Plan,
    /// One per point of the sweeps, the last sweep varying fastest.
    regions: Vec<Region>,
    /// One per replicate.
    sources: Vec<Source>,
    samples_per_series: u64,
    chunk: u64,
    watches: Vec<Watch>,
    /// What the histograms are of: those asked for, then those for quantiles.
    binned: Vec<(Quantity, &'a Bins)>,
}

/// What was found in a range of chunks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Findings {
    /// The first chunk.
    first: u64,
    /// The chunk after the last.
    end: u64,
    /// One per series that the range has chunks of.
    series: Vec<Forest<Tally>>,
    /// One per histogram of the question, those for quantiles last.
    histograms: Vec<Histogram>,
}

/// The end of a survey: all that was asked for, or what there was when the user asked to stop.
#[derive(Debug, Clone, PartialEq)]
pub enum Progress {
    /// All chunks of the range.
    Complete(Findings),
    /// The chunks before the first that was not done; without histograms.
    Interrupted(Findings),
}

impl<'a> Survey<'a> {
    /// Checks `question` against `surrogate`.
    ///
    /// # Errors
    ///
    /// [`SurveyError`]: an input or a quantity that does not exist, bounds outside the domain, numbers that do not fit each other.
    pub fn new(
        surrogate: &'a Surrogate,
        question: &'a Question,
        instructions: InstructionSet,
    ) -> Result<Self, SurveyError> {
        let replicates = u64::from(question.replicates.max(1));
        if question.samples == 0 {
            return Err(SurveyError::NoSamples);
        }
        if question.sampler == Sampler::MonteCarlo && replicates > 1 {
            return Err(SurveyError::ReplicatesOfMonteCarlo);
        }
        if !question.samples.is_multiple_of(replicates) {
            return Err(SurveyError::NotDivisible { samples: question.samples, replicates });
        }
        let samples_per_series = question.samples / replicates;
        let dimension = surrogate.inputs.dimension();
        let source = |replicate| {
            Source::new(question.sampler, question.seed, replicate, samples_per_series, dimension).ok_or(
                SurveyError::SamplerTooSmall { sampler: question.sampler, samples: samples_per_series, dimension },
            )
        };
        let quantity =
            |name: &str| Quantity::named(name, surrogate).ok_or_else(|| SurveyError::unknown_quantity(name, surrogate));
        let watches = question.events.iter().map(|event| {
            let threshold = Some(event.threshold).filter(|threshold| threshold.is_finite());
            let threshold = threshold.ok_or_else(|| SurveyError::NotANumber { what: event.text() })?;
            Ok(Watch { quantity: quantity(&event.quantity)?, below: event.below, threshold })
        });
        if !question.sweeps.is_empty() && !(question.histograms.is_empty() && question.quantile_bins.is_empty()) {
            return Err(SurveyError::HistogramOfSweep);
        }
        let bins = question.histograms.iter().chain(&question.quantile_bins).map(|bins| {
            let is_usable = bins.bins > 0
                && bins.bins <= Self::MOST_BINS
                && bins.lower < bins.upper
                && (bins.upper - bins.lower).is_finite();
            if !is_usable {
                return Err(SurveyError::Bins { bins: bins.clone(), most: Self::MOST_BINS });
            }
            Ok((quantity(&bins.quantity)?, bins))
        });
        let by_elements = SAMPLES_PER_ELEMENT * surrogate.mesh.elements().len() as u64;
        Ok(Self {
            surrogate,
            question,
            plan: Plan::with_instructions(surrogate, instructions),
            regions: regions(&surrogate.inputs, question)?,
            sources: (0..question.replicates.max(1)).map(source).collect::<Result<_, _>>()?,
            samples_per_series,
            chunk: by_elements.clamp(CHUNK, LARGEST_CHUNK).next_multiple_of(CHUNK),
            watches: watches.collect::<Result<_, _>>()?,
            binned: bins.collect::<Result<_, _>>()?,
        })
    }

    /// Bins of one histogram, at most.
    pub const MOST_BINS: u32 = 1_000_000;

    /// Number of chunks of the whole question.
    pub fn chunks(&self) -> u64 {
        self.series_count() * self.chunks_per_series()
    }

    /// Number of samples of the whole question.
    pub fn samples(&self) -> u64 {
        self.series_count() * self.samples_per_series
    }

    /// The chunks of shard `shard` of `shards`, from 0: ranges that differ by one chunk at most.
    pub fn shard(&self, shard: u64, shards: u64) -> Range<u64> {
        let border = |shard: u64| (u128::from(self.chunks()) * u128::from(shard) / u128::from(shards.max(1))) as u64;
        border(shard)..border(shard + 1)
    }

    fn series_count(&self) -> u64 {
        self.regions.len() as u64 * self.sources.len() as u64
    }

    fn chunks_per_series(&self) -> u64 {
        self.samples_per_series.div_ceil(self.chunk)
    }

    /// Works off a range of chunks on the current rayon thread pool.
    ///
    /// # Errors
    ///
    /// [`EvalError::NotFinite`] for the first sample whose max Re λ is not a finite number.
    pub fn run(&self, chunks: Range<u64>, observer: &dyn Observer) -> Result<Progress, EvalError> {
        observer.begin("samples", self.samples_in(&chunks));
        let result = self.run_observed(chunks, observer);
        observer.finish();
        result
    }

    fn run_observed(&self, chunks: Range<u64>, observer: &dyn Observer) -> Result<Progress, EvalError> {
        let mut findings =
            Findings { first: chunks.start, end: chunks.start, series: Vec::new(), histograms: Vec::new() };
        let histograms = Mutex::new(Vec::new());
        while findings.end < chunks.end {
            let batch = findings.end..chunks.end.min(findings.end + CHUNKS_IN_FLIGHT);
            let tallies: Vec<Result<Tally, EvalError>> = batch
                .into_par_iter()
                .map_init(|| Worker::new(self, &histograms), |worker, chunk| worker.run(chunk, observer))
                .collect();
            for tally in tallies {
                match tally {
                    Ok(tally) => findings.push(tally, self.chunks_per_series()),
                    Err(EvalError::Interrupted(_)) => return Ok(Progress::Interrupted(findings)),
                    Err(error) => return Err(error),
                }
            }
        }
        findings.histograms = self.binned.iter().map(|(_, bins)| Histogram::new(bins.bins)).collect();
        for found in histograms.into_inner().unwrap_or_else(PoisonError::into_inner) {
            findings.histograms.iter_mut().zip(&found).for_each(|(own, added)| own.merge(added));
        }
        Ok(Progress::Complete(findings))
    }

    fn samples_in(&self, chunks: &Range<u64>) -> u64 {
        let before = |chunk: u64| {
            let (series, inside) = (chunk / self.chunks_per_series(), chunk % self.chunks_per_series());
            series * self.samples_per_series + inside * self.chunk
        };
        before(chunks.end) - before(chunks.start)
    }

    /// Series and sample numbers inside it.
    fn locate(&self, chunk: u64) -> (u64, Range<u64>) {
        let (series, inside) = (chunk / self.chunks_per_series(), chunk % self.chunks_per_series());
        (series, inside * self.chunk..self.samples_per_series.min((inside + 1) * self.chunk))
    }
}

/// Evaluates chunks, with memory of its own.
struct Worker<'s> {
    survey: &'s Survey<'s>,
    evaluator: Evaluator<'s>,
    /// Taken from those that are not in use, and given back.
    histograms: Vec<Histogram>,
    unused_histograms: &'s Mutex<Vec<Vec<Histogram>>>,
}

impl<'s> Worker<'s> {
    fn new(survey: &'s Survey<'s>, unused_histograms: &'s Mutex<Vec<Vec<Histogram>>>) -> Self {
        let unused = unused_histograms.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let empty = || survey.binned.iter().map(|(_, bins)| Histogram::new(bins.bins)).collect();
        let histograms = unused.unwrap_or_else(empty);
        Self { survey, evaluator: Evaluator::new(survey.surrogate, &survey.plan), histograms, unused_histograms }
    }

    fn run(&mut self, chunk: u64, observer: &dyn Observer) -> Result<Tally, EvalError> {
        observer.check()?;
        let survey = self.survey;
        let (series, samples) = survey.locate(chunk);
        let replicates = survey.sources.len() as u64;
        let region = &survey.regions[(series / replicates) as usize];
        let source = &survey.sources[(series % replicates) as usize];
        let instructions = survey.plan.instructions();
        let count = (samples.end - samples.start) as usize;
        // Sweeps have many series, of which counts are wanted alone.
        let (components, modes) = match survey.question.sweeps.is_empty() {
            true => (survey.surrogate.component_count(), survey.surrogate.modes().len()),
            false => (0, 0),
        };
        let shifts = survey.surrogate.decision.band_shifts();
        let mut gathering = Gathering::new(components, modes, shifts, &survey.watches);
        let fill = |start: usize, points: &mut [_]| {
            instructions.run(Drawing { source, region, first: samples.start + start as u64, points });
        };
        let histograms = &mut self.histograms;
        self.evaluator.each_block(count, fill, |results, lanes| {
            instructions.run(Adding { gathering: &mut gathering, results, lanes });
            for (histogram, (quantity, bins)) in histograms.iter_mut().zip(&survey.binned) {
                histogram.add(&quantity.values(results), lanes, bins);
            }
        });
        if !gathering.is_finite() {
            return Err(self.not_finite(source, region, samples));
        }
        observer.advance(count as u64);
        Ok(gathering.tally())
    }

    /// Finds the sample whose max Re λ is not finite.
    fn not_finite(&mut self, source: &Source, region: &Region, samples: Range<u64>) -> EvalError {
        let instructions = self.survey.plan.instructions();
        let inputs = &self.survey.surrogate.inputs;
        let count = (samples.end - samples.start) as usize;
        let mut points = vec![super::lanes::Lanes::splat(0.0); inputs.dimension()];
        let mut first_bad = None;
        let fill = |start: usize, points: &mut [_]| {
            instructions.run(Drawing { source, region, first: samples.start + start as u64, points });
        };
        let mut seen = 0;
        self.evaluator.each_block(count, fill, |results, lanes| {
            let bad = results.max_re.0[..lanes].iter().position(|max_re| !max_re.is_finite());
            first_bad = first_bad.or(bad.map(|lane| seen + lane as u64));
            seen += lanes as u64;
        });
        let first = samples.start + first_bad.unwrap_or(0);
        instructions.run(Drawing { source, region, first, points: &mut points });
        let point: Vec<f64> = points.iter().map(|coordinate| coordinate.0[0]).collect();
        EvalError::NotFinite { point: inputs.describe(&inputs.physical(&point)) }
    }
}

impl Drop for Worker<'_> {
    fn drop(&mut self) {
        let histograms = std::mem::take(&mut self.histograms);
        self.unused_histograms.lock().unwrap_or_else(PoisonError::into_inner).push(histograms);
    }
}

impl Findings {
    /// The chunks it is about.
    pub fn chunks(&self) -> Range<u64> {
        self.first..self.end
    }

    /// All samples together, series after series; `None` without samples.
    pub fn total(&self) -> Option<Tally> {
        let mut totals = self.series.iter().filter_map(Forest::total);
        let mut total = totals.next()?;
        totals.for_each(|next| total.merge(&next));
        Some(total)
    }

    fn push(&mut self, tally: Tally, chunks_per_series: u64) {
        let inside = self.end % chunks_per_series;
        if inside == 0 || self.series.is_empty() {
            self.series.push(Forest::new(inside));
        }
        if let Some(forest) = self.series.last_mut() {
            forest.push(tally);
        }
        self.end += 1;
    }
}

/// The box of every point of the sweeps.
fn regions(inputs: &InputSpace, question: &Question) -> Result<Vec<Region>, SurveyError> {
    let mut base = Region::whole(inputs.dimension());
    let mut used = Vec::new();
    let mut position = |name: &str| {
        let found = inputs.names().position(|known| known == name);
        let found = found.ok_or_else(|| SurveyError::unknown_input(name, inputs))?;
        if used.contains(&found) {
            return Err(SurveyError::InputTwice { input: name.to_owned() });
        }
        used.push(found);
        Ok(found)
    };
    for condition in &question.conditions {
        let input = position(&condition.input)?;
        let lower = coordinate(inputs, input, condition.lower)?;
        let upper = coordinate(inputs, input, condition.upper)?;
        if condition.lower > condition.upper {
            return Err(SurveyError::Inverted { condition: condition.clone() });
        }
        base.confine(input, lower, upper);
    }
    let mut cells = 1u64;
    let mut regions = vec![base];
    for sweep in &question.sweeps {
        let input = position(&sweep.input)?;
        if sweep.points < 2 {
            return Err(SurveyError::TooFewSteps { sweep: sweep.clone() });
        }
        cells = cells.saturating_mul(u64::from(sweep.points));
        if cells > MOST_CELLS {
            return Err(SurveyError::TooManyCells { most: MOST_CELLS });
        }
        coordinate(inputs, input, sweep.from)?;
        coordinate(inputs, input, sweep.to)?;
        let values: Vec<f64> =
            (0..sweep.points).map(|number| coordinate(inputs, input, sweep.value(number))).collect::<Result<_, _>>()?;
        let at = |region: &Region, xi: f64| {
            let mut region = region.clone();
            region.confine(input, xi, xi);
            region
        };
        regions =
            regions.iter().flat_map(|region| values.iter().map(|&xi| at(region, xi)).collect::<Vec<_>>()).collect();
    }
    Ok(regions)
}

/// The standardized coordinate of a value inside the domain.
fn coordinate(inputs: &InputSpace, input: usize, value: f64) -> Result<f64, SurveyError> {
    let chosen = &inputs.inputs()[input];
    if !chosen.marginal.contains(value) {
        let (lower, upper) = (chosen.marginal.physical(-1.0), chosen.marginal.physical(1.0));
        return Err(SurveyError::Outside { input: chosen.name.clone(), value, lower, upper });
    }
    Ok(chosen.marginal.standardized(value).clamp(-1.0, 1.0))
}
