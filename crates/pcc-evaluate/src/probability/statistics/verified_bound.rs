//! Bounds on a share of the model, of stable points say, from a surrogate that may be wrong.
//!
//! A surrogate is sampled a million times for the price of a few model runs, so its own share p_s of samples is known
//! almost exactly, but it is the surrogate's. The model's share differs from it by the points where the two disagree:
//!
//! p = p_s − P(falsely claimed) + P(falsely denied),
//!
//! where a point is falsely claimed if the surrogate counts it, as stable say, and the model does not, and falsely
//! denied the other way round. Both probabilities are estimated from fresh points at which surrogate and model are
//! evaluated together. Where the surrogate is good they are small, and so is their uncertainty: it decreases as √(P/M)
//! with M fresh points while disagreements are seen, and as 1/M while there are none, against √(p(1 − p)/M) for M model
//! runs that are merely counted. A bad surrogate widens the bound; it does not make it wrong.
//!
//! Three intervals of Clopper and Pearson (1934), <https://doi.org/10.1093/biomet/26.4.404>, are combined by
//! Bonferroni's inequality.

use super::proportion::{Interval, Proportion};

/// Share of the error probability α = 1 − level that is left to each of the two discordant probabilities: about a
/// quarter to either side of each.
const ERROR_SHARE_OF_DISCORDANCE: f64 = 0.49;

/// Share of α that is left to the surrogate's own proportion. Little is enough where samples of the surrogate cost
/// nothing; with the two above the shares sum to one.
const ERROR_SHARE_OF_SURROGATE: f64 = 0.02;

/// How often surrogate and model disagreed about stability at `samples` fresh points.
///
/// The points are drawn from the distribution of the inputs, independently of each other, of the points that the
/// surrogate was fitted to and of those that its proportion was estimated from. Every draw counts once: points chosen
/// because they look critical, or weighted in any other way, void the bound.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::statistics::{DiscordantCounts, Proportion};
/// let surrogate = Proportion { hits: 400_000, samples: 1_000_000 };
/// let counts =
///     DiscordantCounts { samples: 300, falsely_claimed: 2, falsely_denied: 0, claimed_unknown: 0, denied_unknown: 0 };
/// let bound = counts.bound(surrogate, 0.95);
/// assert!(bound.lower > 0.36 && bound.upper < 0.42);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DiscordantCounts {
    /// Number of fresh points, at least one.
    pub samples: u64,
    /// Number of points that the surrogate counts and the model does not.
    pub falsely_claimed: u64,
    /// Number of points that the model counts and the surrogate does not.
    pub falsely_denied: u64,
    /// Number of points at which the model failed, and which the surrogate counts: falsely claimed, or not.
    pub claimed_unknown: u64,
    /// Number of points at which the model failed, and which the surrogate does not count: falsely denied, or not.
    pub denied_unknown: u64,
}

impl DiscordantCounts {
    /// An interval that holds the model's stability proportion p with probability `level` or more, whatever the
    /// surrogate.
    ///
    /// `surrogate` counts the stable ones among independent samples of the surrogate.
    ///
    /// # Formula
    ///
    /// With α = 1 − `level` and Clopper–Pearson intervals \[s⁻, s⁺\] of p_s at error 0.02 α, \[a⁻, a⁺\] of P(falsely
    /// stable) and \[b⁻, b⁺\] of P(falsely denied) at error 0.49 α each,
    ///
    /// max(0, s⁻ − a⁺ + b⁻) ≤ p ≤ min(1, s⁺ − a⁻ + b⁺).
    ///
    /// Each interval misses its probability with at most its error, so by Bonferroni's inequality one or more of them
    /// miss with at most 0.02 α + 2 · 0.49 α = α, however they depend on each other: both discordant counts come from
    /// the same points. When none misses, p = p_s − P(falsely claimed) + P(falsely denied) lies between the two sides.
    /// Points at which the model failed count for a⁺ and b⁺ and not for a⁻ and b⁻: whatever it would have answered, the
    /// bound holds.
    ///
    /// Without fresh points the bound is \[0, 1\].
    pub fn bound(self, surrogate: Proportion, level: f64) -> Interval {
        let alpha = 1.0 - level;
        let discordant =
            |hits| Proportion { hits, samples: self.samples }.clopper_pearson(1.0 - ERROR_SHARE_OF_DISCORDANCE * alpha);
        let counts = [(self.falsely_claimed, self.claimed_unknown), (self.falsely_denied, self.denied_unknown)];
        let [claimed, denied] =
            counts.map(|(known, unknown)| [discordant(known).lower, discordant(known + unknown).upper]);
        let stable = surrogate.clopper_pearson(1.0 - ERROR_SHARE_OF_SURROGATE * alpha);
        Interval {
            lower: (stable.lower - claimed[1] + denied[0]).clamp(0.0, 1.0),
            upper: (stable.upper - claimed[0] + denied[1]).clamp(0.0, 1.0),
            level,
        }
    }

    /// By how much the proportion may differ from that of the surrogate, at `level`: lower and upper end, as shares. A
    /// surrogate is contradicted if zero lies outside.
    pub fn difference(self, level: f64) -> [f64; 2] {
        // In the middle between 0 and 1 nothing is cut off, and with so many samples it is known.
        let middle = Proportion { hits: KNOWN / 2, samples: KNOWN };
        let Interval { lower, upper, .. } = self.bound(middle, level);
        [lower - 0.5, upper - 0.5]
    }
}

/// Samples from which a proportion is known for all purposes.
const KNOWN: u64 = 1 << 50;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probability::random::{Purpose, Stream};

    const LEVEL: f64 = 0.95;

    fn width(interval: Interval) -> f64 {
        interval.upper - interval.lower
    }

    #[test]
    fn failures_widen_the_bound_to_either_side() {
        let surrogate = Proportion { hits: 600_000, samples: 1_000_000 };
        let counts = |claimed_unknown, denied_unknown| DiscordantCounts {
            samples: 300,
            falsely_claimed: 2,
            falsely_denied: 3,
            claimed_unknown,
            denied_unknown,
        };
        let [all_answered, some_failed] = [counts(0, 0), counts(20, 40)].map(|counts| counts.bound(surrogate, LEVEL));
        assert!(some_failed.lower < all_answered.lower - 0.05 && some_failed.upper > all_answered.upper + 0.1);
        // Whatever the failed points are.
        for (claimed, denied) in [(22, 3), (2, 43), (22, 43), (12, 23)] {
            let known = DiscordantCounts { falsely_claimed: claimed, falsely_denied: denied, ..counts(0, 0) };
            let bound = known.bound(surrogate, LEVEL);
            assert!(some_failed.lower <= bound.lower && bound.upper <= some_failed.upper);
        }
    }

    #[test]
    fn error_shares_sum_to_one() {
        assert_eq!(2.0 * ERROR_SHARE_OF_DISCORDANCE + ERROR_SHARE_OF_SURROGATE, 1.0);
    }

    /// Draws a surrogate's samples and `fresh` points with the given truth, and says whether the bound holds p.
    fn bound_holds(repeat: u64, fresh: u64, surrogate_samples: u64, truth: Truth) -> bool {
        let mut evaluation = Stream::new(7, Purpose::Evaluation, repeat);
        let hits = (0..surrogate_samples).filter(|_| evaluation.next_unit() < truth.surrogate()).count() as u64;
        let mut certification = Stream::new(7, Purpose::Certification, repeat);
        let mut seen = DiscordantCounts {
            samples: fresh,
            falsely_claimed: 0,
            falsely_denied: 0,
            claimed_unknown: 0,
            denied_unknown: 0,
        };
        for _ in 0..fresh {
            let unit = certification.next_unit();
            if unit < truth.falsely_claimed {
                seen.falsely_claimed += 1;
            } else if unit < truth.falsely_claimed + truth.falsely_denied {
                seen.falsely_denied += 1;
            }
        }
        let bound = seen.bound(Proportion { hits, samples: surrogate_samples }, LEVEL);
        bound.lower <= truth.model && truth.model <= bound.upper
    }

    #[derive(Clone, Copy)]
    struct Truth {
        model: f64,
        falsely_claimed: f64,
        falsely_denied: f64,
    }

    impl Truth {
        fn surrogate(self) -> f64 {
            self.model + self.falsely_claimed - self.falsely_denied
        }
    }

    #[test]
    fn bound_covers_at_least_at_its_level() {
        let repeats = 2000;
        let good = Truth { model: 0.4, falsely_claimed: 0.02, falsely_denied: 0.005 };
        let biased = Truth { model: 0.4, falsely_claimed: 0.2, falsely_denied: 0.0 };
        for (truth, fresh) in [(good, 50), (good, 300), (good, 1000), (biased, 50)] {
            let held = (0..repeats).filter(|&repeat| bound_holds(repeat, fresh, 2000, truth)).count();
            assert!(held as f64 >= LEVEL * repeats as f64, "{held} of {repeats} with {fresh} fresh points");
        }
    }

    #[test]
    fn no_disagreement_leaves_the_width_of_what_may_have_been_missed() {
        let surrogate = Proportion { hits: 400_000, samples: 1_000_000 };
        let bound = DiscordantCounts {
            samples: 100,
            falsely_claimed: 0,
            falsely_denied: 0,
            claimed_unknown: 0,
            denied_unknown: 0,
        }
        .bound(surrogate, LEVEL);
        // One-sided 0.245 α of 100 points without a hit: 1 − (0.245 · 0.05)^(1/100).
        let missed = 1.0 - (0.245f64 * 0.05).powf(0.01);
        let own = surrogate.clopper_pearson(0.999);
        assert!((bound.lower - (own.lower - missed)).abs() < 1e-9, "{bound:?}");
        assert!((bound.upper - (own.upper + missed)).abs() < 1e-9, "{bound:?}");
    }

    #[test]
    fn disagreement_shifts_the_bound_to_the_side_of_the_model() {
        let surrogate = Proportion { hits: 400_000, samples: 1_000_000 };
        let optimistic = DiscordantCounts {
            samples: 500,
            falsely_claimed: 60,
            falsely_denied: 0,
            claimed_unknown: 0,
            denied_unknown: 0,
        }
        .bound(surrogate, LEVEL);
        assert!(optimistic.lower < 0.28 && 0.28 < optimistic.upper && optimistic.upper < 0.4, "{optimistic:?}");
        let pessimistic = DiscordantCounts {
            samples: 500,
            falsely_claimed: 0,
            falsely_denied: 60,
            claimed_unknown: 0,
            denied_unknown: 0,
        }
        .bound(surrogate, LEVEL);
        assert!(pessimistic.upper > 0.52 && 0.52 > pessimistic.lower && pessimistic.lower > 0.4, "{pessimistic:?}");
    }

    #[test]
    fn a_perfect_surrogate_says_more_than_the_model_runs_alone() {
        let surrogate = Proportion { hits: 400_000, samples: 1_000_000 };
        let bound = DiscordantCounts {
            samples: 300,
            falsely_claimed: 0,
            falsely_denied: 0,
            claimed_unknown: 0,
            denied_unknown: 0,
        }
        .bound(surrogate, LEVEL);
        let alone = Proportion { hits: 120, samples: 300 }.clopper_pearson(LEVEL);
        assert!(width(bound) < 0.4 * width(alone), "{bound:?}, {alone:?}");
    }

    #[test]
    fn bound_stays_within_zero_and_one() {
        for hits in [0, 1_000_000] {
            let surrogate = Proportion { hits, samples: 1_000_000 };
            let bound = DiscordantCounts {
                samples: 50,
                falsely_claimed: 5,
                falsely_denied: 5,
                claimed_unknown: 0,
                denied_unknown: 0,
            }
            .bound(surrogate, LEVEL);
            assert!(0.0 <= bound.lower && bound.lower <= bound.upper && bound.upper <= 1.0, "{bound:?}");
        }
    }

    #[test]
    fn nothing_is_known_without_fresh_points() {
        let surrogate = Proportion { hits: 400_000, samples: 1_000_000 };
        let bound = DiscordantCounts {
            samples: 0,
            falsely_claimed: 0,
            falsely_denied: 0,
            claimed_unknown: 0,
            denied_unknown: 0,
        }
        .bound(surrogate, LEVEL);
        assert_eq!((bound.lower, bound.upper), (0.0, 1.0));
    }
}
