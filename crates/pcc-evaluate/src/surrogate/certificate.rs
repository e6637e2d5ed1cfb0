//! What fresh model runs said of a surrogate.

use serde::Serialize;

/// Verified bounds of the marginal and of the unstable share, each at the level of the certificate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MarginalBounds {
    /// Points that the surrogate calls marginal and the model does not.
    pub falsely_marginal: u64,
    /// Lower and upper end of the bound on the marginal share.
    pub marginal: [f64; 2],
    /// Of the bound on the unstable share.
    pub unstable: [f64; 2],
}

/// A verified bound on the stability proportion. Reports serialise it; surrogate files have a type of their own.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Certificate {
    /// Seed of its points.
    pub seed: u64,
    /// Number of fresh model runs, all strata together.
    pub samples: u64,
    /// How the points were drawn: "strata", or by earlier versions "independent".
    pub scheme: String,
    /// Points that the surrogate calls stable and the model does not.
    pub falsely_stable: u64,
    /// Points that the model calls stable and the surrogate does not.
    pub falsely_unstable: u64,
    /// Points at which the model failed; the bound holds whatever it would have answered there.
    pub failed: u64,
    /// Probability with which both ends hold together.
    pub level: f64,
    /// Lower end of the bound on the stability proportion.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
    /// Bounds of the other shares, where some points are neither stable nor unstable.
    #[serde(flatten)]
    pub marginal: Option<MarginalBounds>,
    /// How the runs were divided, and what follows for the rarer side; absent from certificates of independent points.
    #[serde(flatten)]
    pub strata: Option<Strata>,
    /// `pcc_compile::study::Study::problem_hash` of the model that was run.
    #[serde(skip_serializing)]
    pub problem_hash: String,
}

/// The rarer of stable and not stable, by the surrogate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RareSide {
    /// Stable points.
    Stable,
    /// All others: unstable and marginal ones.
    NotStable,
}

impl RareSide {
    /// An excess, in 1/s, with the sign at which points on this side are not negative.
    pub fn towards(self, excess: f64) -> f64 {
        match self {
            Self::Stable => -excess,
            Self::NotStable => excess,
        }
    }

    /// Whether a point with this excess, in 1/s, lies on this side: stable is below zero.
    pub fn holds(self, excess: f64) -> bool {
        match self {
            Self::Stable => excess < 0.0,
            Self::NotStable => excess >= 0.0,
        }
    }

    /// The share of stable points, given an interval of the share of this side.
    pub fn stable(self, [lower, upper]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Stable => [lower, upper],
            Self::NotStable => [1.0 - upper, 1.0 - lower],
        }
    }
}

/// How the runs of a certificate were divided, and what follows for the rarer side.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Strata {
    /// Probability with which each end alone holds.
    pub side_level: f64,
    /// The side that the runs were divided by.
    pub rare_side: RareSide,
    /// Lower end of the bound on its share.
    pub rare_lower: f64,
    /// Upper end.
    pub rare_upper: f64,
    /// What samples of the surrogate say.
    pub surrogate: SampledStrata,
    /// Runs outside the set that the surrogate puts on the rare side.
    pub outside: StratumRuns,
    /// Further runs outside it, in the layer nearest to it.
    pub layer: StratumRuns,
    /// Runs inside the set.
    pub inside: StratumRuns,
    /// The second line, which is not verified.
    pub if_errors_fall_off: FallingErrors,
}

/// Strata among samples of the surrogate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SampledStrata {
    /// Number of samples.
    pub samples: u64,
    /// Of these on the rare side.
    pub rare: u64,
    /// Of these in the layer.
    pub layer: u64,
    /// The largest distance of |max Re λ + margin| from zero in the layer, in 1/s.
    pub layer_depth: f64,
}

/// Model runs in a stratum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StratumRuns {
    /// Number of runs.
    pub runs: u64,
    /// Of these on the rare side, by the model.
    pub rare: u64,
    /// Of these without an answer.
    pub failed: u64,
}

/// An upper bound on the share of the rare side if an error that eats twice as much of the margin is at most half as
/// frequent, outside the layer.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FallingErrors {
    /// Runs outside the layer.
    pub runs: u64,
    /// The part of the predicted margin that the largest error in these runs ate.
    pub largest_error: f64,
    /// How errors thin out.
    pub thinning: Vec<ErrorTail>,
    /// The bound, or why there is none.
    #[serde(flatten)]
    pub bound: AssumedBound,
}

/// Errors of some size in runs outside the layer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ErrorTail {
    /// The part of the margin that the error ate.
    pub error: f64,
    /// Runs with such an error or a larger one.
    pub runs: u64,
    /// Runs with one twice as large or larger.
    pub twice: u64,
}

/// A bound that rests on an assumption.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum AssumedBound {
    /// The share of the rare side is at most this, with the probability of one end.
    Upper(f64),
    /// There is none.
    Withheld(Withheld),
}

/// Why there is no bound if errors fall off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Withheld {
    /// Model runs failed, and their errors are not known.
    FailedRuns,
    /// Some points are marginal, and their distance from the boundary says nothing.
    Marginal,
    /// No run lies outside the layer.
    NoRuns,
    /// A run outside the layer was on the rare side.
    RareFarAway,
    /// Large errors are too frequent for the assumption.
    NoThinning,
    /// The verified bound is as low: an assumption would gain nothing.
    NoLower,
}

impl AssumedBound {
    /// The bound, if there is one.
    pub fn upper(self) -> Option<f64> {
        match self {
            Self::Upper(upper) => Some(upper),
            Self::Withheld(_) => None,
        }
    }
}

impl Withheld {
    /// In words.
    pub fn describe(self) -> &'static str {
        match self {
            Self::FailedRuns => "runs failed, and their errors are not known",
            Self::Marginal => "some points are marginal",
            Self::NoRuns => "no run lies outside the layer at the boundary",
            Self::RareFarAway => "a run far from the boundary was on its other side",
            Self::NoThinning => "large errors are too frequent",
            Self::NoLower => "it is not below the verified bound",
        }
    }
}
