//! Tails of the binomial law, and the chance of a hit that a tail belongs to.
//!
//! An interval for a share of 10⁻⁸ needs both with small *relative* errors, at a hundred million trials and more. The
//! logarithm of the gamma function, from which incomplete beta functions are usually computed, loses nine digits there,
//! and 1 − x as many. So the single probability is Loader's (2000), "Fast and accurate computation of binomial
//! probabilities", whose terms are small where their sum is; the tail is that times a sum without cancellation, or
//! times the continued fraction of the incomplete beta function (DiDonato and Morris 1992,
//! <https://doi.org/10.1145/131766.131776>) where that sum is long; and chances are solved for in whichever of p and 1
//! − p is small.

use std::f64::consts::TAU;

/// Halvings allowed when a tail is inverted. After some 60 the bracket is usually one rounding wide; more are needed
/// only where the solution is far below hits/n.
const HALVINGS: usize = 1100;

/// With so many hits, and misses, the continued fraction is faster than the sum, and no less accurate.
const MANY: f64 = 1e4;

/// Steps of the continued fraction: a few hundred where the tail is one of an interval, and where it does not end, next
/// to hits/n, the tail is known to be large.
const STEPS: usize = 10_000;

/// Up to here n! is a number without rounding.
const EXACT_FACTORIALS: f64 = 15.0;

/// The chance of a hit, and of a miss: each with a small relative error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chance {
    pub hit: f64,
    pub miss: f64,
}

/// The largest chance of a hit at which `hits` or more in `hits + misses` trials still have at most probability `tail`,
/// which is below one half.
///
/// The tail rises with the chance, from 0 at 0 to about one half at hits/n, so these bracket the solution. Bisection,
/// because it is bounded, and as accurate as the tail.
pub(super) fn largest_refuted(hits: u64, misses: u64, tail: f64) -> Chance {
    let (hits, misses) = (hits as f64, misses as f64);
    if hits == 0.0 {
        return Chance { hit: 0.0, miss: 1.0 };
    }
    if misses == 0.0 {
        let exponent = tail.ln() / hits;
        return Chance { hit: exponent.exp(), miss: -exponent.exp_m1() };
    }
    let is_refuted = |chance: Chance| upper_tail(hits, misses, chance) <= tail;
    let samples = hits + misses;
    if hits <= misses {
        let of_hit = |hit: f64| Chance { hit, miss: 1.0 - hit };
        of_hit(bisect(0.0, hits / samples, |hit| is_refuted(of_hit(hit))))
    } else {
        let of_miss = |miss: f64| Chance { hit: 1.0 - miss, miss };
        of_miss(bisect(1.0, misses / samples, |miss| is_refuted(of_miss(miss))))
    }
}

/// The last number from `inside` towards `outside` for which `holds`, which it does at `inside`.
fn bisect(mut inside: f64, mut outside: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (inside + outside);
        if middle == inside || middle == outside {
            break;
        }
        *if holds(middle) { &mut inside } else { &mut outside } = middle;
    }
    inside
}

/// The probability of `hits` or more in so many trials with this chance, which is neither tiny nor close to 1.
pub(super) fn probability_of_at_least(hits: u64, samples: u64, chance: f64) -> f64 {
    match samples.saturating_sub(hits) {
        _ if hits == 0 => 1.0,
        0 => chance.powf(hits as f64),
        misses => upper_tail(hits as f64, misses as f64, Chance { hit: chance, miss: 1.0 - chance }),
    }
}

/// P(X ≥ hits) of a binomial X; with a hit and a miss at least.
fn upper_tail(hits: f64, misses: f64, chance: Chance) -> f64 {
    let Chance { hit, miss } = chance;
    if hit <= 0.0 || miss <= 0.0 {
        return if hit <= 0.0 { 0.0 } else { 1.0 };
    }
    let single = probability(hits, misses, chance);
    if hits.min(misses) >= MANY {
        return single * miss * continued_fraction(hits, misses + 1.0, hit);
    }
    // P(X = h + k + 1) = P(X = h + k) · (m − k)/(h + k + 1) · p/q: positive terms that fall faster and faster.
    let odds = hit / miss;
    let (mut term, mut sum, mut k) = (1.0, 1.0, 0.0);
    while k < misses && term > sum * f64::EPSILON {
        term *= (misses - k) / (hits + k + 1.0) * odds;
        sum += term;
        k += 1.0;
    }
    (single * sum).min(1.0)
}

/// P(X = hits).
fn probability(hits: f64, misses: f64, chance: Chance) -> f64 {
    let Chance { hit, miss } = chance;
    let samples = hits + misses;
    // hits − n p, from the smaller of the two chances.
    let excess = if hit <= miss { hits - samples * hit } else { samples * miss - misses };
    let exponent = stirling_error(samples)
        - stirling_error(hits)
        - stirling_error(misses)
        - deviance(hits, samples * hit, excess)
        - deviance(misses, samples * miss, -excess);
    exponent.exp() * (samples / (TAU * hits * misses)).sqrt()
}

/// ln n! − ln(√(2πn) (n/e)ⁿ) of a whole number from 1.
fn stirling_error(n: f64) -> f64 {
    if n <= EXACT_FACTORIALS {
        let factorial: f64 = (1..=n as u64).map(|k| k as f64).product();
        return factorial.ln() - (n + 0.5) * n.ln() + n - 0.5 * TAU.ln();
    }
    let squared = n * n;
    (1.0 / 12.0
        - (1.0 / 360.0 - (1.0 / 1260.0 - (1.0 / 1680.0 - 1.0 / 1188.0 / squared) / squared) / squared) / squared)
        / n
}

/// x ln(x/m) + m − x for x > 0, where `excess` = x − m: without cancellation where x is close to m.
fn deviance(x: f64, mean: f64, excess: f64) -> f64 {
    let total = x + mean;
    if excess.abs() >= 0.1 * total {
        return x * (x / mean).ln() - excess;
    }
    // ln(x/m) = 2 artanh(v), as a series.
    let v = excess / total;
    let (mut sum, mut power) = (excess * v, 2.0 * x * v);
    for k in 1.. {
        power *= v * v;
        let next = sum + power / f64::from(2 * k + 1);
        if next == sum {
            break;
        }
        sum = next;
    }
    sum
}

/// The continued fraction of I_x(a, b) a B(a, b)/(xᵃ(1 − x)ᵇ), by the method of Lentz.
fn continued_fraction(a: f64, b: f64, x: f64) -> f64 {
    let nonzero = |value: f64| if value.abs() < f64::MIN_POSITIVE { f64::MIN_POSITIVE } else { value };
    let mut c = 1.0;
    let mut d = 1.0 / nonzero(1.0 - (a + b) * x / (a + 1.0));
    let mut fraction = d;
    for k in (1..=STEPS).map(|k| k as f64) {
        let even = k * (b - k) * x / ((a + 2.0 * k - 1.0) * (a + 2.0 * k));
        let odd = -(a + k) * (a + b + k) * x / ((a + 2.0 * k) * (a + 2.0 * k + 1.0));
        let mut factor = 1.0;
        for coefficient in [even, odd] {
            d = 1.0 / nonzero(1.0 + coefficient * d);
            c = nonzero(1.0 + coefficient / c);
            factor = c * d;
            fraction *= factor;
        }
        if (factor - 1.0).abs() <= f64::EPSILON {
            break;
        }
    }
    fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (hits, misses, chance of a hit or, where negative, of a miss, P(X ≥ hits)) by mpmath, 50 digits.
    const TAILS: [(f64, f64, f64, f64); 10] = [
        (1.0, 99999999.0, 2.5e-10, 0.024690087974715176),
        (2.0, 99999998.0, 2.4e-09, 0.024581452105296665),
        (99.0, 99999901.0, 8e-07, 0.022032591858425076),
        (100.0, 99999900.0, 1.2e-06, 0.972_136_331_554_558_5),
        (5.0, 295.0, 0.0054, 0.024436209358864346),
        (3.0, 9.0, 0.05, 0.019568261997154544),
        (99999997.0, 3.0, -1.1e-07, 0.004_915_865_635_731_767),
        (299.0, 1.0, -0.02, 0.016613152614592806),
        (40000000.0, 60000000.0, 0.3999, 0.020615330631107077),
        (20000.0, 980000.0, 0.0197, 0.015737509114882234),
    ];

    #[test]
    fn tails_have_small_relative_errors() {
        for (hits, misses, chance, expected) in TAILS {
            let chance = match chance {
                miss if miss < 0.0 => Chance { hit: 1.0 + miss, miss: -miss },
                hit => Chance { hit, miss: 1.0 - hit },
            };
            let found = upper_tail(hits, misses, chance);
            assert!((found - expected).abs() < 1e-11 * expected, "{hits} {misses} {chance:?}: {found:e}, {expected:e}");
        }
    }

    /// The sum and the continued fraction, where both are fast.
    #[test]
    fn both_ways_to_a_tail_agree() {
        let (hits, misses) = (MANY, 3.0 * MANY);
        let deviation = (hits * misses / (hits + misses).powi(3)).sqrt();
        for deviations in [0.7, 2.0, 5.0, 20.0] {
            let hit = hits / (hits + misses) - deviations * deviation;
            let chance = Chance { hit, miss: 1.0 - hit };
            let fraction = upper_tail(hits, misses, chance);
            let (mut term, mut sum) = (probability(hits, misses, chance), 0.0);
            for k in 0..misses as u64 {
                sum += term;
                term *= (misses - k as f64) / (hits + k as f64 + 1.0) * hit / (1.0 - hit);
            }
            assert!((fraction - sum).abs() < 1e-11 * sum, "{deviations}: {fraction:e} {sum:e}");
        }
    }

    #[test]
    fn single_probabilities_sum_to_one() {
        for (samples, hit) in [(7, 0.3), (40, 0.02), (300, 0.5)] {
            let chance = Chance { hit, miss: 1.0 - hit };
            let inner: f64 = (1..samples).map(|k| probability(f64::from(k), f64::from(samples - k), chance)).sum();
            let ends = hit.powi(samples) + (1.0 - hit).powi(samples);
            assert!((inner + ends - 1.0).abs() < 1e-13, "{samples} {hit}: {inner}");
        }
    }
}
