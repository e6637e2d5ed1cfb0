//! A verified bound on the stability proportion: fresh model runs against the surrogate.

use super::direct_computations::{ReferenceError, for_each_chunk, surrogate_block};
use crate::campaign::Campaign;
use pcc_evaluate::evaluation::{EvalError, Plan, monte_carlo};
use pcc_evaluate::foundation::Observer;
use pcc_evaluate::probability::random::Purpose;
use pcc_evaluate::probability::statistics::{DiscordantCounts, Interval};
use pcc_evaluate::surrogate::{Certificate, Surrogate};

/// How the fresh points are drawn, as certificates say it.
const SCHEME: &str = "independent";

/// Samples of the surrogate from which its own proportion is known: their interval is a tenth of a percent wide.
const SURROGATE_SAMPLES: u64 = 1_000_000;

/// Runs the model of a study, or of a campaign that keeps books of its runs, at `runs` fresh points and bounds its
/// stability proportion from those at which `surrogate` disagrees ([`DiscordantCounts::bound`]).
///
/// The points belong to a purpose of their own: they are independent of the design and of all evaluation points,
/// whatever the seeds. The certificate is to be added to those the surrogate has; choosing among seeds by their result
/// would void its level, so all of them stay visible.
///
/// # Errors
///
/// [`ReferenceError`]. Whether the study asks what the surrogate answers is for the caller to decide; inputs
/// must agree, or [`ReferenceError::OtherProblem`] is returned.
pub fn certify_with_model<'a>(
    surrogate: &Surrogate,
    campaign: impl Into<Campaign<'a>>,
    runs: u64,
    seed: u64,
    level: f64,
    observer: &dyn Observer,
) -> Result<Certificate, ReferenceError> {
    let campaign = campaign.into();
    let study = campaign.study;
    if surrogate.inputs != study.inputs {
        return Err(ReferenceError::other_problem(surrogate, study));
    }
    let plan = Plan::new(surrogate);
    let mut counts = DiscordantCounts { samples: runs, falsely_stable: 0, falsely_unstable: 0 };
    for_each_chunk(campaign, runs, seed, Purpose::Certification, observer, |points, found| {
        let block = surrogate_block(surrogate, &plan, points)?;
        for (run, &max_re) in found.iter().zip(&block.max_re) {
            let (model, predicted) = (run.spectrum.max_re() < 0.0, max_re < 0.0);
            counts.falsely_stable += u64::from(predicted && !model);
            counts.falsely_unstable += u64::from(model && !predicted);
        }
        Ok(())
    })?;
    let summary = monte_carlo(surrogate, SURROGATE_SAMPLES, seed, observer).map_err(|error| match error {
        EvalError::Interrupted(interrupted) => ReferenceError::Run(interrupted.into()),
        other => ReferenceError::Surrogate(other),
    })?;
    let Interval { lower, upper, level } = counts.bound(summary.stable_proportion(), level);
    Ok(Certificate {
        seed,
        samples: runs,
        scheme: SCHEME.to_owned(),
        falsely_stable: counts.falsely_stable,
        falsely_unstable: counts.falsely_unstable,
        level,
        lower,
        upper,
        problem_hash: study.problem_hash(),
    })
}
