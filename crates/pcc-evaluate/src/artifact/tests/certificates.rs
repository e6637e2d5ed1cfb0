//! Certificates with strata survive a file, and those that cannot be are refused.

use super::{SURROGATE, section_of};
use crate::artifact::{Format, decode, encode};
use crate::surrogate::{
    AssumedBound, Certificate, ErrorTail, FallingErrors, RareSide, SampledStrata, Strata, StratumRuns, Surrogate,
    Withheld,
};

fn certified(change: impl FnOnce(&mut Certificate, &mut Strata)) -> Surrogate {
    let mut strata = Strata {
        side_level: 0.95,
        rare_side: RareSide::NotStable,
        rare_lower: 0.0009,
        rare_upper: 0.0112,
        surrogate: SampledStrata { samples: 10_485_760, rare: 10_480, layer: 20_970, layer_depth: 0.25 },
        outside: StratumRuns { runs: 300, rare: 0, failed: 2 },
        layer: StratumRuns { runs: 100, rare: 1, failed: 0 },
        inside: StratumRuns { runs: 50, rare: 49, failed: 1 },
        if_errors_fall_off: FallingErrors {
            runs: 297,
            largest_error: 0.02,
            thinning: vec![ErrorTail { error: 0.004, runs: 75, twice: 12 }],
            bound: AssumedBound::Upper(0.0017),
        },
    };
    let mut certificate = Certificate {
        seed: 1,
        samples: 450,
        scheme: "strata".to_owned(),
        falsely_stable: 1,
        falsely_unstable: 0,
        failed: 3,
        level: 0.9,
        lower: 0.9888,
        upper: 0.9991,
        marginal: None,
        strata: None,
        problem_hash: SURROGATE.provenance.problem_hash.clone(),
    };
    change(&mut certificate, &mut strata);
    certificate.strata = Some(strata);
    Surrogate { certificates: vec![certificate], ..SURROGATE.clone() }
}

#[test]
fn strata_survive_both_formats() {
    let withheld = certified(|_, strata| {
        strata.if_errors_fall_off.bound = AssumedBound::Withheld(Withheld::FailedRuns);
        strata.rare_side = RareSide::Stable;
    });
    for surrogate in [certified(|_, _| {}), withheld] {
        for format in [Format::Binary, Format::Json] {
            let artifact = decode(&encode(&surrogate, format).unwrap()).unwrap();
            assert!(artifact.surrogate == surrogate && artifact.is_canonical && artifact.version == (1, 3));
        }
    }
}

#[test]
fn strata_that_cannot_be_are_refused() {
    let wrong: [fn(&mut Certificate, &mut Strata); 14] = [
        |certificate, _| certificate.samples = 451,
        |certificate, _| certificate.failed = 2,
        |_, strata| strata.side_level = 1.0,
        |_, strata| strata.rare_lower = 0.5,
        |_, strata| strata.rare_upper = 1.5,
        |_, strata| strata.surrogate.samples = 100,
        |_, strata| strata.surrogate.rare = u64::MAX,
        |_, strata| strata.outside.rare = 299,
        |_, strata| strata.inside.rare = u64::MAX,
        |_, strata| strata.surrogate.layer_depth = -1.0,
        |_, strata| strata.if_errors_fall_off.runs = 301,
        |_, strata| strata.if_errors_fall_off.largest_error = -0.1,
        |_, strata| strata.if_errors_fall_off.thinning[0].twice = 76,
        |_, strata| strata.if_errors_fall_off.bound = AssumedBound::Upper(-0.1),
    ];
    for change in wrong {
        let bytes = encode(&certified(change), Format::Binary).unwrap();
        assert_eq!(section_of(decode(&bytes).unwrap_err()), "certificates");
    }
    let infinite = certified(|_, strata| strata.if_errors_fall_off.largest_error = f64::INFINITY);
    assert!(encode(&infinite, Format::Binary).is_err());
}
