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
//! (Σw)²/Σw², or n = 1 for a single input, whose boundary is some points, the estimate is
//!
//! ε² = (rms(Δp)² (1 + 1/√k)² + 1/T²)/n + mean(Δp)² [only if beyond four standard errors] + δ² + f²,
//!
//! where k is the effective number of residuals, of which few may all be small by chance, and T the number of points:
//! shares below 1/T are not seen. (That part is reported, but no reason for more runs.) Where all else is small enough,
//! or would be but for less than one point, T grows until a thousand points lie on the rarer side, or as many are
//! evaluated as a few seconds allow. The change between the nested levels gives δ = |p − p′| m²/(m² + m′²), where m is
//! the mean |Δp| of this level and m′ that of the one before: of a difference of two independent errors of these sizes,
//! this is the share of the smaller one. And f is the share of runs that the model itself calls otherwise than the
//! modes the surrogate carries: modes left out, or real eigenvalues. More runs do not lower f, so the build does not
//! ask for them.
//!
//! All of this supposes fits that are good: of a poor one, the points may all lie on one side whatever residual is
//! added. Where more runs are misjudged by the fit without them than ε explains, their share is an error that counts,
//! too. And where a component that varies is predicted hardly better than by its mean, no error is known: modes that
//! are not followed between the runs may do anything there.
//!
//! Residuals of points that chose the settings of a fit flatter it, so rms and mean use blind residuals
//! ([`crate::fitting::fit::BlindResiduals`]), at least eight of them, which a first level does not have. In the
//! quantiles, residuals that are not blind are doubled. `tools/src/bin/decision_estimate.rs` compares estimate and
//! truth over seeds and sizes: the truth is a half to three quarters of the estimate in the median and seldom more than
//! three times it. Where errors all point the same way, the assumption of independence fails and it can be more.

use super::blindness::{Groups, unstable_runs};
use super::judged_points::{POINTS, at_judged_points, points_for};
use super::judgement::{JudgedShare, Judgement};
use super::named_shares::NamedShare;
use super::near_boundary::zone_share;
use super::trials::{Class, Judge, Shares, is_not_unstable};
use super::undecided::{excess_of_marginal, is_chance, misjudged, undecided};
use crate::campaign::Run;
use crate::fitting::fit::{FLATTERY, Fitted};
use pcc_evaluate::components::{Verdict, spectral_abscissa};
use pcc_evaluate::foundation::{Interrupted, Observer};
use pcc_evaluate::surrogate::{Decision, Quantile, Surrogate};

/// Levels of the stored quantiles.
const LEVELS: [f64; 9] = [0.005, 0.025, 0.05, 0.25, 0.5, 0.75, 0.95, 0.975, 0.995];

/// Blind residuals that an estimate takes at least.
const LEAST_BLIND: usize = 8;

/// Of fewer points on the rarer side, some batches of runs that look for it have soon tried those that matter: where
/// nothing else tells of it, more points are evaluated.
const FEW_RARE: usize = 100;

/// Recombination gives coalescing eigenvalues back to the root of rounding, relative to the largest.
const RECOMBINATION: f64 = 1e-7;

/// S² below which a component is hardly predicted, and errors, as a share of its scale, below which it does not vary.
const GUESSED: f64 = 0.5;
const VARIES: f64 = 1e-3;

/// A run is undecided if it lies within its error of the boundary, on either side; errors of one sign move points of
/// one side.
const BOTH_SIDES: f64 = 2.0;

/// A mean beyond so many standard errors is no chance.
const SIGNIFICANT: f64 = 4.0;

/// What the judgement of one level leaves for the next.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Previous {
    surrogate: Surrogate,
    /// One per class.
    at: Vec<At>,
}

/// What is compared between levels.
#[derive(Debug, Clone, Copy, PartialEq)]
struct At {
    /// Share of points of the class.
    proportion: f64,
    /// Mean |Δp| by residuals that took part in the fit.
    mean_change: f64,
}

/// What a judgement goes by of the level before.
#[derive(Debug, Clone, Copy)]
pub(super) struct Before<'a> {
    pub previous: &'a Previous,
    /// Whether groups have changed since: then no residuals are blind, and no error is small enough.
    pub is_regrouped: bool,
}

/// What a level is judged for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Purpose<'a> {
    /// The error that is asked for, relative to √(p (1 − p)).
    pub tolerance: Option<f64>,
    /// Whether no level follows.
    pub is_last: bool,
    /// Whether the share is known to be 0 or 1 if this level finds nothing near the boundary.
    pub is_final: bool,
    /// Verdicts whose shares the tolerance is of as well.
    pub shares: &'a [Verdict],
}

/// A level to be judged.
pub(super) struct Judged<'a> {
    pub surrogate: &'a Surrogate,
    pub fitted: &'a [Fitted],
    /// Of its components at its runs.
    pub values: &'a [Vec<f64>],
    pub runs: &'a [Run],
    /// Which runs are those of the design, or were given: a share of others is none of cases.
    pub of_design: Vec<usize>,
    /// The masses of the runs (`mass.rs`), if some were given.
    pub masses: Option<Vec<f64>>,
    /// How many runs were chosen near the boundary.
    pub near_boundary: usize,
}

/// Judges a level; `before` is the judgement of the level before. If there is none and the level is the last, nothing
/// can be estimated, and the points it would take are not evaluated.
pub(super) fn judge(
    level: Judged<'_>,
    before: Option<Before<'_>>,
    purpose: Purpose<'_>,
    observer: &dyn Observer,
) -> Result<Judgement, Interrupted> {
    let Judged { surrogate, fitted, values, runs, of_design, masses, near_boundary } = level;
    let masses = masses.as_deref();
    let left_out: Option<Vec<&Vec<f64>>> = fitted.iter().map(|fit| fit.leave_one_out_residuals.as_ref()).collect();
    let Some(left_out) = left_out else {
        return Ok(Judgement::default());
    };
    let seen: Vec<Vec<f64>> = (0..runs.len()).map(|i| left_out.iter().map(|rest| rest[i]).collect()).collect();
    let blind = blind_residuals(fitted, runs.len());
    let max_re_residuals = residual_quantiles(surrogate, &honest_residuals(&seen, &blind), values, (runs, masses));
    let unlisted = (0..runs.len()).filter(|&i| contradicts(surrogate, values, i, &runs[i])).count() as u64;
    let groups = Groups::new(surrogate, values, &seen);
    let mut sight = groups.sight(unstable_runs(surrogate, values, runs.len()), runs.len());
    if purpose.is_last && before.is_none() && unlisted == 0 {
        let decision = Decision { max_re_residuals, proportion_error: None };
        return Ok(Judgement { decision, sight: Some(sight), ..Judgement::default() });
    }
    let residuals = Residuals { seen, blind };
    let forgotten = unlisted as f64 / runs.len() as f64;
    let judge = Judge::new(surrogate, (runs, masses), POINTS, observer)?;
    let classes = Class::all(purpose.shares);
    let find = |judge: &Judge<'_>| -> Result<Vec<Found>, Interrupted> {
        let each = classes.iter().enumerate();
        each.map(|(number, &class)| Found::by(judge, (number, class), &residuals, before, forgotten)).collect()
    };
    let mut found = find(&judge)?;
    let is_guess = is_guess(surrogate, fitted);
    let undecided = undecided(surrogate, values, &residuals.seen, runs);
    // A change that no point shows is below one of all.
    let change = found[0].at.mean_change.max(((POINTS * runs.len()) as f64).recip());
    let is_chance_of = |count, runs: f64| is_chance(count, BOTH_SIDES * change * runs);
    let chosen = near_boundary as f64;
    let at_random = runs.len() as f64 - chosen + chosen / zone_share(surrogate, judge.rarest(&classes[..1]));
    let is_doubtful = is_guess || !is_chance_of(undecided, at_random);
    let random = of_design.len() as f64;
    let misjudged = misjudged(surrogate, values, &residuals.seen, runs, &of_design);
    let mass = |runs: &[usize]| masses.map_or(runs.len() as f64, |masses| runs.iter().map(|&i| masses[i]).sum());
    let misjudged = if is_chance_of(misjudged.len(), random) { 0.0 } else { mass(&misjudged) / mass(&of_design) };
    let unsettled = excess_of_marginal(surrogate, values, &residuals.seen, runs, &of_design).len();
    // One may be marginal by chance.
    let misjudged = if unsettled > 1 { misjudged.max(unsettled as f64 / random) } else { misjudged };
    if sight.is_blind() && sight.rare() == 0 && !is_guess {
        let is_stable = sight.unstable == 0;
        sight.points = judge.points();
        sight.clearance = groups.clearance(surrogate, judge.block(), is_stable);
        if sight.clearance.is_some() && purpose.is_final {
            let block = at_judged_points(surrogate, points_for(surrogate, 0), observer)?;
            sight.points = block.excess.len();
            sight.clearance = groups.clearance(surrogate, &block, is_stable);
        }
    }
    let judged = |found: &[Found]| Judgement {
        sight: Some(sight),
        ..judgement(found, purpose.shares, runs, is_doubtful).with_misjudged(misjudged)
    };
    let mut judgement = judged(&found);
    let points = points_for(surrogate, judge.rarest(&classes));
    // The next level compares the share of these points.
    let mut at: Vec<At> = found.iter().map(|found| found.at).collect();
    if points > POINTS && purpose.tolerance.is_some_and(|tolerance| judgement.may_be_within(tolerance)) {
        let judge = Judge::new(surrogate, (runs, masses), points, observer)?;
        found = find(&judge)?;
        at.iter_mut().zip(&found).for_each(|(at, found)| at.mean_change = found.at.mean_change);
        judgement = judged(&found);
    }
    if purpose.tolerance.is_some() {
        let has_few = judgement.is_blind() && (1..FEW_RARE).contains(&judge.rarest(&classes));
        let more = has_few.then(|| Judge::new(surrogate, (runs, masses), points, observer)).transpose()?;
        let judge = more.as_ref().unwrap_or(&judge);
        judgement.excess.clone_from(&judge.block().excess);
        judgement.rarer = judge.rarer(judgement.missed());
    }
    let share = found[0].share;
    let proportion_error = judgement.error.map(|error| error / share.reference()).filter(|error| error.is_finite());
    // Residuals of growth rates say nothing of what modes do that are not followed between the runs; runs that are
    // misjudged do.
    let proportion_error = proportion_error.filter(|_| !is_guess || misjudged > 0.0);
    let decision = Decision { max_re_residuals, proportion_error };
    let previous = Some(Previous { surrogate: surrogate.clone(), at });
    Ok(Judgement { decision, unlisted, previous, ..judgement })
}

/// Whether a component that varies is predicted hardly better than by its mean.
fn is_guess(surrogate: &Surrogate, fitted: &[Fitted]) -> bool {
    let components = surrogate.outputs.iter().flat_map(|output| &output.components);
    components.zip(fitted).any(|(component, fit)| {
        let is_poor = fit.errors.and_then(|errors| errors.s2).is_some_and(|s2| s2 < GUESSED);
        is_poor && fit.left_out_error().is_some_and(|error| error > VARIES * component.scale)
    })
}

/// Residuals at runs left out, by run: of all, and of the last ones that no component has used for a choice.
struct Residuals {
    seen: Vec<Vec<f64>>,
    blind: Vec<Vec<f64>>,
}

/// What a number of points says.
struct Found {
    share: JudgedShare,
    at: At,
    error: Option<f64>,
    reducible_error: Option<f64>,
}

impl Found {
    fn by(
        judge: &Judge<'_>,
        (number, class): (usize, Class),
        residuals: &Residuals,
        before: Option<Before<'_>>,
        forgotten: f64,
    ) -> Result<Self, Interrupted> {
        let Residuals { seen, blind } = residuals;
        let by_seen = judge.shares(class, seen, 0)?;
        let value = judge.count(class) as f64 / judge.points() as f64;
        let at = At { proportion: value, mean_change: by_seen.mean_of(f64::abs) };
        let unseen = (judge.points() as f64).recip();
        let former = before.map(|before| judge.at_same_points(before.previous, number, class)).transpose()?;
        let (reducible_error, error) = match (before, former) {
            (Some(Before { is_regrouped: false, .. }), Some(former)) if blind.len() >= LEAST_BLIND.min(seen.len()) => {
                let by_blind = judge.shares(class, blind, seen.len() - blind.len())?;
                let error = |unseen| Some(error_of_share(&by_blind, judge.independent_errors(), former, at, unseen));
                (error(0.0), error(unseen))
            }
            (Some(_), Some(former)) => {
                // Residuals that flatter, and all of the change between the levels.
                let honest = judge.shares(class, &honest_residuals(seen, blind), 0)?;
                let change = at.proportion - former.proportion;
                (None, Some(error_of_share(&honest, judge.independent_errors(), at, at, unseen).hypot(change)))
            }
            _ => (None, None),
        };
        let error = match error {
            None if forgotten == 0.0 => None,
            error => Some(error.unwrap_or(0.0).hypot(forgotten)),
        };
        let share = JudgedShare { value, points: judge.points() };
        Ok(Self { share, at, error, reducible_error })
    }
}

/// What was found of the first class, and of those that the study names.
fn judgement(found: &[Found], named: &[Verdict], runs: &[Run], is_doubtful: bool) -> Judgement {
    let own = |(&verdict, found): (&Verdict, &Found)| {
        let of_it = runs.iter().filter(|run| run.spectrum.top().verdict() == verdict).count();
        let Found { share, error, reducible_error, .. } = *found;
        NamedShare { verdict, share, runs: [of_it, runs.len() - of_it], error, reducible_error }
    };
    let named = named.iter().zip(&found[1..]).map(own).collect();
    let Found { share, error, reducible_error, .. } = found[0];
    Judgement { share: Some(share), error, reducible_error, is_doubtful, named, ..Judgement::default() }
}

impl Judge<'_> {
    /// What the level before says at these points.
    fn at_same_points(&self, previous: &Previous, number: usize, class: Class) -> Result<At, Interrupted> {
        if self.points() == POINTS {
            return Ok(previous.at[number]);
        }
        let block = at_judged_points(&previous.surrogate, self.points(), self.observer())?;
        Ok(At { proportion: class.count(&block) as f64 / self.points() as f64, ..previous.at[number] })
    }
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
    (runs, masses): (&[Run], Option<&[f64]>),
) -> Vec<Quantile> {
    let residual = |(i, rest): (usize, &Vec<f64>)| {
        let predicted: Vec<f64> = values.iter().zip(rest).map(|(value, rest)| value[i] - rest).collect();
        runs[i].spectrum.max_re() - spectral_abscissa(&surrogate.eigenvalues(&predicted))
    };
    let found = residuals.iter().enumerate().map(residual);
    let Some(masses) = masses else {
        let mut found: Vec<f64> = found.collect();
        found.sort_by(f64::total_cmp);
        return LEVELS.map(|level| Quantile { level, value: quantile(&found, level) }).to_vec();
    };
    let mut found: Vec<(f64, f64)> = found.zip(masses.iter().copied()).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    LEVELS.map(|level| Quantile { level, value: weighted_quantile(&found, level) }).to_vec()
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

/// ε of the module's head, in points of probability, where shares below `unseen` are not seen.
fn error_of_share(shares: &Shares, independent: f64, previous: At, now: At, unseen: f64) -> f64 {
    let square = shares.mean_of(|share| share * share);
    let mean = shares.mean_of(|share| share);
    let count = shares.effective_count();
    let is_significant = mean.abs() > SIGNIFICANT * (square / count).sqrt();
    let systematic = if is_significant { mean } else { 0.0 };
    let (square_now, square_former) = (now.mean_change.powi(2), previous.mean_change.powi(2));
    let left = if square_former > 0.0 { square_now / (square_now + square_former) } else { 0.5 };
    let change = (now.proportion - previous.proportion) * left;
    let cautious = square * (1.0 + count.sqrt().recip()).powi(2);
    ((cautious + unseen * unseen) / independent + systematic * systematic + change * change).sqrt()
}

/// The quantile of sorted values by linear interpolation between order statistics (type 7 of Hyndman and Fan 1996).
pub(super) fn quantile(sorted: &[f64], level: f64) -> f64 {
    let position = level * (sorted.len() - 1) as f64;
    let below = position.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (position - below as f64) * (sorted[above] - sorted[below])
}

/// The same of values with weights: a value stands at the weight of all before it and half its own. Of equal weights it
/// is [`quantile`].
fn weighted_quantile(sorted: &[(f64, f64)], level: f64) -> f64 {
    let between = |pair: &[(f64, f64)]| 0.5 * (pair[0].1 + pair[1].1);
    let wanted = level * sorted.windows(2).map(between).sum::<f64>();
    let mut position = 0.0;
    for pair in sorted.windows(2) {
        let step = between(pair);
        if step > 0.0 && position + step >= wanted {
            return pair[0].0 + ((wanted - position) / step).clamp(0.0, 1.0) * (pair[1].0 - pair[0].0);
        }
        position += step;
    }
    sorted.last().map_or(0.0, |last| last.0)
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
    fn quantiles_of_weighted_values_are_those_of_repeated_ones() {
        let equal = [(0.0, 0.2), (1.0, 0.2), (4.0, 0.2)];
        for level in [0.0, 0.1, 0.25, 0.5, 0.75, 1.0] {
            assert!((weighted_quantile(&equal, level) - quantile(&[0.0, 1.0, 4.0], level)).abs() < 1e-12, "{level}");
        }
        let rare = [(0.0, 98.0), (10.0, 1.0), (20.0, 1.0)];
        assert!(weighted_quantile(&rare, 0.5) > 5.0 && weighted_quantile(&rare, 0.95) < 10.0);
        assert_eq!(
            [weighted_quantile(&[(7.0, 0.0)], 0.3), weighted_quantile(&[(1.0, 0.0), (2.0, 0.0)], 0.3)],
            [7.0, 2.0]
        );
    }

    #[test]
    fn scattered_errors_average_out_and_common_ones_do_not() {
        let weights = vec![1.0; 100];
        let now = At { proportion: 0.5, mean_change: 0.01 };
        let scattered = Shares { shares: (0..100).map(|i| if i % 2 == 0 { 0.01 } else { -0.01 }).collect(), weights };
        assert!((error_of_share(&scattered, 100.0, now, now, UNSEEN) - 1.1 * 0.01 / 10.0).abs() < UNSEEN);
        let common = Shares { shares: vec![0.01; 100], weights: vec![1.0; 100] };
        assert!(error_of_share(&common, 100.0, now, now, UNSEEN) > 0.01);
    }

    #[test]
    fn the_change_between_levels_counts_by_how_far_errors_fell() {
        let none = Shares { shares: vec![0.0; 10], weights: vec![1.0; 10] };
        let previous = At { proportion: 0.52, mean_change: 0.03 };
        let now = At { proportion: 0.5, mean_change: 0.01 };
        assert!((error_of_share(&none, 10.0, previous, now, UNSEEN) - 0.02 * 0.1).abs() < UNSEEN);
        let resolved = error_of_share(&none, 10.0, now, now, UNSEEN);
        assert!(resolved > 0.0 && resolved < UNSEEN, "nothing seen is not nothing there");
    }
}
