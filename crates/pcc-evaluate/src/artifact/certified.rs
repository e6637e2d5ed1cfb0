//! Certificates of a surrogate as section 9, and back.

use super::certificates::{self as wire, AnyCertificates};
use super::error::ReadError;
use super::meaning::{ensure, is_hash};
use crate::surrogate::{
    AssumedBound, Certificate, ErrorTail, FallingErrors, MarginalBounds, RareSide, SampledStrata, Strata, StratumRuns,
    Withheld,
};

/// The section, in the lowest version that says it; none without certificates.
pub(super) fn section(certificates: &[Certificate]) -> Option<AnyCertificates> {
    let stored = certificates.iter().map(stored).collect();
    (!certificates.is_empty()).then(|| AnyCertificates::of(stored))
}

fn stored(certificate: &Certificate) -> wire::Certificate {
    let bounds = |bounds: MarginalBounds| wire::MarginalBounds {
        falsely_marginal: bounds.falsely_marginal,
        marginal_lower: bounds.marginal[0],
        marginal_upper: bounds.marginal[1],
        unstable_lower: bounds.unstable[0],
        unstable_upper: bounds.unstable[1],
    };
    wire::Certificate {
        seed: certificate.seed,
        samples: certificate.samples,
        scheme: certificate.scheme.clone(),
        falsely_stable: certificate.falsely_stable,
        falsely_unstable: certificate.falsely_unstable,
        level: certificate.level,
        lower: certificate.lower,
        upper: certificate.upper,
        problem_hash: certificate.problem_hash.clone(),
        marginal: certificate.marginal.map(bounds),
        failed: certificate.failed,
        strata: certificate.strata.as_ref().map(stored_strata),
    }
}

fn stored_strata(strata: &Strata) -> wire::Strata {
    let Strata { surrogate, if_errors_fall_off: falling, .. } = strata;
    let runs = |StratumRuns { runs, rare, failed }: StratumRuns| wire::Runs { runs, rare, failed };
    let tail = |&ErrorTail { error, runs, twice }: &ErrorTail| wire::Tail { error, runs, twice };
    wire::Strata {
        side_level: strata.side_level,
        rare_side: match strata.rare_side {
            RareSide::Stable => wire::RareSide::Stable,
            RareSide::NotStable => wire::RareSide::NotStable,
        },
        rare_lower: strata.rare_lower,
        rare_upper: strata.rare_upper,
        surrogate_samples: surrogate.samples,
        surrogate_rare: surrogate.rare,
        surrogate_layer: surrogate.layer,
        layer_depth: surrogate.layer_depth,
        outside: runs(strata.outside),
        layer: runs(strata.layer),
        inside: runs(strata.inside),
        far_runs: falling.runs,
        largest_error: falling.largest_error,
        thinning: falling.thinning.iter().map(tail).collect(),
        assumed: match falling.bound {
            AssumedBound::Upper(upper) => wire::Assumed::Upper(upper),
            AssumedBound::Withheld(reason) => wire::Assumed::Withheld(match reason {
                Withheld::FailedRuns => wire::Withheld::FailedRuns,
                Withheld::Marginal => wire::Withheld::Marginal,
                Withheld::NoRuns => wire::Withheld::NoRuns,
                Withheld::RareFarAway => wire::Withheld::RareFarAway,
                Withheld::NoThinning => wire::Withheld::NoThinning,
                Withheld::NoLower => wire::Withheld::NoLower,
            }),
        },
    }
}

/// The certificates of a section, if all of them can be.
pub(super) fn certificates(section: Option<AnyCertificates>) -> Result<Vec<Certificate>, ReadError> {
    let Some(section) = section else { return Ok(Vec::new()) };
    let certificates = section.into_latest();
    ensure("certificates", !certificates.is_empty(), || "the section is there but empty".to_owned())?;
    certificates.into_iter().map(certificate).collect()
}

/// Whether these are ends of an interval of a share.
fn is_bound(lower: f64, upper: f64) -> bool {
    0.0 <= lower && lower <= upper && upper <= 1.0
}

fn is_level(level: f64) -> bool {
    0.0 < level && level < 1.0
}

fn certificate(certificate: wire::Certificate) -> Result<Certificate, ReadError> {
    let wire::Certificate { level, lower, upper, samples, .. } = certificate;
    let discordant = certificate.falsely_stable.checked_add(certificate.falsely_unstable);
    let discordant = discordant.and_then(|discordant| discordant.checked_add(certificate.failed));
    let are_bounds = |bounds: &wire::MarginalBounds| {
        is_bound(bounds.marginal_lower, bounds.marginal_upper)
            && is_bound(bounds.unstable_lower, bounds.unstable_upper)
            && bounds.falsely_marginal <= samples
    };
    let sensible = is_level(level)
        && is_bound(lower, upper)
        && discordant.is_some_and(|discordant| discordant <= samples)
        && certificate.marginal.as_ref().is_none_or(are_bounds)
        && certificate.strata.as_ref().is_none_or(|strata| are_sensible(strata, &certificate))
        && is_hash(&certificate.problem_hash);
    ensure("certificates", sensible, || "level, bound, counts or hash are out of range".to_owned())?;
    Ok(Certificate {
        seed: certificate.seed,
        samples,
        scheme: certificate.scheme,
        falsely_stable: certificate.falsely_stable,
        falsely_unstable: certificate.falsely_unstable,
        failed: certificate.failed,
        level,
        lower,
        upper,
        marginal: certificate.marginal.map(|bounds| MarginalBounds {
            falsely_marginal: bounds.falsely_marginal,
            marginal: [bounds.marginal_lower, bounds.marginal_upper],
            unstable: [bounds.unstable_lower, bounds.unstable_upper],
        }),
        strata: certificate.strata.map(strata),
        problem_hash: certificate.problem_hash,
    })
}

/// Whether the strata can be those of the certificate.
fn are_sensible(strata: &wire::Strata, certificate: &wire::Certificate) -> bool {
    let all = [strata.outside, strata.layer, strata.inside];
    let sum = |count: fn(&wire::Runs) -> u64| all.iter().map(count).try_fold(0u64, u64::checked_add);
    let fits = |runs: &wire::Runs| runs.rare.checked_add(runs.failed).is_some_and(|counted| counted <= runs.runs);
    let is_tail = |tail: &wire::Tail| tail.error > 0.0 && tail.twice <= tail.runs && tail.runs <= strata.far_runs;
    let sampled = strata.surrogate_rare.checked_add(strata.surrogate_layer);
    is_level(strata.side_level)
        && is_bound(strata.rare_lower, strata.rare_upper)
        && sampled.is_some_and(|sampled| sampled <= strata.surrogate_samples)
        && strata.surrogate_samples > 0
        && all.iter().all(fits)
        && sum(|runs| runs.runs) == Some(certificate.samples)
        && sum(|runs| runs.failed) == Some(certificate.failed)
        && strata.layer_depth >= 0.0
        && strata.far_runs <= strata.outside.runs
        && strata.largest_error >= 0.0
        && strata.thinning.iter().all(is_tail)
        && match strata.assumed {
            wire::Assumed::Upper(upper) => is_bound(0.0, upper),
            wire::Assumed::Withheld(_) => true,
        }
}

fn strata(strata: wire::Strata) -> Strata {
    let runs = |wire::Runs { runs, rare, failed }: wire::Runs| StratumRuns { runs, rare, failed };
    let tail = |&wire::Tail { error, runs, twice }: &wire::Tail| ErrorTail { error, runs, twice };
    Strata {
        side_level: strata.side_level,
        rare_side: match strata.rare_side {
            wire::RareSide::Stable => RareSide::Stable,
            wire::RareSide::NotStable => RareSide::NotStable,
        },
        rare_lower: strata.rare_lower,
        rare_upper: strata.rare_upper,
        surrogate: SampledStrata {
            samples: strata.surrogate_samples,
            rare: strata.surrogate_rare,
            layer: strata.surrogate_layer,
            layer_depth: strata.layer_depth,
        },
        outside: runs(strata.outside),
        layer: runs(strata.layer),
        inside: runs(strata.inside),
        if_errors_fall_off: FallingErrors {
            runs: strata.far_runs,
            largest_error: strata.largest_error,
            thinning: strata.thinning.iter().map(tail).collect(),
            bound: match strata.assumed {
                wire::Assumed::Upper(upper) => AssumedBound::Upper(upper),
                wire::Assumed::Withheld(reason) => AssumedBound::Withheld(match reason {
                    wire::Withheld::FailedRuns => Withheld::FailedRuns,
                    wire::Withheld::Marginal => Withheld::Marginal,
                    wire::Withheld::NoRuns => Withheld::NoRuns,
                    wire::Withheld::RareFarAway => Withheld::RareFarAway,
                    wire::Withheld::NoThinning => Withheld::NoThinning,
                    wire::Withheld::NoLower => Withheld::NoLower,
                }),
            },
        },
    }
}
