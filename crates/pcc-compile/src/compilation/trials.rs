//! Which points change sides if the surrogate errs by the residuals of a run.

use super::decision::quantile;
use super::judged_points::at_judged_points;
use crate::campaign::Run;
use pcc_evaluate::components::{Block, Margin, Output, OutputKind, Top, Verdict};
use pcc_evaluate::foundation::{Interrupted, Observer, try_map};
use pcc_evaluate::surrogate::Surrogate;

/// Points that are tried for changing sides, those with the smallest excess, and as many marginal ones. Of the others,
/// which only errors as large as all of the excess reach, each of those tried stands for [`FAR_APART`].
const TRIED_POINTS: usize = 10_000;
const FAR_APART: usize = 20;

/// Runs whose residuals are tried, evenly spread: more change the estimate less than it is uncertain anyway.
const TRIED_RUNS: usize = 150;

/// Bounds are exceeded by rounding by less.
const ROUNDING_MARGIN: f64 = 1.001;

/// Points whose share is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Class {
    /// Those that are stable or marginal.
    NotUnstable,
    /// Those with this verdict.
    Of(Verdict),
}

impl Class {
    /// Those that every study asks for, and those that one names.
    pub fn all(named: &[Verdict]) -> Vec<Self> {
        std::iter::once(Self::NotUnstable).chain(named.iter().copied().map(Self::Of)).collect()
    }

    fn holds(self, top: Top) -> bool {
        match self {
            Self::NotUnstable => is_not_unstable(top.excess),
            Self::Of(verdict) => top.verdict() == verdict,
        }
    }

    /// Number of its points.
    pub fn count(self, block: &Block) -> usize {
        (0..block.excess.len()).filter(|&i| self.holds(block.top(i))).count()
    }
}

/// Shares of points that change sides, one per run, with the weights of the runs.
pub(super) struct Shares {
    pub shares: Vec<f64>,
    pub weights: Vec<f64>,
}

impl Shares {
    pub fn mean_of(&self, part: impl Fn(f64) -> f64) -> f64 {
        let sum: f64 = self.shares.iter().zip(&self.weights).map(|(&share, weight)| weight * part(share)).sum();
        sum / self.weights.iter().sum::<f64>()
    }

    pub fn effective_count(&self) -> f64 {
        effective_count(&self.weights)
    }
}

/// (Σw)²/Σw².
fn effective_count(weights: &[f64]) -> f64 {
    weights.iter().sum::<f64>().powi(2) / weights.iter().map(|weight| weight * weight).sum::<f64>()
}

/// The surrogate at many random points.
pub(super) struct Judge<'a> {
    surrogate: &'a Surrogate,
    block: Block,
    /// The points that are tried, by their distance from instability, each with the number of points it stands for.
    near: Vec<(usize, f64)>,
    weights: Vec<f64>,
    observer: &'a dyn Observer,
}

impl<'a> Judge<'a> {
    /// Runs that were given have masses, as far as they stand for the inputs' laws.
    pub fn new(
        surrogate: &'a Surrogate,
        (runs, masses): (&[Run], Option<&[f64]>),
        points: usize,
        observer: &'a dyn Observer,
    ) -> Result<Self, Interrupted> {
        let block = at_judged_points(surrogate, points, observer)?;
        // Marginal points do not say how near they are to instability.
        let (marginal, mut near): (Vec<usize>, Vec<usize>) = (0..points).partition(|&i| block.excess[i] == 0.0);
        let nearer = |a: &usize, b: &usize| block.excess[*a].abs().total_cmp(&block.excess[*b].abs()).then(a.cmp(b));
        near.sort_unstable_by(nearer);
        let far = near.split_off(near.len().min(TRIED_POINTS));
        let every = marginal.len().div_ceil(TRIED_POINTS).max(1);
        let evenly = |points: Vec<usize>, every: usize| {
            points.into_iter().step_by(every).map(|i| (i, every as f64)).collect::<Vec<_>>()
        };
        let near = [evenly(marginal, every), evenly(near, 1), evenly(far, FAR_APART)].concat();
        let distances: Vec<f64> = runs.iter().map(|run| run.spectrum.top().excess.abs()).collect();
        let mut sorted: Vec<f64> = distances.iter().copied().filter(|&distance| distance > 0.0).collect();
        sorted.sort_by(f64::total_cmp);
        let scale = if sorted.is_empty() { f64::MIN_POSITIVE } else { quantile(&sorted, 0.5) };
        let mass = |i: usize| masses.map_or(1.0, |masses| masses[i]);
        let near_zero = |(i, distance): (usize, &f64)| mass(i) / (1.0 + (distance / scale).powi(2));
        let weights = distances.iter().enumerate().map(near_zero).collect();
        Ok(Self { surrogate, block, near, weights, observer })
    }

    /// The surrogate at all of them.
    pub fn block(&self) -> &Block {
        &self.block
    }

    /// Number of points T.
    pub fn points(&self) -> usize {
        self.block.excess.len()
    }

    /// Number of points of a class.
    pub fn count(&self, class: Class) -> usize {
        class.count(&self.block)
    }

    /// For each point, whether it is on the rarer side of a class.
    pub fn rarer(&self, class: Class) -> Vec<bool> {
        let is_rare = 2 * self.count(class) < self.points();
        (0..self.points()).map(|i| class.holds(self.block.top(i)) == is_rare).collect()
    }

    /// The smallest number of points that are, or are not, of one of these classes; of those that a study names only
    /// where some are and some are not.
    pub fn rarest(&self, classes: &[Class]) -> usize {
        let rarer = |&class: &Class| (class, self.count(class).min(self.points() - self.count(class)));
        let counts = classes.iter().map(rarer).filter(|&(class, rare)| rare > 0 || class == Class::NotUnstable);
        counts.map(|(_, rare)| rare).min().unwrap_or(0)
    }

    pub fn observer(&self) -> &'a dyn Observer {
        self.observer
    }

    /// How many errors at distant points of the boundary average out: about one per run. Of a single input the boundary
    /// is some points, and there is nothing to average.
    pub fn independent_errors(&self) -> f64 {
        if self.surrogate.inputs.dimension() == 1 { 1.0 } else { effective_count(&self.weights) }
    }

    /// By how much max Re can move at most if every component is larger by its residual: |√(d + e) ∓ √d| ≤ √|e| for a
    /// pair.
    fn reach(&self, residual: &[f64]) -> f64 {
        let part = |output: &Output, k: usize| {
            let [re, im] = [2 * k, 2 * k + 1].map(|at| residual[output.components[at].id]);
            re.hypot(im)
        };
        let of_output = |output: &Output| match (output.kind, output.modes.len()) {
            (OutputKind::Eigenvalue, _) => part(output, 0),
            (OutputKind::Cluster, 2) => part(output, 0) + part(output, 1).sqrt(),
            _ => f64::INFINITY,
        };
        // Not less than what rounding of the recombination adds.
        let of_margin = match self.surrogate.verdict.margin {
            Margin::GrowthRate(_) => 1.0,
            // |λ| moves by as much as λ.
            Margin::DampingRatio(ratio) => 1.0 + ratio,
        };
        of_margin * ROUNDING_MARGIN * self.surrogate.outputs.iter().map(of_output).fold(f64::MIN_POSITIVE, f64::max)
    }

    /// Δp of a class for the residuals of runs `first`….
    pub fn shares(&self, class: Class, residuals: &[Vec<f64>], first: usize) -> Result<Shares, Interrupted> {
        let tried = residuals.len().min(TRIED_RUNS);
        let run = |k: usize| k * residuals.len() / tried;
        let shares = try_map(tried, |k| {
            self.observer.check()?;
            Ok(self.share(class, &residuals[run(k)]))
        })?;
        Ok(Shares { shares, weights: (0..tried).map(|k| self.weights[first + run(k)]).collect() })
    }

    /// Points of a class gained minus lost, as a share, if every component were larger by its residual.
    fn share(&self, class: Class, residual: &[f64]) -> f64 {
        let (mut values, mut eigenvalues) = (vec![0.0; residual.len()], Vec::new());
        let mut gained = 0.0;
        let reach = self.reach(residual);
        for &(i, stands_for) in self.near.iter().take_while(|&&(i, _)| self.block.excess[i].abs() <= reach) {
            for ((value, component), rest) in values.iter_mut().zip(&self.block.components).zip(residual) {
                *value = component[i] + rest;
            }
            eigenvalues.clear();
            self.surrogate.outputs.iter().for_each(|output| output.recombine(&values, &mut eigenvalues));
            let moved = class.holds(self.surrogate.verdict.top(&eigenvalues));
            gained += stands_for * (f64::from(moved) - f64::from(class.holds(self.block.top(i))));
        }
        gained / self.points() as f64
    }
}

/// Whether a point with this excess is stable or marginal; what is no number is neither.
pub(super) fn is_not_unstable(excess: f64) -> bool {
    excess <= 0.0
}
