//! How sure a proportion is: what sampling leaves open, what the surrogate leaves open, and what is verified.

use super::survey::LEVEL;
use pcc_evaluate::foundation::count;
use pcc_evaluate::probability::statistics::{Interval, Proportion};
use pcc_evaluate::surrogate::{Certificate, Decision, Surrogate};
use serde::Serialize;
use std::fmt;

/// Answers to "how sure?", each about something else.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Confidence {
    /// Wilson interval of the share: what the finite number of samples leaves open.
    pub interval: Interval,
    /// The share if max Re λ were larger or smaller by its residuals' central quantiles: what the surrogate leaves
    /// open; null if unknown.
    pub surrogate_band: Option<Interval>,
    /// Estimated relative error of the proportion; null if unknown.
    pub estimated_error_percent: Option<f64>,
    /// The certificate with the most model runs, the first of equals; null if there is none.
    pub verified_bound: Option<VerifiedBound>,
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
    /// Whether the samples are from a part of the domain alone.
    pub is_confined: bool,
    /// Whether the estimated error is the part of modes left out alone, because there was one design level.
    pub of_modes_left_out: bool,
}

/// A bound from fresh model runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
}

impl Confidence {
    /// `stable` counts the stable samples, `if_shifted` those that would be if max Re λ were larger by the lower, and
    /// by the upper, end of the band.
    pub fn new(surrogate: &Surrogate, stable: Proportion, if_shifted: [u64; 2], interval: Interval) -> Self {
        let decision = &surrogate.decision;
        let share = |hits| Proportion { hits, samples: stable.samples }.value();
        let band = Interval { lower: share(if_shifted[1]), upper: share(if_shifted[0]), level: Decision::BAND_LEVEL };
        Self {
            interval,
            surrogate_band: (!decision.max_re_residuals.is_empty()).then_some(band),
            estimated_error_percent: decision.proportion_error.map(|error| 100.0 * error),
            verified_bound: verified_bound(surrogate),
            basis: Basis {
                samples: stable.samples,
                replicates: 1,
                is_confined: false,
                of_modes_left_out: is_of_modes_left_out(surrogate),
            },
        }
    }

    /// Of direct computations, which leave open what their number does.
    pub(super) fn of_model(stable: Proportion) -> Self {
        Self {
            interval: stable.wilson(LEVEL),
            surrogate_band: None,
            estimated_error_percent: None,
            verified_bound: None,
            basis: Basis { samples: stable.samples, replicates: 1, is_confined: false, of_modes_left_out: false },
        }
    }

    /// What to say first where a certificate excludes the share of the surrogate.
    pub(super) fn contradiction(surrogate: &Surrogate, share: f64) -> Option<String> {
        let own = |certificate: &&Certificate| certificate.problem_hash == surrogate.provenance.problem_hash;
        let excludes = |certificate: &&Certificate| share < certificate.lower || share > certificate.upper;
        let certificate = surrogate.certificates.iter().filter(own).find(excludes)?;
        let bound = Interval { lower: certificate.lower, upper: certificate.upper, level: certificate.level };
        Some(format!(
            "a certificate contradicts the surrogate: by {} fresh model runs {} to {} are stable, not {}; trust the certificate, and \
             build with more runs",
            count(certificate.samples),
            percent(bound.lower),
            percent(bound.upper),
            percent(share)
        ))
    }

    /// Takes back what is known of the whole domain only.
    pub(super) fn confine(&mut self) {
        self.basis.is_confined = true;
        self.estimated_error_percent = None;
        self.verified_bound = None;
    }
}

/// Whether the estimated error of a surrogate is the part of modes left out alone: the rest takes two design levels,
/// and points left out.
pub(super) fn is_of_modes_left_out(surrogate: &Surrogate) -> bool {
    surrogate.training.levels.len() == 1 || super::build::is_quadrature(surrogate)
}

/// What an estimated error of so many percent says.
pub(super) fn error_text(percent: f64, of_modes_left_out: bool) -> String {
    let percent = super::significant(percent, 2);
    match of_modes_left_out {
        true => format!("modes left out alone may move it by {percent} %"),
        false => format!("estimated error {percent} % of the proportion"),
    }
}

fn verified_bound(surrogate: &Surrogate) -> Option<VerifiedBound> {
    let own = |certificate: &&Certificate| certificate.problem_hash == surrogate.provenance.problem_hash;
    let valid: Vec<&Certificate> = surrogate.certificates.iter().filter(own).collect();
    let most = valid.iter().map(|certificate| certificate.samples).max()?;
    let chosen = valid.iter().find(|certificate| certificate.samples == most)?;
    let Certificate { lower, upper, level, samples, seed, .. } = **chosen;
    Some(VerifiedBound { bound: Interval { lower, upper, level }, samples, seed, certificates: valid.len() })
}

fn percent(share: f64) -> String {
    format!("{:.3} %", 100.0 * share)
}

impl Confidence {
    /// The three lines: what each is about, and what it says.
    pub(super) fn facts(&self) -> [(&'static str, String); 3] {
        let range = |interval: &Interval| format!("{} to {}", percent(interval.lower), percent(interval.upper));
        let level = |interval: &Interval| format!("{:.0} %", 100.0 * interval.level);
        let Self { interval, surrogate_band, verified_bound, .. } = self;
        let sampling = match self.basis.replicates {
            0 | 1 => format!("{}   {}, from {} samples", range(interval), level(interval), count(self.basis.samples)),
            replicates => format!("{}   {}, from {replicates} replicates", range(interval), level(interval)),
        };
        let band = match (surrogate_band, self.estimated_error_percent) {
            (None, None) => "unknown: no point could be left out".to_owned(),
            (None, Some(error)) => {
                format!("unknown: no point could be left out; {}", error_text(error, self.basis.of_modes_left_out))
            }
            (Some(band), error) => {
                let error = error
                    .map_or(String::new(), |error| format!("; {}", error_text(error, self.basis.of_modes_left_out)));
                let place = if self.basis.is_confined { " in all of the domain" } else { "" };
                format!("{}   {} of points left out{place}{error}", range(band), level(band))
            }
        };
        let verified = match verified_bound {
            None if self.basis.is_confined => "none for a part of the domain".to_owned(),
            None => "none; `pcc certify` makes one from fresh model runs".to_owned(),
            Some(VerifiedBound { bound, samples, seed, certificates }) => {
                let others =
                    if *certificates > 1 { format!(", one of {certificates} certificates") } else { String::new() };
                format!(
                    "{}   {}, {} fresh model runs, seed {seed}{others}",
                    range(bound),
                    level(bound),
                    count(*samples)
                )
            }
        };
        [("sampling interval", sampling), ("surrogate band", band), ("verified bound", verified)]
    }
}

impl fmt::Display for Confidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.facts().iter().try_for_each(|(name, fact)| writeln!(f, "  {name:<22} {fact}"))
    }
}
