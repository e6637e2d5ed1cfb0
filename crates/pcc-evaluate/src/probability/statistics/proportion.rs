//! Proportions and what a finite number of samples says about them.

use super::binomial_tail::largest_refuted;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal};

/// With fewer hits, or misses, than this the exact interval is taken: Wilson's covers 84 to 92 % instead of 95 % below
/// five expected hits, and is good to a tenth of a percent from some fifty.
const FEW: u64 = 100;

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

    /// What a finite number of independent trials leaves open, as all reports say it: [`Self::clopper_pearson`] where
    /// fewer than 100 trials are on the rarer side, and [`Self::wilson`] above.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::statistics::Proportion;
    /// let none = Proportion { hits: 0, samples: 100_000_000 };
    /// assert!((none.interval(0.95).upper - 3.688_879e-8).abs() < 1e-14);
    /// let half = Proportion { hits: 500, samples: 1000 };
    /// assert_eq!(half.interval(0.95), half.wilson(0.95));
    /// ```
    pub fn interval(self, level: f64) -> Interval {
        match self.hits.min(self.misses()) < FEW {
            true => self.clopper_pearson(level),
            false => self.wilson(level),
        }
    }

    fn misses(self) -> u64 {
        self.samples.saturating_sub(self.hits)
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
    /// The ends have relative errors below 1e-11, that of a share of 10⁻⁸ as well. Without hits the lower end is 0,
    /// without misses the upper end is 1, and without samples the interval is \[0, 1\].
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
        Interval { lower: self.lower_bound(tail), upper: self.upper_bound(tail), level }
    }

    /// The lower end of Clopper and Pearson alone: the true probability is below it with probability `error`, which is
    /// less than one half, at most.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::statistics::Proportion;
    /// // 50 of 50: 0.05^(1/50).
    /// let all = Proportion { hits: 50, samples: 50 };
    /// assert!((all.lower_bound(0.05) - 0.941845).abs() < 1e-6);
    /// ```
    pub fn lower_bound(self, error: f64) -> f64 {
        largest_refuted(self.hits, self.misses(), error).hit
    }

    /// The upper end alone: the true probability is above it with probability `error` at most.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::statistics::Proportion;
    /// // None of 300: 1 − 0.05^(1/300).
    /// let none = Proportion { hits: 0, samples: 300 };
    /// assert!((none.upper_bound(0.05) - 0.009936).abs() < 1e-6);
    /// ```
    pub fn upper_bound(self, error: f64) -> f64 {
        largest_refuted(self.misses(), self.hits, error).miss
    }
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

    /// (hits, samples, level, lower end, upper end) by mpmath, 50 digits. SciPy's `beta.ppf` has the lower ends to
    /// 1e-15, and the upper ones to 1e-9 at 10⁸ samples.
    const ENDS: [(u64, u64, f64, f64, f64); 16] = [
        (0, 100_000_000, 0.95, 0.0, 3.688_879_386_074_779e-8),
        (1, 100_000_000, 0.95, 2.531_780_798_108_492e-10, 5.571_643_263_581_067e-8),
        (2, 100_000_000, 0.95, 2.422_092_794_616_846_3e-9, 7.224_687_478_990_28e-8),
        (10, 100_000_000, 0.95, 4.795_388_796_946_165_3e-8, 1.839_035_527_050_960_8e-7),
        (99, 100_000_000, 0.95, 8.046_232_190_981_131e-7, 1.205_289_347_788_461_9e-6),
        (5, 300, 0.95, 0.005_433_205_315_105_25, 0.038_463_744_964_996_43),
        (3, 10_000, 0.95, 6.187_148_574_838_714e-5, 0.000_876_474_522_514_001),
        (1_000_000, 100_000_000, 0.95, 0.009_980_507_788_672_496, 0.010_019_520_585_175_583),
        (1, 1_000_000_000, 0.95, 2.531_780_798_396_938e-11, 5.571_643_378_203_115e-9),
        (0, 100_000_000, 0.999, 0.0, 7.600_902_170_673_499e-8),
        (1, 100_000_000, 0.999, 5.001_250_416_810_473e-12, 9.998_677_047_749_445e-8),
        (2, 100_000_000, 0.999, 3.196_102_241_065_643e-10, 1.205_139_889_182_460_8e-7),
        (99, 100_000_000, 0.999, 6.949_494_265_638_75e-7, 1.362_112_786_772_120_5e-6),
        (5, 300, 0.999, 0.002_120_228_709_034_225, 0.056_846_766_350_242_76),
        (1_000_000, 100_000_000, 0.999, 0.009_967_291_673_537_225, 0.010_032_782_349_420_78),
        (1, 1_000_000_000, 0.999, 5.001_250_416_821_729e-13, 9.998_677_452_636_367e-9),
    ];

    #[test]
    fn ends_near_zero_have_small_relative_errors() {
        for (hits, samples, level, lower, upper) in ENDS {
            let found = Proportion { hits, samples }.clopper_pearson(level);
            assert!((found.lower - lower).abs() <= 1e-11 * lower, "{hits} of {samples} at {level}: {found:?}");
            assert!((found.upper - upper).abs() <= 1e-11 * upper, "{hits} of {samples} at {level}: {found:?}");
        }
    }

    /// Coverage by summation of binomial probabilities, at expected hits from 0.01 to 60, from which the hundred hits
    /// where Wilson's interval begins are beyond five standard deviations.
    #[test]
    fn intervals_of_few_hits_cover_at_least_at_their_level() {
        for samples in [300u64, 10_000, 1_000_000] {
            let ends: Vec<[Interval; 2]> = (0..140)
                .map(|hits| [hits, samples - hits].map(|hits| Proportion { hits, samples }.interval(0.95)))
                .collect();
            for step in 0..400 {
                let expected = 0.01 * 6000f64.powf(f64::from(step) / 399.0);
                for truth in [expected / samples as f64, 1.0 - expected / samples as f64] {
                    let rare = truth.min(1.0 - truth);
                    let (mut single, mut covered) = ((samples as f64 * (-rare).ln_1p()).exp(), 0.0);
                    for (hits, [interval, mirrored]) in ends.iter().enumerate() {
                        let interval = if truth < 0.5 { interval } else { mirrored };
                        if interval.lower <= truth && truth <= interval.upper {
                            covered += single;
                        }
                        single *= (samples - hits as u64) as f64 / (hits as f64 + 1.0) * rare / (1.0 - rare);
                    }
                    assert!(covered >= 0.95 - 1e-9, "{expected} expected of {samples}, {truth}: {covered}");
                }
            }
        }
    }

    #[test]
    fn exact_and_score_intervals_meet_at_a_hundred_hits() {
        for samples in [1000, 1_000_000] {
            let [below, above] = [99, 100].map(|hits| Proportion { hits, samples }.interval(0.95));
            assert_eq!(below, Proportion { hits: 99, samples }.clopper_pearson(0.95));
            assert_eq!(above, Proportion { hits: 100, samples }.wilson(0.95));
            let mirrored = Proportion { hits: samples - 99, samples }.interval(0.95);
            assert!((1.0 - mirrored.upper - below.lower).abs() < 1e-15);
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
