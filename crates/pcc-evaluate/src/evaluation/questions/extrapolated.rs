//! Samples outside the box that the model runs of a surrogate spanned.

use crate::evaluation::kernel::lanes::Lanes;
use crate::probability::statistics::{Interval, Merge, Proportion};
use crate::surrogate::TrainedDomain;
use serde::{Deserialize, Serialize};

/// Confidence level of the ends of bounds, which are shares of samples.
const LEVEL: f64 = 0.95;

/// How many samples lie outside the box in at least one input, and what the surrogate says there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Extrapolated {
    /// All of them.
    pub samples: u64,
    /// Those that are stable.
    pub stable: u64,
    /// Those that are unstable.
    pub unstable: u64,
}

impl Extrapolated {
    /// Between what the share of `hits` of `samples` lies, whatever the model would say outside the box: `own` of the
    /// hits lie there. The ends are as far out as so many samples leave open.
    pub fn bounds(&self, hits: u64, own: u64, samples: u64) -> Interval {
        let wilson = |hits: u64| Proportion { hits, samples }.wilson(LEVEL);
        let others = hits.saturating_sub(own);
        Interval {
            lower: wilson(others).lower,
            upper: wilson(others.saturating_add(self.samples).min(samples)).upper,
            level: LEVEL,
        }
    }
}

impl Merge for Extrapolated {
    fn merge(&mut self, next: &Self) {
        self.samples += next.samples;
        self.stable += next.stable;
        self.unstable += next.unstable;
    }
}

/// The sides of a box, for lanes.
#[derive(Debug, Clone)]
pub(crate) struct Sides(Vec<(usize, [f64; 2])>);

impl Sides {
    pub fn of(domain: &TrainedDomain) -> Self {
        let sides = domain.sides().iter().enumerate();
        Self(sides.filter_map(|(input, side)| side.map(|side| (input, side))).collect())
    }

    /// By how much each point lies outside the box, in standardized variables: positive there alone.
    #[inline(always)]
    pub fn distances(&self, points: &[Lanes]) -> Lanes {
        let mut distances = Lanes::splat(f64::NEG_INFINITY);
        for &(input, [lower, upper]) in &self.0 {
            let Some(Lanes(coordinates)) = points.get(input) else { continue };
            for (distance, &coordinate) in distances.0.iter_mut().zip(coordinates) {
                let (below, above) = (lower - coordinate, coordinate - upper);
                let farther = if below > above { below } else { above };
                *distance = if farther > *distance { farther } else { *distance };
            }
        }
        distances
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::kernel::lanes::BLOCK_POINTS;

    #[test]
    fn bounds_trust_nothing_that_is_said_outside() {
        let outside = Extrapolated { samples: 50_000, stable: 20_000, unstable: 30_000 };
        let found = outside.bounds(400_000, outside.stable, 1_000_000);
        // Less the stable ones outside, or all of those outside stable: each as far out as Wilson's interval.
        assert!((0.379..0.38).contains(&found.lower) && (0.43..0.431).contains(&found.upper), "{found:?}");
        assert_eq!(found.lower, Proportion { hits: 380_000, samples: 1_000_000 }.wilson(LEVEL).lower);
        assert_eq!(found.upper, Proportion { hits: 430_000, samples: 1_000_000 }.wilson(LEVEL).upper);
        assert_eq!(Extrapolated::default().bounds(0, 0, 10).lower, 0.0);
    }

    #[test]
    fn the_farthest_input_counts() {
        let sides = Sides(vec![(0, [-1.0, 2.0]), (2, [-3.0, 0.5])]);
        let points = [Lanes::splat(2.5), Lanes::splat(99.0), Lanes::splat(0.25)];
        assert_eq!(sides.distances(&points).0[BLOCK_POINTS - 1], 0.5);
        let points = [Lanes::splat(2.0), Lanes::splat(99.0), Lanes::splat(-3.0)];
        assert_eq!(sides.distances(&points).0[0], 0.0);
    }
}
