//! Proportions and what a finite number of samples says about them.

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::beta::checked_beta_reg;

/// Halvings allowed when a tail probability is inverted. After some 60 the bracket is usually one rounding wide; more
/// are needed only where the solution is far below hits/n.
const HALVINGS: usize = 200;

/// An interval that holds the true value with probability `level`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Interval {
    /// Lower end.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
    /// Confidence level, in (0, 1).
    pub level: f64,
}

/// `hits` out of `samples` independent trials.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Proportion {
    /// Number of trials that hit.
    pub hits: u64,
    /// Number of trials, at least one.
    pub samples: u64,
}

impl Proportion {
    /// hits/samples.
    pub fn value(self) -> f64 {
        self.hits as f64 / self.samples as f64
    }

    /// Wilson's score interval (Wilson 1927, <https://doi.org/10.1080/01621459.1927.10502953>):
    /// (p + z²/2n ± z√(p(1 − p)/n + z²/4n²))/(1 + z²/n) with the normal quantile z. It holds its level also near 0
    /// and 1, where p ± z√(p(1 − p)/n) does not.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::statistics::Proportion;
    /// let interval = Proportion { hits: 0, samples: 100 }.wilson(0.95);
    /// assert_eq!(interval.lower, 0.0);
    /// assert!((interval.upper - 0.036993).abs() < 1e-5);
    /// ```
    pub fn wilson(self, level: f64) -> Interval {
        let z = Normal::standard().inverse_cdf(0.5 + 0.5 * level);
        let (n, p) = (self.samples as f64, self.value());
        let scale = 1.0 + z * z / n;
        let centre = (p + z * z / (2.0 * n)) / scale;
        let half_width = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt() / scale;
        let lower = if self.hits == 0 { 0.0 } else { centre - half_width };
        let upper = if self.hits == self.samples { 1.0 } else { centre + half_width };
        Interval { lower, upper, level }
    }

    /// The exact interval of Clopper and Pearson (1934), <https://doi.org/10.1093/biomet/26.4.404>: with
    /// α = 1 − `level`, the lower end solves P(X ≥ hits) = α/2 and the upper end P(X ≤ hits) = α/2 for binomial X.
    ///
    /// It covers the true probability at least at its level for every sample size and every probability, and pays with
    /// width: [`Self::wilson`] is narrower, but holds its level only on average.
    ///
    /// The tails are regularised incomplete beta functions, P(X ≥ h) = I_p(h, n − h + 1), inverted by bisection. For
    /// levels from 0.9 the ends are within 1e-7 standard deviations of the exact ones up to ten million samples, and
    /// within 1e-5 up to a billion. Without hits the lower end is 0, without misses the upper end is 1, and without
    /// samples the interval is \[0, 1\].
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::statistics::Proportion;
    /// let interval = Proportion { hits: 0, samples: 100 }.clopper_pearson(0.95);
    /// assert_eq!(interval.lower, 0.0);
    /// assert!((interval.upper - (1.0 - 0.025f64.powf(0.01))).abs() < 1e-12);
    /// ```
    pub fn clopper_pearson(self, level: f64) -> Interval {
        let tail = 0.5 * (1.0 - level);
        let misses = self.samples.saturating_sub(self.hits);
        let lower = largest_refuted(self.hits, misses, tail);
        let upper = 1.0 - largest_refuted(misses, self.hits, tail);
        Interval { lower, upper, level }
    }
}

/// The largest probability of a hit at which `hits` or more in `hits + misses` trials still have at most probability
/// `tail`; 0 without hits.
///
/// The tail probability rises with the probability of a hit, from 0 at 0 to about one half at hits/n, so the solution
/// is bracketed by the two. Bisection rather than a quantile function, because it is bounded and needs the incomplete
/// beta function only as a comparison: its continued fraction converges where the tail is small, and where it does not,
/// next to hits/n, the tail is known to be large.
fn largest_refuted(hits: u64, misses: u64, tail: f64) -> f64 {
    if hits == 0 {
        return 0.0;
    }
    let (hits, misses) = (hits as f64, misses as f64);
    let (mut lower, mut upper) = (0.0, hits / (hits + misses));
    for _ in 0..HALVINGS {
        let middle = 0.5 * (lower + upper);
        if middle <= lower || middle >= upper {
            break;
        }
        let is_refuted = checked_beta_reg(hits, misses + 1.0, middle).is_ok_and(|probability| probability <= tail);
        if is_refuted {
            lower = middle;
        } else {
            upper = middle;
        }
    }
    lower
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lower ends at α/2 = 0.025 of (hits, samples), from the tail summed with 50 digits and solved by the secant
    /// method.
    const LOWER_ENDS: [(u64, u64, f64); 6] = [
        (1, 10_000_000, 2.531_780_795_224_030_5e-9),
        (20_000, 1_000_000, 0.019_726_495_903_615_73),
        (300_000, 1_000_000, 0.299_101_911_933_582_15),
        (999_999, 1_000_000, 0.999_994_428_369_344_8),
        (4_000_000, 10_000_000, 0.399_696_342_670_472_65),
        (9_990_000, 10_000_000, 0.998_980_214_933_488_9),
    ];

    /// P(X ≥ hits) by summation of the binomial probabilities, each the one before times a ratio.
    fn upper_tail(hits: u64, samples: u64, probability: f64) -> f64 {
        let odds = probability / (1.0 - probability);
        let mut term = (1.0 - probability).powf(samples as f64);
        let mut sum = 0.0;
        for count in 0..=samples {
            if count >= hits {
                sum += term;
            }
            term *= (samples - count) as f64 / (count + 1) as f64 * odds;
        }
        sum
    }

    /// Newcombe (1998), table I, method 5,
    /// <https://doi.org/10.1002/(SICI)1097-0258(19980430)17:8%3C857::AID-SIM777%3E3.0.CO;2-E>: four decimals.
    #[test]
    fn clopper_pearson_equals_published_values() {
        for (hits, samples, lower, upper) in
            [(81, 263, 0.2527, 0.3676), (15, 148, 0.0578, 0.1617), (1, 29, 0.0009, 0.1776), (0, 20, 0.0, 0.1684)]
        {
            let interval = Proportion { hits, samples }.clopper_pearson(0.95);
            assert!((interval.lower - lower).abs() < 5e-5, "{interval:?}");
            assert!((interval.upper - upper).abs() < 5e-5, "{interval:?}");
        }
    }

    #[test]
    fn tails_at_the_ends_are_half_the_error() {
        for level in [0.5, 0.9, 0.95, 0.99, 0.9999] {
            let tail = 0.5 * (1.0 - level);
            for samples in [1, 2, 7, 30, 100] {
                for hits in 0..=samples {
                    let interval = Proportion { hits, samples }.clopper_pearson(level);
                    if hits > 0 {
                        let found = upper_tail(hits, samples, interval.lower);
                        assert!((found - tail).abs() < 1e-9 * tail, "{hits} of {samples}: {found} is not {tail}");
                    }
                    if hits < samples {
                        let found = upper_tail(samples - hits, samples, 1.0 - interval.upper);
                        assert!((found - tail).abs() < 1e-9 * tail, "{hits} of {samples}: {found} is not {tail}");
                    }
                }
            }
        }
    }

    #[test]
    fn without_hits_or_without_misses_the_interval_has_a_closed_form() {
        for samples in [1, 10, 1000, 1_000_000, 10_000_000] {
            let smallest = 1.0 - 0.025f64.powf(1.0 / samples as f64);
            let none = Proportion { hits: 0, samples }.clopper_pearson(0.95);
            let all = Proportion { hits: samples, samples }.clopper_pearson(0.95);
            assert_eq!((none.lower, all.upper), (0.0, 1.0));
            assert!((none.upper - smallest).abs() < 1e-6 * smallest, "{none:?} with {samples} samples");
            assert!((all.lower - (1.0 - smallest)).abs() < 1e-6 * smallest, "{all:?} with {samples} samples");
        }
    }

    #[test]
    fn ends_are_accurate_for_millions_of_samples() {
        for (hits, samples, lower) in LOWER_ENDS {
            let interval = Proportion { hits, samples }.clopper_pearson(0.95);
            let mirrored = Proportion { hits: samples - hits, samples }.clopper_pearson(0.95);
            let share = hits as f64 / samples as f64;
            let deviation = (share * (1.0 - share) / samples as f64).sqrt();
            assert!((interval.lower - lower).abs() < 1e-7 * deviation, "{hits} of {samples}: {interval:?}");
            assert!((mirrored.upper - (1.0 - lower)).abs() < 1e-7 * deviation, "{hits} of {samples}: {mirrored:?}");
        }
    }

    #[test]
    fn exact_interval_contains_the_proportion_and_the_interval_of_a_lower_level() {
        for (hits, samples) in [(1, 10), (5, 10), (399, 1000), (999_999, 1_000_000), (1, 10_000_000)] {
            let proportion = Proportion { hits, samples };
            let mut inner = Interval { lower: proportion.value(), upper: proportion.value(), level: 0.0 };
            for level in [0.5, 0.9, 0.99, 0.999_999] {
                let outer = proportion.clopper_pearson(level);
                assert!(outer.lower < inner.lower && inner.upper < outer.upper, "{outer:?}, {inner:?}");
                inner = outer;
            }
        }
    }

    #[test]
    fn nothing_is_known_without_samples() {
        let interval = Proportion { hits: 0, samples: 0 }.clopper_pearson(0.95);
        assert_eq!((interval.lower, interval.upper), (0.0, 1.0));
    }

    /// Newcombe (1998), table I, method 3,
    /// <https://doi.org/10.1002/(SICI)1097-0258(19980430)17:8%3C857::AID-SIM777%3E3.0.CO;2-E>: four decimals.
    #[test]
    fn wilson_equals_published_values() {
        for (hits, samples, lower, upper) in
            [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (1, 29, 0.0061, 0.1718), (0, 20, 0.0, 0.1611)]
        {
            let interval = Proportion { hits, samples }.wilson(0.95);
            assert!((interval.lower - lower).abs() < 5e-5, "{interval:?}");
            assert!((interval.upper - upper).abs() < 5e-5, "{interval:?}");
        }
    }

    #[test]
    fn interval_covers_at_about_its_level() {
        use crate::probability::random::{Purpose, Stream};
        let (repeats, samples, truth) = (2000, 200, 0.03);
        let covered = (0..repeats)
            .filter(|&repeat| {
                let mut stream = Stream::new(3, Purpose::Evaluation, repeat);
                let hits = (0..samples).filter(|_| stream.next_unit() < truth).count() as u64;
                let interval = Proportion { hits, samples }.wilson(0.95);
                interval.lower <= truth && truth <= interval.upper
            })
            .count();
        // Exact coverage at this p and n is 0.9436; four standard errors of 2000 repeats are 0.021.
        assert!((0.922..=0.965).contains(&(covered as f64 / repeats as f64)), "{covered} of {repeats}");
    }
}
