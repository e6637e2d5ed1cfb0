//! Bounds on the stability proportion: fresh model runs against the surrogate.

use super::direct_computations::{ReferenceError, for_each_chunk_of};
use super::strata::{Drawn, Origin, Strata, Wanted};
use super::verdicts::Verdicts;
use crate::campaign::Campaign;
use crate::mechanics::spectrum::Spectrum;
use pcc_evaluate::evaluation::Plan;
use pcc_evaluate::foundation::Observer;
use pcc_evaluate::probability::inputs::random_point;
use pcc_evaluate::probability::random::Purpose;
use pcc_evaluate::probability::statistics::{
    ClassDiscordance, DiscordantCounts, FarErrors, NoBound, Proportion, StratifiedCounts, StratumCounts, Thinning,
    bound_of_class,
};
use pcc_evaluate::surrogate::{
    AssumedBound, Certificate, ErrorTail, FallingErrors, MarginalBounds, RareSide, StratumRuns, Surrogate, Withheld,
};

/// How the points are drawn, as certificates say it.
const SCHEME: &str = "strata";

/// Runs inside the rare set: if all are as predicted, the lower end is 0.94 of the surrogate's share.
const INSIDE: u64 = 50;

/// Runs outside, at least: fewer leave a bound of a quarter of all cases even where nothing disagrees.
pub const LEAST_RUNS: u64 = 10;

/// The points that a certificate with so many runs outside the rare set takes.
fn wanted(outside: u64) -> Wanted {
    Wanted { outside, layer: outside.div_ceil(3), inside: INSIDE, resolved: outside }
}

/// Runs the model of a study, or of a campaign that keeps books of its runs, and bounds its stability proportion,
/// whatever the surrogate. The rarer of stable and not stable, by the surrogate, divides the runs: `runs` at random
/// points that the surrogate does not put on that side, a third as many more in the layer nearest to it, and 50 at
/// random points that it puts there.
///
/// The verified bound is [`StratifiedCounts::bound`], and where points are marginal
/// [`pcc_evaluate::probability::statistics::bound_of_class`] of the other two shares. Each end holds at `side_level`.
/// The bound if errors fall off is [`FarErrors::upper`].
///
/// The points belong to a purpose of their own: they are independent of the design and of all evaluation points,
/// whatever the seeds. The certificate is to be added to those the surrogate has; choosing among seeds by their result
/// would void its level, so all of them stay visible.
///
/// # Errors
///
/// [`ReferenceError`], [`ReferenceError::TooFewRuns`] with fewer than [`LEAST_RUNS`]. Whether the study asks what the
/// surrogate answers is for the caller to decide; inputs must agree, or [`ReferenceError::OtherProblem`] is returned.
pub fn certify_with_model<'a>(
    surrogate: &Surrogate,
    campaign: impl Into<Campaign<'a>>,
    runs: u64,
    seed: u64,
    side_level: f64,
    observer: &dyn Observer,
) -> Result<Certificate, ReferenceError> {
    let campaign = campaign.into();
    let study = campaign.study;
    if !surrogate.inputs.is_same_as(&study.inputs) {
        return Err(ReferenceError::other_problem(surrogate, study));
    }
    if runs < LEAST_RUNS {
        return Err(ReferenceError::TooFewRuns { runs, least: LEAST_RUNS });
    }
    let strata = Strata::new(surrogate, &Plan::new(surrogate), seed, wanted(runs), observer)?;
    let mut found = Outcomes::default();
    let point = |number: u64| {
        let mut point = vec![0.0; study.inputs.dimension()];
        let index = strata.drawn[number as usize].index;
        random_point(&study.inputs, seed, Purpose::Certification, index, &mut point);
        point
    };
    for_each_chunk_of(campaign, strata.drawn.len() as u64, point, observer, |chunk| {
        let excess = |spectrum: &Spectrum| spectrum.top().excess;
        for (&number, run) in chunk.numbers.iter().zip(&chunk.runs) {
            found.add(strata.rare_side, &strata.drawn[number as usize], Some(excess(&run.spectrum)));
        }
        for &number in &chunk.failed_numbers {
            found.add(strata.rare_side, &strata.drawn[number as usize], None);
        }
        Ok(())
    })?;
    Ok(found.certificate(&strata, seed, side_level, study.problem_hash()))
}

/// How many runs a certificate takes whose upper end lies at most `width` above the surrogate's share of its rarer
/// side.
#[derive(Debug, Clone, PartialEq)]
pub struct RunsForWidth {
    /// The rarer side.
    pub rare_side: RareSide,
    /// Its share of samples of the surrogate.
    pub share: Proportion,
    /// Per number of runs outside that are on the rare side all the same, from none: what to ask for.
    pub runs: Vec<RunsNeeded>,
}

/// Runs of a certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunsNeeded {
    /// Runs outside that may be on the rare side.
    pub rare: u64,
    /// Runs outside.
    pub outside: u64,
    /// Runs in the layer.
    pub layer: u64,
    /// Runs inside.
    pub inside: u64,
}

/// Numbers of runs outside on the rare side for which it is said how many are needed.
const DISAGREEMENTS: [u64; 3] = [0, 1, 3];

/// What a certificate of this seed needs, without any model run.
///
/// # Errors
///
/// [`ReferenceError::TooNarrow`], or what keeps the surrogate from being sampled.
pub fn runs_for_width(
    surrogate: &Surrogate,
    width: f64,
    seed: u64,
    side_level: f64,
    observer: &dyn Observer,
) -> Result<RunsForWidth, ReferenceError> {
    // Three over the width are hardly too few.
    let none = Wanted { outside: 0, layer: 0, inside: INSIDE, resolved: (3.0 / width).ceil() as u64 };
    let strata = Strata::new(surrogate, &Plan::new(surrogate), seed, none, observer)?;
    let share = strata.rare();
    let inside = strata.drawn.len() as u64;
    let needed = |rare| {
        let outside = StratifiedCounts::runs_for(inside, share, width, rare, side_level)?.max(LEAST_RUNS);
        Some(RunsNeeded { rare, outside, layer: wanted(outside).layer, inside })
    };
    let known = share.upper_bound(0.01 * (1.0 - side_level)) - share.value();
    let too_narrow = ReferenceError::TooNarrow { width, samples: share.samples, known };
    let runs = DISAGREEMENTS.into_iter().map(needed).collect::<Option<Vec<_>>>().ok_or(too_narrow)?;
    Ok(RunsForWidth { rare_side: strata.rare_side, share, runs })
}

/// What the model said.
#[derive(Debug, Default)]
struct Outcomes {
    outside: Verdicts,
    layer: Verdicts,
    inside: Verdicts,
    /// The part of the predicted margin that the error ate, per run beyond the layer.
    errors: Vec<f64>,
}

impl Outcomes {
    /// Counts a run, with the model's excess in 1/s, if it has one.
    fn add(&mut self, side: RareSide, drawn: &Drawn, model: Option<f64>) {
        let verdicts = match drawn.origin {
            Origin::Far | Origin::Near => &mut self.outside,
            Origin::Layer => &mut self.layer,
            Origin::Inside => &mut self.inside,
        };
        let Some(model) = model else { return verdicts.count_failure(drawn.excess) };
        verdicts.add_strictly(drawn.excess, model);
        if drawn.origin == Origin::Far {
            let margin = -side.towards(drawn.excess);
            let eaten = (side.towards(model) + margin) / margin;
            // Without a margin any error is all of it.
            self.errors.push(if margin > 0.0 { eaten.clamp(0.0, f64::MAX) } else { 1.0 });
        }
    }

    fn certificate(self, strata: &Strata, seed: u64, side_level: f64, problem_hash: String) -> Certificate {
        let Self { outside, layer, inside, errors } = self;
        let side = strata.rare_side;
        let mut all = outside;
        [layer, inside].iter().for_each(|verdicts| all.merge(verdicts));
        let [of_outside, of_layer, of_inside] =
            [outside, layer, inside].map(|verdicts| stratum_counts(&verdicts, side));
        let bound = StratifiedCounts { outside: of_outside, inside: of_inside }.bound(strata.rare(), side_level);
        let [lower, upper] = side.stable([bound.lower, bound.upper]);
        let has_marginal = all.has_marginal() || strata.classes[1] > 0;
        let other_shares = || {
            let marginal = share_of(strata, 1, [&outside, &inside], Verdicts::of_marginal, side_level);
            let unstable = share_of(strata, 2, [&outside, &inside], Verdicts::of_unstable, side_level);
            MarginalBounds { falsely_marginal: all.of_marginal().falsely_claimed, marginal, unstable }
        };
        let far = FarErrors::new(errors);
        let assumed = match () {
            () if has_marginal => Err(Withheld::Marginal),
            () if all.failed() > 0 => Err(Withheld::FailedRuns),
            () => match far.upper(strata.rare(), strata.layer(), of_layer, side_level) {
                // An assumption that gains nothing is not made.
                Ok(upper) if upper >= bound.upper => Err(Withheld::NoLower),
                Ok(upper) => Ok(upper),
                Err(NoBound::NoRuns) => Err(Withheld::NoRuns),
                Err(NoBound::RareFarAway) => Err(Withheld::RareFarAway),
                Err(NoBound::NoThinning) => Err(Withheld::NoThinning),
            },
        };
        let runs = |StratumCounts { runs, rare, failed }: StratumCounts| StratumRuns { runs, rare, failed };
        let tail = |Thinning { error, runs, twice }: Thinning| ErrorTail { error, runs, twice };
        let stable = all.of_stable();
        Certificate {
            seed,
            samples: all.points(),
            scheme: SCHEME.to_owned(),
            falsely_stable: stable.falsely_claimed,
            falsely_unstable: stable.falsely_denied,
            failed: all.failed(),
            level: bound.level,
            lower,
            upper,
            marginal: has_marginal.then(other_shares),
            strata: Some(pcc_evaluate::surrogate::Strata {
                side_level,
                rare_side: side,
                rare_lower: bound.lower,
                rare_upper: bound.upper,
                surrogate: strata.sampled,
                outside: runs(of_outside),
                layer: runs(of_layer),
                inside: runs(of_inside),
                if_errors_fall_off: FallingErrors {
                    runs: far.runs(),
                    largest_error: far.largest(),
                    thinning: far.thinning().into_iter().map(tail).collect(),
                    bound: assumed.map_or_else(AssumedBound::Withheld, AssumedBound::Upper),
                },
            }),
            problem_hash,
        }
    }
}

fn stratum_counts(verdicts: &Verdicts, side: RareSide) -> StratumCounts {
    StratumCounts { runs: verdicts.points(), rare: verdicts.of_side(side), failed: verdicts.failed() }
}

/// The bound of the share of a class, marginal (1) or unstable (2). What is not stable is one stratum and what is
/// stable is the other: stable points are never claimed for the class.
fn share_of(
    strata: &Strata,
    class: usize,
    [outside, inside]: [&Verdicts; 2],
    of_class: fn(&Verdicts) -> DiscordantCounts,
    side_level: f64,
) -> [f64; 2] {
    let share = Proportion { hits: strata.classes[class], samples: strata.sampled.samples };
    let is_inside_stable = strata.rare_side == RareSide::Stable;
    let discordance = |weight, verdicts, is_stable: bool| ClassDiscordance {
        weight,
        counts: of_class(verdicts),
        claims: !is_stable,
        denies: true,
    };
    let both =
        [discordance(strata.rare(), inside, is_inside_stable), discordance(strata.rest(), outside, !is_inside_stable)];
    let bound = bound_of_class(share, &both, side_level);
    [bound.lower, bound.upper]
}
