//! Latin hypercubes of any size, point by point.

use super::feistel_permutation::{FeistelPermutation, LANES, width};
use crate::probability::random::{UNIT_BITS, philox_4x32_10, unit_interval};

/// The word of the random counter that tells what numbers are for; nothing else draws under this one.
const LATIN_HYPERCUBE_PURPOSE: u32 = 5;
/// Points computed at once, from a multiple of their number on.
const CHUNK: usize = LANES;
/// In the first word of the random counter: tells the words of the permutations from those of places inside strata.
const PERMUTATION_FLAG: u32 = 1 << 31;
/// In the first word of the random counter: the dimension is above the high bits of the number of a draw. A draw serves
/// two points, so its number has 51 bits, of which 32 are in the third word.
const DIMENSION_SHIFT: u32 = 19;

/// A Latin hypercube of n points in (0, 1)ᵈ of which any point is computed on its own, without memory for permutations.
///
/// Coordinate j of point i is (πⱼ(i) + u)/n: πⱼ is a pseudo-random permutation of 0…n − 1, a Feistel network with cycle
/// walking (Black and Rogaway 2002, <https://doi.org/10.1007/3-540-45760-7_9>), and u is uniform in (0, 1), so that
/// each dimension has exactly one point in each of n equal strata (McKay, Beckman and Conover 1979,
/// <https://doi.org/10.1080/00401706.1979.10489755>). Permutations and places depend on nothing but the key, the
/// replicate, j and i; they are independent across replicates and across dimensions.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::random::LatinHypercubeSampler;
/// let sampler = LatinHypercubeSampler::new(3, 2, [1, 0], 0).expect("a supported size");
/// let mut units = [0.0; 3];
/// sampler.units(1, 0, &mut units);
/// units.sort_by(f64::total_cmp);
/// assert_eq!(units.map(|unit| (3.0 * unit) as u64), [0, 1, 2]);
/// ```
#[derive(Debug, Clone)]
pub struct LatinHypercubeSampler {
    points: u64,
    /// ⌈log₂ n⌉.
    width: u32,
    key: [u32; 2],
    replicate: u32,
    permutations: Vec<FeistelPermutation>,
}

impl LatinHypercubeSampler {
    /// The largest number of points: beyond, double precision cannot tell strata apart.
    pub const MAXIMUM_POINTS: u64 = 1 << UNIT_BITS;
    /// The largest number of dimensions: what the random counter leaves room for.
    pub const MAXIMUM_DIMENSION: usize = 1 << (31 - DIMENSION_SHIFT);

    /// Replicate number `replicate` of `points` points in `dimension` dimensions under the seed `key`.
    ///
    /// Dimension j of a replicate is the same whatever the number of dimensions asked for. `None` if either number is 0
    /// or above [`Self::MAXIMUM_POINTS`] and [`Self::MAXIMUM_DIMENSION`].
    pub fn new(points: u64, dimension: usize, key: [u32; 2], replicate: u32) -> Option<Self> {
        let supported =
            (1..=Self::MAXIMUM_POINTS).contains(&points) && (1..=Self::MAXIMUM_DIMENSION).contains(&dimension);
        if !supported {
            return None;
        }
        let permutation = |j: usize| {
            let block = PERMUTATION_FLAG | (j as u32) << DIMENSION_SHIFT;
            FeistelPermutation::new(points, |round| {
                philox_4x32_10([block, LATIN_HYPERCUBE_PURPOSE, round, replicate], key)
            })
        };
        let permutations = (0..dimension).map(permutation).collect();
        Some(Self { points, width: width(points), key, replicate, permutations })
    }

    /// The number n of points.
    pub fn points(&self) -> u64 {
        self.points
    }

    /// The number of dimensions.
    pub fn dimension(&self) -> usize {
        self.permutations.len()
    }

    /// Writes the coordinates of points `first`, `first` + 1, … in dimension `dimension` (from 0).
    ///
    /// Each lies in (0, 1) and strictly inside its stratum: the place inside is one of 2^(52 − ⌈log₂ n⌉) midpoints,
    /// which is what double precision resolves. Numbers from n on belong to no point; what is written for them is some
    /// number of (0, 1). Any `first` and any length are right; multiples of 32 are fastest.
    ///
    /// # Panics
    ///
    /// If `dimension` is not below [`Self::dimension`], like the index of a slice.
    pub fn units(&self, dimension: usize, first: u64, units: &mut [f64]) {
        let permutation = &self.permutations[dimension];
        let block = (dimension as u32) << DIMENSION_SHIFT;
        let offset = (first % CHUNK as u64) as usize;
        let mut start = first - offset as u64;
        let (head, aligned) = units.split_at_mut((CHUNK - offset).min(units.len()));
        head.copy_from_slice(&self.chunk(permutation, block, start)[offset..offset + head.len()]);
        for piece in aligned.chunks_mut(CHUNK) {
            start = start.wrapping_add(CHUNK as u64);
            piece.copy_from_slice(&self.chunk(permutation, block, start)[..piece.len()]);
        }
    }

    /// The coordinates of the chunk of points from `start` on.
    fn chunk(&self, permutation: &FeistelPermutation, block: u32, start: u64) -> [f64; CHUNK] {
        let mut strata = std::array::from_fn(|lane| start.wrapping_add(lane as u64).min(self.points - 1));
        permutation.apply(&mut strata);
        let places = places(start, block, self.replicate, self.key);
        let filled = self.points as f64 / (1_u64 << self.width) as f64;
        std::array::from_fn(|lane| unit_in_stratum(strata[lane], places[lane], self.width, filled))
    }
}

/// The coordinate in stratum number `stratum` of n ≤ 2ʷ, w = `width`, at the random cell `place` of it; `filled` is
/// n/2ʷ.
///
/// The 52-bit number whose high w bits are the stratum and whose other bits are random is a cell of the unit interval.
/// Its midpoint, exact in double precision, is (stratum + u)/2ʷ; division by n/2ʷ, which is exact too, gives (stratum +
/// u)/n. The midpoint is at least 2⁻⁵³ away from both ends of its stratum, division does not shrink that, and the
/// rounding error is at most 2⁻⁵⁴: no coordinate leaves its stratum, and none is 0 or 1.
#[inline]
fn unit_in_stratum(stratum: u64, place: u64, width: u32, filled: f64) -> f64 {
    unit_interval(stratum << (UNIT_BITS - width) | place >> width) / filled
}

/// Random cells for the chunk of points from `start` on. One draw of the generator serves a point of the first half and
/// one of the second half of the chunk; that, and a counter of which a single word varies, lets compilers vectorise,
/// which they do best alone, not inlined.
#[inline(never)]
fn places(start: u64, block: u32, replicate: u32, key: [u32; 2]) -> [u64; CHUNK] {
    let first_draw = start % LatinHypercubeSampler::MAXIMUM_POINTS / 2;
    let (low, block) = (first_draw as u32, block | (first_draw >> 32) as u32);
    let mut places = [0; CHUNK];
    let (early, late) = places.split_at_mut(CHUNK / 2);
    for (lane, (early, late)) in early.iter_mut().zip(late).enumerate() {
        let words = philox_4x32_10([block, LATIN_HYPERCUBE_PURPOSE, low | lane as u32, replicate], key);
        *early = (u64::from(words[0]) | u64::from(words[1]) << 32) >> (64 - UNIT_BITS);
        *late = (u64::from(words[2]) | u64::from(words[3]) << 32) >> (64 - UNIT_BITS);
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: [u32; 2] = [0x1234_5678, 0x9abc_def0];

    fn sampler(points: u64, dimension: usize, replicate: u32) -> LatinHypercubeSampler {
        LatinHypercubeSampler::new(points, dimension, KEY, replicate).unwrap()
    }

    fn column(sampler: &LatinHypercubeSampler, dimension: usize) -> Vec<f64> {
        let mut units = vec![0.0; sampler.points() as usize];
        sampler.units(dimension, 0, &mut units);
        units
    }

    #[test]
    fn every_stratum_of_every_dimension_has_one_point() {
        for points in (1..=300).chain([1023, 1024, 1025, 100_003]) {
            let sampler = sampler(points, 3, 1);
            for dimension in 0..3 {
                let mut strata: Vec<u64> =
                    column(&sampler, dimension).into_iter().map(|unit| (unit * points as f64) as u64).collect();
                strata.sort();
                assert!(strata.into_iter().eq(0..points), "{points} points");
            }
        }
    }

    /// The top and bottom strata of the largest samples, where rounding would be worst.
    #[test]
    fn coordinates_stay_inside_their_strata_up_to_the_largest_sample() {
        for points in [1, 2, 3, (1 << 51) + 1, (1 << 52) - 1, 1 << 52] {
            let width = width(points);
            for target in [0, 1, points / 2, points.saturating_sub(2), points - 1].map(|target| target.min(points - 1))
            {
                for place in [0, (1 << UNIT_BITS) - 1] {
                    let unit = unit_in_stratum(target, place, width, points as f64 / (1_u64 << width) as f64);
                    assert!(0.0 < unit && unit < 1.0);
                    // Fused multiplication and addition rounds once, so the sign of the difference is exact.
                    assert!(unit.mul_add(points as f64, -(target as f64)) > 0.0, "{points} points");
                    assert!(unit.mul_add(points as f64, -((target + 1) as f64)) < 0.0, "{points} points");
                }
            }
        }
        let sampler = sampler(1 << 52, 1, 0);
        for first in [0, 1 << 33, (1 << 52) - 4096] {
            let mut units = vec![0.0; 4096];
            sampler.units(0, first, &mut units);
            assert!(units.iter().all(|&unit| 0.0 < unit && unit < 1.0));
        }
    }

    #[test]
    fn slices_agree_whatever_their_start_and_length() {
        let sampler = sampler(1000, 2, 0);
        let all = column(&sampler, 1);
        for first in [0, 1, 17, 31, 32, 900] {
            for length in [0, 1, 15, 31, 32, 33, 100] {
                let mut units = vec![0.0; length];
                sampler.units(1, first, &mut units);
                assert_eq!(units, all[first as usize..][..length]);
            }
        }
        let mut past_the_end = [0.0; 70];
        sampler.units(1, u64::MAX - 20, &mut past_the_end);
        assert!(past_the_end.iter().all(|&unit| 0.0 < unit && unit < 1.0));
    }

    #[test]
    fn a_dimension_depends_on_key_and_replicate_but_not_on_how_many_there_are() {
        let units =
            |dimension, key, replicate| column(&LatinHypercubeSampler::new(50, dimension, key, replicate).unwrap(), 1);
        assert_eq!(units(2, KEY, 4), units(40, KEY, 4));
        assert_ne!(units(2, KEY, 4), units(2, KEY, 5));
        assert_ne!(units(2, KEY, 4), units(2, [KEY[1], KEY[0]], 4));
        assert!(LatinHypercubeSampler::new(0, 1, KEY, 0).is_none());
        assert!(LatinHypercubeSampler::new((1 << 52) + 1, 1, KEY, 0).is_none());
        assert!(LatinHypercubeSampler::new(1, 0, KEY, 0).is_none());
        assert!(LatinHypercubeSampler::new(1, 4097, KEY, 0).is_none());
    }

    /// Chi-square over 16 × 16 groups of strata, with the 15² degrees of freedom that fixed margins leave.
    #[test]
    fn dimensions_and_replicates_are_independent() {
        const POINTS: u64 = 1 << 14;
        let (one, other) = (sampler(POINTS, 6, 0), sampler(POINTS, 6, 1));
        let mut columns: Vec<_> = (0..6).map(|dimension| column(&one, dimension)).collect();
        columns.extend((0..6).map(|dimension| column(&other, dimension)));
        for (j, k) in (0..12).flat_map(|k| (0..k).map(move |j| (j, k))) {
            let mut counts = [0.0; 256];
            for (x, y) in columns[j].iter().zip(&columns[k]) {
                counts[(16.0 * x) as usize * 16 + (16.0 * y) as usize] += 1.0;
            }
            let expected = POINTS as f64 / 256.0;
            let chi_square: f64 = counts.iter().map(|count| (count - expected).powi(2) / expected).sum();
            assert!(((chi_square - 225.0) / 450.0_f64.sqrt()).abs() < 5.0, "columns {j} and {k}: {chi_square}");
        }
    }

    /// The places inside strata are uniform and not correlated with those of neighbours or of other dimensions.
    #[test]
    fn places_inside_strata_are_uniform() {
        const POINTS: u64 = 30_000;
        let sampler = sampler(POINTS, 2, 9);
        let place = |unit: f64| (unit * POINTS as f64).fract() - 0.5;
        let places = [0, 1].map(|dimension| column(&sampler, dimension).into_iter().map(place).collect::<Vec<_>>());
        let bound = 5.0 / (POINTS as f64).sqrt();
        let average = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / POINTS as f64;
        assert!(average(&mut places[0].iter().map(|u| u * 12.0_f64.sqrt())).abs() < bound);
        assert!(average(&mut places[0].iter().map(|u| (12.0 * u * u - 1.0) / 0.8_f64.sqrt())).abs() < bound);
        assert!(average(&mut places[0].iter().zip(&places[1]).map(|(u, v)| 12.0 * u * v)).abs() < bound);
        for lag in [1, 16, 32] {
            assert!(average(&mut places[0].iter().zip(&places[0][lag..]).map(|(u, v)| 12.0 * u * v)).abs() < bound);
        }
    }

    /// Stein (1987), <https://doi.org/10.1080/00401706.1987.10488205>: the variance of additive functions vanishes
    /// faster than 1/n, and means are unbiased.
    #[test]
    fn means_of_additive_functions_are_unbiased_and_nearly_exact() {
        const REPLICATES: u32 = 200;
        for points in [3, 100, 1024, 1500] {
            let errors: Vec<f64> = (0..REPLICATES)
                .map(|replicate| {
                    let sampler = sampler(points, 4, replicate);
                    let sum = |dimension| column(&sampler, dimension).iter().map(|x| x.exp()).sum::<f64>();
                    (0..4).map(sum).sum::<f64>() / points as f64 - 4.0 * (1.0_f64.exp() - 1.0)
                })
                .collect();
            let mean = errors.iter().sum::<f64>() / f64::from(REPLICATES);
            let variance = errors.iter().map(|error| error * error).sum::<f64>() / f64::from(REPLICATES);
            // var exp(U) = (e² − 1)/2 − (e − 1)²; strata of width 1/n reduce it about n² times.
            let monte_carlo = 4.0 * 0.242_035_607_452_765 / points as f64;
            assert!(variance < 2.0 * monte_carlo / (points as f64).powi(2), "{points} points");
            assert!(mean.abs() < 5.0 * (variance / f64::from(REPLICATES)).sqrt(), "{points} points");
        }
    }

    /// The variance of the mean of xy is exactly known for random permutations, and it depends on how pairs are
    /// permuted.
    #[test]
    fn means_of_interactions_have_the_variance_of_random_permutations() {
        const REPLICATES: u32 = 4000;
        for points in [8_u64, 11, 64, 100] {
            let square = |replicate| {
                let sampler = sampler(points, 2, replicate);
                let product: f64 = column(&sampler, 0).iter().zip(column(&sampler, 1)).map(|(x, y)| x * y).sum();
                (product / points as f64 - 0.25).powi(2)
            };
            let variance = (0..REPLICATES).map(square).sum::<f64>() / f64::from(REPLICATES);
            let n = points as f64;
            // Stratum means vary by (1 − 1/n²)/12, places by 1/12n² around them.
            let (between, within) = ((1.0 - 1.0 / (n * n)) / 12.0, 1.0 / (12.0 * n * n));
            let expected = (between * between * n / (n - 1.0) + 2.0 * within * (between + 0.25) + within * within) / n;
            assert!((variance / expected - 1.0).abs() < 5.0 * (2.0 / f64::from(REPLICATES)).sqrt(), "{points} points");
        }
    }
}
