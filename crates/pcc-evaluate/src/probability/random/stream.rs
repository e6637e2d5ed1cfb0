//! Streams keyed by (seed, purpose, index).

use std::convert::Infallible;

use rand::TryRng;

use super::philox::philox_4x32_10;
use super::uniform::{UNIT_BITS, unit_interval};

/// What random numbers are for. Two purposes never share a stream, so evaluation points are independent of the points
/// that a surrogate was trained on, and certification points of both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Experimental designs.
    Design = 1,
    /// Monte Carlo points of `eval`, `reference` and `compare`.
    Evaluation = 2,
    /// Fresh model runs that certify a surrogate.
    Certification = 3,
}

/// The random words of one (seed, purpose, index), in order.
///
/// The key of Philox 4×32-10 is the seed, the counter (block, purpose, index): block counts the 128-bit blocks drawn
/// from this stream, index is a sample number or a design level. It is a generator for all of `rand`.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::random::{Purpose, Stream};
/// let first: f64 = Stream::new(1, Purpose::Evaluation, 41).next_unit();
/// let again: f64 = Stream::new(1, Purpose::Evaluation, 41).next_unit();
/// assert_eq!(first, again);
/// ```
#[derive(Debug, Clone)]
pub struct Stream {
    key: [u32; 2],
    counter: [u32; 4],
    words: [u32; 4],
    used: usize,
}

/// The key of a seed, low word first.
#[inline(always)]
pub fn key(seed: u64) -> [u32; 2] {
    [seed as u32, (seed >> 32) as u32]
}

/// The counter of one block of a stream.
#[inline(always)]
pub(super) fn counter(block: u32, purpose: Purpose, index: u64) -> [u32; 4] {
    [block, purpose as u32, index as u32, (index >> 32) as u32]
}

impl Stream {
    /// The stream of `index` for `purpose` under `seed`.
    #[inline]
    pub fn new(seed: u64, purpose: Purpose, index: u64) -> Self {
        Self { key: key(seed), counter: counter(0, purpose, index), words: [0; 4], used: 4 }
    }

    /// The next cell of the unit interval, uniform in 0…2⁵² − 1.
    #[inline]
    pub fn next_cell(&mut self) -> u64 {
        self.next_word_pair() >> (64 - UNIT_BITS)
    }

    /// The next uniform number of the open interval (0, 1).
    #[inline]
    pub fn next_unit(&mut self) -> f64 {
        unit_interval(self.next_cell())
    }

    #[inline]
    fn next_word(&mut self) -> u32 {
        if self.used == self.words.len() {
            self.words = philox_4x32_10(self.counter, self.key);
            self.counter[0] = self.counter[0].wrapping_add(1);
            self.used = 0;
        }
        self.used += 1;
        self.words[self.used - 1]
    }

    /// Two words, low word first.
    #[inline]
    fn next_word_pair(&mut self) -> u64 {
        let low = u64::from(self.next_word());
        low | u64::from(self.next_word()) << 32
    }
}

impl TryRng for Stream {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.next_word())
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(self.next_word_pair())
    }

    fn try_fill_bytes(&mut self, destination: &mut [u8]) -> Result<(), Infallible> {
        for chunk in destination.chunks_mut(4) {
            chunk.copy_from_slice(&self.next_word().to_le_bytes()[..chunk.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use std::collections::HashSet;

    #[test]
    fn words_are_the_blocks_of_the_counter_in_order() {
        let mut stream = Stream::new(0x0123_4567_89ab_cdef, Purpose::Certification, 0x1_0000_0002);
        let key = [0x89ab_cdef, 0x0123_4567];
        let words: Vec<u32> = (0..8).map(|_| stream.next_u32()).collect();
        assert_eq!(words[..4], philox_4x32_10([0, 3, 2, 1], key));
        assert_eq!(words[4..], philox_4x32_10([1, 3, 2, 1], key));
    }

    #[test]
    fn seeds_purposes_and_indices_do_not_share_streams() {
        let mut seen = HashSet::new();
        for seed in [0, 1, 1 << 32] {
            for purpose in [Purpose::Design, Purpose::Evaluation, Purpose::Certification] {
                for index in [0, 1, 1 << 32] {
                    assert!(seen.insert(Stream::new(seed, purpose, index).next_u64()));
                }
            }
        }
    }

    #[test]
    fn uniform_numbers_have_the_moments_of_the_uniform_law() {
        const DRAWS: usize = 100_000;
        let mut stream = Stream::new(7, Purpose::Evaluation, 0);
        let draws: Vec<f64> = (0..DRAWS).map(|_| stream.next_unit()).collect();
        let mean = draws.iter().sum::<f64>() / DRAWS as f64;
        let square = draws.iter().map(|u| u * u).sum::<f64>() / DRAWS as f64;
        // Five standard errors of the mean (√(1/12n)) and of the mean square (√(4/45n)).
        assert!((mean - 0.5).abs() < 5.0 * (1.0 / 12.0 / DRAWS as f64).sqrt());
        assert!((square - 1.0 / 3.0).abs() < 5.0 * (4.0 / 45.0 / DRAWS as f64).sqrt());
    }
}
