//! Proportions and what a finite number of samples says about them.

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal};

/// An interval that holds the true value with probability `level`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
    /// let interval = pcc::statistics::Proportion { hits: 0, samples: 100 }.wilson(0.95);
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
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Newcombe (1998), table I, method 3, <https://doi.org/10.1002/(SICI)1097-0258(19980430)17:8%3C857::AID-SIM777%3E3.0.CO;2-E>:
    /// four decimals.
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
        use crate::random::{Purpose, Stream};
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
