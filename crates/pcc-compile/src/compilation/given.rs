//! Runs that somebody has made already: which of them a fit takes, in which levels, and which validate it.
//!
//! A share of the runs that the study states is held out, at random. The fit takes the others, but no more than
//! [`Study::most_given`]. Where there are more, it takes those that lie nearest to the points of the design that a
//! build would have asked for, each once: clusters of runs are thinned out, and the fit sees what the inputs' laws ask
//! for. Runs that it does not take validate it as those do that were held out.
//!
//! The last levels are half of the runs and all of them: what the second half says of a fit to the first is part of the
//! estimated error, as with a design that has grown. Where half is more than a first level of a design, such a level
//! comes before: on it, methods and groups that are no good are given up at little cost.

use crate::fitting::design::{NestedLatinHypercube, Samples};
use crate::study::{GivenData, Study};
use crate::tables::GivenRun;
use pcc_evaluate::foundation::{Interrupted, Observer, try_map};
use pcc_evaluate::probability::inputs::InputSpace;
use pcc_evaluate::probability::random::{Purpose, Stream};
use rand::seq::SliceRandom;
use std::collections::VecDeque;

/// Numbers of a design's stream that no level has: of the order of given runs, and of those that are held out.
const ORDER: u64 = 1 << 43;

/// Fewer runs are no level: a fit to them says nothing of a fit to twice as many.
const LEAST_LEVEL: usize = 5;

/// Given runs that wait to be taken.
pub(super) struct GivenLevels<'a> {
    data: &'a GivenData,
    levels: VecDeque<Vec<usize>>,
    validating: Vec<usize>,
    held_out: usize,
}

impl<'a> GivenLevels<'a> {
    /// The levels of the study's data; none if it has no data.
    pub fn new(study: &'a Study, observer: &dyn Observer) -> Result<Option<Self>, Interrupted> {
        let Some(data) = &study.data else { return Ok(None) };
        let runs = &data.runs.runs;
        let mut order: Vec<usize> = (0..runs.len()).collect();
        order.shuffle(&mut Stream::new(study.seed, Purpose::Design, ORDER));
        // Failures cannot validate.
        let (answered, failed): (Vec<usize>, Vec<usize>) = order.into_iter().partition(|&i| runs[i].answer.is_ok());
        let held_out = (data.holdout * answered.len() as f64).round() as usize;
        let (validating, mut rest) = answered.split_at(held_out);
        let mut validating = validating.to_vec();
        let taken: Vec<usize>;
        let most = study.most_given();
        if rest.len() > most {
            let chosen = nearest_to_design(study, runs, rest, most, observer)?;
            let mut is_chosen = vec![false; runs.len()];
            chosen.iter().for_each(|&i| is_chosen[i] = true);
            validating.extend(rest.iter().copied().filter(|&i| !is_chosen[i]));
            taken = chosen;
            rest = &taken;
        }
        let half = rest.len() / 2;
        let is_one = study.fit.method.has_fixed_design() || half < LEAST_LEVEL;
        let first = study.design.initial.max(LEAST_LEVEL).min(half);
        let ends = if is_one { [0, 0, rest.len()] } else { [first, half, rest.len()] };
        let part = |(start, &end): (usize, &usize)| rest[start..end].to_vec();
        let mut levels: VecDeque<Vec<usize>> = [0, ends[0], ends[1]].into_iter().zip(&ends).map(part).collect();
        levels.retain(|level| !level.is_empty());
        // Failures are as frequent among the runs that are taken as among all.
        let mut failed = failed;
        if !answered.is_empty() && !rest.is_empty() {
            failed.truncate((failed.len() * rest.len()).div_ceil(answered.len()));
        }
        match levels.back_mut() {
            Some(last) => last.extend(&failed),
            // What they say is the cause that there is no level.
            None if !failed.is_empty() => levels.push_back(failed),
            None => {}
        }
        Ok(Some(Self { data, levels, validating, held_out }))
    }

    /// Whether some wait to be taken.
    pub fn are_left(&self) -> bool {
        !self.levels.is_empty()
    }

    /// The runs of the next level that are not those of levels before.
    pub fn next(&mut self) -> Vec<&'a GivenRun> {
        self.levels.pop_front().unwrap_or_default().into_iter().map(|i| &self.data.runs.runs[i]).collect()
    }

    /// The runs that no fit sees.
    pub fn validating(&self) -> impl Iterator<Item = &'a GivenRun> {
        self.validating.iter().map(|&i| &self.data.runs.runs[i])
    }

    /// How many of them were held out, and not just too many for a fit.
    pub fn held_out(&self) -> usize {
        self.held_out
    }

    /// What they come from.
    pub fn data(&self) -> &'a GivenData {
        self.data
    }
}

/// For each point of a design of this size, in its order, the run among `candidates` that is nearest to it, none twice.
fn nearest_to_design(
    study: &Study,
    runs: &[GivenRun],
    candidates: &[usize],
    size: usize,
    observer: &dyn Observer,
) -> Result<Vec<usize>, Interrupted> {
    /// Candidates of one part of the work.
    const PART: usize = 4096;
    let inputs = &study.inputs;
    let mut design = NestedLatinHypercube::new(inputs.dimension(), study.seed);
    design.grow_to(size);
    let design = design.placed(|units| inputs.place(units));
    let wanted = probabilities(inputs, design.points().map(|point| inputs.physical(point)));
    let points = probabilities(inputs, candidates.iter().map(|&i| runs[i].point.clone()));
    let parts: Vec<usize> = (0..candidates.len()).step_by(PART).collect();
    let mut is_taken = vec![false; candidates.len()];
    let mut chosen = Vec::with_capacity(size);
    for point in wanted.points() {
        let nearest_of = |part: usize| {
            observer.check()?;
            let range = part * PART..((part + 1) * PART).min(candidates.len());
            Ok(nearest(point, range.filter(|&i| !is_taken[i]).map(|i| (i, points.point(i)))))
        };
        let found = try_map(parts.len(), nearest_of)?.into_iter().flatten();
        let found = found.reduce(|a, b| if b.1 < a.1 { b } else { a });
        if let Some((at, _)) = found {
            is_taken[at] = true;
            chosen.push(candidates[at]);
        }
    }
    Ok(chosen)
}

/// The first of the points that is nearest to one, with the square of its distance.
pub(super) fn nearest<'p>(point: &[f64], among: impl Iterator<Item = (usize, &'p [f64])>) -> Option<(usize, f64)> {
    let mut best: Option<(usize, f64)> = None;
    for (i, other) in among {
        let distance: f64 = point.iter().zip(other).map(|(a, b)| (a - b) * (a - b)).sum();
        if best.is_none_or(|(_, least)| distance < least) {
            best = Some((i, distance));
        }
    }
    best
}

/// Physical points in the distribution functions of their coordinates, u = F(x) in [0, 1].
pub(super) fn probabilities(inputs: &InputSpace, points: impl Iterator<Item = Vec<f64>>) -> Samples {
    let of = |point: Vec<f64>| {
        let coordinates = inputs.inputs().iter().zip(point);
        coordinates.map(|(input, x)| 0.5 + 0.5 * input.marginal.centred_probability(x)).collect::<Vec<f64>>()
    };
    Samples::new(inputs.dimension(), points.flat_map(of).collect())
}
