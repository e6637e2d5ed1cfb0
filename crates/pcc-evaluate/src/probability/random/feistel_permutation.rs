//! Pseudo-random permutations of 0…n − 1 without a table.

/// Values that a call permutes.
pub(super) const LANES: usize = 32;
/// Values that stay in vector registers through all rounds; it divides [`LANES`].
const GROUP: usize = 8;
/// Rounds never go below this, whatever the width; see [`FeistelPermutation`].
const MINIMUM_ROUNDS: u32 = 8;
/// The bits of a round function's 64-bit sum that are used, from this one up: the highest 26, half the widest value.
const ROUND_SHIFT: u32 = 38;

/// A pseudo-random permutation of 0…n − 1, n ≤ 2⁵²: a Feistel network on the w = ⌈log₂ n⌉ bits of a value, and cycle
/// walking, that is, repetition until the value is below n (Black and Rogaway 2002,
/// <https://doi.org/10.1007/3-540-45760-7_9>). A value takes 2ʷ/n < 2 passes on average.
///
/// The value is split into a left half of ⌈w/2⌉ bits and a right half of ⌊w/2⌋ bits; rounds alternately replace left by
/// left ⊕ f(right) and right by right ⊕ f(left). The round function f(x) is the highest bits of (αx + β) mod 2⁶⁴ with
/// random 64-bit α and β of its own for each round. For halves of at most 26 bits that is strongly universal: the
/// values at two different x are uniform and independent (Dietzfelbinger 1996,
/// <https://doi.org/10.1007/3-540-60922-9_46>; Thorup 2015, <https://doi.org/10.48550/arXiv.1504.06804>).
///
/// Number of rounds. For n = 2ʷ a single image is therefore exactly uniform after two rounds, and a pair of images
/// behaves exactly as with ideal round functions: if two values agree in the right half with probability p, a round on
/// the left makes them agree in the left half with probability (1 − p)2^−⌈w/2⌉, and likewise on the other side, so two
/// rounds shrink the distance from the pairs of a random permutation by 2ʷ. The variance of a mean over a Latin
/// hypercube depends on nothing but pairs; cycle walking and sums of many terms also see larger groups, which converge
/// more slowly if w is small. Hence 2(⌈48/w⌉ + 1) rounds, a distance below 2⁻⁴⁸. Wide networks make at least eight:
/// chi-square tests of equidistant points reject four rounds, five for few keys, and six never, for w from 16 to 52.
#[derive(Debug, Clone)]
pub(super) struct FeistelPermutation {
    size: u64,
    right_bits: u32,
    left_mask: u64,
    right_mask: u64,
    /// A round on the left and one on the right.
    rounds: Vec<[Round; 2]>,
}

/// The round function x → highest bits of (`multiplier` x + `addend`) mod 2⁶⁴.
#[derive(Debug, Clone, Copy)]
struct Round {
    multiplier: u64,
    addend: u64,
}

impl Round {
    fn new(words: [u32; 4]) -> Self {
        let join = |low: u32, high: u32| u64::from(low) | u64::from(high) << 32;
        Self { multiplier: join(words[0], words[1]), addend: join(words[2], words[3]) }
    }

    #[inline]
    fn value(self, half: u64) -> u64 {
        // Halves have at most 26 bits; told so, compilers drop a third of a vector multiplication.
        (half & u64::from(u32::MAX)).wrapping_mul(self.multiplier).wrapping_add(self.addend) >> ROUND_SHIFT
    }
}

/// ⌈log₂ size⌉, the bits that the numbers below `size` need.
pub(super) fn width(size: u64) -> u32 {
    u64::BITS - size.saturating_sub(1).leading_zeros()
}

impl FeistelPermutation {
    /// A permutation of the numbers below `size` ≤ 2⁵², random through `words`: four random words for each round.
    pub(super) fn new(size: u64, words: impl Fn(u32) -> [u32; 4]) -> Self {
        let rounds = (2 * (48_u32.div_ceil(width(size).max(1)) + 1)).max(MINIMUM_ROUNDS);
        Self::with_rounds(size, rounds, words)
    }

    fn with_rounds(size: u64, rounds: u32, words: impl Fn(u32) -> [u32; 4]) -> Self {
        let width = width(size);
        let right_bits = width / 2;
        Self {
            size,
            right_bits,
            left_mask: (1 << (width - right_bits)) - 1,
            right_mask: (1 << right_bits) - 1,
            rounds: (0..rounds / 2).map(|i| [Round::new(words(2 * i)), Round::new(words(2 * i + 1))]).collect(),
        }
    }

    /// Replaces each value, which must be below the size, by its image.
    pub(super) fn apply(&self, values: &mut [u64; LANES]) {
        self.encipher(values);
        // Cycle walking: values outside are gathered, so that further passes work on full vectors.
        let mut lanes = [0; LANES];
        let mut walkers = [0; LANES];
        let mut count = 0;
        for (lane, &value) in values.iter().enumerate() {
            lanes[count] = lane;
            walkers[count] = value;
            count += usize::from(value >= self.size);
        }
        while count > 0 {
            self.encipher(&mut walkers[..count.next_multiple_of(GROUP)]);
            let walking = std::mem::take(&mut count);
            for slot in 0..walking {
                let (lane, walker) = (lanes[slot], walkers[slot]);
                values[lane] = walker;
                lanes[count] = lane;
                walkers[count] = walker;
                count += usize::from(walker >= self.size);
            }
        }
    }

    /// One pass of the network over each value; whole groups only. Not inlined, because compilers vectorise it best
    /// alone.
    #[inline(never)]
    fn encipher(&self, values: &mut [u64]) {
        let Self { right_bits, left_mask, right_mask, ref rounds, .. } = *self;
        let (groups, _) = values.as_chunks_mut::<GROUP>();
        for group in groups {
            let mut left = group.map(|value| value >> right_bits);
            let mut right = group.map(|value| value & right_mask);
            for [on_left, on_right] in rounds {
                for (left, &right) in left.iter_mut().zip(&right) {
                    *left ^= on_left.value(right) & left_mask;
                }
                for (right, &left) in right.iter_mut().zip(&left) {
                    *right ^= on_right.value(left) & right_mask;
                }
            }
            for (lane, value) in group.iter_mut().enumerate() {
                *value = left[lane] << right_bits | right[lane];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probability::random::philox_4x32_10;

    fn permutation(size: u64, key: u32) -> FeistelPermutation {
        FeistelPermutation::new(size, |round| philox_4x32_10([round, 0, 0, 0], [key, 77]))
    }

    /// The images of 0, `stride`, 2 `stride`, …, `count` of them.
    fn images(permutation: &FeistelPermutation, stride: u64, count: usize) -> Vec<u64> {
        let mut images: Vec<u64> = (0..count as u64).map(|point| point * stride).collect();
        for piece in images.chunks_mut(LANES) {
            let mut values = [0; LANES];
            values[..piece.len()].copy_from_slice(piece);
            permutation.apply(&mut values);
            piece.copy_from_slice(&values[..piece.len()]);
        }
        images
    }

    /// Standard normal, approximately, if all `counts` have the same expectation.
    fn excess(counts: &[u32]) -> f64 {
        let expected = f64::from(counts.iter().sum::<u32>()) / counts.len() as f64;
        let chi_square: f64 = counts.iter().map(|&count| (f64::from(count) - expected).powi(2) / expected).sum();
        let freedom = counts.len() as f64 - 1.0;
        (chi_square - freedom) / (2.0 * freedom).sqrt()
    }

    #[test]
    fn widths_are_binary_logarithms_rounded_up() {
        assert_eq!([1, 2, 3, 4, 5, 1 << 40, (1 << 40) + 1, 1 << 52].map(width), [0, 1, 2, 2, 3, 40, 41, 52]);
    }

    #[test]
    fn every_image_occurs_once() {
        for size in (1..=300).chain([1023, 1024, 1025, 65_537, 100_003, 1 << 18]) {
            let mut images = images(&permutation(size, size as u32), 1, size as usize);
            images.sort();
            assert!(images.into_iter().eq(0..size), "size {size}");
        }
    }

    #[test]
    fn small_permutations_are_equally_likely() {
        for (size, factorial) in [(2, 2), (3, 6), (4, 24), (5, 120), (6, 720)] {
            let mut counts = vec![0; factorial];
            for key in 0..200 * factorial as u32 {
                let images = images(&permutation(size, key), 1, size as usize);
                // The Lehmer code of a permutation is its rank.
                let rank = (0..images.len()).fold(0, |rank, i| {
                    let smaller = images[i + 1..].iter().filter(|&&later| later < images[i]).count();
                    rank * (images.len() - i) + smaller
                });
                counts[rank] += 1;
            }
            assert!(excess(&counts).abs() < 4.5, "size {size}: {}", excess(&counts));
        }
    }

    #[test]
    fn pairs_of_images_are_equally_likely() {
        for size in [7, 13, 32] {
            let mut counts = vec![0; (size * (size - 1)) as usize];
            for key in 0..100_000 {
                let images = images(&permutation(size, key), 1, 2);
                counts[(images[0] * (size - 1) + images[1] - u64::from(images[1] > images[0])) as usize] += 1;
            }
            assert!(excess(&counts).abs() < 4.5, "size {size}: {}", excess(&counts));
        }
    }

    /// Chi-square of the leading and of the trailing bits of three consecutive images, the larger deviation. Neighbours
    /// a stride of the right half apart are hardest: the first round moves all their left halves alike.
    fn deviation_of_triples(permutation: &FeistelPermutation, stride: u64) -> f64 {
        let (images, size) = (images(permutation, stride, 3 << 12), permutation.size);
        let deviation = |digit: &dyn Fn(u64) -> u64| {
            let mut counts = vec![0; 64];
            for triple in images.as_chunks::<3>().0 {
                counts[triple.iter().fold(0, |sum, &image| sum * 4 + digit(image) as usize)] += 1;
            }
            excess(&counts).abs()
        };
        deviation(&|image| ((image as u128 * 4) / size as u128) as u64).max(deviation(&|image| image % 4))
    }

    #[test]
    fn consecutive_images_look_independent_with_eight_rounds_but_not_with_four() {
        for (size, stride) in [(1 << 20, 1), (1_000_003, 1), (1 << 27, 1 << 13), (1 << 40, 1 << 20), (1 << 52, 1 << 26)]
        {
            let mut four_rounds: f64 = 0.0;
            for key in 0..100 {
                let words = |round| philox_4x32_10([round, 0, 0, 0], [key, 77]);
                let eight_rounds = deviation_of_triples(&FeistelPermutation::with_rounds(size, 8, words), stride);
                assert!(eight_rounds < 5.5, "size {size}, key {key}: {eight_rounds}");
                let network = FeistelPermutation::with_rounds(size, 4, words);
                four_rounds = four_rounds.max(deviation_of_triples(&network, stride));
            }
            assert!(four_rounds > 10.0, "size {size}: {four_rounds}");
        }
    }
}
