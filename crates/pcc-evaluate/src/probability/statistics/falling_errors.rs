//! An upper bound of a rare share under an assumption: that large errors of the surrogate are rarer than small ones.
//!
//! For a point that the surrogate ĝ predicts not to be rare (ĝ < 0; rare is g ≥ 0), Z = max(0, (g − ĝ)/(−ĝ)) is the
//! part of the predicted margin that the error eats: the point is rare if Z ≥ 1. The assumption, beyond a layer of
//! points at the predicted boundary: **an error that eats twice as much of the margin is at most half as frequent**, so
//! P(Z ≥ 1) ≤ z P(Z ≥ z) for z ≤ 1. With the largest Z of m runs for z, P(Z > max Z) is at most that of none in m.
//!
//! The layer gets runs of its own, because there margins are small and Z is anything: without it the bound fails. A
//! region that no run has seen at all breaks the assumption. So this bound is not called verified.

use super::binomial_tail::probability_of_at_least;
use super::proportion::Proportion;
use super::stratified_bound::StratumCounts;

/// Parts of the error probability: of the layer, of the rest where no run is rare, and as much where some are (then
/// nothing is said), and of the weights.
const LAYER: f64 = 0.4;
const REST: f64 = 0.29;
const WEIGHTS: f64 = 0.02;

/// Errors are looked at down to those that one in so many runs exceeds.
const TAILS: [usize; 3] = [4, 8, 16];

/// If errors fall off as assumed, a check fails by chance with this probability at most.
const FALSE_ALARM: f64 = 0.01;

/// How many errors were so large, and how many twice as large.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thinning {
    /// The part of the margin that the error eats.
    pub error: f64,
    /// Runs in which it is so large or larger.
    pub runs: u64,
    /// Runs in which it is twice as large or larger.
    pub twice: u64,
}

impl Thinning {
    /// Whether more errors are twice as large than chance explains if at most half are.
    pub fn contradicts(&self) -> bool {
        probability_of_at_least(self.twice, self.runs, 0.5) < FALSE_ALARM
    }
}

/// Why there is no bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoBound {
    /// There are no runs outside the layer.
    NoRuns,
    /// A run outside the layer was rare.
    RareFarAway,
    /// Large errors are too frequent for the assumption.
    NoThinning,
}

/// What is known of errors outside the layer.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::statistics::{FarErrors, Proportion, StratumCounts};
/// // Errors of 296 runs eat at most 2 % of the margin, and thin out as 1/z².
/// let errors = FarErrors::new((1..=296).map(|i| 0.02 / f64::from(i).sqrt()).collect());
/// let share = |hits| Proportion { hits, samples: 10_000_000 };
/// let layer = StratumCounts { runs: 100, rare: 0, failed: 0 };
/// let upper = errors.upper(share(10_000), share(20_000), layer, 0.95).unwrap();
/// assert!(upper > 0.001 && upper < 0.002);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FarErrors {
    /// Largest first.
    errors: Vec<f64>,
}

impl FarErrors {
    /// From Z of all runs outside the layer, in any order. What is not a number is taken for rare.
    pub fn new(mut errors: Vec<f64>) -> Self {
        errors.iter_mut().filter(|error| error.is_nan()).for_each(|error| *error = f64::INFINITY);
        errors.sort_by(|a, b| b.total_cmp(a));
        Self { errors }
    }

    /// Number of runs.
    pub fn runs(&self) -> u64 {
        self.errors.len() as u64
    }

    /// The largest error, as a part of the margin; 0 without runs.
    pub fn largest(&self) -> f64 {
        self.errors.first().copied().unwrap_or(0.0)
    }

    /// How errors thin out, from the quarter of the largest to the sixteenth; of those that are not zero.
    pub fn thinning(&self) -> Vec<Thinning> {
        let at_least = |error: f64| self.errors.partition_point(|&other| other >= error) as u64;
        let tail = |part: &usize| {
            let error = *self.errors.get(self.errors.len().div_ceil(*part).checked_sub(1)?)?;
            (error > 0.0).then(|| Thinning { error, runs: at_least(error), twice: at_least(2.0 * error) })
        };
        TAILS.iter().filter_map(tail).collect()
    }

    /// The model's rare share is more than this with probability 1 − `side_level` at most, if errors fall off.
    ///
    /// `surrogate` and `layer_weight` count the samples in the predicted set and in the layer; `layer` is what runs in
    /// the layer said.
    ///
    /// # Formula
    ///
    /// With α = 1 − `side_level` and one-sided Clopper–Pearson ends U: p_s⁺ + W_N U(layer, 0.4 α) + W_F max Z U(none of
    /// m_F, 0.29 α), where p_s⁺ is the upper end of the surrogate's share at 0.01 α, and W_N and W_F are those of the
    /// layer and of the rest at 0.005 α each. (0.29 α more is for the case that runs far away are rare.)
    ///
    /// # Errors
    ///
    /// [`NoBound`] where the assumption is not supported.
    pub fn upper(
        &self,
        surrogate: Proportion,
        layer_weight: Proportion,
        layer: StratumCounts,
        side_level: f64,
    ) -> Result<f64, NoBound> {
        match () {
            () if self.errors.is_empty() => return Err(NoBound::NoRuns),
            () if self.largest() >= 1.0 => return Err(NoBound::RareFarAway),
            () if self.thinning().iter().any(Thinning::contradicts) => return Err(NoBound::NoThinning),
            () => {}
        }
        let alpha = 1.0 - side_level;
        let of_rest = surrogate.samples.saturating_sub(surrogate.hits).saturating_sub(layer_weight.hits);
        let rest_weight = Proportion { hits: of_rest, samples: surrogate.samples };
        let unseen = Proportion { hits: 0, samples: self.runs() }.upper_bound(REST * alpha);
        let near = layer_weight.upper_bound(0.25 * WEIGHTS * alpha) * layer.upper(LAYER * alpha);
        let far = rest_weight.upper_bound(0.25 * WEIGHTS * alpha) * unseen * self.largest();
        Ok((surrogate.upper_bound(0.5 * WEIGHTS * alpha) + near + far).min(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probability::random::{Purpose, Stream};

    const LEVEL: f64 = 0.95;

    fn share(hits: u64) -> Proportion {
        Proportion { hits, samples: 10_000_000 }
    }

    fn runs(runs: u64, rare: u64) -> StratumCounts {
        StratumCounts { runs, rare, failed: 0 }
    }

    #[test]
    fn the_bound_is_the_sum_of_its_parts() {
        let errors = FarErrors::new((1..=290).map(|i| 0.05 / f64::from(i)).collect());
        let found = errors.upper(share(10_000), share(20_000), runs(100, 0), LEVEL).unwrap();
        let weight = |hits, error: f64| share(hits).upper_bound(error * 0.05);
        let near = weight(20_000, 0.005) * (1.0 - 0.02f64.powf(0.01));
        let far = weight(9_970_000, 0.005) * (1.0 - 0.0145f64.powf(1.0 / 290.0)) * 0.05;
        assert!((found - (weight(10_000, 0.01) + near + far)).abs() < 1e-12, "{found}");
        assert!(found < 2e-3, "a good surrogate of a thousandth is bounded by two");
        let with_errors_nearby = errors.upper(share(10_000), share(20_000), runs(100, 3), LEVEL).unwrap();
        assert!(with_errors_nearby > found);
    }

    #[test]
    fn without_support_there_is_no_bound() {
        let upper = |errors: Vec<f64>| FarErrors::new(errors).upper(share(10_000), share(20_000), runs(100, 0), LEVEL);
        assert_eq!(upper(Vec::new()), Err(NoBound::NoRuns));
        assert_eq!(upper(vec![0.1, 1.0, 0.01]), Err(NoBound::RareFarAway));
        assert_eq!(upper(vec![0.1, f64::NAN]), Err(NoBound::RareFarAway));
        // P(Z ≥ z) falls as the fourth root.
        assert_eq!(upper((1..=300).map(|i| 1e-9 * (300.0 / f64::from(i)).powi(3)).collect()), Err(NoBound::NoThinning));
        assert!(upper(vec![0.0; 300]).is_ok(), "no error at all thins out");
    }

    #[test]
    fn tails_count_errors_and_those_twice_as_large() {
        let thinning = FarErrors::new((1..=16).map(|i| f64::from(i) / 100.0).collect()).thinning();
        let expected = [(0.13, 4, 0), (0.15, 2, 0), (0.16, 1, 0)];
        let found: Vec<_> = thinning.iter().map(|tail| (tail.error, tail.runs, tail.twice)).collect();
        assert_eq!(found, expected);
        assert!(!Thinning { error: 0.1, runs: 10, twice: 5 }.contradicts());
        // 10 of 10 by chance: 1/1024.
        assert!(Thinning { error: 0.1, runs: 10, twice: 10 }.contradicts());
        assert!(!Thinning { error: 0.1, runs: 6, twice: 6 }.contradicts());
    }

    /// Errors that just fall off as assumed, P(Z ≥ z) = z₀/z, and faster ones.
    #[test]
    fn a_bound_that_is_given_is_seldom_wrong_where_errors_fall_off() {
        const REPETITIONS: u64 = 2000;
        for (power, smallest) in [(1.0, 2e-3), (1.0, 1e-4), (2.0, 0.02), (3.0, 0.1)] {
            // Points beyond the layer that are rare all the same.
            let missed = 0.997 * f64::powf(smallest, power);
            let (mut given, mut wrong) = (0, 0);
            for repetition in 0..REPETITIONS {
                let mut stream = Stream::new(23, Purpose::Certification, repetition);
                let errors = (0..297).map(|_| smallest * stream.next_unit().powf(-1.0 / power)).collect();
                let found = FarErrors::new(errors).upper(share(10_000), share(20_000), runs(100, 0), LEVEL);
                given += u64::from(found.is_ok());
                wrong += u64::from(found.is_ok_and(|upper| upper < 1e-3 + missed));
            }
            assert!(wrong * 100 <= 5 * REPETITIONS, "{power} {smallest}: {wrong} wrong of {given}");
            assert!(given * 2 > REPETITIONS, "{power} {smallest}: {given}");
        }
    }
}
