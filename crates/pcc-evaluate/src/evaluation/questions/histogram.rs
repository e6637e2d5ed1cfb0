//! Counts in equal bins with fixed edges: they add up to the same whatever the samples were divided into.

use super::question::Bins;
use crate::evaluation::kernel::lanes::{BLOCK_POINTS, Lanes};
use serde::{Deserialize, Serialize};

/// Samples per bin, and those outside.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Histogram {
    /// Samples below the lower edge.
    pub below: u64,
    /// Samples in each bin; a sample on an inner edge belongs to the upper bin, one on the last edge to the last bin.
    pub counts: Vec<u64>,
    /// Samples above the upper edge.
    pub above: u64,
}

impl Histogram {
    /// Empty, of so many bins.
    pub fn new(bins: u32) -> Self {
        Self { below: 0, counts: vec![0; bins as usize], above: 0 }
    }

    /// Number of samples.
    pub fn samples(&self) -> u64 {
        self.below + self.counts.iter().sum::<u64>() + self.above
    }

    /// The same for counts that come from a file: `None` if there are more than can be counted.
    pub(crate) fn checked_samples(&self) -> Option<u64> {
        self.counts.iter().try_fold(self.below.checked_add(self.above)?, |sum, &count| sum.checked_add(count))
    }

    /// Adds the samples of `other`, which has as many bins.
    pub fn merge(&mut self, other: &Self) {
        self.below += other.below;
        self.above += other.above;
        self.counts.iter_mut().zip(&other.counts).for_each(|(own, added)| *own += added);
    }

    /// Adds the first `lanes` values.
    pub(crate) fn add(&mut self, values: &Lanes, lanes: usize, bins: &Bins) {
        let scale = f64::from(bins.bins) / (bins.upper - bins.lower);
        let mut places = Lanes::splat(0.0);
        for lane in 0..BLOCK_POINTS {
            places.0[lane] = (values.0[lane] - bins.lower) * scale;
        }
        let last = self.counts.len() - 1;
        for (&place, &value) in places.0[..lanes].iter().zip(&values.0) {
            if value < bins.lower {
                self.below += 1;
            } else if value > bins.upper {
                self.above += 1;
            } else {
                self.counts[(place as usize).min(last)] += 1;
            }
        }
    }

    /// The value that a share `level` of the samples does not exceed, interpolated inside its bin; `None` if it lies
    /// outside the bins or there are no samples.
    pub fn quantile(&self, bins: &Bins, level: f64) -> Option<f64> {
        let rank = level * self.samples() as f64;
        let mut before = self.below as f64;
        if rank < before {
            return None;
        }
        for (number, &count) in (0u32..).zip(&self.counts) {
            let count = count as f64;
            if count > 0.0 && rank <= before + count {
                let (lower, upper) = (bins.edge(number), bins.edge(number + 1));
                return Some(lower + (upper - lower) * ((rank - before) / count));
            }
            before += count;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bins(lower: f64, upper: f64, bins: u32) -> Bins {
        Bins { quantity: String::new(), lower, upper, bins }
    }

    #[test]
    fn every_sample_is_in_one_bin() {
        let bins = bins(-1.0, 1.0, 4);
        let mut values = Lanes::splat(0.0);
        values.0[..9].copy_from_slice(&[-1.5, -1.0, -0.6, -0.5, 0.0, 0.4999, 0.5, 1.0, 1.1]);
        let mut histogram = Histogram::new(4);
        histogram.add(&values, 9, &bins);
        assert_eq!(histogram, Histogram { below: 1, counts: vec![2, 1, 2, 2], above: 1 });
        assert_eq!(histogram.samples(), 9);
    }

    #[test]
    fn quantiles_are_those_of_the_samples_to_a_bin() {
        let bins = bins(0.0, 1.0, 1000);
        let mut histogram = Histogram::new(1000);
        for start in 0..100 {
            let mut values = Lanes::splat(0.0);
            (0..BLOCK_POINTS).for_each(|lane| {
                values.0[lane] = ((start * BLOCK_POINTS + lane) as f64 / (100 * BLOCK_POINTS) as f64).powi(2)
            });
            histogram.add(&values, BLOCK_POINTS, &bins);
        }
        for level in [0.01, 0.3, 0.5, 0.99, 1.0] {
            let found = histogram.quantile(&bins, level).unwrap();
            assert!((found - level * level).abs() < 2e-3, "{level}: {found}");
        }
    }

    #[test]
    fn quantiles_outside_the_bins_are_not_known() {
        let histogram = Histogram { below: 10, counts: vec![5, 5], above: 10 };
        let bins = bins(0.0, 2.0, 2);
        assert_eq!(histogram.quantile(&bins, 0.1), None);
        assert_eq!(histogram.quantile(&bins, 0.9), None);
        assert_eq!(histogram.quantile(&bins, 0.5), Some(1.0));
        assert_eq!(Histogram::new(2).quantile(&bins, 0.5), None);
    }
}
