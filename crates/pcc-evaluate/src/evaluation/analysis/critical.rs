//! The value of one input at which a system loses stability.
//!
//! For every random sample of the other inputs, the critical value of input j is the smallest value of its domain at
//! which it is unstable, max Re λ > 0. Its distribution says where a limit for this input has to lie so that, say, 99 %
//! of all systems stay stable below it.
//!
//! The domain is the interval of an input with bounds; of others what lies between two quantiles far out, of the law
//! that they have where the inputs that they depend on are fixed. Its width is measured in the input where that is
//! uniform, else in normal scores, so that what happens in a tail is told apart.
//!
//! 1. max Re λ at the 65 ends of 64 equal cells of the input's domain, from below, until one is unstable. If it is the
//!    first, the critical value is the smallest that is looked at; if there is none, there is no critical value.
//! 2. The crossing between the last stable and the first unstable end, by interpolation with the safety of
//!    bisection, until a stable and an unstable value are less than 10⁻⁹ of the domain's width apart: the critical
//!    value is the unstable one.
//!
//! All other changes of stability along the input are found in the same way ([`super::crossings`]).
//!
//! Instability that begins and ends inside one cell is missed, and among several crossings inside a cell any one can be
//! found. Polynomials of degree up to some tens do not oscillate within such a cell, but max Re λ can rise above zero
//! within one and fall again where it barely does so.
//!
//! Many samples are searched side by side, one per lane of the evaluator. Critical values are kept as counts in 10 000
//! equal bins, so memory does not depend on the number of samples.

use super::bracket::{Bracket, End};
use super::crossings::{Crossing, CrossingKey, Crossings};
use super::domain::Domain;
use crate::components::{Label, Top};
use crate::evaluation::error::EvalError;
use crate::evaluation::kernel::chunks::{CHUNK, in_chunks};
use crate::evaluation::kernel::plan::Plan;
use crate::evaluation::kernel::points::Evaluator;
use crate::evaluation::questions::region::Region;
use crate::foundation::Observer;
use crate::probability::random::{Purpose, Stream};
use crate::probability::statistics::Moments;
use crate::surrogate::Surrogate;
use std::ops::Range;

/// Cells of the grid on which instability is looked for; a power of two, so that its points are exact.
const GRID: u32 = 64;

/// Bins of the counts: the resolution of quantiles is 10⁻⁴ of the domain's width.
pub(super) const BINS: usize = 10_000;

/// Levels of the quantiles that reports show.
pub const CRITICAL_LEVELS: [f64; 7] = [0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99];

/// The distribution of the critical value of one input.
#[derive(Debug, Clone, PartialEq)]
pub struct CriticalValues {
    /// Number of samples of the other inputs.
    pub samples: u64,
    /// Samples that are stable at every point of the grid: they have no critical value.
    pub never: u64,
    /// Samples that are unstable at the smallest value already: it is their critical value.
    pub unstable_from_start: u64,
    domain: Domain,
    /// Critical values above the smallest, per bin.
    counts: Vec<u64>,
    /// All critical values, in the input's own unit.
    values: Moments,
    /// Every change of stability along the input.
    crossings: Crossings,
    labels: Vec<Label>,
}

impl CriticalValues {
    fn new(samples: u64, domain: Domain, labels: Vec<Label>) -> Self {
        Self {
            samples,
            never: 0,
            unstable_from_start: 0,
            domain,
            counts: vec![0; BINS],
            values: Moments::default(),
            crossings: Crossings::default(),
            labels,
        }
    }

    /// Between which values they were looked for, in the input's own unit.
    pub fn looked_for(&self) -> [f64; 2] {
        self.domain.ends()
    }

    /// The probability of values beyond either of these, of the law that fixed inputs leave the input.
    pub fn tail(&self) -> f64 {
        self.domain.tail()
    }

    /// Every change of stability along the input, in order, with the mode and the kind of instability on its unstable
    /// side.
    pub fn crossings(&self) -> Vec<Crossing> {
        self.crossings.list(&self.labels, &self.domain)
    }

    /// The critical value that a share `level` ∈ \[0, 1\] of all samples does not exceed, in the input's own unit, to
    /// 10⁻⁴ of the domain's width: interpolated linearly inside its bin. Samples that never lose stability count as
    /// above the upper bound; `None` if the quantile lies among them.
    pub fn quantile(&self, level: f64) -> Option<f64> {
        let rank = level * self.samples as f64;
        let below = self.unstable_from_start as f64;
        if self.unstable_from_start > 0 && rank <= below {
            return Some(self.domain.along(-1.0));
        }
        quantile_in_bins(&self.counts, rank - below, &self.values, &self.domain)
    }

    /// Mean critical value of the samples that lose stability, in the input's own unit; `None` if there are none.
    pub fn mean(&self) -> Option<f64> {
        // Rounding of the sum takes it no farther than the values.
        self.of_lost(|values| values.mean().max(values.minimum()).min(values.maximum()))
    }

    /// Smallest critical value, in the input's own unit; `None` if no sample loses stability.
    pub fn minimum(&self) -> Option<f64> {
        self.of_lost(Moments::minimum)
    }

    /// Largest critical value, in the input's own unit; `None` if no sample loses stability.
    pub fn maximum(&self) -> Option<f64> {
        self.of_lost(Moments::maximum)
    }

    fn of_lost(&self, part: fn(&Moments) -> f64) -> Option<f64> {
        (self.values.count() > 0).then(|| part(&self.values))
    }

    fn add(&mut self, part: &Part) {
        self.never += part.never;
        self.unstable_from_start += part.unstable_from_start;
        for &place in &part.crossings {
            self.counts[bin_of(place)] += 1;
        }
        let values: Vec<f64> = part.crossings.iter().map(|&place| self.domain.along(place)).collect();
        self.values.merge(&Moments::of(&vec![self.domain.along(-1.0); part.unstable_from_start as usize]));
        self.values.merge(&Moments::of(&values));
        self.crossings.add(&part.changes, &self.domain);
    }
}

/// The bin of a place of the domain, from −1 to 1.
pub(super) fn bin_of(place: f64) -> usize {
    ((0.5 * (1.0 + place) * BINS as f64) as usize).min(BINS - 1)
}

/// The value that as many values as `rank` do not exceed, interpolated linearly inside its bin; `None` if there are
/// fewer.
pub(super) fn quantile_in_bins(counts: &[u64], rank: f64, values: &Moments, domain: &Domain) -> Option<f64> {
    let mut below = 0.0;
    for (bin, &count) in counts.iter().enumerate().filter(|&(_, &count)| count > 0) {
        let count = count as f64;
        if rank <= below + count {
            let share = (bin as f64 + (rank - below) / count) / BINS as f64;
            return Some(domain.along(2.0 * share - 1.0).max(values.minimum()).min(values.maximum()));
        }
        below += count;
    }
    None
}

/// The critical value of input number `input`, from 0, over samples 0 … `samples` − 1 of the others under `seed`, on
/// the current rayon thread pool.
///
/// Sample i has the coordinates that [`monte_carlo`](fn@crate::evaluation::monte_carlo) evaluates as sample i under
/// this seed, except that of `input`. The result is the same bits for any number of threads.
///
/// # Errors
///
/// [`EvalError`]; [`EvalError::NoSuchInput`] if there are not that many inputs, [`EvalError::Dependent`] if others
/// depend on it that are not fixed.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::artifact;
/// use pcc_evaluate::evaluation::critical_values;
/// use pcc_evaluate::foundation::Silent;
/// let surrogate = artifact::decode(include_bytes!("../../../../../surrogates/clutch-r2-eigenvalues.pcc"))?.surrogate;
/// assert_eq!(surrogate.inputs.names().next(), Some("mu"));
/// let friction = critical_values(&surrogate, 0, 1000, 1, &Silent)?;
/// let safe = friction.quantile(0.01).expect("more than 1 % lose stability");
/// assert!(friction.minimum() <= Some(safe) && Some(safe) <= friction.mean());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn critical_values(
    surrogate: &Surrogate,
    input: usize,
    samples: u64,
    seed: u64,
    observer: &dyn Observer,
) -> Result<CriticalValues, EvalError> {
    critical_values_in(surrogate, &Region::whole(&surrogate.inputs), input, samples, seed, observer)
}

/// The same with the other inputs confined to `region`; `input` itself is looked for in all of its domain.
///
/// # Errors
///
/// As [`critical_values`].
pub fn critical_values_in(
    surrogate: &Surrogate,
    region: &Region,
    input: usize,
    samples: u64,
    seed: u64,
    observer: &dyn Observer,
) -> Result<CriticalValues, EvalError> {
    let inputs = surrogate.inputs.inputs();
    let chosen = inputs.get(input).ok_or(EvalError::NoSuchInput { input, inputs: inputs.len() })?;
    let alone = region.score_alone(&surrogate.inputs, input);
    let of_scores = alone.ok_or_else(|| EvalError::Dependent { input: chosen.name.clone() })?;
    let domain = &Domain::new(chosen.marginal.clone(), of_scores);
    let plan = Plan::new(surrogate);
    let mut values = CriticalValues::new(samples, domain.clone(), surrogate.labels());
    in_chunks(
        samples,
        CHUNK,
        observer,
        || {
            let evaluator = Evaluator::new(surrogate, &plan);
            Search { surrogate, region, domain, evaluator, input, seed, points: Vec::new() }
        },
        |search, range| search.run(range, observer),
        |part| values.add(&part),
    )?;
    Ok(values)
}

/// What was found in one chunk of samples.
struct Part {
    never: u64,
    unstable_from_start: u64,
    /// Critical values above the smallest value that is looked at, as places of the domain from −1 to 1.
    crossings: Vec<f64>,
    /// Every change of stability, as a place of the domain.
    changes: Vec<(CrossingKey, f64)>,
}

/// A sample of the chunk with the last point of the grid and how often its stability has changed.
#[derive(Clone, Copy)]
struct Walking {
    end: Point,
    changes: u32,
}

/// A point of the input's domain with what decides there.
#[derive(Clone, Copy)]
struct Point {
    end: End,
    decides: Decides,
}

/// What decides at a point.
#[derive(Clone, Copy)]
struct Decides {
    top: Top,
    /// Its position among the surrogate's labels.
    position: usize,
}

impl Point {
    fn is_stable(&self) -> bool {
        self.end.excess <= 0.0
    }
}

/// A sample of the chunk with an interval in which its stability changes.
struct Changing {
    sample: usize,
    order: u32,
    loses: bool,
    /// In coordinates that run from the stable to the unstable end: ξ where stability is lost, −ξ where it is regained.
    bracket: Bracket,
    /// What decides at the unstable end.
    decides: Decides,
}

impl Changing {
    fn xi(&self, coordinate: f64) -> f64 {
        if self.loses { coordinate } else { -coordinate }
    }

    /// The unstable end, as a place of the domain.
    fn place(&self) -> f64 {
        self.xi(self.bracket.unstable.xi)
    }

    fn key(&self) -> CrossingKey {
        let Decides { top, position } = self.decides;
        CrossingKey { order: self.order, loses: self.loses, position, is_real: top.frequency == 0.0 }
    }
}

/// Searches chunks of samples, with memory of its own.
struct Search<'a> {
    surrogate: &'a Surrogate,
    region: &'a Region,
    domain: &'a Domain,
    evaluator: Evaluator<'a>,
    input: usize,
    seed: u64,
    /// Standardized coordinates of every sample of the chunk.
    points: Vec<f64>,
}

impl Search<'_> {
    fn run(&mut self, range: Range<u64>, observer: &dyn Observer) -> Result<Part, EvalError> {
        let dimension = self.surrogate.inputs.dimension();
        let samples = (range.end - range.start) as usize;
        self.points.resize(samples * dimension, 0.0);
        for (index, point) in range.zip(self.points.chunks_exact_mut(dimension)) {
            let mut stream = Stream::new(self.seed, Purpose::Evaluation, index);
            point.iter_mut().for_each(|coordinate| *coordinate = stream.next_unit());
            self.region.place(point);
        }
        let start: Vec<_> = (0..samples).map(|sample| (sample, grid_point(0))).collect();
        let walking: Vec<Walking> = self.evaluate(&start)?.into_iter().map(|end| Walking { end, changes: 0 }).collect();
        let starts_stable: Vec<bool> = walking.iter().map(|walking| walking.end.is_stable()).collect();
        let unstable_from_start = starts_stable.iter().filter(|is_stable| !**is_stable).count() as u64;
        let mut changing = self.march(walking, observer)?;
        self.refine(&mut changing, observer)?;
        // The first loss of those that were stable at the start.
        let first_losses = changing.iter().filter(|changing| changing.order == 1 && starts_stable[changing.sample]);
        let crossings: Vec<f64> = first_losses.map(Changing::place).collect();
        let never = samples as u64 - unstable_from_start - crossings.len() as u64;
        let changes = changing.iter().map(|changing| (changing.key(), changing.place())).collect();
        Ok(Part { never, unstable_from_start, crossings, changes })
    }

    /// Step 1: the cells of the grid in which stability changes.
    fn march(&mut self, mut walking: Vec<Walking>, observer: &dyn Observer) -> Result<Vec<Changing>, EvalError> {
        let mut changing = Vec::with_capacity(walking.len());
        for k in 1..=GRID {
            observer.check()?;
            let trials: Vec<_> = (0..walking.len()).map(|sample| (sample, grid_point(k))).collect();
            let found = self.evaluate(&trials)?;
            for (sample, (walking, end)) in walking.iter_mut().zip(found).enumerate() {
                let before = std::mem::replace(&mut walking.end, end);
                if before.is_stable() == end.is_stable() {
                    continue;
                }
                walking.changes += 1;
                let mirrored = |end: End| End { xi: -end.xi, ..end };
                let loses = before.is_stable();
                let (bracket, decides) = match loses {
                    true => (Bracket::new(before.end, end.end), end.decides),
                    false => (Bracket::new(mirrored(end.end), mirrored(before.end)), before.decides),
                };
                changing.push(Changing { sample, order: walking.changes, loses, bracket, decides });
            }
        }
        Ok(changing)
    }

    /// Step 2: narrows all brackets; each takes a bounded number of trials.
    fn refine(&mut self, changing: &mut [Changing], observer: &dyn Observer) -> Result<(), EvalError> {
        let mut open: Vec<&mut Changing> = changing.iter_mut().collect();
        while !open.is_empty() {
            observer.check()?;
            let trials: Vec<_> = open.iter().map(|one| (one.sample, one.xi(one.bracket.trial()))).collect();
            for (one, found) in open.iter_mut().zip(self.evaluate(&trials)?) {
                one.bracket.narrow(End { xi: one.xi(found.end.xi), ..found.end });
                if !found.is_stable() {
                    one.decides = found.decides;
                }
            }
            open.retain(|one| !one.bracket.is_narrow());
        }
        Ok(())
    }

    /// What decides at samples of the chunk with the input's standardized value set to that of the trial.
    fn evaluate(&mut self, trials: &[(usize, f64)]) -> Result<Vec<Point>, EvalError> {
        let (points, input) = (&self.points, self.input);
        let domain = self.domain;
        let set_point = |(sample, xi): (usize, f64), point: &mut [f64]| {
            point.copy_from_slice(&points[sample * point.len()..(sample + 1) * point.len()]);
            point[input] = domain.standardized(xi);
        };
        let mut found = Vec::with_capacity(trials.len());
        self.evaluator.deciding(trials.len(), |number, point| set_point(trials[number], point), &mut found);
        if let Some(at) = found.iter().position(|(top, _)| !top.max_re.is_finite()) {
            let inputs = &self.surrogate.inputs;
            let mut point = vec![0.0; inputs.dimension()];
            set_point(trials[at], &mut point);
            return Err(EvalError::NotFinite { point: inputs.describe(&inputs.physical(&point)) });
        }
        let point = |(&(_, xi), (top, position)): (&(usize, f64), (Top, usize))| Point {
            end: End { xi, excess: top.excess },
            decides: Decides { top, position },
        };
        Ok(trials.iter().zip(found).map(point).collect())
    }
}

/// Grid point number k of the standardized domain \[−1, 1\], exact.
fn grid_point(k: u32) -> f64 {
    2.0 * f64::from(k) / f64::from(GRID) - 1.0
}

#[cfg(test)]
mod tests;
