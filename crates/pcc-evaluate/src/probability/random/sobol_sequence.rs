//! Scrambled points of the Sobol' sequence, for randomised quasi-Monte Carlo integration.
//!
//! Direction numbers: Joe and Kuo (2008), <https://doi.org/10.1137/070709359>. Scrambling: the random linear matrix
//! scrambling of Matoušek (1998), <https://doi.org/10.1006/jcom.1998.0489>, followed by a random digital shift. It
//! keeps the balance of the net, makes every single point uniform, so that means are unbiased, and gives means the
//! variance of Owen's nested scrambling (Owen 2003, <https://doi.org/10.1145/945511.945518>) at the price of 53 random
//! numbers per dimension instead of one per node of a tree.

use super::direction_numbers::RECURRENCES;
use crate::probability::random::{UNIT_BITS, philox_4x32_10};

/// Binary digits of a coordinate, and the binary logarithm of the number of points.
const DIGITS: usize = UNIT_BITS as usize;
/// Points whose numbers differ only in the lowest five bits: within a block the coordinates follow one fixed pattern.
const BLOCK: usize = 32;
/// The word of the random counter that tells what numbers are for; nothing else draws under this one.
const SCRAMBLING_PURPOSE: u32 = 4;

/// One randomisation of the Sobol' sequence in up to 256 dimensions, of period 2⁵² points.
///
/// In dimension j the cell of point i = Σ iᵦ2ᵇ (binary digits iᵦ) is xⱼ(i) = eⱼ ⊕ ⨁ᵦ iᵦ Lⱼ vⱼ(b): vⱼ(b) are the 52-bit
/// direction numbers, Lⱼ is a random lower triangular binary matrix with unit diagonal that acts on their digits, and
/// eⱼ is a random digital shift. Lⱼ and eⱼ depend on nothing but the key, the replicate and j; they are independent
/// across replicates and across dimensions.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::random::SobolSequence;
/// let sequence = SobolSequence::new(2, [1, 0], 0).expect("a supported dimension");
/// let mut cells = [0; 4];
/// sequence.cells(1, 0, &mut cells);
/// let mut quarters = cells.map(|cell| cell >> 50);
/// quarters.sort();
/// assert_eq!(quarters, [0, 1, 2, 3]);
/// ```
#[derive(Debug, Clone)]
pub struct SobolSequence {
    coordinates: Vec<Coordinate>,
}

impl SobolSequence {
    /// The largest number of dimensions: that of the table of direction numbers.
    pub const MAXIMUM_DIMENSION: usize = RECURRENCES.len() + 1;

    /// The number of points after which they repeat.
    pub const PERIOD: u64 = 1 << DIGITS;

    /// Replicate number `replicate` of the sequence in `dimension` dimensions under the seed `key`.
    ///
    /// Dimension j of a replicate is the same whatever the number of dimensions asked for. `None` if `dimension` is 0
    /// or above [`Self::MAXIMUM_DIMENSION`].
    pub fn new(dimension: usize, key: [u32; 2], replicate: u32) -> Option<Self> {
        if !(1..=Self::MAXIMUM_DIMENSION).contains(&dimension) {
            return None;
        }
        let coordinates = (0..dimension).map(|j| Coordinate::scrambled(j, key, replicate)).collect();
        Some(Self { coordinates })
    }

    /// The number of dimensions.
    pub fn dimension(&self) -> usize {
        self.coordinates.len()
    }

    /// Writes the cells, in 0…2⁵² − 1, of points `first`, `first` + 1, … in dimension `dimension` (from 0).
    ///
    /// [`unit_interval`](crate::probability::random::unit_interval) maps a cell to its coordinate in (0, 1). Points are
    /// numbered modulo 2⁵². Any `first` and any length are right; multiples of 32 are fastest.
    ///
    /// # Panics
    ///
    /// If `dimension` is not below [`Self::dimension`], like the index of a slice.
    pub fn cells(&self, dimension: usize, first: u64, cells: &mut [u64]) {
        let coordinate = &self.coordinates[dimension];
        let offset = (first % BLOCK as u64) as usize;
        let mut point = first - offset as u64;
        let mut base = coordinate.shift ^ combination(&coordinate.directions, point);

        let to_block = (BLOCK - offset) % BLOCK;
        let (head, aligned) = cells.split_at_mut(to_block.min(cells.len()));
        if offset > 0 {
            fill(head, base, &coordinate.pattern[offset..]);
            advance(&mut point, &mut base, &coordinate.directions);
        }
        let (blocks, tail) = aligned.as_chunks_mut::<BLOCK>();
        for block in blocks {
            fill(block, base, &coordinate.pattern);
            advance(&mut point, &mut base, &coordinate.directions);
        }
        fill(tail, base, &coordinate.pattern);
    }
}

/// What one dimension needs: scrambling is folded into the direction numbers once, so it costs nothing per point.
#[derive(Debug, Clone)]
struct Coordinate {
    directions: [u64; DIGITS],
    shift: u64,
    /// The combinations of the lowest five direction numbers.
    pattern: [u64; BLOCK],
}

impl Coordinate {
    fn new(directions: [u64; DIGITS], shift: u64) -> Self {
        let pattern = std::array::from_fn(|point| combination(&directions, point as u64));
        Self { directions, shift, pattern }
    }

    fn scrambled(dimension: usize, key: [u32; 2], replicate: u32) -> Self {
        // Blocks 0…25 hold the columns of the matrix, two each, block 26 the shift.
        let draw = |block: usize| {
            let words = philox_4x32_10([block as u32, SCRAMBLING_PURPOSE, dimension as u32, replicate], key);
            [u64::from(words[0]) | u64::from(words[1]) << 32, u64::from(words[2]) | u64::from(words[3]) << 32]
        };
        // Column d is where digit d goes, the most significant digit being number 0 (bit 51): to itself and, at random,
        // to any less significant digits.
        let columns: [u64; DIGITS] = std::array::from_fn(|digit| {
            let diagonal = 1 << (DIGITS - 1 - digit);
            diagonal | draw(digit / 2)[digit % 2] & (diagonal - 1)
        });
        let matrix_times = |number: u64| combination(&columns, number.reverse_bits() >> (64 - DIGITS));
        let shift = draw(DIGITS / 2)[0] >> (64 - DIGITS);
        Self::new(direction_numbers(dimension).map(matrix_times), shift)
    }
}

/// The direction numbers v(b) = mᵦ₊₁ 2⁵¹⁻ᵇ, by the recurrence of Bratley and Fox (1988),
/// <https://doi.org/10.1145/42288.214372>: v(b) = a₁v(b−1) ⊕ … ⊕ aₛ₋₁v(b−s+1) ⊕ v(b−s) ⊕ v(b−s)/2ˢ.
fn direction_numbers(dimension: usize) -> [u64; DIGITS] {
    let mut directions = std::array::from_fn(|bit| 1 << (DIGITS - 1 - bit));
    if dimension == 0 {
        return directions;
    }
    let (polynomial, initial) = RECURRENCES[dimension - 1];
    for (direction, &number) in directions.iter_mut().zip(initial) {
        *direction *= u64::from(number);
    }
    let degree = initial.len();
    for bit in degree..DIGITS {
        let oldest = directions[bit - degree];
        directions[bit] = (1..degree)
            .filter(|back| polynomial >> (degree - back) & 1 == 1)
            .fold(oldest ^ oldest >> degree, |sum, back| sum ^ directions[bit - back]);
    }
    directions
}

/// ⨁ vectors\[b\] over the set bits b < 52 of `number`.
#[inline]
fn combination(vectors: &[u64; DIGITS], number: u64) -> u64 {
    let mut remaining = number & ((1 << DIGITS) - 1);
    let mut sum = 0;
    while remaining != 0 {
        sum ^= vectors[remaining.trailing_zeros() as usize];
        remaining &= remaining - 1;
    }
    sum
}

/// From one block to the next only the bits that a carry flips change, two on average.
#[inline]
fn advance(point: &mut u64, base: &mut u64, directions: &[u64; DIGITS]) {
    let next = point.wrapping_add(BLOCK as u64);
    *base ^= combination(directions, *point ^ next);
    *point = next;
}

#[inline]
fn fill(cells: &mut [u64], base: u64, pattern: &[u64]) {
    for (cell, &low) in cells.iter_mut().zip(pattern) {
        *cell = base ^ low;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probability::random::unit_interval;

    const KEY: [u32; 2] = [0x1234_5678, 0x9abc_def0];

    fn scrambled(dimension: usize, replicate: u32) -> SobolSequence {
        SobolSequence::new(dimension, KEY, replicate).unwrap()
    }

    fn first_cells(sequence: &SobolSequence, dimension: usize, count: usize) -> Vec<u64> {
        let mut cells = vec![0; count];
        sequence.cells(dimension, 0, &mut cells);
        cells
    }

    /// Mean of `function` over the first `count` points.
    fn mean(sequence: &SobolSequence, count: usize, function: impl Fn(&[f64]) -> f64) -> f64 {
        let cells: Vec<_> = (0..sequence.dimension()).map(|j| first_cells(sequence, j, count)).collect();
        let value = |i: usize| function(&cells.iter().map(|column| unit_interval(column[i])).collect::<Vec<_>>());
        (0..count).map(value).sum::<f64>() / count as f64
    }

    /// Points 1, 2, 3, 100, 677 and 1023 of SciPy 1.17, its Gray code order undone.
    #[test]
    fn unscrambled_points_are_those_of_scipy() {
        const POINTS: [u64; 6] = [1, 2, 3, 100, 677, 1023];
        let coordinates = (0..256).map(|j| Coordinate::new(direction_numbers(j), 0)).collect();
        let sequence = SobolSequence { coordinates };
        for (dimension, expected) in [
            (1, [0x80000, 0x40000, 0xc0000, 0x26000, 0xa5400, 0xffc00]),
            (2, [0x80000, 0xc0000, 0x40000, 0xc6000, 0xd3c00, 0x41400]),
            (3, [0x80000, 0xc0000, 0x40000, 0xb2000, 0xe5c00, 0xbb400]),
            (8, [0x80000, 0x40000, 0xc0000, 0x96000, 0xb7400, 0x4bc00]),
            (55, [0x80000, 0xc0000, 0x40000, 0xbe000, 0x05400, 0x95c00]),
            (128, [0x80000, 0xc0000, 0x40000, 0x3a000, 0xca400, 0x2ec00]),
            (256, [0x80000, 0x40000, 0xc0000, 0x46000, 0xfec00, 0x2c400]),
        ] {
            let cells = first_cells(&sequence, dimension - 1, 1024);
            assert_eq!(POINTS.map(|point| cells[point as usize]), expected.map(|leading: u64| leading << 32));
        }
    }

    /// The digest (FNV-1a over words) of the 256 × 52 direction numbers that SciPy 1.17 computes.
    #[test]
    fn all_direction_numbers_are_those_of_scipy() {
        let numbers = (0..256).flat_map(direction_numbers);
        let digest =
            numbers.fold(0xcbf2_9ce4_8422_2325_u64, |sum, number| (sum ^ number).wrapping_mul(0x0100_0000_01b3));
        assert_eq!(digest, 0x29d1_efb7_7335_7919);
    }

    #[test]
    fn every_dimension_has_one_of_the_first_points_in_each_cell() {
        let sequence = scrambled(256, 3);
        for dimension in 0..256 {
            for digits in [1, 5, 8, 11] {
                let mut cells = first_cells(&sequence, dimension, 1 << digits);
                cells.iter_mut().for_each(|cell| *cell >>= DIGITS - digits);
                cells.sort();
                assert!(cells.into_iter().eq(0..1 << digits), "dimension {dimension}, {digits} digits");
            }
        }
    }

    /// A pair of dimensions whose polynomials have degrees s and s' is a net of quality t = s + s' − 2 (Niederreiter
    /// 1992, <https://doi.org/10.1137/1.9781611970081>, theorem 4.49; the first dimension counts as degree 1).
    #[test]
    fn pairs_of_dimensions_are_balanced_in_elementary_boxes() {
        const POINTS: usize = 10;
        let sequence = scrambled(10, 0);
        let degree = |dimension: usize| if dimension == 0 { 1 } else { RECURRENCES[dimension - 1].1.len() };
        let cells: Vec<_> = (0..10).map(|dimension| first_cells(&sequence, dimension, 1 << POINTS)).collect();
        for (j, k) in (0..10).flat_map(|k| (0..k).map(move |j| (j, k))) {
            let quality = degree(j) + degree(k) - 2;
            for rows in 0..=POINTS - quality {
                let columns = POINTS - quality - rows;
                let mut counts = vec![0; 1 << (rows + columns)];
                for (x, y) in cells[j].iter().zip(&cells[k]) {
                    counts[(x >> (DIGITS - rows) << columns | y >> (DIGITS - columns)) as usize] += 1;
                }
                assert!(counts.iter().all(|&count| count == 1 << quality), "dimensions {j} and {k}");
            }
        }
    }

    #[test]
    fn blocks_are_filled_as_point_by_point() {
        let sequence = scrambled(7, 1);
        let directions = &sequence.coordinates[6].directions;
        for first in [0, 1, 31, 32, 96, 1000, (1 << 40) - 33, (1 << 52) - 40, u64::MAX - 70] {
            for length in [0, 1, 5, 31, 32, 33, 64, 100] {
                let mut cells = vec![0; length];
                sequence.cells(6, first, &mut cells);
                for (i, cell) in cells.into_iter().enumerate() {
                    let point = first.wrapping_add(i as u64);
                    let bits = (0..DIGITS).filter(|bit| point >> bit & 1 == 1);
                    let expected = bits.fold(sequence.coordinates[6].shift, |sum, bit| sum ^ directions[bit]);
                    assert_eq!(cell, expected, "point {point} from {first}");
                }
            }
        }
    }

    #[test]
    fn a_dimension_depends_on_key_and_replicate_but_not_on_how_many_there_are() {
        let cells =
            |dimension, key, replicate| first_cells(&SobolSequence::new(dimension, key, replicate).unwrap(), 2, 100);
        assert_eq!(cells(3, KEY, 5), cells(256, KEY, 5));
        assert_ne!(cells(3, KEY, 5), cells(3, KEY, 6));
        assert_ne!(cells(3, KEY, 5), cells(3, [KEY[1], KEY[0]], 5));
        assert!(SobolSequence::new(0, KEY, 0).is_none() && SobolSequence::new(257, KEY, 0).is_none());
    }

    /// Over replicates every mean of eight points is unbiased, and the first points of two dimensions are uncorrelated:
    /// five standard errors.
    #[test]
    fn replicates_are_unbiased_and_independent() {
        const REPLICATES: u32 = 4000;
        let sequences: Vec<_> = (0..REPLICATES).map(|replicate| scrambled(3, replicate)).collect();
        let means: Vec<f64> = sequences.iter().map(|one| mean(one, 8, |x| (x[0] + x[1] * x[2]).exp())).collect();
        // ∫ exp(x + yz) = (e − 1) Σ 1/(k! (k+1)²).
        let exact = (1.0_f64.exp() - 1.0) * 1.317_902_151_454_404;
        let average = means.iter().sum::<f64>() / f64::from(REPLICATES);
        let square = means.iter().map(|value| (value - average).powi(2)).sum::<f64>() / f64::from(REPLICATES);
        assert!((average - exact).abs() < 5.0 * (square / f64::from(REPLICATES)).sqrt(), "{average} against {exact}");

        let product = |one: &SobolSequence| mean(one, 1, |x| 12.0 * (x[0] - 0.5) * (x[1] - 0.5));
        let correlation = sequences.iter().map(product).sum::<f64>() / f64::from(REPLICATES);
        assert!(correlation.abs() < 5.0 / f64::from(REPLICATES).sqrt());
    }

    #[test]
    fn smooth_functions_converge_much_faster_than_monte_carlo() {
        const POINTS: usize = 1 << 12;
        let function = |x: &[f64]| x.iter().map(|x| 1.0 + (x - 0.5)).product::<f64>();
        let square = |replicate| (mean(&scrambled(8, replicate), POINTS, function) - 1.0).powi(2);
        let error = ((0..20).map(square).sum::<f64>() / 20.0).sqrt();
        let monte_carlo = (((1.0 + 1.0 / 12.0_f64).powi(8) - 1.0) / POINTS as f64).sqrt();
        assert!(error < monte_carlo / 40.0, "{error} against {monte_carlo}");
    }
}
