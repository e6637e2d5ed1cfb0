//! Which eigenvalues form groups: decided by how well groups predict the eigenvalues of runs left out.
//!
//! Overlaps of eigenvectors give labels and candidates, never the decision: whether an edge of the tree is ambiguous
//! depends on how dense the design is, and an exceptional point just outside the box spoils single expansions without
//! any ambiguity. The *score* of a grouping is that of its worst eigenvalue (`group_fits.rs`).
//!
//! 1. Candidates: the finest grouping; labels united that nearly change places between neighbouring runs, at three
//!    thresholds; labels united whose frequencies come close; all in one that approach each other, with and without
//!    regard to whether they oscillate.
//! 2. From each, the worst group is merged with a neighbour or with its own conjugates, as long as that lowers its
//!    score by a factor [`WORTH`].
//! 3. A grouping whose score is negligible ends the search, and so does that of the level before if its score has
//!    fallen by that factor: more runs are what it needs. Else, of all groupings found, those within that factor of the
//!    best are as good as it is, and the finest of them is taken; the one of the level before stays if it is among
//!    them.
//!
//! No model is run for any of this, so it is done anew at every level.

use super::components::Care;
use super::group_fits::{Followed, GroupFits};
use crate::mechanics::spectrum::{CLOSE, Group};
use pcc_evaluate::foundation::{Interrupted, Observer};

/// Scores that differ by less than this factor are equal, and merging must lower a score by more.
const WORTH: f64 = 3.0;

/// Errors this small relative to the distances that decide are as good as none: they move shares by less than they are
/// asked for.
const NEGLIGIBLE: f64 = 1e-4;

/// Swap ratios above which labels are united in some candidate.
const SWAPS: [f64; 3] = [0.5, 0.05, 0.005];

/// A mode whose frequency falls below this share of its largest |λ| is tried together with its conjugate.
const NEAR_AXIS: f64 = 0.2;

/// Eigenvalues in a group that merging makes, at most: errors of more are amplified 10⁶ times in the roots.
const MOST_MERGED: usize = 6;

/// Eigenvalues in a group of a candidate, at most.
const MOST_IN_CANDIDATE: usize = 8;

/// Neighbours that a group is merged with by way of trial, the closest.
const TRIED_NEIGHBOURS: usize = 4;

/// Groups whose distance nowhere falls below this share of its largest are not on their way to meet. The square of the
/// distance then has its zero at |ξ| > 6, where expansions converge by a factor 10 per degree.
const APPROACHING: f64 = 0.85;

/// Equations, values and derivatives, of a design on which trials are fitted with full care.
const SMALL_DESIGN: usize = 150;

/// A way to group all labels of interest.
pub(super) type Grouping = Vec<Group>;

/// The grouping that predicts best, of the labels whose finest groups are `of_interest`, with its score; `former` is
/// that of the level before.
pub(super) fn choose(
    followed: &Followed<'_>,
    of_interest: &[Group],
    former: Option<(&Grouping, f64)>,
    fits: &mut GroupFits<'_>,
    can_grow: bool,
    observer: &dyn Observer,
) -> Result<(Grouping, f64), Interrupted> {
    let finest: Grouping = sorted(of_interest.to_vec());
    let mut choice = Choice { followed, fits, can_grow, observer };
    let mut found: Vec<(Grouping, f64)> = Vec::new();
    let former = former.filter(|(former, _)| is_made_of(former, &finest));
    if let Some((former, before)) = former {
        let score = choice.score_of_all(former)?;
        if score <= NEGLIGIBLE || WORTH * score <= before {
            return Ok((former.clone(), score));
        }
        found.push((former.clone(), score));
    }
    for candidate in candidates(followed, &finest) {
        let candidate = choice.merged(candidate)?;
        if candidate.1 <= NEGLIGIBLE {
            return Ok(candidate);
        }
        if !found.iter().any(|(known, _)| *known == candidate.0) {
            found.push(candidate);
        }
    }
    let best = found.iter().map(|(_, score)| score.max(NEGLIGIBLE)).fold(f64::INFINITY, f64::min);
    let as_good: Vec<&(Grouping, f64)> =
        found.iter().filter(|(_, score)| score.max(NEGLIGIBLE) <= WORTH * best || best == f64::INFINITY).collect();
    let is_former = |(grouping, _): &&&(Grouping, f64)| former.is_some_and(|(former, _)| grouping == former);
    let finer = |a: &(Grouping, f64), b: &(Grouping, f64)| b.0.len().cmp(&a.0.len()).then(a.1.total_cmp(&b.1));
    let chosen = as_good.iter().find(is_former).copied().or_else(|| as_good.into_iter().min_by(|a, b| finer(a, b)));
    Ok(chosen.cloned().unwrap_or((finest, f64::INFINITY)))
}

struct Choice<'c, 'f, 'a> {
    followed: &'c Followed<'c>,
    fits: &'f mut GroupFits<'a>,
    can_grow: bool,
    observer: &'c dyn Observer,
}

impl Choice<'_, '_, '_> {
    fn score_of(&mut self, group: &Group) -> Result<f64, Interrupted> {
        self.fits.add([group], self.followed, (self.care(), self.can_grow), self.observer)?;
        Ok(self.fits.get(group).map_or(f64::INFINITY, |fit| fit.score))
    }

    /// Small designs cost little, and there methods differ most.
    fn care(&self) -> Care {
        let inputs = if self.followed.has_derivatives { self.followed.samples.dimension() } else { 0 };
        if self.followed.runs.len() * (1 + inputs) <= SMALL_DESIGN { Care::Full } else { Care::Trial }
    }

    /// The score of a grouping that is likely to stay.
    fn score_of_all(&mut self, grouping: &Grouping) -> Result<f64, Interrupted> {
        self.fits.add(grouping, self.followed, (Care::Full, self.can_grow), self.observer)?;
        let scores: Vec<f64> = grouping.iter().map(|group| self.score_of(group)).collect::<Result<_, _>>()?;
        Ok(scores.into_iter().fold(0.0, f64::max))
    }

    /// Merges the worst group as long as that is worth it; the grouping with its score.
    fn merged(&mut self, mut grouping: Grouping) -> Result<(Grouping, f64), Interrupted> {
        self.fits.add(&grouping, self.followed, (self.care(), self.can_grow), self.observer)?;
        loop {
            self.observer.check()?;
            let mut scores = Vec::with_capacity(grouping.len());
            for group in &grouping {
                scores.push(self.score_of(group)?);
            }
            let Some(worst) = (0..scores.len()).reduce(|a, b| if scores[b] > scores[a] { b } else { a }) else {
                return Ok((grouping, 0.0));
            };
            let score = scores[worst];
            if score <= NEGLIGIBLE {
                return Ok((grouping, score));
            }
            let trials = self.trials(&grouping, worst);
            self.fits.add(
                trials.iter().map(|(group, _)| group),
                self.followed,
                (self.care(), self.can_grow),
                self.observer,
            )?;
            let mut best: Option<(f64, Group, Option<usize>)> = None;
            for (group, other) in trials {
                let merged = self.score_of(&group)?;
                if best.as_ref().is_none_or(|(least, ..)| merged < *least) {
                    best = Some((merged, group, other));
                }
            }
            // Several groups may be as bad as the worst: merging is worth it if it mends this one.
            match best.filter(|(merged, ..)| WORTH * merged.max(NEGLIGIBLE) < score) {
                Some((_, group, other)) => {
                    let mut kept: Grouping = Vec::with_capacity(grouping.len());
                    let old = grouping.into_iter().enumerate();
                    kept.extend(old.filter(|(at, _)| *at != worst && Some(*at) != other).map(|(_, group)| group));
                    kept.push(group);
                    grouping = sorted(kept);
                }
                None => return Ok((grouping, score)),
            }
        }
    }

    /// The worst group with its conjugates, and with each of its nearest neighbours.
    fn trials(&self, grouping: &Grouping, worst: usize) -> Vec<(Group, Option<usize>)> {
        let (groups, group) = (&self.followed.groups, &grouping[worst]);
        let apart = (0..grouping.len()).filter(|&other| other != worst);
        let distances = apart.map(|other| (other, distances(self.followed, group, &grouping[other])));
        let mut others: Vec<(usize, f64)> = distances
            .filter(|(_, apart)| come_closer(*apart))
            .map(|(other, [smallest, _])| (other, smallest))
            .collect();
        others.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        let with_conjugates =
            Some((groups.closed(group), None)).filter(|_| !group.is_closed() && nears_the_axis(self.followed, group));
        let with_neighbours = others
            .into_iter()
            .take(TRIED_NEIGHBOURS)
            .map(|(other, _)| (groups.union(group, &grouping[other]), Some(other)));
        with_conjugates.into_iter().chain(with_neighbours).filter(|(group, _)| group.size() <= MOST_MERGED).collect()
    }
}

/// The smallest and the largest over all runs of the distance between two groups, relative to the size of their
/// eigenvalues.
fn distances(followed: &Followed<'_>, one: &Group, other: &Group) -> [f64; 2] {
    let at_run = |run: usize| {
        let of =
            |group: &Group| -> Vec<_> { group.labels().iter().map(|&label| followed.eigenvalue(run, label)).collect() };
        let (one, other) = (of(one), of(other));
        let relative = |a: &nalgebra::Complex<f64>, b: &nalgebra::Complex<f64>| {
            (a - b).norm() / a.norm().max(b.norm()).max(f64::MIN_POSITIVE)
        };
        one.iter().flat_map(|a| other.iter().map(move |b| relative(a, b))).fold(f64::INFINITY, f64::min)
    };
    let found: Vec<f64> = (0..followed.runs.len()).map(at_run).collect();
    [found.iter().copied().fold(f64::INFINITY, f64::min), found.into_iter().fold(0.0, f64::max)]
}

/// Whether groups with these distances come much closer at some runs than at others.
fn come_closer([smallest, largest]: [f64; 2]) -> bool {
    smallest < APPROACHING * largest
}

fn sorted(mut grouping: Grouping) -> Grouping {
    grouping.sort_unstable();
    grouping
}

/// Groupings to begin with, the finest first.
fn candidates(followed: &Followed<'_>, finest: &Grouping) -> Vec<Grouping> {
    let mut candidates = vec![finest.clone()];
    let labels: Vec<usize> = finest.iter().flat_map(|group| followed.groups.closed(group).labels().to_vec()).collect();
    for threshold in SWAPS {
        candidates.push(united(followed, finest, &labels, |a, b| followed.labels.swap(a, b) > threshold));
    }
    candidates.push(united(followed, finest, &labels, |a, b| is_close(followed, a, b)));
    candidates.push(connected(followed, finest, |a, b| a.is_closed() == b.is_closed()));
    let is_on_the_axis = |group: &Group| group.is_closed() || nears_the_axis(followed, group);
    if finest.iter().any(is_on_the_axis) {
        let close = |group: Group| if is_on_the_axis(&group) { followed.groups.closed(&group) } else { group };
        candidates.push(sorted(connected(followed, finest, |_, _| true).into_iter().map(close).collect()));
    }
    candidates.retain(|grouping| grouping.iter().all(|group| group.size() <= MOST_IN_CANDIDATE));
    let mut distinct: Vec<Grouping> = Vec::with_capacity(candidates.len());
    candidates.into_iter().for_each(|candidate| {
        if !distinct.contains(&candidate) {
            distinct.push(candidate);
        }
    });
    distinct
}

/// Whether a grouping of an earlier level is still one: every finest group lies in one of its groups.
fn is_made_of(grouping: &Grouping, finest: &Grouping) -> bool {
    let holds = |whole: &Group, part: &Group| {
        part.labels().iter().all(|label| whole.labels().contains(label)) && (whole.is_closed() || !part.is_closed())
    };
    finest.iter().all(|part| grouping.iter().any(|whole| holds(whole, part)))
}

/// The finest groups with those in one whose labels `belong` together. Half a pair that belongs to the other half, or
/// to that of another pair, makes the group closed.
fn united(
    followed: &Followed<'_>,
    finest: &Grouping,
    labels: &[usize],
    belong: impl Fn(usize, usize) -> bool,
) -> Grouping {
    let groups = &followed.groups;
    let mut grouping: Grouping = finest.clone();
    for (k, &a) in labels.iter().enumerate() {
        for &b in labels[..k].iter().filter(|&&b| belong(a, b)) {
            let holds = |group: &Group, label: usize| groups.closed(group).labels().contains(&label);
            let (parts, apart): (Vec<Group>, Vec<Group>) =
                grouping.into_iter().partition(|group| holds(group, a) || holds(group, b));
            grouping = apart;
            let Some(mut whole) = parts.into_iter().reduce(|whole, part| groups.union(&whole, &part)) else { continue };
            // Vectors of modes that coalesce with each other are close to those of their conjugates, too.
            if groups.is_upper_half(a) != groups.is_upper_half(b) && nears_the_axis(followed, &whole) {
                whole = groups.closed(&whole);
            }
            grouping.push(whole);
        }
    }
    sorted(grouping)
}

/// The finest groups with those in one that approach each other, directly or through others, where two of them `may`.
fn connected(followed: &Followed<'_>, finest: &Grouping, may: impl Fn(&Group, &Group) -> bool) -> Grouping {
    let mut grouping: Grouping = Vec::with_capacity(finest.len());
    let mut parts: Vec<Vec<&Group>> = Vec::with_capacity(finest.len());
    for group in finest {
        let approaches = |part: &Vec<&Group>| {
            part.iter().any(|other| may(group, other) && come_closer(distances(followed, group, other)))
        };
        let (near, apart): (Vec<_>, Vec<_>) = parts.into_iter().partition(approaches);
        parts = apart;
        parts.push(near.into_iter().flatten().chain([group]).collect());
    }
    for part in parts {
        grouping.extend(part.into_iter().cloned().reduce(|whole, group| followed.groups.union(&whole, &group)));
    }
    sorted(grouping)
}

/// Whether a mode of a complex group slows down so much that it may meet its conjugate nearby.
fn nears_the_axis(followed: &Followed<'_>, group: &Group) -> bool {
    group.labels().iter().any(|&label| {
        let lambdas = || (0..followed.runs.len()).map(|run| followed.eigenvalue(run, label));
        let lowest = lambdas().map(|lambda| lambda.im.abs()).fold(f64::INFINITY, f64::min);
        lowest < NEAR_AXIS * lambdas().map(|lambda| lambda.norm()).fold(0.0, f64::max)
    })
}

/// Whether the frequencies of two labels that always oscillate come close, compared with the largest distance of the
/// two.
fn is_close(followed: &Followed<'_>, one: usize, other: usize) -> bool {
    if !(followed.groups.is_upper_half(one) && followed.groups.is_upper_half(other)) {
        return false;
    }
    let at_run = |run: usize| followed.eigenvalue(run, one) - followed.eigenvalue(run, other);
    let runs = 0..followed.runs.len();
    let largest = runs.clone().map(|run| at_run(run).norm()).fold(0.0, f64::max);
    let smallest = runs.map(|run| at_run(run).im.abs()).fold(f64::INFINITY, f64::min);
    smallest < CLOSE * largest
}
