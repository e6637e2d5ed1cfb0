//! Counts and moments of many samples, gathered from blocks of lanes.
//!
//! Moments of a chunk come from sums of deviations from the mean of its first block, in 16 interleaved parts, whatever
//! the width of the processor's vectors: the bits are the same everywhere.

use super::extrapolated::{Extrapolated, Sides};
use super::quantity::{Quantity, damping_ratios};
use crate::components::{EigenvalueSummary, Summary, beyond_rounding};
use crate::evaluation::kernel::lanes::{BLOCK_POINTS, Lanes};
use crate::evaluation::kernel::recombination::excesses;
use crate::evaluation::kernel::results::Results;
use crate::probability::statistics::{Merge, Moments};
use crate::surrogate::VerdictBasis;
use pulp::{Simd, WithSimd};
use serde::{Deserialize, Serialize};

/// Interleaved partial sums: a divisor of [`BLOCK_POINTS`].
const PARTS: usize = 16;

/// What was counted and summed over some samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tally {
    /// Stability, moments, eigenvalues.
    pub summary: Summary,
    /// Samples in each event.
    pub events: Vec<u64>,
    /// Samples outside the box that the model runs spanned; `None` if there is no such box.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extrapolated: Option<Extrapolated>,
}

impl Tally {
    /// Whether all moments are finite numbers.
    pub fn is_finite(&self) -> bool {
        self.summary.moments().all(Moments::is_finite)
    }
}

impl Merge for Tally {
    fn merge(&mut self, next: &Self) {
        self.summary.merge(&next.summary);
        self.events.iter_mut().zip(&next.events).for_each(|(own, added)| *own += added);
        if let (Some(own), Some(added)) = (&mut self.extrapolated, &next.extrapolated) {
            own.merge(added);
        }
    }
}

/// Samples in which a quantity lies on one side of a threshold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Watch {
    pub quantity: Quantity,
    /// Below the threshold, or above.
    pub below: bool,
    pub threshold: f64,
}

/// Sums over the samples of a chunk.
#[derive(Debug, Clone)]
pub(crate) struct Gathering<'a> {
    /// What eigenvalues are judged by.
    verdict: VerdictBasis,
    /// Errors of max Re λ that could be, in 1/s.
    shifts: [f64; 2],
    watches: &'a [Watch],
    /// The box that the model runs spanned.
    trained: Option<&'a Sides>,
    extrapolated: Extrapolated,
    /// Whether eigenvalues can be real: where none can, nothing is counted of it.
    has_reals: bool,
    count: u64,
    stable: u64,
    unstable: u64,
    divergent: u64,
    stable_if_shifted: [u64; 2],
    events: Vec<u64>,
    max_re: Sums,
    components: Vec<Sums>,
    eigenvalues: Vec<EigenvalueSums>,
    is_finite: bool,
}

#[derive(Debug, Clone, Copy)]
struct EigenvalueSums {
    growth_rate: Sums,
    angular_frequency: Sums,
    damping_ratio: Sums,
    flutter_frequency: Sums,
    unstable: u64,
    marginal: u64,
    real: u64,
    divergent: u64,
}

/// Sums of the deviations d of a quantity from `shift`.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Sums {
    first: [f64; PARTS],
    second: [f64; PARTS],
    minimum: [f64; PARTS],
    maximum: [f64; PARTS],
    shift: f64,
}

impl<'a> Gathering<'a> {
    /// Nothing yet, of so many components and eigenvalues, 0 of them for counts alone.
    pub fn new(
        (components, eigenvalues): (usize, usize),
        has_reals: bool,
        (verdict, shifts): (VerdictBasis, [f64; 2]),
        watches: &'a [Watch],
        trained: Option<&'a Sides>,
    ) -> Self {
        let none = EigenvalueSums {
            growth_rate: Sums::NONE,
            angular_frequency: Sums::NONE,
            damping_ratio: Sums::NONE,
            flutter_frequency: Sums::NONE,
            unstable: 0,
            marginal: 0,
            real: 0,
            divergent: 0,
        };
        Self {
            verdict,
            shifts,
            watches,
            trained,
            extrapolated: Extrapolated::default(),
            has_reals,
            count: 0,
            stable: 0,
            unstable: 0,
            divergent: 0,
            stable_if_shifted: [0; 2],
            events: vec![0; watches.len()],
            max_re: Sums::NONE,
            components: vec![Sums::NONE; components],
            eigenvalues: vec![none; eigenvalues],
            is_finite: true,
        }
    }

    /// Whether max Re λ was finite in all samples.
    pub fn is_finite(&self) -> bool {
        self.is_finite
    }

    /// What was gathered.
    pub fn tally(&self) -> Tally {
        let moments = |sums: &Sums| sums.moments(self.count);
        let eigenvalue = |sums: &EigenvalueSums| EigenvalueSummary {
            growth_rate: moments(&sums.growth_rate),
            angular_frequency: moments(&sums.angular_frequency),
            damping_ratio: moments(&sums.damping_ratio),
            unstable: sums.unstable,
            marginal: sums.marginal,
            real: sums.real,
            divergent: sums.divergent,
            flutter_frequency: match sums.unstable - sums.divergent {
                0 => None,
                count => Some(sums.flutter_frequency.moments(count)),
            },
        };
        let summary = Summary {
            stable: self.stable,
            unstable: self.unstable,
            divergent: self.divergent,
            stable_if_shifted: self.stable_if_shifted,
            max_re: moments(&self.max_re),
            components: self.components.iter().map(moments).collect(),
            eigenvalues: self.eigenvalues.iter().map(eigenvalue).collect(),
        };
        Tally { summary, events: self.events.clone(), extrapolated: self.trained.map(|_| self.extrapolated) }
    }
}

/// Adds the first `lanes` samples of a block, at these points, to a gathering.
pub(crate) struct Adding<'a, 'b> {
    pub gathering: &'a mut Gathering<'b>,
    pub points: &'a [Lanes],
    pub results: &'a Results,
    pub lanes: usize,
}

impl WithSimd for Adding<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { gathering, points, results, lanes } = self;
        let (max_re, excess) = (&results.max_re, &results.excess);
        let is_first = gathering.count == 0;
        gathering.count += lanes as u64;
        gathering.is_finite &= count(max_re, lanes, |value| value.abs() < f64::INFINITY) == lanes as u64;
        gathering.stable += count(excess, lanes, |value| value < 0.0);
        gathering.unstable += count(excess, lanes, |value| value > 0.0);
        for (counted, shift) in gathering.stable_if_shifted.iter_mut().zip(gathering.shifts) {
            *counted += count(excess, lanes, |value| (value != 0.0) & (value + shift < 0.0));
        }
        if let Some(sides) = gathering.trained {
            let distances = sides.distances(points);
            let counted = &mut gathering.extrapolated;
            counted.samples += count(&distances, lanes, |distance| distance > 0.0);
            counted.stable += count_both(&distances, excess, lanes, |distance, value| (distance > 0.0) & (value < 0.0));
            counted.unstable +=
                count_both(&distances, excess, lanes, |distance, value| (distance > 0.0) & (value > 0.0));
        }
        for (counted, watch) in gathering.events.iter_mut().zip(gathering.watches) {
            let (values, threshold) = (watch.quantity.values(results), watch.threshold);
            *counted += match watch.below {
                true => count(&values, lanes, |value| value < threshold),
                false => count(&values, lanes, |value| value > threshold),
            };
        }
        gathering.max_re.add(max_re, lanes, is_first);
        for (sums, values) in gathering.components.iter_mut().zip(&results.components) {
            sums.add(values, lanes, is_first);
        }
        if gathering.has_reals {
            gathering.divergent +=
                count_both(excess, &results.top_frequency, lanes, |excess, im| excess > 0.0 && im == 0.0);
        }
        let eigenvalues = results.growth_rates.iter().zip(&results.angular_frequencies);
        for (sums, (growth_rate, angular_frequency)) in gathering.eigenvalues.iter_mut().zip(eigenvalues) {
            sums.growth_rate.add(growth_rate, lanes, is_first);
            sums.angular_frequency.add(angular_frequency, lanes, is_first);
            sums.damping_ratio.add(&damping_ratios(growth_rate, angular_frequency), lanes, is_first);
            let mut excess = excesses(growth_rate, angular_frequency, gathering.verdict.margin);
            excess.0.iter_mut().for_each(|excess| *excess = beyond_rounding(*excess, gathering.verdict.tolerance));
            let unstable = count(&excess, lanes, |value| value > 0.0);
            sums.unstable += unstable;
            // Deviations are from what the frequency is about.
            sums.flutter_frequency.shift = sums.angular_frequency.shift;
            if unstable > 0 {
                sums.flutter_frequency.add_fluttering(angular_frequency, &excess, lanes);
            }
            sums.marginal += count(&excess, lanes, |value| value == 0.0);
            if gathering.has_reals {
                sums.real += count(angular_frequency, lanes, |value| value == 0.0);
                sums.divergent += count_both(&excess, angular_frequency, lanes, |excess, im| excess > 0.0 && im == 0.0);
            }
        }
    }
}

#[inline(always)]
fn count(values: &Lanes, lanes: usize, holds: impl Fn(f64) -> bool) -> u64 {
    match lanes {
        BLOCK_POINTS => values.0.iter().map(|&value| u64::from(holds(value))).sum(),
        _ => values.0[..lanes].iter().map(|&value| u64::from(holds(value))).sum(),
    }
}

#[inline(always)]
fn count_both(first: &Lanes, second: &Lanes, lanes: usize, holds: impl Fn(f64, f64) -> bool) -> u64 {
    first.0[..lanes].iter().zip(&second.0[..lanes]).map(|(&a, &b)| u64::from(holds(a, b))).sum()
}

impl Sums {
    const NONE: Self = Self {
        first: [0.0; PARTS],
        second: [0.0; PARTS],
        minimum: [f64::INFINITY; PARTS],
        maximum: [f64::NEG_INFINITY; PARTS],
        shift: 0.0,
    };

    #[inline(always)]
    fn add(&mut self, values: &Lanes, lanes: usize, is_first: bool) {
        if is_first {
            self.shift = values.0[..lanes].iter().sum::<f64>() / lanes as f64;
        }
        let mut sums = *self;
        match lanes {
            BLOCK_POINTS => {
                for row in values.0.as_chunks::<PARTS>().0 {
                    row.iter().enumerate().for_each(|(part, &value)| sums.add_one(part, value));
                }
            }
            _ => (0..lanes).for_each(|lane| sums.add_one(lane % PARTS, values.0[lane])),
        }
        *self = sums;
    }

    #[inline(always)]
    fn add_one(&mut self, part: usize, value: f64) {
        let deviation = value - self.shift;
        self.first[part] += deviation;
        self.second[part] = deviation.mul_add(deviation, self.second[part]);
        self.minimum[part] = if value < self.minimum[part] { value } else { self.minimum[part] };
        self.maximum[part] = if value > self.maximum[part] { value } else { self.maximum[part] };
    }

    /// Adds those that oscillate and whose excess is positive.
    #[inline(always)]
    fn add_fluttering(&mut self, frequencies: &Lanes, excess: &Lanes, lanes: usize) {
        let mut sums = *self;
        for lane in 0..lanes {
            let (value, part) = (frequencies.0[lane], lane % PARTS);
            let flutters = (excess.0[lane] > 0.0) & (value != 0.0);
            let deviation = if flutters { value - sums.shift } else { 0.0 };
            sums.first[part] += deviation;
            sums.second[part] = deviation.mul_add(deviation, sums.second[part]);
            sums.minimum[part] = if flutters & (value < sums.minimum[part]) { value } else { sums.minimum[part] };
            sums.maximum[part] = if flutters & (value > sums.maximum[part]) { value } else { sums.maximum[part] };
        }
        *self = sums;
    }

    fn moments(&self, count: u64) -> Moments {
        let sum = |parts: &[f64; PARTS]| parts.iter().sum::<f64>();
        // Not f64::min and max, which may choose either of 0 and −0.
        let minimum = self.minimum.iter().copied().fold(f64::INFINITY, |a, b| if b < a { b } else { a });
        let maximum = self.maximum.iter().copied().fold(f64::NEG_INFINITY, |a, b| if b > a { b } else { a });
        Moments::from_sums(count, self.shift, sum(&self.first), sum(&self.second), minimum, maximum)
    }
}
