//! Uniform numbers of many streams at once.

use super::philox::ten_rounds;
use super::stream::{Purpose, counter, key};
use super::uniform::{UNIT_BITS, unit_interval};

/// Numbers 2 `pair` and 2 `pair` + 1 of the streams of index `first`, `first` + 1, …, one stream per lane: the same
/// bits as [`Stream::next_unit`](super::Stream::next_unit). No lane depends on another, so that this compiles to vector
/// instructions where the caller allows them.
#[inline(always)]
pub fn unit_pairs<const LANES: usize>(
    seed: u64,
    purpose: Purpose,
    first: u64,
    pair: u32,
    even: &mut [f64; LANES],
    odd: &mut [f64; LANES],
) {
    let key = key(seed);
    for lane in 0..LANES {
        let index = first.wrapping_add(lane as u64);
        let words = ten_rounds(counter(pair, purpose, index).map(u64::from), key);
        even[lane] = unit(words[0], words[1]);
        odd[lane] = unit(words[2], words[3]);
    }
}

/// The number of two words, low word first; the upper halves of both do not count.
#[inline(always)]
fn unit(low: u64, high: u64) -> f64 {
    unit_interval(((low & 0xFFFF_FFFF) | high << 32) >> (64 - UNIT_BITS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probability::random::Stream;

    #[test]
    fn lanes_hold_the_numbers_of_their_streams() {
        for (seed, first) in [(1, 0), (u64::MAX, (1 << 32) - 3), (0x0123_4567_89ab_cdef, u64::MAX - 5)] {
            for pair in 0..3 {
                let (mut even, mut odd) = ([0.0; 8], [0.0; 8]);
                unit_pairs(seed, Purpose::Evaluation, first, pair, &mut even, &mut odd);
                for lane in 0..8 {
                    let mut stream = Stream::new(seed, Purpose::Evaluation, first.wrapping_add(lane as u64));
                    let units: Vec<f64> = (0..2 * pair + 2).map(|_| stream.next_unit()).collect();
                    assert_eq!(units[units.len() - 2..], [even[lane], odd[lane]]);
                }
            }
        }
    }
}
