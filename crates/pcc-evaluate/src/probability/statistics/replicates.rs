//! Proportions from independent randomisations.

use super::proportion::{Interval, Proportion};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Hits, or misses, of all replicates together below which their spread is no measure: with 16 replicates and
/// independent samples Student's interval alone covers 88 to 93 % at 3 to 8 hits instead of 95 %.
const FEW: u64 = 20;

/// A proportion with what is not known of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Holds the true value at its level.
    pub interval: Interval,
}

impl Share {
    /// From replicates of equal size, whose samples need not be independent of each other, but replicates are. With the
    /// mean p̄ of their proportions and their standard deviation s, R of them: p̄ ± t s/√R with the quantile t of
    /// Student's law of R − 1 degrees of freedom, cut off at 0 and 1.
    ///
    /// Of few hits, or misses, the spread of replicates says little: the interval then holds that of all samples as if
    /// they were independent, too.
    ///
    /// A single replicate is taken for independent samples: standard error √(p(1 − p)/n), [`Proportion::interval`]. So
    /// are replicates that all agree: their spread says nothing then. That is cautious for samples that cover the
    /// domain more evenly than independent ones. Without replicates the interval is \[0, 1\].
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::statistics::{Proportion, Share};
    /// let replicates = [48, 50, 52].map(|hits| Proportion { hits, samples: 100 });
    /// let share = Share::of_replicates(&replicates, 0.95);
    /// assert!((share.value - 0.5).abs() < 1e-15);
    /// assert!((share.standard_error - 0.02 / 3f64.sqrt()).abs() < 1e-15);
    /// // The quantile of two degrees of freedom is 4.303.
    /// assert!((share.interval.upper - 0.5 - 4.3027 * 0.02 / 3f64.sqrt()).abs() < 1e-5);
    /// ```
    pub fn of_replicates(replicates: &[Proportion], level: f64) -> Self {
        let samples = replicates.iter().map(|replicate| replicate.samples).sum();
        let pooled = Proportion { hits: replicates.iter().map(|replicate| replicate.hits).sum(), samples };
        if samples == 0 {
            return Self { value: 0.0, standard_error: 0.5, interval: Interval { lower: 0.0, upper: 1.0, level } };
        }
        let (value, count) = (pooled.value(), replicates.len() as f64);
        let squares: f64 = replicates.iter().map(|replicate| (replicate.value() - value).powi(2)).sum();
        if replicates.len() < 2 || replicates.iter().all(|replicate| replicate.hits == replicates[0].hits) {
            let standard_error = (value * (1.0 - value) / samples as f64).sqrt();
            return Self { value, standard_error, interval: pooled.interval(level) };
        }
        let standard_error = (squares / (count - 1.0) / count).sqrt();
        let half_width = quantile(count - 1.0, 0.5 + 0.5 * level) * standard_error;
        let mut interval =
            Interval { lower: (value - half_width).max(0.0), upper: (value + half_width).min(1.0), level };
        if pooled.hits.min(samples.saturating_sub(pooled.hits)) < FEW {
            let pooled = pooled.interval(level);
            interval.lower = interval.lower.min(pooled.lower);
            interval.upper = interval.upper.max(pooled.upper);
        }
        Self { value, standard_error, interval }
    }
}

/// Quantile of Student's law.
fn quantile(degrees_of_freedom: f64, probability: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees_of_freedom).map_or(f64::INFINITY, |law| law.inverse_cdf(probability))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probability::random::{Purpose, Stream};

    #[test]
    fn intervals_of_replicates_cover_at_their_level() {
        const REPEATS: u64 = 2000;
        let truth = 0.2;
        let covered = (0..REPEATS)
            .filter(|&repeat| {
                let mut stream = Stream::new(11, Purpose::Evaluation, repeat);
                let mut hits = || (0..500).filter(|_| stream.next_unit() < truth).count() as u64;
                let replicates: Vec<_> = (0..8).map(|_| Proportion { hits: hits(), samples: 500 }).collect();
                let interval = Share::of_replicates(&replicates, 0.95).interval;
                interval.lower <= truth && truth <= interval.upper
            })
            .count();
        // Four standard errors of 2000 repeats are 0.0195.
        assert!((0.93..=0.97).contains(&(covered as f64 / REPEATS as f64)), "{covered} of {REPEATS}");
    }

    #[test]
    fn intervals_of_few_hits_cover_at_their_level() {
        const REPEATS: u64 = 4000;
        for expected in [1.0, 3.5, 5.0, 8.0] {
            let truth = expected / (16.0 * 500.0);
            let covered = (0..REPEATS)
                .filter(|&repeat| {
                    let mut stream = Stream::new(12, Purpose::Evaluation, repeat);
                    let mut hits = || (0..500).filter(|_| stream.next_unit() < truth).count() as u64;
                    let replicates: Vec<_> = (0..16).map(|_| Proportion { hits: hits(), samples: 500 }).collect();
                    let interval = Share::of_replicates(&replicates, 0.95).interval;
                    interval.lower <= truth && truth <= interval.upper
                })
                .count();
            // That of all samples alone has 95 % at least; three standard errors of 4000 repeats are 0.0103.
            assert!(covered as f64 > 0.94 * REPEATS as f64, "{expected} hits: {covered} of {REPEATS}");
        }
    }

    #[test]
    fn replicates_that_agree_do_not_claim_certainty() {
        for hits in [0, 40, 100] {
            let share = Share::of_replicates(&[Proportion { hits, samples: 100 }; 4], 0.95);
            assert_eq!(share.interval, Proportion { hits: 4 * hits, samples: 400 }.interval(0.95));
            assert!(share.interval.lower < share.interval.upper);
        }
        assert_eq!(Share::of_replicates(&[], 0.95).interval, Interval { lower: 0.0, upper: 1.0, level: 0.95 });
    }

    #[test]
    fn intervals_stay_within_zero_and_one() {
        let replicates = [0, 0, 9].map(|hits| Proportion { hits, samples: 10 });
        let Interval { lower, upper, .. } = Share::of_replicates(&replicates, 0.99).interval;
        assert!(lower == 0.0 && upper == 1.0);
    }
}
