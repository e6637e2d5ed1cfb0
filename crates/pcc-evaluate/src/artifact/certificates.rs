//! Section 9: certificates. Version 2 has bounds of systems that can be marginal, runs that failed, and strata.
//!
//! Files are written with version 1 wherever that can say it. The rules of [`super::v1`] hold: a published body never
//! changes.

use super::v1;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

/// Certificates, in the version that says them.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub enum AnyCertificates {
    /// Of the stability proportion alone, from independent points.
    V1(v1::Certificates),
    /// Others beside them.
    V2(Certificates),
}

/// Section 9, version 2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Certificates2"))]
#[serde(deny_unknown_fields)]
pub struct Certificates {
    /// Oldest first.
    pub certificates: Vec<Certificate>,
}

/// A verified bound, with those of the other shares where some points are marginal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Certificate2"))]
#[serde(deny_unknown_fields)]
pub struct Certificate {
    /// Seed of its points.
    pub seed: u64,
    /// Number of fresh model runs.
    pub samples: u64,
    /// How the points were drawn.
    pub scheme: String,
    /// Points that the surrogate calls stable and the model does not.
    pub falsely_stable: u64,
    /// Points that the model calls stable and the surrogate does not.
    pub falsely_unstable: u64,
    /// Confidence level.
    pub level: f64,
    /// Lower end of the bound on the stability proportion.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
    /// Problem hash of the model that was run.
    pub problem_hash: String,
    /// What else it bounds.
    pub marginal: Option<MarginalBounds>,
    /// Points at which the model failed.
    #[serde(default)]
    pub failed: u64,
    /// How its runs were divided.
    #[serde(default)]
    pub strata: Option<Strata>,
}

/// How the runs were divided by the rarer of stable and not stable, and what follows for it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Strata {
    /// Probability with which each end holds.
    pub side_level: f64,
    /// The side that the runs were divided by.
    pub rare_side: RareSide,
    /// Lower end of the bound on its share.
    pub rare_lower: f64,
    /// Upper end.
    pub rare_upper: f64,
    /// Samples of the surrogate.
    pub surrogate_samples: u64,
    /// Of these on the rare side.
    pub surrogate_rare: u64,
    /// Of these in the layer nearest to it.
    pub surrogate_layer: u64,
    /// The largest distance of the excess from zero in the layer, in 1/s.
    pub layer_depth: f64,
    /// Runs outside the set that the surrogate puts on the rare side.
    pub outside: Runs,
    /// Further ones in the layer.
    pub layer: Runs,
    /// Runs inside the set.
    pub inside: Runs,
    /// Runs outside that are not in the layer.
    pub far_runs: u64,
    /// The part of the predicted margin that the largest error in these ate.
    pub largest_error: f64,
    /// How these errors thin out.
    pub thinning: Vec<Tail>,
    /// What follows if they fall off.
    pub assumed: Assumed,
}

/// The rarer of stable and not stable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RareSide {
    /// Stable points.
    Stable,
    /// Unstable and marginal points.
    NotStable,
}

/// Model runs in a stratum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Runs {
    /// Number of runs.
    pub runs: u64,
    /// Of these on the rare side.
    pub rare: u64,
    /// Of these without an answer.
    pub failed: u64,
}

/// Errors of some size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Tail {
    /// The part of the margin that the error ate.
    pub error: f64,
    /// Runs with such an error or a larger one.
    pub runs: u64,
    /// Runs with one twice as large or larger.
    pub twice: u64,
}

/// An upper bound on the rare share if errors fall off, or why there is none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Assumed {
    /// The bound.
    Upper(f64),
    /// Why there is none.
    Withheld(Withheld),
}

/// Why there is no bound if errors fall off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Withheld {
    /// Model runs failed.
    FailedRuns,
    /// Some points are marginal.
    Marginal,
    /// No run lies outside the layer.
    NoRuns,
    /// A run outside the layer was on the rare side.
    RareFarAway,
    /// Large errors are too frequent.
    NoThinning,
    /// The verified bound is as low.
    NoLower,
}

/// Bounds of the marginal and of the unstable share.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MarginalBounds {
    /// Points that the surrogate calls marginal and the model does not.
    pub falsely_marginal: u64,
    /// Lower end of the bound on the marginal share.
    pub marginal_lower: f64,
    /// Its upper end.
    pub marginal_upper: f64,
    /// Lower end of the bound on the unstable share.
    pub unstable_lower: f64,
    /// Its upper end.
    pub unstable_upper: f64,
}

impl<'de> Deserialize<'de> for AnyCertificates {
    /// Version 2 is told by a certificate that says something that version 1 cannot.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // What version 1 does not have may be missing in JSON.
        Certificates::deserialize(deserializer).map(|latest| Self::of(latest.certificates))
    }
}

impl From<v1::Certificate> for Certificate {
    fn from(certificate: v1::Certificate) -> Self {
        let v1::Certificate {
            seed,
            samples,
            scheme,
            falsely_stable,
            falsely_unstable,
            level,
            lower,
            upper,
            problem_hash,
        } = certificate;
        Self {
            seed,
            samples,
            scheme,
            falsely_stable,
            falsely_unstable,
            level,
            lower,
            upper,
            problem_hash,
            marginal: None,
            failed: 0,
            strata: None,
        }
    }
}

impl AnyCertificates {
    /// Certificates in the lowest version that says them.
    pub(super) fn of(certificates: Vec<Certificate>) -> Self {
        let says_more = |one: &Certificate| one.marginal.is_some() || one.failed > 0 || one.strata.is_some();
        if certificates.iter().any(says_more) {
            return Self::V2(Certificates { certificates });
        }
        let first_version = |certificate: Certificate| v1::Certificate {
            seed: certificate.seed,
            samples: certificate.samples,
            scheme: certificate.scheme,
            falsely_stable: certificate.falsely_stable,
            falsely_unstable: certificate.falsely_unstable,
            level: certificate.level,
            lower: certificate.lower,
            upper: certificate.upper,
            problem_hash: certificate.problem_hash,
        };
        Self::V1(v1::Certificates { certificates: certificates.into_iter().map(first_version).collect() })
    }

    /// All certificates in the words of version 2.
    pub(super) fn into_latest(self) -> Vec<Certificate> {
        match self {
            Self::V1(v1::Certificates { certificates }) => certificates.into_iter().map(Certificate::from).collect(),
            Self::V2(Certificates { certificates }) => certificates,
        }
    }
}
