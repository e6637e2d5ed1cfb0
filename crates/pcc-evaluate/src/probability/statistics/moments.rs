//! Mean, variance and range of a stream of numbers.

use serde::{Deserialize, Serialize};

/// Interleaved partial results of a block: enough to keep a processor's vector units busy.
const LANES: usize = 16;

/// Folds `values` in [`LANES`] interleaved parts, then the parts in order.
fn fold_lanes(values: &[f64], start: f64, add: impl Fn(f64, f64) -> f64, combine: impl Fn(f64, f64) -> f64) -> f64 {
    let mut lanes = [start; LANES];
    let blocks = values.chunks_exact(LANES);
    let rest = blocks.remainder();
    for block in blocks {
        for (lane, &value) in lanes.iter_mut().zip(block) {
            *lane = add(*lane, value);
        }
    }
    for (lane, &value) in lanes.iter_mut().zip(rest) {
        *lane = add(*lane, value);
    }
    lanes.into_iter().reduce(combine).unwrap_or(start)
}

/// Count, mean, sum of squared deviations and range of the numbers seen so far.
///
/// Numbers are added by Welford's update; parts are merged by the formula of Chan, Golub and LeVeque (1983),
/// <https://doi.org/10.1080/00031305.1983.10483115>. Merging the same parts in the same order gives the same bits,
/// whatever computed the parts.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::statistics::Moments;
/// let mut low: Moments = [1.0, 2.0].into_iter().collect();
/// let high: Moments = [3.0, 4.0].into_iter().collect();
/// low.merge(&high);
/// assert_eq!((low.mean(), low.variance()), (2.5, 5.0 / 3.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Moments {
    count: u64,
    mean: f64,
    squares: f64,
    minimum: f64,
    maximum: f64,
}

impl Default for Moments {
    fn default() -> Self {
        Self { count: 0, mean: 0.0, squares: 0.0, minimum: f64::INFINITY, maximum: f64::NEG_INFINITY }
    }
}

impl Moments {
    /// Adds one number.
    #[inline]
    pub fn push(&mut self, value: f64) {
        self.count += 1;
        let deviation = value - self.mean;
        self.mean += deviation / self.count as f64;
        self.squares += deviation * (value - self.mean);
        self.minimum = self.minimum.min(value);
        self.maximum = self.maximum.max(value);
    }

    /// The moments of a block of numbers in two passes: faster and more accurate than one by one. Sums run over
    /// 16 interleaved parts, in an order that does not depend on the processor.
    pub fn of(values: &[f64]) -> Self {
        if values.is_empty() {
            return Self::default();
        }
        let mean = fold_lanes(values, 0.0, |sum, value| sum + value, |a, b| a + b) / values.len() as f64;
        let square = |sum, value| sum + (value - mean) * (value - mean);
        let minimum = |a: f64, b: f64| if b < a { b } else { a };
        let maximum = |a: f64, b: f64| if b > a { b } else { a };
        Self {
            count: values.len() as u64,
            mean,
            squares: fold_lanes(values, 0.0, square, |a, b| a + b),
            minimum: fold_lanes(values, f64::INFINITY, minimum, minimum),
            maximum: fold_lanes(values, f64::NEG_INFINITY, maximum, maximum),
        }
    }

    /// The moments of `count` numbers with these sums of their deviations from `shift`, and of their squares: exact but
    /// for rounding where `shift` is among the numbers or close to their mean.
    pub fn from_sums(count: u64, shift: f64, sum: f64, squares: f64, minimum: f64, maximum: f64) -> Self {
        if count == 0 {
            return Self::default();
        }
        let deviation = sum / count as f64;
        Self { count, mean: shift + deviation, squares: (squares - deviation * sum).max(0.0), minimum, maximum }
    }

    /// Adds all numbers that `other` has seen.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let (before, added) = (self.count as f64, other.count as f64);
        self.count += other.count;
        let total = self.count as f64;
        let deviation = other.mean - self.mean;
        self.mean += deviation * (added / total);
        self.squares += other.squares + deviation * deviation * (before * added / total);
        // Not f64::min and max, which may choose either of 0 and −0.
        self.minimum = if other.minimum < self.minimum { other.minimum } else { self.minimum };
        self.maximum = if other.maximum > self.maximum { other.maximum } else { self.maximum };
    }

    /// Whether these can be the moments of so many numbers: what this crate computes always are; what a file says need
    /// not be.
    pub fn are_of(&self, count: u64) -> bool {
        // A mean has one rounding per number and merge, which is less than this share of the range.
        let slack = 1e-6 * (self.minimum.abs() + self.maximum.abs());
        let holds_mean = self.minimum - slack <= self.mean && self.mean <= self.maximum + slack;
        self.count == count && count > 0 && self.squares >= 0.0 && self.minimum <= self.maximum && holds_mean
    }

    /// Whether all of them are finite numbers.
    pub fn is_finite(&self) -> bool {
        [self.mean, self.squares, self.minimum, self.maximum].iter().all(|number| number.is_finite())
    }

    /// How many numbers were seen.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Arithmetic mean; 0 before the first number.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Unbiased variance, Σ(x − x̄)²/(n − 1); 0 for fewer than two numbers.
    pub fn variance(&self) -> f64 {
        if self.count < 2 { 0.0 } else { self.squares / (self.count - 1) as f64 }
    }

    /// Smallest number seen; ∞ before the first.
    pub fn minimum(&self) -> f64 {
        self.minimum
    }

    /// Largest number seen; −∞ before the first.
    pub fn maximum(&self) -> f64 {
        self.maximum
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut moments = Self::default();
        values.into_iter().for_each(|value| moments.push(value));
        moments
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn merged_parts_equal_the_whole(values in prop::collection::vec(-1e3..1e3f64, 2..200), cut in 0.0..1.0f64) {
            let cut = (cut * values.len() as f64) as usize;
            let whole: Moments = values.iter().copied().collect();
            let mut parts = Moments::of(&values[..cut]);
            parts.merge(&values[cut..].iter().copied().collect());
            prop_assert_eq!(parts.count(), whole.count());
            prop_assert_eq!((parts.minimum(), parts.maximum()), (whole.minimum(), whole.maximum()));
            prop_assert!((parts.mean() - whole.mean()).abs() <= 1e-12 * 1e3);
            prop_assert!((parts.variance() - whole.variance()).abs() <= 1e-12 * 1e6);
        }
    }

    #[test]
    fn large_offsets_do_not_cancel() {
        let moments: Moments = (0..1000).map(|i| 1e9 + f64::from(i % 2)).collect();
        assert!((moments.variance() - 0.25 * 1000.0 / 999.0).abs() < 1e-6);
    }
}
