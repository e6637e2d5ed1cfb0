//! Philox 4×32-10, the counter-based generator of Salmon, Moraes, Dror and Shaw (2011),
//! <https://doi.org/10.1145/2063384.2063405>.
//!
//! Four words come from a 128-bit counter and a 64-bit key by ten rounds of multiplication and exclusive or. Nothing is
//! carried from one call to the next, so any draw can be computed on its own, by any thread, in any order. The 32-bit
//! variant is chosen because its products exist as vector instructions on every processor of interest.

const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
/// Golden ratio and √3 − 1: what the key grows by from round to round.
const KEY_STEPS: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
const ROUNDS: usize = 10;
const LOWER_HALF: u64 = 0xFFFF_FFFF;

/// The four words at `counter` under `key`.
///
/// # Examples
///
/// ```
/// let words = pcc_evaluate::probability::random::philox_4x32_10([0; 4], [0; 2]);
/// assert_eq!(words, [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
/// ```
#[inline]
pub fn philox_4x32_10(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    ten_rounds(counter.map(u64::from), key).map(|word| word as u32)
}

/// The same on words that are the lower halves of numbers of 64 bits, whatever the upper halves hold: vector
/// instructions multiply lower halves to numbers of 64 bits, and nothing has to be cut off in between.
#[inline(always)]
pub(super) fn ten_rounds(mut counter: [u64; 4], mut key: [u32; 2]) -> [u64; 4] {
    for round in 0..ROUNDS {
        if round > 0 {
            key = [key[0].wrapping_add(KEY_STEPS[0]), key[1].wrapping_add(KEY_STEPS[1])];
        }
        let product = [
            u64::from(MULTIPLIERS[0]) * (counter[0] & LOWER_HALF),
            u64::from(MULTIPLIERS[1]) * (counter[2] & LOWER_HALF),
        ];
        counter = [
            (product[1] >> 32) ^ counter[1] ^ u64::from(key[0]),
            product[1],
            (product[0] >> 32) ^ counter[3] ^ u64::from(key[1]),
            product[0],
        ];
    }
    counter
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The three known answers published with the Random123 library (file `kat_vectors`).
    #[test]
    fn published_known_answers() {
        let ones = u32::MAX;
        assert_eq!(philox_4x32_10([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(philox_4x32_10([ones; 4], [ones; 2]), [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]);
        assert_eq!(
            philox_4x32_10([0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344], [0xa409_3822, 0x299f_31d0]),
            [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]
        );
    }
}
