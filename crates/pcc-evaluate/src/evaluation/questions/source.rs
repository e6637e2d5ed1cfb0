//! Where samples come from: random, quasi-random or stratified points of the unit cube, addressed by number.

use super::question::Sampler;
use super::region::Region;
use crate::evaluation::kernel::lanes::{BLOCK_POINTS, Lanes};
use crate::probability::random::{LatinHypercubeSampler, Purpose, SobolSequence, seed_key, unit_interval, unit_pairs};
use pulp::{Simd, WithSimd};

/// The points of one replicate.
#[derive(Debug, Clone)]
pub(crate) enum Source {
    /// Streams of the seed, for the purpose of evaluation: the points of [`crate::probability::inputs::random_point`].
    MonteCarlo {
        seed: u64,
    },
    Sobol(SobolSequence),
    LatinHypercube(LatinHypercubeSampler),
}

impl Source {
    /// Replicate number `replicate`, of `points` points in `dimension` dimensions; `None` if the sampler cannot have so
    /// many points or dimensions.
    pub fn new(sampler: Sampler, seed: u64, replicate: u32, points: u64, dimension: usize) -> Option<Self> {
        let key = seed_key(seed);
        match sampler {
            Sampler::MonteCarlo => Some(Self::MonteCarlo { seed }),
            Sampler::Sobol if points > SobolSequence::PERIOD => None,
            Sampler::Sobol => SobolSequence::new(dimension, key, replicate).map(Self::Sobol),
            Sampler::LatinHypercube => {
                LatinHypercubeSampler::new(points, dimension, key, replicate).map(Self::LatinHypercube)
            }
        }
    }
}

/// Writes the standardized coordinates of the points from number `first` on, one lane each.
pub(crate) struct Drawing<'a> {
    pub source: &'a Source,
    pub region: &'a Region,
    pub first: u64,
    pub points: &'a mut [Lanes],
}

impl WithSimd for Drawing<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { source, region, first, points } = self;
        match source {
            Source::MonteCarlo { seed } => random_units(*seed, first, points),
            Source::Sobol(sequence) => {
                let mut cells = [0; BLOCK_POINTS];
                for (input, units) in points.iter_mut().enumerate() {
                    sequence.cells(input, first, &mut cells);
                    units.0.iter_mut().zip(cells).for_each(|(unit, cell)| *unit = unit_interval(cell));
                }
            }
            Source::LatinHypercube(sampler) => {
                for (input, units) in points.iter_mut().enumerate() {
                    sampler.units(input, first, &mut units.0);
                }
            }
        }
        region.place_lanes(points);
    }
}

/// Two inputs at a time, as the generator yields them.
#[inline(always)]
fn random_units(seed: u64, first: u64, points: &mut [Lanes]) {
    let mut unused = [0.0; BLOCK_POINTS];
    for (pair, inputs) in (0u32..).zip(points.chunks_mut(2)) {
        match inputs {
            [even, odd] => unit_pairs(seed, Purpose::Evaluation, first, pair, &mut even.0, &mut odd.0),
            [even] => unit_pairs(seed, Purpose::Evaluation, first, pair, &mut even.0, &mut unused),
            _ => {}
        }
    }
}
