//! How sure a proportion is: what sampling leaves open, what the surrogate leaves open, and what is verified.

use super::certify::{assumed, contradicts, ends as ends_in_words};
use super::numbers::{level, plain_range, share, share_below, share_range, significant};
use super::sight::Sight;
use super::survey::LEVEL;
use pcc_evaluate::foundation::count;
use pcc_evaluate::probability::statistics::{Interval, Proportion};
use pcc_evaluate::surrogate::{Certificate, Decision, Surrogate};
use serde::Serialize;

/// Answers to "how sure?", each about something else.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Confidence {
    /// Interval of the share: what the finite number of samples leaves open.
    pub interval: Interval,
    /// The share if max Re λ were larger or smaller by its residuals' central quantiles: what the surrogate leaves
    /// open; null if unknown.
    pub surrogate_band: Option<Interval>,
    /// Estimated relative error of the proportion; null if unknown.
    pub estimated_error_percent: Option<f64>,
    /// The certificate with the most model runs, the first of equals; null if there is none.
    pub verified_bound: Option<VerifiedBound>,
    /// What the same certificate says if errors fall off, which is not verified; null if it says nothing.
    pub bound_if_errors_fall_off: Option<AssumedShare>,
    /// What the text says besides.
    #[serde(skip)]
    pub basis: Basis,
}

/// What the answers rest on: said in words, not in JSON, which has the numbers elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Basis {
    /// Number of samples.
    pub samples: u64,
    /// Independent randomisations that the interval is made from; 1 if it is from the number of samples.
    pub replicates: u64,
    /// The share of samples that are not unstable: what the estimated error is relative to.
    pub not_unstable: f64,
    /// Whether the samples are from a part of the domain alone.
    pub is_confined: bool,
    /// Whether the estimated error is the part of modes left out alone, because there was one design level.
    pub of_modes_left_out: bool,
}

/// The share that is named, and so are its intervals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Named {
    /// Of stable samples.
    Stable,
    /// Of unstable ones, all others being stable.
    Unstable,
    /// Of unstable ones beside marginal ones, with its interval.
    BesideMarginal(Interval),
}

/// A bound from fresh model runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct VerifiedBound {
    /// The bound.
    #[serde(flatten)]
    pub bound: Interval,
    /// Fresh model runs.
    pub samples: u64,
    /// Their seed.
    pub seed: u64,
    /// How many certificates the file has: choosing among many would void the level.
    pub certificates: usize,
    /// Probability with which each end alone holds; null for certificates of earlier versions.
    pub side_level: Option<f64>,
    /// The bound of unstable samples, where some are marginal.
    #[serde(skip)]
    pub unstable: Option<[f64; 2]>,
}

/// A bound of the stable share that rests on an assumption: one of its ends is 0 or 1.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AssumedShare {
    /// The bound.
    #[serde(flatten)]
    pub bound: Interval,
    /// In words, as a share of stable samples and of unstable ones.
    #[serde(skip)]
    words: [String; 2],
}

impl Confidence {
    /// `stable` counts the stable samples, `if_shifted` those that would be if max Re λ were larger by the lower, and
    /// by the upper, end of the band.
    pub fn new(
        surrogate: &Surrogate,
        (stable, not_unstable): (Proportion, f64),
        if_shifted: [u64; 2],
        interval: Interval,
    ) -> Self {
        let decision = &surrogate.decision;
        let share = |hits| Proportion { hits, samples: stable.samples }.value();
        let band = Interval { lower: share(if_shifted[1]), upper: share(if_shifted[0]), level: Decision::BAND_LEVEL };
        Self {
            interval,
            surrogate_band: (!decision.max_re_residuals.is_empty()).then_some(band),
            estimated_error_percent: known_error(surrogate).map(|error| 100.0 * error),
            verified_bound: verified_bound(surrogate),
            bound_if_errors_fall_off: chosen(surrogate).and_then(|(certificate, _)| assumed_share(certificate)),
            basis: Basis {
                samples: stable.samples,
                replicates: 1,
                not_unstable,
                is_confined: false,
                of_modes_left_out: is_of_modes_left_out(surrogate),
            },
        }
    }

    /// Of direct computations, which leave open what their number does.
    pub(super) fn of_model(stable: Proportion) -> Self {
        Self {
            interval: stable.interval(LEVEL),
            surrogate_band: None,
            estimated_error_percent: None,
            verified_bound: None,
            bound_if_errors_fall_off: None,
            basis: Basis {
                samples: stable.samples,
                replicates: 1,
                not_unstable: stable.value(),
                is_confined: false,
                of_modes_left_out: false,
            },
        }
    }

    /// What to say first where a certificate excludes the share of the surrogate.
    pub(super) fn contradiction(surrogate: &Surrogate, share: f64) -> Option<String> {
        let own = |certificate: &&Certificate| certificate.problem_hash == surrogate.provenance.problem_hash;
        // Few samples may lie outside the bound of a rare share by chance: strata have many of their own.
        let excludes = |certificate: &&Certificate| match certificate.strata {
            Some(_) => contradicts(certificate),
            None => share < certificate.lower || share > certificate.upper,
        };
        let certificate = surrogate.certificates.iter().filter(own).find(excludes)?;
        Some(format!(
            "a certificate contradicts the surrogate: by {} fresh model runs {} are stable, not {}; trust it, and build \
             with more runs",
            count(certificate.samples),
            share_range(certificate.lower, certificate.upper),
            super::share(share)
        ))
    }

    /// Takes back what is known of the whole domain only.
    pub(super) fn confine(&mut self) {
        self.basis.is_confined = true;
        self.estimated_error_percent = None;
        self.verified_bound = None;
        self.bound_if_errors_fall_off = None;
    }
}

/// The estimated error of a surrogate, unless its runs tell nothing of it.
pub(super) fn known_error(surrogate: &Surrogate) -> Option<f64> {
    surrogate.decision.proportion_error.filter(|_| !Sight::of(surrogate).is_some_and(Sight::is_unknown))
}

/// Whether the estimated error of a surrogate is the part of modes left out alone: the rest takes two design levels,
/// and points left out.
pub(super) fn is_of_modes_left_out(surrogate: &Surrogate) -> bool {
    surrogate.training.levels.len() == 1 || super::build::is_quadrature(surrogate)
}

/// 1 − x without the noise of its last digits.
fn complement(share: f64) -> f64 {
    const RESOLUTION: f64 = 1e15;
    ((1.0 - share) * RESOLUTION).round() / RESOLUTION
}

/// The certificate with the most model runs, and how many there are.
fn chosen(surrogate: &Surrogate) -> Option<(&Certificate, usize)> {
    let own = |certificate: &&Certificate| certificate.problem_hash == surrogate.provenance.problem_hash;
    let valid: Vec<&Certificate> = surrogate.certificates.iter().filter(own).collect();
    let most = valid.iter().map(|certificate| certificate.samples).max()?;
    let chosen = valid.iter().find(|certificate| certificate.samples == most)?;
    Some((chosen, valid.len()))
}

fn verified_bound(surrogate: &Surrogate) -> Option<VerifiedBound> {
    let (certificate, certificates) = chosen(surrogate)?;
    let Certificate { lower, upper, level, samples, seed, marginal, .. } = *certificate;
    Some(VerifiedBound {
        bound: Interval { lower, upper, level },
        samples,
        seed,
        certificates,
        side_level: certificate.strata.as_ref().map(|strata| strata.side_level),
        unstable: marginal.map(|bounds| bounds.unstable),
    })
}

fn assumed_share(certificate: &Certificate) -> Option<AssumedShare> {
    let strata = certificate.strata.as_ref()?;
    let [lower, upper] = strata.rare_side.stable([0.0, strata.if_errors_fall_off.bound.upper()?]);
    let words = [assumed(strata, false)?, assumed(strata, true)?];
    Some(AssumedShare { bound: Interval { lower, upper, level: strata.side_level }, words })
}

impl Confidence {
    /// What leaves how much open: names, values and words.
    pub(super) fn facts(&self, named: Named) -> Vec<(&'static str, String, String)> {
        let ends = |interval: &Interval| match named {
            Named::Unstable => [complement(interval.upper), complement(interval.lower)],
            _ => [interval.lower, interval.upper],
        };
        let range = |interval: &Interval| match ends(interval) {
            [lower, upper] if lower <= 0.0 && upper > 0.0 && named == Named::Unstable => share_below(upper),
            [lower, upper] => share_range(lower, upper),
        };
        let Self { interval, surrogate_band, estimated_error_percent, verified_bound, basis, .. } = self;
        let by = match basis.replicates {
            0 | 1 => format!("{} samples", count(basis.samples)),
            replicates => format!("{replicates} replicates"),
        };
        let interval = if let Named::BesideMarginal(unstable) = &named { unstable } else { interval };
        let mut facts =
            vec![("sampling interval", range(interval), format!("left open by {by}, {}", level(interval.level)))];
        let place = if basis.is_confined { ", in all of the domain" } else { "" };
        // Where rounding decides, a shift of max Re λ says nothing.
        let is_marginal = matches!(named, Named::BesideMarginal(_));
        facts.extend((!is_marginal).then(|| match surrogate_band {
            Some(band) => {
                let words = format!("left open by the fit, {} of points{place}", level(band.level));
                let [lower, upper] = ends(band);
                ("surrogate band", plain_range(lower, upper), words)
            }
            None => ("surrogate band", "unknown".to_owned(), "no point could be left out".to_owned()),
        }));
        if let Some(error) = estimated_error_percent {
            // As a share of all cases, like the row that it belongs to.
            let absolute = 0.01 * error * basis.not_unstable;
            let is_rare = named == Named::Unstable && super::numbers::is_small(1.0 - basis.not_unstable);
            let value = if is_rare { share(absolute) } else { format!("{} %", significant(100.0 * absolute, 2)) };
            let by = if basis.of_modes_left_out { "by left-out modes alone" } else { "by left-out points" };
            facts.push(("estimated error", format!("± {value}"), by.to_owned()));
        }
        facts.push(match verified_bound {
            None if basis.is_confined => ("verified bound", "none for a part of the domain".to_owned(), String::new()),
            None => ("verified bound", "none yet".to_owned(), "pcc certify makes one from fresh runs".to_owned()),
            Some(VerifiedBound { bound, samples, seed, certificates, side_level, unstable }) => {
                let others =
                    if *certificates > 1 { format!(", one of {certificates} certificates") } else { String::new() };
                let holds = side_level.map_or_else(|| level(bound.level), |side| ends_in_words(side, bound.level));
                let words = format!("{holds}, {} fresh model runs, seed {seed}{others}", count(*samples));
                let bound = match (is_marginal, unstable) {
                    (true, &Some([lower, upper])) => share_range(lower, upper),
                    (true, None) => format!("{} stable", range(bound)),
                    _ => range(bound),
                };
                ("verified bound", bound, words)
            }
        });
        facts.extend(self.bound_if_errors_fall_off.as_ref().filter(|_| !is_marginal).map(|assumed| {
            let [stable, unstable] = &assumed.words;
            let bound = if named == Named::Unstable { unstable } else { stable };
            ("if errors fall off", bound.clone(), format!("{}, not verified", level(assumed.bound.level)))
        }));
        facts
    }

    /// The interval alone: what is known of direct computations.
    pub(super) fn sampling(&self, named: Named) -> (&'static str, String, String) {
        self.facts(named).swap_remove(0)
    }
}
