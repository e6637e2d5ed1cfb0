//! How far the surrogate is off where stability is decided, from predictions of points left out.
//!
//! Every run i, left out, has a residual of each component. They are pushed through the recombination in two ways.
//!
//! **Residuals of max Re.** The predictions of all components at point i form eigenvalues; max Re of the model minus
//! that of the prediction is one residual. Its quantiles are stored, for the band that `eval` prints.
//!
//! **Error of the proportion.** The residuals of run i are added to the components at many random points; the share of
//! points that change sides, Δp_i (points that are not unstable, gained minus lost), is what the proportion would be
//! off by if the surrogate erred by that much everywhere. Only points where the largest excess e, max Re with the
//! margin, is near zero change sides, and runs are weighted by how near their own is, w_i = 1/(1 + (e_i/median)²).
//! Marginal points do not say how near they are, so they are tried evenly spread. Errors at distant points of the
//! stability boundary are taken as independent, about one per design point, so with the effective number of runs n =
//! (Σw)²/Σw² the estimate is
//!
//! ε² = (rms(Δp)² (1 + 1/√k)² + 1/T²)/n + mean(Δp)² [only if beyond four standard errors] + δ² + f²,
//!
//! where k is the effective number of residuals, of which few may all be small by chance, and T the number of points:
//! shares below 1/T are not seen. (That part is reported, but no reason for more runs: where few cases are stable, it
//! would take thousands.) The change between the nested levels gives δ = |p − p′| m²/(m² + m′²), where m is the mean
//! |Δp| of this level and m′ that of the one before: of a difference of two independent errors of these sizes, this is
//! the share of the smaller one. And f is the share of runs that the model itself calls otherwise than the modes the
//! surrogate carries: modes left out, or real eigenvalues. More runs do not lower f, so the build does not ask for
//! them.
//!
//! Residuals of points that chose the settings of a fit flatter it, so rms and mean use blind residuals
//! ([`crate::fitting::fit::BlindResiduals`]), at least eight of them, which a first level does not have. In the
//! quantiles, residuals that are not blind are doubled. `tools/src/bin/decision_estimate.rs` compares estimate and
//! truth over seeds and sizes: the truth is a half to three quarters of the estimate in the median and seldom more than
//! three times it. Where errors all point the same way, the assumption of independence fails and it can be more.

use super::undecided::{is_chance, undecided};
use crate::campaign::Run;
use crate::fitting::fit::Fitted;
use pcc_evaluate::components::{Block, Margin, Output, OutputKind, spectral_abscissa};
use pcc_evaluate::evaluation::{Plan, evaluate_points};
use pcc_evaluate::foundation::{Interrupted, Observer, try_map};
use pcc_evaluate::probability::inputs::random_point;
use pcc_evaluate::probability::random::Purpose;
use pcc_evaluate::surrogate::{Decision, Quantile, Surrogate};

/// Levels of the stored quantiles.
const LEVELS: [f64; 9] = [0.005, 0.025, 0.05, 0.25, 0.5, 0.75, 0.95, 0.975, 0.995];

/// Points at which proportions are compared between levels: T.
const POINTS: usize = 50_000;

/// Points that are tried for changing sides, those with the smallest excess, and as many marginal ones. Of the others,
/// which only errors as large as all of the excess reach, each of those tried stands for [`FAR_APART`].
const TRIED_POINTS: usize = 10_000;
const FAR_APART: usize = 20;

/// Runs whose residuals are tried, evenly spread: more change the estimate less than it is uncertain anyway.
const TRIED_RUNS: usize = 150;

/// Blind residuals that an estimate takes at least.
const LEAST_BLIND: usize = 8;

/// How much smaller residuals look at points that chose the settings of the fit, about.
const FLATTERY: f64 = 2.0;

/// Recombination gives coalescing eigenvalues back to the root of rounding, relative to the largest.
const RECOMBINATION: f64 = 1e-7;

/// Bounds are exceeded by rounding by less.
const ROUNDING_MARGIN: f64 = 1.001;

/// A run is undecided if it lies within its error of the boundary, on either side; errors of one sign move points of
/// one side.
const BOTH_SIDES: f64 = 2.0;

/// A mean beyond so many standard errors is no chance.
const SIGNIFICANT: f64 = 4.0;

/// The points are the same for all surrogates of a dimension and seed: numbers of a design's stream that no level has.
const FIRST_INDEX: u64 = 1 << 40;

/// What the judgement of one level leaves for the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Previous {
    /// Proportion of stable points.
    proportion: f64,
    /// Mean |Δp| by residuals that took part in the fit.
    mean_change: f64,
}

impl Previous {
    /// What errors are relative to: the proportion, or all points where it is zero.
    fn reference(&self) -> f64 {
        if self.proportion > 0.0 { self.proportion } else { 1.0 }
    }
}

/// What a judgement goes by of the level before.
#[derive(Debug, Clone, Copy)]
pub(super) struct Before {
    pub previous: Previous,
    /// Whether groups have changed since: then no residuals are blind, and no error is small enough.
    pub is_regrouped: bool,
}

/// What is known of a surrogate's decision.
#[derive(Default)]
pub(super) struct Judgement {
    /// What is stored.
    pub decision: Decision,
    /// Number of runs whose stability the carried modes do not decide as the model does.
    pub unlisted: u64,
    /// The estimated relative error without the parts that more runs do not lower, or are not worth.
    pub reducible_error: Option<f64>,
    /// Whether more runs are undecided than so small an error explains.
    pub is_doubtful: bool,
    /// For the next level.
    pub previous: Option<Previous>,
}

/// Judges `surrogate`, fitted to `values` of its components at `runs`; `before` is the judgement of the level before.
/// If there is none and the level `is_last`, nothing can be estimated, and the points it would take are not evaluated.
pub(super) fn judge(
    surrogate: &Surrogate,
    fitted: &[Fitted],
    values: &[Vec<f64>],
    runs: &[Run],
    before: Option<Before>,
    is_last: bool,
    observer: &dyn Observer,
) -> Result<Judgement, Interrupted> {
    let left_out: Option<Vec<&Vec<f64>>> = fitted.iter().map(|fit| fit.leave_one_out_residuals.as_ref()).collect();
    let Some(left_out) = left_out else {
        return Ok(Judgement::default());
    };
    let seen: Vec<Vec<f64>> = (0..runs.len()).map(|i| left_out.iter().map(|rest| rest[i]).collect()).collect();
    let blind = blind_residuals(fitted, runs.len());
    let max_re_residuals = residual_quantiles(surrogate, &honest_residuals(&seen, &blind), values, runs);
    let unlisted = (0..runs.len()).filter(|&i| contradicts(surrogate, values, i, &runs[i])).count() as u64;
    let forgotten = unlisted as f64 / runs.len() as f64;
    if is_last && before.is_none() && forgotten == 0.0 {
        let decision = Decision { max_re_residuals, proportion_error: None };
        return Ok(Judgement { decision, unlisted, ..Judgement::default() });
    }
    let judge = Judge::new(surrogate, runs, observer)?;
    let by_seen = judge.shares(&seen, 0)?;
    let now = Previous { proportion: judge.proportion(), mean_change: by_seen.mean_of(f64::abs) };
    let unseen = 1.0 / POINTS as f64;
    let (reducible_error, whole_error) = match before {
        Some(Before { previous, is_regrouped: false }) if blind.len() >= LEAST_BLIND.min(runs.len()) => {
            let by_blind = judge.shares(&blind, runs.len() - blind.len())?;
            let error = |unseen| Some(relative_error(&by_blind, judge.effective_runs(), previous, now, unseen));
            (error(0.0), error(unseen))
        }
        Some(Before { previous, .. }) => {
            // Residuals that flatter, and all of the change between the levels.
            let honest = judge.shares(&honest_residuals(&seen, &blind), 0)?;
            let change = (now.proportion - previous.proportion) / now.reference();
            (None, Some(relative_error(&honest, judge.effective_runs(), now, now, unseen).hypot(change)))
        }
        None => (None, None),
    };
    let error = match whole_error {
        None if forgotten == 0.0 => None,
        error => Some(error.unwrap_or(0.0).hypot(forgotten / now.reference())).filter(|error| error.is_finite()),
    };
    let decision = Decision { max_re_residuals, proportion_error: error };
    let undecided = undecided(surrogate, values, &seen, runs);
    let is_doubtful = !is_chance(undecided, BOTH_SIDES * now.mean_change * runs.len() as f64);
    Ok(Judgement { decision, unlisted, reducible_error, is_doubtful, previous: Some(now) })
}

/// The residuals of the last points of the design, by point, that no component has used for a choice.
fn blind_residuals(fitted: &[Fitted], points: usize) -> Vec<Vec<f64>> {
    let blind: Option<Vec<_>> = fitted.iter().map(|fit| fit.blind_residuals.as_ref()).collect();
    let Some(blind) = blind else { return Vec::new() };
    let first = blind.iter().map(|residuals| residuals.first).max().unwrap_or(points);
    let at = |i: usize| blind.iter().map(|residuals| residuals.values[i - residuals.first]).collect();
    (first..points).map(at).collect()
}

/// Blind residuals where there are some, else those of the fit as large as they might be.
fn honest_residuals(seen: &[Vec<f64>], blind: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let inflated = seen[..seen.len() - blind.len()].iter();
    inflated.map(|rest| rest.iter().map(|e| FLATTERY * e).collect()).chain(blind.iter().cloned()).collect()
}

/// The largest excess at run i over the modes that the surrogate carries, by the model.
fn carried_excess(surrogate: &Surrogate, values: &[Vec<f64>], i: usize) -> f64 {
    let exact: Vec<f64> = values.iter().map(|value| value[i]).collect();
    surrogate.top(&exact).excess
}

fn contradicts(surrogate: &Surrogate, values: &[Vec<f64>], i: usize, run: &Run) -> bool {
    let carried = carried_excess(surrogate, values, i);
    let (model, scale) = (run.spectrum.top().excess, run.spectrum.largest());
    is_not_unstable(model) != is_not_unstable(carried) && (model - carried).abs() > RECOMBINATION * scale
}

fn residual_quantiles(
    surrogate: &Surrogate,
    residuals: &[Vec<f64>],
    values: &[Vec<f64>],
    runs: &[Run],
) -> Vec<Quantile> {
    let residual = |(i, rest): (usize, &Vec<f64>)| {
        let predicted: Vec<f64> = values.iter().zip(rest).map(|(value, rest)| value[i] - rest).collect();
        runs[i].spectrum.max_re() - spectral_abscissa(&surrogate.eigenvalues(&predicted))
    };
    let mut found: Vec<f64> = residuals.iter().enumerate().map(residual).collect();
    found.sort_by(f64::total_cmp);
    LEVELS.map(|level| Quantile { level, value: quantile(&found, level) }).to_vec()
}

/// What is known of a surrogate by quadrature, from `values` of its components and `runs` at nodes with these
/// `weights`, which sum to one. Residuals at nodes say nothing of what lies between them, so only the share of cases is
/// known in which modes that the surrogate does not carry decide stability.
pub(super) fn judge_by_nodes(surrogate: &Surrogate, values: &[Vec<f64>], runs: &[Run], weights: &[f64]) -> Judgement {
    let share = |holds: &dyn Fn(usize) -> bool| (0..runs.len()).filter(|&i| holds(i)).map(|i| weights[i]).sum::<f64>();
    let is_unlisted: Vec<bool> = (0..runs.len()).map(|i| contradicts(surrogate, values, i, &runs[i])).collect();
    let unlisted = is_unlisted.iter().filter(|&&holds| holds).count() as u64;
    let forgotten = share(&|i| is_unlisted[i]);
    let stable = share(&|i| is_not_unstable(carried_excess(surrogate, values, i)));
    let proportion_error = (forgotten > 0.0).then_some(forgotten / stable).filter(|error| error.is_finite());
    let decision = Decision { max_re_residuals: Vec::new(), proportion_error };
    Judgement { decision, unlisted, ..Judgement::default() }
}

/// ε of the module's head, relative to the proportion, or to the whole where that is zero, where shares below `unseen`
/// are not seen.
fn relative_error(shares: &Shares, effective_runs: f64, previous: Previous, now: Previous, unseen: f64) -> f64 {
    let square = shares.mean_of(|share| share * share);
    let mean = shares.mean_of(|share| share);
    let count = shares.effective_count();
    let is_significant = mean.abs() > SIGNIFICANT * (square / count).sqrt();
    let systematic = if is_significant { mean } else { 0.0 };
    let (square_now, square_former) = (now.mean_change.powi(2), previous.mean_change.powi(2));
    let left = if square_former > 0.0 { square_now / (square_now + square_former) } else { 0.5 };
    let change = (now.proportion - previous.proportion) * left;
    let cautious = square * (1.0 + count.sqrt().recip()).powi(2);
    let error = ((cautious + unseen * unseen) / effective_runs + systematic * systematic + change * change).sqrt();
    error / now.reference()
}

/// Shares of points that change sides, one per run, with the weights of the runs.
struct Shares {
    shares: Vec<f64>,
    weights: Vec<f64>,
}

impl Shares {
    fn mean_of(&self, part: impl Fn(f64) -> f64) -> f64 {
        let sum: f64 = self.shares.iter().zip(&self.weights).map(|(&share, weight)| weight * part(share)).sum();
        sum / self.weights.iter().sum::<f64>()
    }

    fn effective_count(&self) -> f64 {
        effective_count(&self.weights)
    }
}

/// (Σw)²/Σw².
fn effective_count(weights: &[f64]) -> f64 {
    weights.iter().sum::<f64>().powi(2) / weights.iter().map(|weight| weight * weight).sum::<f64>()
}

/// A surrogate at the points at which proportions are compared, the same for all of a dimension and seed.
pub(super) fn at_judged_points(surrogate: &Surrogate, observer: &dyn Observer) -> Result<Block, Interrupted> {
    let plan = Plan::new(surrogate);
    const PART: usize = 4096;
    let parts = try_map(POINTS.div_ceil(PART), |part| {
        observer.check()?;
        let range = part * PART..POINTS.min((part + 1) * PART);
        let points: Vec<Vec<f64>> = range.map(|i| judged_point(surrogate, i)).collect();
        Ok(evaluate_points(surrogate, &plan, &points.iter().map(Vec::as_slice).collect::<Vec<_>>()))
    })?;
    let mut block = Block::with_capacity(surrogate.component_count(), surrogate.labels().len(), POINTS);
    for part in parts {
        block.append(part);
    }
    Ok(block)
}

/// The standardized point number `i` of those.
pub(super) fn judged_point(surrogate: &Surrogate, i: usize) -> Vec<f64> {
    let mut point = vec![0.0; surrogate.inputs.dimension()];
    let (inputs, seed) = (&surrogate.inputs, surrogate.training.seed);
    random_point(inputs, seed, Purpose::Design, FIRST_INDEX + i as u64, &mut point);
    point
}

/// The surrogate at many random points.
struct Judge<'a> {
    surrogate: &'a Surrogate,
    block: Block,
    /// The points that are tried, by their distance from instability, each with the number of points it stands for.
    near: Vec<(usize, f64)>,
    weights: Vec<f64>,
    observer: &'a dyn Observer,
}

impl<'a> Judge<'a> {
    fn new(surrogate: &'a Surrogate, runs: &[Run], observer: &'a dyn Observer) -> Result<Self, Interrupted> {
        let block = at_judged_points(surrogate, observer)?;
        // Marginal points do not say how near they are to instability.
        let (marginal, mut near): (Vec<usize>, Vec<usize>) = (0..POINTS).partition(|&i| block.excess[i] == 0.0);
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
        let weights = distances.iter().map(|distance| 1.0 / (1.0 + (distance / scale).powi(2))).collect();
        Ok(Self { surrogate, block, near, weights, observer })
    }

    /// The share of points that are not unstable.
    fn proportion(&self) -> f64 {
        self.block.excess.iter().filter(|&&excess| is_not_unstable(excess)).count() as f64 / POINTS as f64
    }

    fn effective_runs(&self) -> f64 {
        effective_count(&self.weights)
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

    /// Δp for the residuals of runs `first`….
    fn shares(&self, residuals: &[Vec<f64>], first: usize) -> Result<Shares, Interrupted> {
        let tried = residuals.len().min(TRIED_RUNS);
        let run = |k: usize| k * residuals.len() / tried;
        let shares = try_map(tried, |k| {
            self.observer.check()?;
            Ok(self.share(&residuals[run(k)]))
        })?;
        Ok(Shares { shares, weights: (0..tried).map(|k| self.weights[first + run(k)]).collect() })
    }

    /// Stable points gained minus lost, as a share, if every component were larger by its residual.
    fn share(&self, residual: &[f64]) -> f64 {
        let (mut values, mut eigenvalues) = (vec![0.0; residual.len()], Vec::new());
        let mut gained = 0.0;
        let reach = self.reach(residual);
        for &(i, stands_for) in self.near.iter().take_while(|&&(i, _)| self.block.excess[i].abs() <= reach) {
            for ((value, component), rest) in values.iter_mut().zip(&self.block.components).zip(residual) {
                *value = component[i] + rest;
            }
            eigenvalues.clear();
            self.surrogate.outputs.iter().for_each(|output| output.recombine(&values, &mut eigenvalues));
            let moved = is_not_unstable(self.surrogate.verdict.top(&eigenvalues).excess);
            gained += stands_for * (f64::from(moved) - f64::from(is_not_unstable(self.block.excess[i])));
        }
        gained / POINTS as f64
    }
}

/// Whether a point with this excess is stable or marginal; what is no number is neither.
fn is_not_unstable(excess: f64) -> bool {
    excess <= 0.0
}

/// The quantile of sorted values by linear interpolation between order statistics (type 7 of Hyndman and Fan 1996).
fn quantile(sorted: &[f64], level: f64) -> f64 {
    let position = level * (sorted.len() - 1) as f64;
    let below = position.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (position - below as f64) * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What shares too small to be seen add to these estimates.
    const UNSEEN: f64 = 2e-5;

    #[test]
    fn quantiles_interpolate_between_order_statistics() {
        let sorted = [0.0, 1.0, 4.0];
        assert_eq!([0.0, 0.25, 0.5, 0.75, 1.0].map(|level| quantile(&sorted, level)), [0.0, 0.5, 1.0, 2.5, 4.0]);
        assert_eq!(quantile(&[7.0], 0.3), 7.0);
    }

    #[test]
    fn scattered_errors_average_out_and_common_ones_do_not() {
        let weights = vec![1.0; 100];
        let now = Previous { proportion: 0.5, mean_change: 0.01 };
        let scattered = Shares { shares: (0..100).map(|i| if i % 2 == 0 { 0.01 } else { -0.01 }).collect(), weights };
        assert!((relative_error(&scattered, 100.0, now, now, UNSEEN) - 1.1 * 0.01 / 10.0 / 0.5).abs() < UNSEEN);
        let common = Shares { shares: vec![0.01; 100], weights: vec![1.0; 100] };
        assert!(relative_error(&common, 100.0, now, now, UNSEEN) > 0.01 / 0.5);
    }

    #[test]
    fn the_change_between_levels_counts_by_how_far_errors_fell() {
        let none = Shares { shares: vec![0.0; 10], weights: vec![1.0; 10] };
        let previous = Previous { proportion: 0.52, mean_change: 0.03 };
        let now = Previous { proportion: 0.5, mean_change: 0.01 };
        assert!((relative_error(&none, 10.0, previous, now, UNSEEN) - 0.02 * 0.1 / 0.5).abs() < UNSEEN);
        let resolved = relative_error(&none, 10.0, now, now, UNSEEN);
        assert!(resolved > 0.0 && resolved < UNSEEN, "nothing seen is not nothing there");
        let nowhere = Previous { proportion: 0.0, ..now };
        assert!(relative_error(&none, 10.0, nowhere, nowhere, UNSEEN) < UNSEEN, "nothing is stable, and that is known");
    }
}
