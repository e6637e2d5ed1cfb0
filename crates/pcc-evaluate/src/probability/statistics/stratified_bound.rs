//! Bounds on a rare share of the model, from runs inside and outside the set that a surrogate predicts to be rare.
//!
//! Let p_s be the probability of that set. Fresh runs at points drawn at random inside it say which part r_i of it is
//! rare indeed, and runs outside it which part r_o of the rest is rare all the same:
//!
//! p = p_s r_i + (1 − p_s) r_o.
//!
//! Without an assumption no allocation of runs gives a lower upper end than plain sampling outside: with m runs and no
//! disagreement every valid bound of r_o is at least 1 − α^(1/m). Runs inside serve the lower end: 50 of them, all as
//! predicted, give p ≥ 0.94 p_s. The ends are those of Clopper and Pearson (1934),
//! <https://doi.org/10.1093/biomet/26.4.404>, one-sided, combined by Bonferroni's inequality.

use super::proportion::{Interval, Proportion};
use super::verified_bound::DiscordantCounts;

/// Parts of the error probability of one end: of what it rests on first, of what corrects it, and of the surrogate's
/// own share. The first gets nearly all, so that little is lost where nothing is corrected.
const FIRST: f64 = 0.96;
const CORRECTION: f64 = 0.02;
const SURROGATE: f64 = 0.02;

/// Runs that are not asked for in one certificate.
const TOO_MANY: u64 = 1 << 40;

/// What runs at random points of a set of inputs said.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StratumCounts {
    /// Number of runs.
    pub runs: u64,
    /// Of these on the rare side.
    pub rare: u64,
    /// Of these without an answer: on either side.
    pub failed: u64,
}

impl StratumCounts {
    /// The rare part of the set is less than this with probability `error` at most.
    pub fn lower(self, error: f64) -> f64 {
        Proportion { hits: self.rare, samples: self.runs }.lower_bound(error)
    }

    /// The rare part of the set is more than this with probability `error` at most.
    pub fn upper(self, error: f64) -> f64 {
        Proportion { hits: self.rare.saturating_add(self.failed), samples: self.runs }.upper_bound(error)
    }
}

/// Runs outside and inside the set that the surrogate predicts to be rare.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::statistics::{Proportion, StratifiedCounts, StratumCounts};
/// let counts = StratifiedCounts {
///     outside: StratumCounts { runs: 300, rare: 0, failed: 0 },
///     inside: StratumCounts { runs: 50, rare: 50, failed: 0 },
/// };
/// let bound = counts.bound(Proportion { hits: 10_000, samples: 10_000_000 }, 0.95);
/// assert!(bound.lower > 0.9e-3 && bound.upper < 1e-3 + 0.0102);
/// assert!((bound.level - 0.9).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StratifiedCounts {
    /// Outside the set.
    pub outside: StratumCounts,
    /// Inside it.
    pub inside: StratumCounts,
}

impl StratifiedCounts {
    /// An interval of the model's rare share, whatever the surrogate. Each end holds with probability `side_level`, so
    /// both together do with 2 `side_level` − 1.
    ///
    /// `surrogate` counts the samples in the predicted set, among samples of the surrogate that are independent of the
    /// runs' outcomes.
    ///
    /// # Formula
    ///
    /// With α = 1 − `side_level`, Clopper–Pearson ends L and U of one side, and p_s within \[w⁻, w⁺\] at 0.02 α,
    ///
    /// min over w of w L(inside, 0.96 α) + (1 − w) L(outside, 0.02 α) ≤ p ≤
    /// max over w of w U(inside, 0.02 α) + (1 − w) U(outside, 0.96 α).
    ///
    /// Runs that failed count as rare in U and not in L. Without runs the interval is \[0, 1\].
    pub fn bound(self, surrogate: Proportion, side_level: f64) -> Interval {
        let alpha = 1.0 - side_level;
        let Interval { lower: least, upper: most, .. } = surrogate.clopper_pearson(1.0 - SURROGATE * alpha);
        let Self { outside, inside } = self;
        let mixed = |inside: f64, outside: f64| [least, most].map(|w| w * inside + (1.0 - w) * outside);
        let lower = mixed(inside.lower(FIRST * alpha), outside.lower(CORRECTION * alpha));
        let upper = mixed(inside.upper(CORRECTION * alpha), outside.upper(FIRST * alpha));
        Interval {
            lower: lower[0].min(lower[1]).clamp(0.0, 1.0),
            upper: upper[0].max(upper[1]).clamp(0.0, 1.0),
            level: 2.0 * side_level - 1.0,
        }
    }

    /// The fewest runs outside at which the upper end is at most `width` above the surrogate's share, if so many
    /// of them are on the rare side and all of `inside` are; `None` if no number is enough.
    pub fn runs_for(inside: u64, surrogate: Proportion, width: f64, rare: u64, side_level: f64) -> Option<u64> {
        let inside = StratumCounts { runs: inside, rare: inside, failed: 0 };
        let is_enough = |runs: u64| {
            let outside = StratumCounts { runs, rare, failed: 0 };
            Self { outside, inside }.bound(surrogate, side_level).upper - surrogate.value() <= width
        };
        let (mut few, mut enough) = (rare, rare.max(1));
        while !is_enough(enough) {
            (few, enough) = (enough, enough.checked_mul(2).filter(|&runs| runs <= TOO_MANY)?);
        }
        while enough - few > 1 {
            let middle = few + (enough - few) / 2;
            *if is_enough(middle) { &mut enough } else { &mut few } = middle;
        }
        Some(enough)
    }
}

/// Disagreement about one of three classes in one stratum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClassDiscordance {
    /// The stratum among samples of the surrogate.
    pub weight: Proportion,
    /// What runs in it said.
    pub counts: DiscordantCounts,
    /// Whether the surrogate can put points of this stratum into the class.
    pub claims: bool,
    /// Whether it can put points of this stratum into another class.
    pub denies: bool,
}

/// An interval of the model's share of one of three classes: the surrogate's, less what it claims falsely and with what
/// it denies falsely, stratum by stratum. Each end holds with probability `side_level`.
///
/// The errors are divided as in [`StratifiedCounts::bound`], evenly among strata; half of the surrogate's part is for
/// its share of the class, and half for the weights of the strata.
pub fn bound_of_class(share: Proportion, strata: &[ClassDiscordance], side_level: f64) -> Interval {
    let alpha = 1.0 - side_level;
    let own = share.clopper_pearson(1.0 - SURROGATE * alpha);
    let of_weight = SURROGATE * alpha / strata.len().max(1) as f64;
    // What falsely claimed and denied points of a stratum are at least and at most.
    let term = |stratum: &ClassDiscordance, claimed: bool, is_most: bool, error: f64| {
        let ClassDiscordance { weight, counts, .. } = stratum;
        let (known, unknown) = match claimed {
            true => (counts.falsely_claimed, counts.claimed_unknown),
            false => (counts.falsely_denied, counts.denied_unknown),
        };
        let part = StratumCounts { runs: counts.samples, rare: known, failed: unknown };
        let weight = weight.clopper_pearson(1.0 - of_weight);
        if is_most { weight.upper * part.upper(error) } else { weight.lower * part.lower(error) }
    };
    let sum = |claimed: bool, is_most: bool, part: f64| {
        let of_kind = |stratum: &&ClassDiscordance| if claimed { stratum.claims } else { stratum.denies };
        let concerned: Vec<_> = strata.iter().filter(of_kind).collect();
        let error = part * alpha / concerned.len().max(1) as f64;
        concerned.into_iter().map(|stratum| term(stratum, claimed, is_most, error)).sum::<f64>()
    };
    Interval {
        lower: (own.lower - sum(true, true, FIRST) + sum(false, false, CORRECTION)).clamp(0.0, 1.0),
        upper: (own.upper - sum(true, false, CORRECTION) + sum(false, true, FIRST)).clamp(0.0, 1.0),
        level: 2.0 * side_level - 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probability::random::{Purpose, Stream};

    const SIDE_LEVEL: f64 = 0.95;

    /// Binomial probabilities of 0 to `samples` hits.
    fn law(samples: u64, truth: f64) -> Vec<f64> {
        let ln = |k: u64| (1..=k).map(|k| (k as f64).ln()).sum::<f64>();
        let all = ln(samples);
        let single = |k: u64| match truth {
            0.0 => f64::from(u8::from(k == 0)),
            1.0 => f64::from(u8::from(k == samples)),
            _ => {
                let logs = k as f64 * truth.ln() + (samples - k) as f64 * (-truth).ln_1p();
                (all - ln(k) - ln(samples - k) + logs).exp()
            }
        };
        (0..=samples).map(single).collect()
    }

    fn counts(runs: u64, rare: u64) -> StratumCounts {
        StratumCounts { runs, rare, failed: 0 }
    }

    /// The probability with which the lower and the upper end hold, for a surrogate whose share is known.
    fn exact_coverage(share: f64, inside: f64, outside: f64, [runs, within]: [u64; 2]) -> [f64; 2] {
        let samples = 1 << 40;
        let surrogate = Proportion { hits: (share * samples as f64) as u64, samples };
        let truth = share * inside + (1.0 - share) * outside;
        let (of_inside, of_outside) = (law(within, inside), law(runs, outside));
        let mut held = [0.0; 2];
        for (i, &chance) in of_outside.iter().enumerate().filter(|(_, chance)| **chance > 1e-12) {
            for (k, &other) in of_inside.iter().enumerate().filter(|(_, chance)| **chance > 1e-9) {
                let seen = StratifiedCounts { outside: counts(runs, i as u64), inside: counts(within, k as u64) };
                let bound = seen.bound(surrogate, SIDE_LEVEL);
                held[0] += if bound.lower <= truth { chance * other } else { 0.0 };
                held[1] += if truth <= bound.upper { chance * other } else { 0.0 };
            }
        }
        held
    }

    /// A good surrogate, one with a tenth of its points misclassified, a poor one, one that sees nothing; and few runs.
    #[test]
    fn each_end_holds_at_its_level_by_exact_sums() {
        let cases = [
            (1e-3, 1.0, 0.0, [300, 50]),
            (1e-3, 0.98, 1e-4, [300, 50]),
            (1e-3, 0.9, 0.1, [60, 50]),
            (0.2, 0.9, 0.1, [60, 50]),
            (0.3, 0.4, 0.3, [60, 50]),
            (0.0, 0.0, 0.5, [40, 0]),
            (0.1, 0.5, 0.01, [10, 20]),
        ];
        for (share, inside, outside, runs) in cases {
            let [lower, upper] = exact_coverage(share, inside, outside, runs);
            assert!(
                lower >= SIDE_LEVEL - 1e-6 && upper >= SIDE_LEVEL - 1e-6,
                "{share} {inside} {outside}: {lower} {upper}"
            );
        }
    }

    /// 400 repetitions, with the surrogate sampled as well.
    #[test]
    fn each_end_holds_in_95_percent_of_repetitions() {
        let (repetitions, samples) = (400, 20_000u64);
        for (share, inside, outside) in [(1e-3, 1.0, 0.0), (1e-3, 0.9, 0.1), (0.3, 0.5, 0.2)] {
            let truth = share * inside + (1.0 - share) * outside;
            let mut held = [0; 2];
            for repetition in 0..repetitions {
                let mut stream = Stream::new(21, Purpose::Certification, repetition);
                let mut hits =
                    |runs: u64, chance: f64| (0..runs).filter(|_| stream.next_unit() < chance).count() as u64;
                let surrogate = Proportion { hits: hits(samples, share), samples };
                let seen =
                    StratifiedCounts { outside: counts(300, hits(300, outside)), inside: counts(50, hits(50, inside)) };
                let bound = seen.bound(surrogate, SIDE_LEVEL);
                held[0] += u64::from(bound.lower <= truth);
                held[1] += u64::from(truth <= bound.upper);
            }
            assert!(held.iter().all(|&held| held * 100 >= repetitions * 95), "{share} {inside} {outside}: {held:?}");
        }
    }

    #[test]
    fn without_disagreement_the_bound_is_that_of_plain_sampling_above_and_of_fifty_runs_below() {
        let surrogate = Proportion { hits: 10_000, samples: 10_000_000 };
        let seen = StratifiedCounts { outside: counts(300, 0), inside: counts(50, 50) };
        let bound = seen.bound(surrogate, SIDE_LEVEL);
        let own = surrogate.clopper_pearson(0.999);
        let missed = 1.0 - 0.048f64.powf(1.0 / 300.0);
        assert!((bound.upper - (own.upper + (1.0 - own.upper) * missed)).abs() < 1e-12, "{bound:?}");
        assert!((bound.lower - own.lower * 0.048f64.powf(0.02)).abs() < 1e-12, "{bound:?}");
        assert!(bound.upper <= 1e-3 + 0.0102 && bound.lower >= 0.9e-3, "{bound:?}");
    }

    #[test]
    fn failures_widen_the_bound_to_either_side() {
        let surrogate = Proportion { hits: 200_000, samples: 1_000_000 };
        let failed = StratifiedCounts {
            outside: StratumCounts { runs: 300, rare: 3, failed: 5 },
            inside: StratumCounts { runs: 50, rare: 40, failed: 4 },
        };
        let wide = failed.bound(surrogate, SIDE_LEVEL);
        for (outside, inside) in [(3, 40), (8, 40), (3, 44), (8, 44), (5, 42)] {
            let known = StratifiedCounts { outside: counts(300, outside), inside: counts(50, inside) };
            let bound = known.bound(surrogate, SIDE_LEVEL);
            assert!(wide.lower <= bound.lower && bound.upper <= wide.upper, "{wide:?}, {bound:?}");
        }
        let nothing = StratifiedCounts::default().bound(Proportion { hits: 0, samples: 0 }, SIDE_LEVEL);
        assert_eq!((nothing.lower, nothing.upper), (0.0, 1.0));
    }

    #[test]
    fn the_runs_for_a_width_are_the_fewest() {
        let surrogate = Proportion { hits: 10_000, samples: 10_000_000 };
        for (width, rare) in [(0.01, 0), (0.002, 0), (0.002, 1), (0.05, 3)] {
            let runs = StratifiedCounts::runs_for(50, surrogate, width, rare, SIDE_LEVEL).unwrap();
            let above = |runs| {
                let seen = StratifiedCounts { outside: counts(runs, rare), inside: counts(50, 50) };
                seen.bound(surrogate, SIDE_LEVEL).upper - surrogate.value()
            };
            assert!(above(runs) <= width && above(runs - 1) > width, "{width} {rare}: {runs}");
        }
        // Nearly ln(1/0.048)/0.002, and what the surrogate's own share leaves open.
        let runs = StratifiedCounts::runs_for(50, surrogate, 0.002, 0, SIDE_LEVEL).unwrap();
        assert!((1518..1560).contains(&runs), "{runs}");
        assert_eq!(
            StratifiedCounts::runs_for(50, surrogate, 1e-6, 0, SIDE_LEVEL),
            None,
            "its own share is not so well known"
        );
    }

    /// Marginal and unstable shares of a system of which a tenth is stable, with a surrogate that mixes all three up.
    #[test]
    fn bounds_of_three_classes_hold_at_their_level() {
        // By the surrogate's class, the probabilities of the model's: stable, marginal, unstable.
        let (shares, model) = ([0.1, 0.3, 0.6], [[0.9, 0.06, 0.04], [0.03, 0.85, 0.12], [0.02, 0.08, 0.9]]);
        let (repetitions, samples) = (400, 20_000u64);
        for class in [1, 2] {
            let truth: f64 = (0..3).map(|said| shares[said] * model[said][class]).sum();
            let mut held = [0; 2];
            for repetition in 0..repetitions {
                let mut stream = Stream::new(22, Purpose::Certification, repetition);
                let mut draw = |law: [f64; 3]| {
                    let unit = stream.next_unit();
                    if unit < law[0] { 0 } else { 1 + usize::from(unit >= law[0] + law[1]) }
                };
                let mut said = [0u64; 3];
                (0..samples).for_each(|_| said[draw(shares)] += 1);
                let mut part = |among: &[f64; 3], runs: u64| {
                    let mut counts = DiscordantCounts {
                        samples: runs,
                        falsely_claimed: 0,
                        falsely_denied: 0,
                        claimed_unknown: 0,
                        denied_unknown: 0,
                    };
                    for _ in 0..runs {
                        let said = draw(*among);
                        let is = draw(model[said]);
                        counts.falsely_claimed += u64::from(said == class && is != class);
                        counts.falsely_denied += u64::from(said != class && is == class);
                    }
                    counts
                };
                let (inside, outside) = (part(&[1.0, 0.0, 0.0], 50), part(&[0.0, 1.0 / 3.0, 2.0 / 3.0], 300));
                let weight = |hits| Proportion { hits, samples };
                let strata = [
                    ClassDiscordance { weight: weight(said[0]), counts: inside, claims: false, denies: true },
                    ClassDiscordance { weight: weight(samples - said[0]), counts: outside, claims: true, denies: true },
                ];
                let bound = bound_of_class(weight(said[class]), &strata, SIDE_LEVEL);
                held[0] += u64::from(bound.lower <= truth);
                held[1] += u64::from(truth <= bound.upper);
            }
            assert!(held.iter().all(|&held| held * 100 >= repetitions * 95), "class {class}: {held:?}");
        }
    }
}
