//! A verified bound on the stability proportion: fresh model runs against the surrogate.

use super::monte_carlo::{ReferenceError, run_points};
use crate::design::Runner;
use crate::eval::{self, EvalError, Plan, evaluate_points};
use crate::input::random_point;
use crate::progress::Observer;
use crate::random::Purpose;
use crate::statistics::{Discordance, Interval};
use crate::study::Study;
use crate::surrogate::{Certificate, Surrogate};

/// How the fresh points are drawn, as certificates say it.
const SCHEME: &str = "independent";

/// Samples of the surrogate from which its own proportion is known: their interval is a tenth of a percent wide.
const SURROGATE_SAMPLES: u64 = 1_000_000;

/// Points that are run together.
const CHUNK: u64 = 4096;

/// Runs the model of `study` at `runs` fresh points and bounds its stability proportion from those at which `surrogate`
/// disagrees ([`Discordance::bound`]).
///
/// The points belong to a purpose of their own: they are independent of the design and of all evaluation points,
/// whatever the seeds. The certificate is to be added to those the surrogate has; choosing among seeds by their result
/// would void its level, so all of them stay visible.
///
/// # Errors
///
/// [`ReferenceError`]. Whether the study asks what the surrogate answers is for the caller to decide; inputs
/// must agree, or [`ReferenceError::OtherProblem`] is returned.
pub fn certify(
    surrogate: &Surrogate,
    study: &Study,
    runs: u64,
    seed: u64,
    level: f64,
    observer: &dyn Observer,
) -> Result<Certificate, ReferenceError> {
    if runs == 0 {
        return Err(ReferenceError::NoSamples);
    }
    if surrogate.inputs != study.inputs {
        return Err(ReferenceError::other_problem(surrogate, study));
    }
    let plan = Plan::new(surrogate);
    let mut discordance = Discordance { samples: runs, falsely_stable: 0, falsely_unstable: 0 };
    let mut runner = Runner::new(study)?;
    observer.begin("model runs", runs);
    for start in (0..runs).step_by(CHUNK as usize) {
        let points: Vec<Vec<f64>> = (start..runs.min(start + CHUNK))
            .map(|index| {
                let mut point = vec![0.0; study.inputs.dimension()];
                random_point(&study.inputs, seed, Purpose::Certification, index, &mut point);
                point
            })
            .collect();
        let found = run_points(study, &mut runner, &points, observer)?;
        let block = evaluate_points(surrogate, &plan, &points.iter().map(Vec::as_slice).collect::<Vec<_>>());
        if let Some(at) = block.first_not_finite() {
            let point = study.inputs.describe(&study.inputs.physical(&points[at]));
            return Err(ReferenceError::NotFinite { point });
        }
        for (run, &max_re) in found.iter().zip(&block.max_re) {
            let (model, predicted) = (run.spectrum.max_re() < 0.0, max_re < 0.0);
            discordance.falsely_stable += u64::from(predicted && !model);
            discordance.falsely_unstable += u64::from(model && !predicted);
        }
    }
    observer.finish();
    let summary = eval::monte_carlo(surrogate, SURROGATE_SAMPLES, seed, observer).map_err(|error| match error {
        EvalError::Interrupted(interrupted) => ReferenceError::Run(interrupted.into()),
        other => ReferenceError::Surrogate(other),
    })?;
    let Interval { lower, upper, level } = discordance.bound(summary.stable_proportion(), level);
    Ok(Certificate {
        seed,
        samples: runs,
        scheme: SCHEME.to_owned(),
        falsely_stable: discordance.falsely_stable,
        falsely_unstable: discordance.falsely_unstable,
        level,
        lower,
        upper,
        problem_hash: study.problem_hash(),
    })
}
