//! Eigenvalues that go to infinity inside the ranges of the inputs: where a mass or a time constant vanishes.
//!
//! No polynomial follows a group with such an eigenvalue, however many runs there are, and a build would not end. But
//! the reciprocal of the product of the group's eigenvalues is smooth there, and passes through zero. So where a group
//! is predicted badly, this reciprocal is fitted by way of trial. If it is predicted well, and is zero at some of the
//! points at which shares are judged, the eigenvalue goes to infinity there. Of inputs without bounds, these points lie
//! between runs: in tails beyond all runs, an expansion of what falls to zero far out passes through zero by itself.

use super::group_fits::{Followed, GroupFits};
use super::judged_points::{POINTS, at_judged_points, judged_point};
use crate::fitting::design::Samples;
use crate::mechanics::spectrum::{Group, Numbers, output};
use crate::study::Study;
use nalgebra::Complex;
use pcc_evaluate::components::OutputKind;
use pcc_evaluate::foundation::{Interrupted, Observer};
use pcc_evaluate::probability::statistics::Moments;
use pcc_evaluate::surrogate::TrainedDomain;

/// Groups with a lower score are predicted well enough to be finite.
const BAD: f64 = 0.05;

/// Left-out residuals above this share of what is to be known are no good prediction.
const GOOD: f64 = 0.1;

/// Reciprocals below this share of their spread are zero.
const ZERO: f64 = 1e-4;

/// The point, in physical units, next to which an eigenvalue of one of the groups goes to infinity.
pub(super) fn infinite_near(
    study: &Study,
    followed: &Followed<'_>,
    grouping: &[Group],
    fits: &GroupFits<'_>,
    observer: &dyn Observer,
) -> Result<Option<Vec<f64>>, Interrupted> {
    let is_bad = |group: &&Group| fits.get(group).is_none_or(|fit| fit.score > BAD);
    for group in grouping.iter().filter(is_bad) {
        let eigenvalues = followed.eigenvalues(&followed.groups.closed(group));
        if let Some(point) = infinite_in(study, followed.samples, &eigenvalues, fits, observer)? {
            return Ok(Some(point));
        }
    }
    Ok(None)
}

/// The same for a group with these eigenvalues, closed under conjugation, at every run.
fn infinite_in(
    study: &Study,
    samples: &Samples,
    eigenvalues: &[Vec<Complex<f64>>],
    fits: &GroupFits<'_>,
    observer: &dyn Observer,
) -> Result<Option<Vec<f64>>, Interrupted> {
    let reciprocals: Vec<f64> =
        eigenvalues.iter().map(|lambdas| lambdas.iter().product::<Complex<f64>>().re.recip()).collect();
    if !reciprocals.iter().all(|value| value.is_finite()) {
        return Ok(None);
    }
    let Some(fit) = fits.trial_of_values(&reciprocals, observer)? else { return Ok(None) };
    let Some(error) = fit.result.left_out_error() else { return Ok(None) };
    let spread = Moments::of(&reciprocals).variance().sqrt();
    let is_one_sided = reciprocals.iter().all(|value| *value > 0.0) || reciprocals.iter().all(|value| *value < 0.0);
    let smallest = reciprocals.iter().map(|value| value.abs()).fold(f64::INFINITY, f64::min);
    // Of one sign at all runs, it must be known much better than it is small, to be zero at the edge.
    let needed = if is_one_sided { GOOD * smallest } else { GOOD * spread };
    if error > needed {
        return Ok(None);
    }
    let alone = Numbers { modes: Vec::new(), reals: vec![1] };
    let surrogate = super::record::of_fits(study, &output(OutputKind::Closed, &alone, &[]), &[fit]);
    let predicted = &at_judged_points(&surrogate, POINTS, observer)?.components[0];
    let point = |at| judged_point((&study.inputs, study.seed), at);
    let runs = TrainedDomain::of(&study.inputs, samples.points());
    let is_between_runs = |at: &usize| runs.as_ref().is_none_or(|runs| runs.holds(&point(*at)));
    let between = (0..predicted.len()).filter(is_between_runs);
    let nearest = between.reduce(|a, b| if predicted[b].abs() < predicted[a].abs() { b } else { a });
    let zero = if is_one_sided { error } else { error.max(ZERO * spread) };
    let is_zero = |at: &usize| predicted[*at].abs() <= zero;
    Ok(nearest.filter(is_zero).map(|at| study.inputs.physical(&point(at))))
}
