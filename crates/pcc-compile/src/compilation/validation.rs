//! What runs that no fit has seen say of a surrogate.

use super::trials::is_not_unstable;
use crate::campaign::Run;
use crate::fitting::design::Samples;
use pcc_evaluate::evaluation::{Plan, evaluate_points};
use pcc_evaluate::foundation::{Interrupted, Observer, try_map};
use pcc_evaluate::probability::statistics::Moments;
use pcc_evaluate::surrogate::Surrogate;

/// A surrogate beside runs that its fits have not seen. Shares are those of these runs, which need not lie as the laws
/// of the inputs ask for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Validation {
    /// Their number.
    pub runs: u64,
    /// How many of them are unstable.
    pub unstable: u64,
    /// How many of them the surrogate calls unstable.
    pub predicted_unstable: u64,
    /// How many of them it calls unstable where they are not, or the other way round.
    pub misjudged: u64,
    /// Root of the mean square error of max Re λ, in 1/s.
    pub rms_error: f64,
    /// The largest error of max Re λ, in 1/s.
    pub largest_error: f64,
    /// 1 − mean square error/variance of max Re λ; `None` if that does not vary.
    pub q2: Option<f64>,
}

/// Runs that are evaluated together.
const PART: usize = 4096;

/// Compares a surrogate with `runs` at these standardized points; `None` if there are none.
pub(super) fn validate(
    surrogate: &Surrogate,
    points: &Samples,
    runs: &[Run],
    observer: &dyn Observer,
) -> Result<Option<Validation>, Interrupted> {
    if runs.is_empty() {
        return Ok(None);
    }
    let plan = Plan::new(surrogate);
    let parts = try_map(runs.len().div_ceil(PART), |part| {
        observer.check()?;
        let own: Vec<&[f64]> = (part * PART..runs.len().min((part + 1) * PART)).map(|i| points.point(i)).collect();
        let block = evaluate_points(surrogate, &plan, &own);
        Ok(block.max_re.iter().copied().zip(block.excess.iter().copied()).collect::<Vec<_>>())
    })?;
    let mut found = Validation {
        runs: runs.len() as u64,
        unstable: 0,
        predicted_unstable: 0,
        misjudged: 0,
        rms_error: 0.0,
        largest_error: 0.0,
        q2: None,
    };
    for ((max_re, excess), run) in parts.into_iter().flatten().zip(runs) {
        let [is_unstable, is_called_so] = [run.spectrum.top().excess, excess].map(|excess| !is_not_unstable(excess));
        found.unstable += u64::from(is_unstable);
        found.predicted_unstable += u64::from(is_called_so);
        found.misjudged += u64::from(is_unstable != is_called_so);
        let error = max_re - run.spectrum.max_re();
        found.rms_error += error * error / runs.len() as f64;
        found.largest_error = found.largest_error.max(error.abs());
    }
    let exact: Vec<f64> = runs.iter().map(|run| run.spectrum.max_re()).collect();
    // The mean square distance from the mean of these runs, not the variance of a law.
    let spread = Moments::of(&exact).variance() * (runs.len() as f64 - 1.0) / runs.len() as f64;
    found.q2 = Some(1.0 - found.rms_error / spread).filter(|q2| q2.is_finite());
    found.rms_error = found.rms_error.sqrt();
    Ok(Some(found))
}
