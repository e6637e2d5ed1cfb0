//! The standard normal law: Φ and its inverse.
//!
//! Wichura's algorithm AS 241 (1988, <https://doi.org/10.2307/2347330>), PPND16, to about a part in 10¹⁶: a rational
//! function in the middle, two in the tails, chosen without branches, so that it runs in vector lanes. Logarithms are
//! computed here from fused operations, so that it gives the same bits on every machine.

use std::f64::consts::LN_2;

/// Up to here |p − ½| belongs to the middle.
const MIDDLE: f64 = 0.425;

/// √(−ln p) up to which the first of the tails' functions holds.
const FAR: f64 = 5.0;

/// Numerators and denominators, constant term first.
#[allow(clippy::excessive_precision, reason = "as published")]
const CENTRAL: [[f64; 8]; 2] = [
    [
        3.3871328727963666080,
        1.3314166789178437745e2,
        1.9715909503065514427e3,
        1.3731693765509461125e4,
        4.5921953931549871457e4,
        6.7265770927008700853e4,
        3.3430575583588128105e4,
        2.5090809287301226727e3,
    ],
    [
        1.0,
        4.2313330701600911252e1,
        6.8718700749205790830e2,
        5.3941960214247511077e3,
        2.1213794301586595867e4,
        3.9307895800092710610e4,
        2.8729085735721942674e4,
        5.2264952788528545610e3,
    ],
];
#[allow(clippy::excessive_precision, reason = "as published")]
const NEAR_TAIL: [[f64; 8]; 2] = [
    [
        1.42343711074968357734,
        4.63033784615654529590,
        5.76949722146069140550,
        3.64784832476320460504,
        1.27045825245236838258,
        2.41780725177450611770e-1,
        2.27238449892691845833e-2,
        7.74545014278341407640e-4,
    ],
    [
        1.0,
        2.05319162663775882187,
        1.67638483018380384940,
        6.89767334985100004550e-1,
        1.48103976427480074590e-1,
        1.51986665636164571966e-2,
        5.47593808499534494600e-4,
        1.05075007164441684324e-9,
    ],
];
#[allow(clippy::excessive_precision, reason = "as published")]
const FAR_TAIL: [[f64; 8]; 2] = [
    [
        6.65790464350110377720,
        5.46378491116411436990,
        1.78482653991729133580,
        2.96560571828504891230e-1,
        2.65321895265761230930e-2,
        1.24266094738807843860e-3,
        2.71155556874348757815e-5,
        2.01033439929228813265e-7,
    ],
    [
        1.0,
        5.99832206555887937690e-1,
        1.36929880922735805310e-1,
        1.48753612908506148525e-2,
        7.86869131145613259100e-4,
        1.84631831751005468180e-5,
        1.42151175831644588870e-7,
        2.04426310338993978564e-15,
    ],
];

/// Φ(ξ), the probability that a standard normal variable is below ξ, to about a part in 10¹⁵ of it also where it is
/// small.
pub(super) fn distribution(xi: f64) -> f64 {
    /// From here on the continued fraction converges to the last digit within so many terms.
    const TAIL: f64 = 1.5;
    const TERMS: u32 = 200;
    let x = xi.abs();
    if x >= TAIL {
        // Laplace: 1 − Φ(x) = φ(x)/(x + 1/(x + 2/(x + 3/(x + …)))).
        let fraction = (1..=TERMS).rev().fold(x, |rest, k| x + f64::from(k) / rest);
        let tail = density(x) / fraction;
        return if xi < 0.0 { tail } else { 1.0 - tail };
    }
    // Φ(ξ) = ½ + φ(ξ) (ξ + ξ³/3 + ξ⁵/(3·5) + …).
    let (mut sum, mut term) = (0.0, xi);
    for k in 1..=25 {
        sum += term;
        term *= xi * xi / f64::from(2 * k + 1);
    }
    density(xi).mul_add(sum, 0.5)
}

/// φ(ξ), the density.
pub(super) fn density(xi: f64) -> f64 {
    const SCALE: f64 = 0.398_942_280_401_432_7;
    SCALE * (-0.5 * xi * xi).exp()
}

/// The value whose probability to be undercut is p.
pub(super) fn quantile(p: f64) -> f64 {
    if p <= 0.5 { -upper_quantile(p) } else { upper_quantile(1.0 - p) }
}

/// The value whose probability to be exceeded is p ≤ ½.
pub(super) fn upper_quantile(p: f64) -> f64 {
    at_centred(1.0 - 2.0 * p, p)
}

/// ξ at 2Φ(ξ) − 1 = `centred`.
#[inline(always)]
pub(crate) fn normal_at(centred: f64) -> f64 {
    at_centred(centred, tail_of(centred))
}

/// The same in all lanes and bits, step by step, so that every step is a loop of vector operations.
#[inline(always)]
pub(crate) fn normal_at_lanes<const LANES: usize>(numbers: &mut [f64; LANES]) {
    let mut depths = [0.0; LANES];
    for lane in 0..LANES {
        depths[lane] = depth(tail_of(numbers[lane]));
    }
    let mut tails = [Fraction::default(); LANES];
    for lane in 0..LANES {
        tails[lane] = near(depths[lane]);
    }
    // One number in 10¹¹ is that far out.
    if depths.iter().fold(0.0, |deepest, &depth| f64::max(deepest, depth)) > FAR {
        for lane in 0..LANES {
            tails[lane] = tail(depths[lane]);
        }
    }
    for lane in 0..LANES {
        numbers[lane] = score(0.5 * numbers[lane], tails[lane]);
    }
}

/// ξ, given the probability of the tail on its side as well.
#[inline(always)]
pub(super) fn at_centred(centred: f64, p: f64) -> f64 {
    score(0.5 * centred, tail(depth(p)))
}

/// The probability of the tail. Exact: `centred` is above −1 and below 1.
#[inline(always)]
fn tail_of(centred: f64) -> f64 {
    0.5 * (1.0 - centred.abs())
}

/// r = √(−ln p).
#[inline(always)]
fn depth(p: f64) -> f64 {
    (-logarithm(p)).max(0.0).sqrt()
}

/// Numerator and denominator.
#[derive(Clone, Copy, Default)]
struct Fraction([f64; 2]);

impl Fraction {
    #[inline(always)]
    fn at(coefficients: &[[f64; 8]; 2], x: f64) -> Self {
        let polynomial = |c: &[f64; 8]| {
            let mut value = c[7];
            for k in (0..7).rev() {
                value = value.mul_add(x, c[k]);
            }
            value
        };
        Self([polynomial(&coefficients[0]), polynomial(&coefficients[1])])
    }
}

/// |ξ| in a tail of depth r.
#[inline(always)]
fn tail(r: f64) -> Fraction {
    if r <= FAR { near(r) } else { Fraction::at(&FAR_TAIL, r - FAR) }
}

#[inline(always)]
fn near(r: f64) -> Fraction {
    Fraction::at(&NEAR_TAIL, r - 1.6)
}

/// ξ at p = ½ + q, given |ξ| as if it were in the tail.
#[inline(always)]
fn score(q: f64, Fraction(tail): Fraction) -> f64 {
    let Fraction(middle) = Fraction::at(&CENTRAL, (-q).mul_add(q, MIDDLE * MIDDLE).max(0.0));
    let is_middle = q.abs() <= MIDDLE;
    let side = if q < 0.0 { -1.0 } else { 1.0 };
    let numerator = if is_middle { middle[0] } else { tail[0] };
    let denominator = if is_middle { middle[1] } else { tail[1] };
    let factor = if is_middle { q } else { side };
    factor * (numerator / denominator)
}

/// ln x of a positive normal number, to a part in 10¹⁵ of it or of 1: x = 2ᵉ m with m near 1, and
/// ln m = 2 artanh s with s = (m − 1)/(m + 1).
#[inline(always)]
fn logarithm(x: f64) -> f64 {
    /// Bits of √½: mantissas from here on count to the next power of two.
    const ROOT: u64 = 0x3FE6_A09E_667F_3BCD;
    const ONE: u64 = 0x3FF0_0000_0000_0000;
    const MANTISSA: u64 = 0x000F_FFFF_FFFF_FFFF;
    /// 2⁵²: adding it turns a small integer into the last bits of a double.
    const SHIFT: f64 = 4_503_599_627_370_496.0;
    /// 1/3, 1/5, …: the Taylor series of artanh.
    const TERMS: usize = 10;
    const INVERSE_ODD: [f64; TERMS] = {
        let mut terms = [0.0; TERMS];
        let mut k = 0;
        while k < TERMS {
            terms[k] = 1.0 / (2 * k + 3) as f64;
            k += 1;
        }
        terms
    };
    let bits = x.to_bits().wrapping_add(ONE - ROOT);
    // The exponent, 1023 above what it means, as a double without a conversion.
    let exponent = f64::from_bits((bits >> 52) | SHIFT.to_bits()) - SHIFT - 1023.0;
    let m = f64::from_bits((bits & MANTISSA).wrapping_add(ROOT));
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let mut series = INVERSE_ODD[TERMS - 1];
    for k in (0..TERMS - 1).rev() {
        series = series.mul_add(z, INVERSE_ODD[k]);
    }
    let artanh = (s * z).mul_add(series, s);
    exponent.mul_add(LN_2, 2.0 * artanh)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From mpmath with 40 digits: p, Φ⁻¹(p).
    const KNOWN: [(f64, f64); 9] = [
        (1e-15, -7.941345326170997),
        (1e-12, -7.034483825301132),
        (1e-9, -5.9978070150076865),
        (1e-5, -4.264890793922825),
        (1e-3, -3.0902323061678136),
        (0.02, -2.053748910631823),
        (0.074, -1.4466320671589785),
        (0.1, -1.2815515655446004),
        (0.4, -0.2533471031357997),
    ];

    #[test]
    fn quantiles_are_those_of_forty_digits_on_both_sides() {
        for (p, expected) in KNOWN {
            assert!((quantile(p) - expected).abs() <= 4e-16 * expected.abs() + 2e-16, "{p:e}: {}", quantile(p));
            assert_eq!(upper_quantile(p), -quantile(p), "{p:e}");
        }
        assert_eq!(normal_at(0.0), 0.0);
    }

    #[test]
    fn lanes_have_the_bits_of_single_numbers() {
        let numbers: [f64; 64] = std::array::from_fn(|k| match k {
            0 => -1.0 + f64::EPSILON,
            1 => 1.0 - f64::EPSILON / 2.0,
            2 => 0.0,
            _ => (k as f64 * 0.731).sin(),
        });
        for outermost in [1.0, 0.999, 0.8] {
            let mut lanes = numbers.map(|number| number * outermost);
            let expected = lanes.map(|number| normal_at(number).to_bits());
            normal_at_lanes(&mut lanes);
            assert_eq!(lanes.map(f64::to_bits), expected);
        }
    }

    #[test]
    fn the_distribution_undoes_the_quantile() {
        for k in 1..10_000 {
            let p = f64::from(k) / 20_000.0;
            let back = distribution(quantile(p));
            assert!((back - p).abs() <= 1e-14 * p, "{p}: {back}");
        }
        // The smallest and the largest coordinates that random numbers have.
        let least = -1.0 + f64::EPSILON / 2.0;
        assert!((normal_at(least) + 8.292).abs() < 0.01 && normal_at(-least) == -normal_at(least));
    }

    #[test]
    fn logarithms_are_those_of_the_library() {
        for k in 0..2000 {
            let x = 1.0123_f64.powi(-k);
            assert!((logarithm(x) - x.ln()).abs() <= 4.0 * f64::EPSILON * x.ln().abs().max(1.0), "{x}");
        }
    }
}
