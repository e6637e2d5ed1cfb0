//! A verified bound on the stability proportion: fresh model runs against the surrogate.

use super::compare::Verdicts;
use super::direct_computations::{ReferenceError, for_each_chunk, surrogate_block};
use crate::campaign::Campaign;
use pcc_evaluate::evaluation::{EvalError, Plan, monte_carlo};
use pcc_evaluate::foundation::Observer;
use pcc_evaluate::probability::random::Purpose;
use pcc_evaluate::probability::statistics::{Interval, Proportion};
use pcc_evaluate::surrogate::{Certificate, MarginalBounds, Surrogate};

/// How the fresh points are drawn, as certificates say it.
const SCHEME: &str = "independent";

/// Samples of the surrogate from which its own proportion is known: their interval is a tenth of a percent wide.
const SURROGATE_SAMPLES: u64 = 1_000_000;

/// Runs the model of a study, or of a campaign that keeps books of its runs, at `runs` fresh points and bounds its
/// stability proportion from those at which `surrogate` disagrees
/// ([`pcc_evaluate::probability::statistics::DiscordantCounts::bound`]).
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
    if !surrogate.inputs.is_same_as(&study.inputs) {
        return Err(ReferenceError::other_problem(surrogate, study));
    }
    let plan = Plan::new(surrogate);
    let mut verdicts = Verdicts::default();
    for_each_chunk(campaign, runs, seed, Purpose::Certification, observer, |points, found, failed| {
        verdicts.count_failures(&surrogate_block(surrogate, &plan, failed)?);
        let block = surrogate_block(surrogate, &plan, points)?;
        verdicts.classify_strictly(found.iter().map(|run| run.spectrum.top().excess), &block);
        Ok(())
    })?;
    let summary = monte_carlo(surrogate, SURROGATE_SAMPLES, seed, observer).map_err(|error| match error {
        EvalError::Interrupted(interrupted) => ReferenceError::Run(interrupted.into()),
        other => ReferenceError::Surrogate(other),
    })?;
    let counts = verdicts.of_stable();
    let Interval { lower, upper, .. } = counts.bound(summary.stable_proportion(), level);
    let proportion = |hits: u64| Proportion { hits, samples: summary.samples() };
    let bounds = verdicts.has_marginal() || summary.marginal() > 0;
    let marginal = bounds.then(|| {
        let marginal = verdicts.of_marginal().bound(proportion(summary.marginal()), level);
        let unstable = verdicts.of_unstable().bound(proportion(summary.unstable), level);
        MarginalBounds {
            falsely_marginal: verdicts.of_marginal().falsely_claimed,
            marginal: [marginal.lower, marginal.upper],
            unstable: [unstable.lower, unstable.upper],
        }
    });
    Ok(Certificate {
        seed,
        samples: runs,
        scheme: SCHEME.to_owned(),
        falsely_stable: counts.falsely_claimed,
        falsely_unstable: counts.falsely_denied,
        failed: verdicts.failed(),
        level,
        lower,
        upper,
        marginal,
        problem_hash: study.problem_hash(),
    })
}
