//! Groups that no run has seen: neighbours that coalesce in a part of the box that the design has not hit.
//!
//! Where the unstable share is small, single expansions of modes that coalesce at no run cannot flutter, and neither
//! residuals at runs left out nor more runs of the same kind show it. So neighbours in frequency are fitted as a pair
//! by way of trial, and their predicted distance, d = ((λ₁ − λ₂)/2)², is looked at where shares are judged, at many
//! points. If it comes near zero anywhere, nearer than the design alone would call close, or than d is known, they form
//! a group; unless the pair is predicted badly, or their eigenvectors follow them through. Where runs are far apart,
//! vectors seem to pass through what is a narrow strip of flutter between them. But then frequencies bend there: a
//! crossing is none whose modes are predicted much worse alone than together.
//!
//! A mode and its own conjugate are such neighbours, too. Where it slows down, both are fitted by way of trial, and
//! are closed under conjugation if they meet on the real axis at some of these points: divergence that no run has
//! seen. In the tails of inputs without bounds, runs may not even show that it slows down: there the prediction of Im
//! λ is looked at, too.

use super::components::Care;
use super::group_fits::{Followed, GroupFit, GroupFits, left_out_distance};
use super::grouping::Grouping;
use super::judged_points::{POINTS, at_judged_points};
use crate::mechanics::spectrum::{CLOSE, Group};
use crate::study::Study;
use pcc_evaluate::foundation::{Interrupted, Observer};

/// Pairs whose d nowhere falls below this share of its largest on the design are not on their way to meet.
const APPROACHING: f64 = 0.5;

/// Modes whose frequency nowhere falls below this share of its largest are not on their way to the real axis.
const SLOWING: f64 = 0.85;

/// A trial with a higher score says nothing that its parts do not say better.
const BAD: f64 = 0.1;

/// Residuals of d within which it may be zero.
const RESIDUALS: f64 = 3.0;

/// Swap ratios below this follow two modes through a crossing.
const FOLLOWED: f64 = 0.005;

/// Errors of eigenvalues below this share of the largest are no bends, and together they must be so much smaller.
const BENT: f64 = 1e-6;
const MENDED: f64 = 5.0;

/// Pairs that are tried at most, those that come nearest: systems with many modes have many that are dense.
const MOST_PAIRS: usize = 20;

/// The grouping with neighbours united whose predicted distance closes somewhere.
pub(super) fn with_unseen_groups(
    study: &Study,
    followed: &Followed<'_>,
    mut grouping: Grouping,
    fits: &mut GroupFits<'_>,
    can_grow: bool,
    observer: &dyn Observer,
) -> Result<Grouping, Interrupted> {
    for (pair, crosses) in neighbours(followed, &grouping) {
        let trial = followed.groups.union(&pair[0], &pair[1]);
        fits.add([&trial], followed, (Care::Trial, can_grow), observer)?;
        let Some(fit) = fits.get(&trial).filter(|fit| fit.fits.len() == fit.values.len()) else { continue };
        let apart = pair.iter().filter_map(|group| fits.get(group)).map(|fit| fit.score).fold(0.0, f64::max);
        if is_worse(fit, apart) || (crosses && !bends(followed, fits, &pair, &trial)) {
            continue;
        }
        if !closes(study, followed, &trial, fit, observer)? {
            continue;
        }
        let holds = |group: &Group| group.labels().iter().any(|label| trial.labels().contains(label));
        let (parts, mut kept): (Vec<Group>, Vec<Group>) = grouping.iter().cloned().partition(holds);
        let whole = parts.into_iter().reduce(|whole, part| followed.groups.union(&whole, &part));
        if let Some(whole) = whole.filter(Group::is_possible) {
            kept.push(whole);
            kept.sort_unstable();
            grouping = kept;
        }
    }
    for group in grouping.clone() {
        let is_open = !group.is_closed() && followed.groups.closed(&group).is_possible();
        if !is_open || !(is_slowing(followed, &group) || crosses_the_axis(study, fits.get(&group), observer)?) {
            continue;
        }
        let closed = followed.groups.closed(&group);
        let apart = fits.get(&group).map_or(f64::INFINITY, |fit| fit.score);
        fits.add([&closed], followed, (Care::Trial, can_grow), observer)?;
        let Some(fit) = fits.get(&closed).filter(|fit| fit.fits.len() == fit.values.len()) else { continue };
        if !is_worse(fit, apart) && meets_the_axis(study, fit, observer)? {
            grouping.retain(|other| *other != group);
            grouping.push(closed);
            grouping.sort_unstable();
        }
    }
    fits.add(&grouping, followed, (Care::Full, can_grow), observer)?;
    Ok(grouping)
}

/// Whether a trial is predicted badly, and worse than what it is made of.
fn is_worse(trial: &GroupFit, apart: f64) -> bool {
    trial.score > BAD.max(apart)
}

/// Whether two modes that cross are predicted much worse alone than together.
fn bends(followed: &Followed<'_>, fits: &GroupFits<'_>, pair: &[Group; 2], trial: &Group) -> bool {
    let error = |group: &Group| fits.get(group).map_or(f64::INFINITY, |fit| left_out_distance(fit, group, followed));
    let alone = pair.iter().map(error).fold(0.0, f64::max);
    let largest = followed.runs.iter().map(|run| run.spectrum.largest()).fold(0.0, f64::max);
    alone.is_finite() && alone > BENT * largest && MENDED * error(trial) < alone
}

/// Whether a mode of a complex group is slower at some runs than at others, so that it may meet its conjugate.
fn is_slowing(followed: &Followed<'_>, group: &Group) -> bool {
    group.labels().iter().any(|&label| {
        let frequencies = || (0..followed.runs.len()).map(|run| followed.eigenvalue(run, label).im.abs());
        frequencies().fold(f64::INFINITY, f64::min) < SLOWING * frequencies().fold(0.0, f64::max)
    })
}

/// Whether an eigenvalue of a complex group is predicted below the real axis in the tail of an input.
fn crosses_the_axis(study: &Study, fit: Option<&GroupFit>, observer: &dyn Observer) -> Result<bool, Interrupted> {
    let fit = fit.filter(|fit| fit.fits.len() == fit.values.len() && study.inputs.is_unbounded());
    let Some(fit) = fit else { return Ok(false) };
    let block = at_judged_points(&super::record::of_fits(study, &fit.output, &fit.fits), POINTS, observer)?;
    Ok(block.eigenvalues.iter().flatten().any(|lambda| lambda.im <= 0.0))
}

/// Whether eigenvalues of a group closed under conjugation, which oscillate at every run, are predicted to be real
/// somewhere. Of a single mode (Im λ)² = e₂ − (e₁/2)² is looked at, and known with its residuals.
fn meets_the_axis(study: &Study, fit: &GroupFit, observer: &dyn Observer) -> Result<bool, Interrupted> {
    let block = at_judged_points(&super::record::of_fits(study, &fit.output, &fit.fits), POINTS, observer)?;
    let [e_1, e_2] = &block.components[..] else {
        return Ok(block.eigenvalues.iter().flatten().any(|lambda| lambda.im == 0.0));
    };
    let residual = fit.fits[1].result.left_out_error().unwrap_or(0.0);
    Ok(e_1.iter().zip(e_2).any(|(e_1, e_2)| e_2 - 0.25 * e_1 * e_1 < RESIDUALS * residual))
}

/// Pairs of single modes that are neighbours in frequency and come closer at some runs than at others, and whether they
/// are followed through a crossing.
fn neighbours(followed: &Followed<'_>, grouping: &Grouping) -> Vec<([Group; 2], bool)> {
    let mut singles: Vec<&Group> = grouping.iter().filter(|group| !group.is_closed() && group.size() == 1).collect();
    let mean =
        |group: &Group| (0..followed.runs.len()).map(|run| followed.eigenvalue(run, group.labels()[0]).im).sum::<f64>();
    singles.sort_by(|a, b| mean(a).total_cmp(&mean(b)).then(a.cmp(b)));
    let crosses = |a: &Group, b: &Group| {
        let (a, b) = (a.labels()[0], b.labels()[0]);
        let gap = |run: usize| followed.eigenvalue(run, b).im - followed.eigenvalue(run, a).im;
        let signs: Vec<bool> = (0..followed.runs.len()).map(|run| gap(run) > 0.0).collect();
        signs.iter().any(|sign| *sign != signs[0]) && followed.labels.swap(a, b) < FOLLOWED
    };
    let approaches = |a: &Group, b: &Group| {
        let (a, b) = (a.labels()[0], b.labels()[0]);
        let distance = |run: usize| (followed.eigenvalue(run, b) - followed.eigenvalue(run, a)).norm_sqr();
        let distances = || (0..followed.runs.len()).map(distance);
        distances().fold(f64::INFINITY, f64::min) < APPROACHING * distances().fold(0.0, f64::max)
    };
    let nearness = |pair: &[Group; 2]| {
        let (a, b) = (pair[0].labels()[0], pair[1].labels()[0]);
        let distance = |run: usize| {
            let (a, b) = (followed.eigenvalue(run, a), followed.eigenvalue(run, b));
            (b - a).norm() / b.norm()
        };
        (0..followed.runs.len()).map(distance).fold(f64::INFINITY, f64::min)
    };
    let mut pairs: Vec<[Group; 2]> = singles
        .windows(2)
        .filter(|pair| approaches(pair[0], pair[1]))
        .map(|pair| [pair[0].clone(), pair[1].clone()])
        .collect();
    if pairs.len() > MOST_PAIRS {
        pairs.sort_by(|a, b| nearness(a).total_cmp(&nearness(b)).then(a.cmp(b)));
        pairs.truncate(MOST_PAIRS);
    }
    let with_crossing = |pair: [Group; 2]| {
        let is_crossing = crosses(&pair[0], &pair[1]);
        (pair, is_crossing)
    };
    pairs.into_iter().map(with_crossing).collect()
}

/// Whether d of a pair comes near zero at some of the points.
fn closes(
    study: &Study,
    followed: &Followed<'_>,
    trial: &Group,
    fit: &GroupFit,
    observer: &dyn Observer,
) -> Result<bool, Interrupted> {
    let (a, b) = (trial.labels()[0], trial.labels()[1]);
    let largest = (0..followed.runs.len())
        .map(|run| (followed.eigenvalue(run, a) - followed.eigenvalue(run, b)).norm())
        .fold(0.0, f64::max);
    // The components of a pair are Re s, Im s, Re c₀, Im c₀ with c₀ = −d.
    let error = |at: usize| fit.fits[at].result.left_out_error().unwrap_or(0.0);
    let residual = error(2).hypot(error(3));
    let near = (0.5 * CLOSE * largest).powi(2).max(RESIDUALS * residual);
    let surrogate = super::record::of_fits(study, &fit.output, &fit.fits);
    let block = at_judged_points(&surrogate, POINTS, observer)?;
    Ok(block.components[2].iter().zip(&block.components[3]).any(|(re, im)| re.hypot(*im) < near))
}
