//! The tails of the standard normal law in vector lanes: the way back of the [quantile](super::normal_quantile).
//!
//! Beyond x ≥ 0 lies Q(x) = e^(−x²/2) P(t)/(1 + x) with t = (x − 5)/(x + 5) ∈ [−1, 1). P is a smooth function there
//! (after Shepherd and Laframboise 1981, <https://doi.org/10.1090/S0025-5718-1981-0595058-X>): here the truncated
//! Chebyshev series of degree 23, found with 40 digits and written by powers of t. Exponentials are computed here from
//! fused operations, so that the tails have the same bits on every machine.

use std::f64::consts::LOG2_E;

/// P, constant term first; exact to 3·10⁻¹⁶ of it, and P(−1) = ½ without error.
const SERIES: [f64; 24] = [
    0.46151582985003775,
    -0.09155228183400904,
    0.031030368425963708,
    0.010002352385229379,
    -0.026401042966308286,
    0.02453696324367877,
    -0.015170415402515222,
    0.006522000667782375,
    -0.0016760723445513966,
    7.791597420165029e-06,
    0.00018233414510112735,
    -5.3607581161758396e-05,
    -9.896097711915448e-06,
    9.059824811203437e-06,
    -7.034654060052775e-08,
    -1.307448837261277e-06,
    1.2787834068830818e-07,
    1.9627837629892933e-07,
    -2.628629839624773e-08,
    -3.0952221905347975e-08,
    3.6274144487059377e-09,
    4.4012453252114415e-09,
    -2.822155932680626e-10,
    -3.815972214793274e-10,
];

/// x at t = 0.
const MIDDLE: f64 = 5.0;

/// Farther out tails are no normal numbers any more.
const FARTHEST: f64 = 37.5;

/// The probabilities that a standard normal variable is below `score`, and that it is above: the smaller one to some
/// parts in 10¹⁵ of it.
#[inline(always)]
pub(super) fn tails(score: f64) -> [f64; 2] {
    let tail = tail(score.abs().min(FARTHEST));
    let rest = 1.0 - tail;
    if score < 0.0 { [tail, rest] } else { [rest, tail] }
}

/// Q(x) for 0 ≤ x ≤ [`FARTHEST`].
#[inline(always)]
fn tail(x: f64) -> f64 {
    let t = (x - MIDDLE) / (x + MIDDLE);
    let mut series = SERIES[23];
    for k in (0..23).rev() {
        series = series.mul_add(t, SERIES[k]);
    }
    // What x² loses by rounding counts where it is large.
    let square = x * x;
    let lost = x.mul_add(x, -square);
    let power = exponential(-0.5 * square);
    power * (-0.5f64).mul_add(lost, 1.0) * series / (1.0 + x)
}

/// eʸ for −708 ≤ y ≤ 0, to a part in 10¹⁶ or two: y = n ln 2 + r, and 2ⁿ times a polynomial of r.
#[inline(always)]
fn exponential(y: f64) -> f64 {
    /// ln 2 in two parts, the first with so few digits that n times it is exact.
    const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];
    /// 1.5 · 2⁵²: adding it rounds to an integer, which the last bits then hold.
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    /// 1/k! from k = 13 down to 0.
    const INVERSE_FACTORIALS: [f64; 14] = [
        1.0 / 6_227_020_800.0,
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ];
    let shifted = y.mul_add(LOG2_E, SHIFT);
    let n = shifted - SHIFT;
    let r = (-n).mul_add(LN_2[1], (-n).mul_add(LN_2[0], y));
    let mut power = INVERSE_FACTORIALS[0];
    for factor in &INVERSE_FACTORIALS[1..] {
        power = power.mul_add(r, *factor);
    }
    power * f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52)
}

#[cfg(test)]
mod tests {
    use super::super::normal_quantile::{distribution, normal_at};
    use super::*;

    /// From mpmath with 40 digits: x, Q(x).
    const KNOWN: [(f64, f64); 9] = [
        (0.1, 0.460172162722971),
        (0.5, 0.3085375387259869),
        (1.0, 0.15865525393145705),
        (2.3, 0.01072411002167581),
        (4.0, 3.1671241833119924e-5),
        (6.25, 2.0522634252189388e-10),
        (8.3, 5.205569744890254e-17),
        (15.0, 3.670966199312751e-51),
        (37.0, 5.725571222524577e-300),
    ];

    #[test]
    fn tails_are_those_of_forty_digits_on_both_sides() {
        for (x, expected) in KNOWN {
            let [below, above] = tails(-x);
            assert!((below - expected).abs() <= 2e-15 * expected, "{x}: {below:e}");
            assert_eq!(tails(x), [above, below]);
            assert!((above - (1.0 - expected)).abs() <= 2e-16);
        }
        assert_eq!(tails(0.0), [0.5; 2]);
        assert_eq!(tails(1e9), tails(FARTHEST));
    }

    #[test]
    fn tails_are_those_of_the_scalar_distribution_and_undo_the_quantile() {
        for k in -1600..=1600 {
            let x = f64::from(k) / 200.0;
            let (found, known) = (tails(x), [distribution(x), distribution(-x)]);
            for (found, known) in found.into_iter().zip(known) {
                assert!((found - known).abs() <= 1e-14 * known, "{x}: {found:e} {known:e}");
            }
        }
        for k in -999..1000 {
            let centred = f64::from(k) / 1000.0;
            let [below, above] = tails(normal_at(centred));
            assert!((below - above - centred).abs() < 1e-15, "{centred}");
        }
    }

    #[test]
    fn exponentials_are_those_of_the_library() {
        for k in 0..7000 {
            let y = -0.101 * f64::from(k);
            assert!((exponential(y) / y.exp() - 1.0).abs() < 5e-16, "{y}");
        }
        assert_eq!(exponential(0.0), 1.0);
    }
}
