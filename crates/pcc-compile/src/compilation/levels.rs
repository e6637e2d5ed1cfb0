//! The loop of the build: the paper's five steps (section 3.3.3), for all components on one design. A level is a design
//! of one size, with everything fitted anew.
//!
//! A build that ends early gives the level with the smallest estimated error. What the runs of later levels say of an
//! earlier one is part of that: the share of them that it calls otherwise than the model.

use super::blindness::{LEAST_RARE, Sight};
use super::components::{ComponentFit, ComponentResult};
use super::decision::{Before, Judged, Previous, Purpose, judge};
use super::end_levels::end_levels;
use super::evaluations::{Evaluations, Level, Sizes, groups};
use super::given::GivenLevels;
use super::given_use::GivenUse;
use super::grouped::GroupedEigenvalues;
use super::judgement::Judgement;
use super::level_remark::{Spent, remark, slowest};
use super::mass::masses;
use super::near_boundary::near_boundary;
use super::ranked::RankedModes;
use super::stopping::{EarlyEnd, StoppingRule};
use super::{BuildError, Built, record, rigid_body_modes};
use crate::campaign::{Campaign, Ledger, RunError};
use crate::mechanics::model::Model;
use crate::mechanics::spectrum::Target;
use crate::study::{Enrich, Study};
use pcc_evaluate::components::Output;
use pcc_evaluate::evaluation::{Plan, evaluate_points};
use pcc_evaluate::foundation::{Interrupted, Observer, is_interruption};
use pcc_evaluate::surrogate::Surrogate;
use std::time::Instant;

/// A level takes the place of an earlier one unless its estimated error is so many times as large.
const MUCH_WORSE: f64 = 1.5;

/// Batches that must find nothing near the boundary before a share is known to be 0 or 1.
const CLEAR_BATCHES: usize = 2;

/// Runs of a batch, at least; else as many as inputs, but no more than a level of the design has.
const LEAST_BATCH: usize = 3;

/// Below this share, runs near the boundary are worth more than those of the design: of a tenth, the clutch with
/// scatter takes 18 to 24 runs, without them 24. Of a fifth they gain nothing.
const RARE: f64 = 0.19;

/// After so many batches that have not lowered the error, or not found the rarer side, a level is one of the design,
/// which may find it where none looked.
const IDLE_BATCHES: usize = 3;

/// Blind builds end, unless the study says how many runs they are worth, before the design has more than so many times
/// the runs of its second level.
const BLIND_GROWTH: usize = 2;

/// Beside runs that are given, a level of the design adds this part of what there is: fewer change little.
const WORTH_A_LEVEL: usize = 4;

/// Builds level by level, until the stopping rule holds.
pub(super) fn build(
    campaign: Campaign<'_>,
    model: Box<dyn Model>,
    observer: &dyn Observer,
) -> Result<Built, BuildError> {
    let mut levels = Levels::new(campaign, model, observer)?;
    loop {
        match levels.next(observer) {
            Ok(None) => {}
            Ok(Some(surrogate)) => {
                let end = levels.early_end;
                return levels.ended(surrogate, end);
            }
            Err(error @ BuildError::Run(RunError::Unanswered { .. })) if levels.settles() => {
                let best = levels.best().ok_or_else(|| levels.fitting.refusal().unwrap_or(error))?;
                return levels.ended(best, Some(EarlyEnd::DataExhausted));
            }
            Err(error) if is_interruption(&error) && observer.takes_what_there_is() => {
                let best = levels.best().ok_or(error)?;
                return levels.ended(best, Some(EarlyEnd::Interrupted));
            }
            Err(error) => return Err(error),
        }
        if let Some(end) = levels.early_end
            && let Some(best) = levels.best()
        {
            return levels.ended(best, Some(end));
        }
    }
}

/// A level that could be the result.
struct Candidate {
    surrogate: Surrogate,
    /// Estimated error of the share, in points of probability.
    error: Option<f64>,
    /// What the file gives errors relative to.
    reference: f64,
}

/// What makes a level.
enum Growth {
    /// Runs that are given.
    Given,
    /// The design grows to this size.
    Design(usize),
    /// Runs at these points near the boundary.
    Batch(Vec<Vec<f64>>),
}

impl Growth {
    fn is_given(&self) -> bool {
        matches!(self, Self::Given)
    }
}

/// The levels so far.
struct Levels<'a> {
    study: &'a Study,
    campaign: Campaign<'a>,
    /// Runs that are given.
    given: Option<GivenLevels<'a>>,
    fitting: Fitting<'a>,
    evaluations: Evaluations<'a>,
    stopping: StoppingRule,
    /// Numbers of runs of the levels so far.
    sizes: Vec<u64>,
    /// What makes the next level.
    growth: Growth,
    /// Batches of runs near the boundary, one after the other, that have found it nowhere.
    clear_batches: usize,
    /// The smallest estimated error so far, and batches since.
    least_error: f64,
    idle_batches: usize,
    /// Batches since the last level of the design.
    batches: usize,
    /// Runs at the ends of discrete inputs.
    end_levels: usize,
    /// What the runs of the last level have seen.
    sight: Option<Sight>,
    grouping: Vec<Output>,
    previous: Option<Previous>,
    spent: Spent,
    /// Levels that could be the result.
    candidates: Vec<Candidate>,
    /// Why no further level is worth its runs.
    early_end: Option<EarlyEnd>,
}

impl<'a> Levels<'a> {
    fn new(campaign: Campaign<'a>, model: Box<dyn Model>, observer: &dyn Observer) -> Result<Self, BuildError> {
        let study = campaign.study;
        let fitting = Fitting::new(campaign)?;
        let given = GivenLevels::new(study, observer)?;
        let growth = if given.is_some() { Growth::Given } else { Growth::Design(study.design.initial) };
        Ok(Self {
            study,
            campaign,
            given,
            evaluations: Evaluations::new(campaign, model, matches!(fitting, Fitting::Ranked(_)))?,
            fitting,
            stopping: StoppingRule::new(study),
            sizes: Vec::new(),
            growth,
            clear_batches: 0,
            least_error: f64::INFINITY,
            idle_batches: 0,
            batches: 0,
            end_levels: 0,
            sight: None,
            grouping: Vec::new(),
            previous: None,
            spent: Spent::default(),
            candidates: Vec::new(),
            early_end: None,
        })
    }

    /// One level. Its surrogate if it is the last one.
    fn next(&mut self, observer: &dyn Observer) -> Result<Option<Surrogate>, BuildError> {
        // Step 1: the design, and the model at its points.
        let start = Instant::now();
        let is_batch = match &self.growth {
            Growth::Given => {
                let given = self.given.as_mut().map_or_else(Vec::new, GivenLevels::next);
                self.evaluations.take(&given)?;
                false
            }
            Growth::Design(size) => {
                let is_first = self.evaluations.sizes().design == 0;
                self.evaluations.grow_to(*size, observer)?;
                if is_first {
                    self.run_end_levels(observer)?;
                }
                false
            }
            Growth::Batch(points) => self.evaluations.add(points, observer).map(|()| true)?,
        };
        self.batches = if is_batch { self.batches + 1 } else { 0 };
        let size = self.evaluations.sizes().sum();
        self.sizes.push(size as u64);
        self.spent.runs += start.elapsed();
        let start = Instant::now();
        // Steps 2 and 3: what the components are, and their terms and coefficients.
        let next = self.next_growth().filter(|growth| growth.is_given() || !self.study.fit.method.has_fixed_design());
        let fitted = self.fitting.fit(&mut self.evaluations, next.is_some(), observer)?;
        // Step 4: a design that is too small for the terms that matter grows.
        let (level, fitted) = match (&next, fitted) {
            (Some(_), None) => {
                self.growth = next.unwrap_or(Growth::Given);
                return Ok(None);
            }
            (None, None) => (self.evaluations.by_rank()?, Vec::new()),
            (_, Some(fitted)) => fitted,
        };
        let is_regrouped = groups(&level.outputs) != groups(&self.grouping);
        self.grouping.clone_from(&level.outputs);
        // Step 5: enough, or the next level.
        let runs = self.evaluations.runs();
        let masses = self.masses(&level, observer)?;
        let mut surrogate =
            record::surrogate(self.study, (&self.evaluations, masses.as_deref()), &level, &fitted, &self.sizes);
        let slowest = slowest(&level.outputs, &fitted);
        let results: Vec<_> = fitted.into_iter().map(|fit| fit.result).collect();
        let is_last = next.is_none() || self.stopping.needs_no_judgement(&results);
        let before = self.previous.as_ref().map(|previous| Before { previous, is_regrouped });
        let tolerance = self.study.fit.proportion_tolerance;
        let of_design: Vec<usize> = (0..runs.len()).filter(|&i| !self.evaluations.is_chosen(i)).collect();
        let near_boundary = (runs.len() - of_design.len()).saturating_sub(self.end_levels);
        let values = &level.values;
        let judged = Judged { surrogate: &surrogate, fitted: &results, values, runs, of_design, masses, near_boundary };
        let is_final = is_batch && self.clear_batches + 1 >= CLEAR_BATCHES;
        let mut judgement =
            judge(judged, before, Purpose { tolerance, is_last, is_final, shares: &self.study.fit.shares }, observer)?;
        let is_first = self.previous.is_none();
        self.previous = judgement.previous.take();
        record::judged(&mut surrogate, &judgement, runs);
        self.spent.fits += start.elapsed();
        observer.remark(&remark((size, tolerance), slowest, &judgement, self.spent));
        self.stopping.note(judgement.largest_error(), size);
        let former = std::mem::replace(&mut self.sight, judgement.sight.filter(|_| tolerance.is_some()));
        let is_clear = self.sight.is_some_and(|sight| sight.is_blind() && sight.clearance.is_some());
        self.clear_batches = if is_clear { self.clear_batches + usize::from(is_batch) } else { 0 };
        let error = judgement.error.unwrap_or(f64::INFINITY);
        self.idle_batches = if error < self.least_error { 0 } else { self.idle_batches + usize::from(is_batch) };
        self.least_error = self.least_error.min(error);
        let is_enough = match self.clear_batches >= CLEAR_BATCHES {
            true => self.stopping.are_accurate(&results),
            false => self.stopping.holds(&results, &judgement),
        };
        // All runs that are there are taken, whatever a part of them says.
        let waits = next.as_ref().is_some_and(Growth::is_given);
        let is_enough = is_enough && !waits;
        let batch = (!is_first && !waits && !is_enough && tolerance.is_some() && self.stopping.are_accurate(&results))
            .then(|| self.batch(&surrogate, &judgement, former))
            .flatten();
        let growth = batch.map(Growth::Batch).or(next).filter(|_| !is_enough);
        if growth.is_none() && !is_enough && !self.study.fit.method.has_fixed_design() {
            self.early_end = match self.settles() {
                true => Some(EarlyEnd::DataExhausted),
                false => self.stopping.end_at_largest_design(&results),
            };
        }
        let Some(growth) = growth else {
            return match self.fitting.refusal() {
                Some(refusal) => Err(refusal),
                None => Ok(Some(surrogate)),
            };
        };
        if self.fitting.refusal().is_none() {
            let reference = judgement.share.map_or(1.0, |share| share.reference());
            self.candidates.push(Candidate { surrogate, error: judgement.error, reference });
        }
        self.early_end = self.stopping.early_end(&results, self.fitting.work()).filter(|_| !waits);
        if self.is_blind_for_good(&growth, &judgement) {
            self.early_end = Some(EarlyEnd::Blind);
        }
        self.growth = growth;
        Ok(None)
    }

    /// Runs what the first level of the design has left out of discrete inputs.
    fn run_end_levels(&mut self, observer: &dyn Observer) -> Result<(), BuildError> {
        let mut points = end_levels(&self.study.inputs, &self.evaluations.points());
        points.truncate(self.study.design.maximum.saturating_sub(self.evaluations.sizes().sum()));
        self.evaluations.add(&points, observer)?;
        self.end_levels = points.len();
        Ok(())
    }

    /// Whether a blind level should look near the boundary: while nothing comes near it, while that finds the rarer
    /// side, and some times after each level of the design, as often as there are signs of it; unless the next level of
    /// the design is needed anyway and should see enough.
    fn is_worth_looking(&self, sight: Sight, former: Option<Sight>, share: f64, judgement: &Judgement) -> bool {
        let next = self.next_design().filter(|&size| !self.is_too_large_for_blind(size));
        let is_soon_seen = next.is_some_and(|size| share * size as f64 >= LEAST_RARE as f64);
        if is_soon_seen && !judgement.would_be_within(self.study.fit.proportion_tolerance) {
            return false;
        }
        let has_found = former.is_some_and(|former| sight.rare() > former.rare());
        let most = if share > 0.0 || sight.rare() > 0 { IDLE_BATCHES } else { 1 };
        sight.clearance.is_some() || has_found || self.batches < most
    }

    /// What makes the next level, unless runs near the boundary do.
    fn next_growth(&self) -> Option<Growth> {
        match self.given.as_ref().is_some_and(GivenLevels::are_left) {
            true => Some(Growth::Given),
            false => self.next_design().map(Growth::Design),
        }
    }

    /// The size of the next design: with the runs near the boundary and those that are given it is not larger than the
    /// study allows. Beside runs that are given it begins anew, and adds enough to tell.
    fn next_design(&self) -> Option<usize> {
        let Sizes { design, given, chosen } = self.evaluations.sizes();
        let most = self.study.design.maximum.saturating_sub(chosen + given);
        let size = match given {
            0 => self.study.design.next_size(design)?,
            _ if design == 0 => self.study.design.initial.max(given / WORTH_A_LEVEL),
            _ => (design + self.study.design.step).max(design + (given + design) / WORTH_A_LEVEL),
        };
        Some(size.min(most)).filter(|&size| size > design && self.evaluations.can_grow_to(size))
    }

    /// The masses of the runs of a level, if some are given.
    fn masses(&self, level: &Level, observer: &dyn Observer) -> Result<Option<Vec<f64>>, Interrupted> {
        let (inputs, seed) = (&self.study.inputs, self.study.seed);
        self.given.as_ref().map(|_| masses(inputs, seed, &level.samples, observer)).transpose()
    }

    /// Whether the build makes do with the runs that there are.
    fn settles(&self) -> bool {
        self.campaign.ledger.is_some_and(Ledger::settles)
    }

    /// Points near the boundary for the next runs, if they are worth more than a level of the design.
    fn batch(&self, surrogate: &Surrogate, judgement: &Judgement, former: Option<Sight>) -> Option<Vec<Vec<f64>>> {
        let sight = judgement.sight.filter(|_| self.study.fit.enrich == Enrich::Decision)?;
        let share = judgement.share.map_or(0.0, |share| share.value.min(1.0 - share.value));
        let is_worth_it = match sight.is_blind() {
            _ if sight.is_marginal => false,
            true => self.is_worth_looking(sight, former, share, judgement),
            false if judgement.is_blind_to_named() => self.batches < IDLE_BATCHES,
            false => share < RARE && (self.batches == 0 || self.idle_batches < IDLE_BATCHES),
        };
        if !is_worth_it {
            return None;
        }
        let room = self.study.design.maximum.saturating_sub(self.evaluations.sizes().sum());
        let wanted = self.study.inputs.dimension().max(LEAST_BATCH).min(self.study.design.step).min(room);
        let is_blind = sight.is_blind() || judgement.is_blind_to_named();
        let judged = (judgement.excess.as_slice(), judgement.rarer.as_slice());
        let points = near_boundary(surrogate, judged, &self.evaluations.points(), (wanted, is_blind));
        Some(points).filter(|points| !points.is_empty())
    }

    /// Whether the rarer side has been looked for long enough.
    fn is_blind_for_good(&self, growth: &Growth, judgement: &Judgement) -> bool {
        let is_blind = self.sight.is_some_and(|sight| sight.is_blind()) || judgement.is_blind_to_named();
        is_blind && matches!(growth, Growth::Design(size) if self.is_too_large_for_blind(*size))
    }

    /// Whether blind builds end before a design of this size, unless the study says how many runs it is worth.
    fn is_too_large_for_blind(&self, size: usize) -> bool {
        size > BLIND_GROWTH * (self.study.design.initial + self.study.design.step) && !self.study.limits_runs()
    }

    /// The best level so far, the last of about equal ones, with what later runs say of its error.
    fn best(&mut self) -> Option<Surrogate> {
        let known = std::mem::take(&mut self.candidates).into_iter().map(|candidate| {
            let Candidate { mut surrogate, error, reference } = candidate;
            let denied = self.denied_by_later_runs(&surrogate);
            if denied > 0.0 {
                surrogate.decision.proportion_error = Some(error.unwrap_or(0.0).max(denied) / reference);
            }
            (error.unwrap_or(f64::INFINITY).max(denied), surrogate)
        });
        let better = |best: (f64, Surrogate), later: (f64, Surrogate)| {
            if later.0 <= MUCH_WORSE * best.0 { later } else { best }
        };
        known.reduce(better).map(|(_, surrogate)| surrogate)
    }

    /// The share of the runs made since that a level calls otherwise than the model.
    fn denied_by_later_runs(&self, surrogate: &Surrogate) -> f64 {
        let known = surrogate.training.counts.values as usize;
        let samples = self.evaluations.samples();
        // Points chosen near the boundary say nothing of a share.
        let later: Vec<usize> = (known..samples.len()).filter(|&i| !self.evaluations.is_chosen(i)).collect();
        let points: Vec<&[f64]> = later.iter().map(|&i| samples.point(i)).collect();
        let block = evaluate_points(surrogate, &Plan::new(surrogate), &points);
        let differs = |(&i, &excess): (&usize, &f64)| {
            (excess <= 0.0) != (self.evaluations.runs()[i].spectrum.top().excess <= 0.0)
        };
        let denied = later.iter().zip(&block.excess).filter(|&pair| differs(pair)).count();
        if denied == 0 { 0.0 } else { denied as f64 / later.len() as f64 }
    }

    /// The result: a level, with all runs that were spent.
    fn ended(&mut self, mut surrogate: Surrogate, early_end: Option<EarlyEnd>) -> Result<Built, BuildError> {
        let is_settled = self.clear_batches >= CLEAR_BATCHES && early_end.is_none();
        let sight = self.sight.map(|sight| Sight { clearance: sight.clearance.filter(|_| is_settled), ..sight });
        record::ended(&mut surrogate, (&self.evaluations, self.end_levels), sight, early_end);
        surrogate.self_test = surrogate.make_self_test(record::self_test_points(self.study));
        let given = match &self.given {
            Some(given) => Some(GivenUse::of(given, &mut self.evaluations, &surrogate, self.study)?),
            None => None,
        };
        given.iter().for_each(|found| record::given(&mut surrogate, found));
        Ok(Built { surrogate, rigid_body_modes: rigid_body_modes(self.evaluations.runs()), given })
    }
}

/// How eigenvalues become components.
enum Fitting<'a> {
    /// Modes have frequency ranks.
    Ranked(RankedModes<'a>),
    /// Eigenvalues are followed, and grouped by prediction.
    Grouped(Box<GroupedEigenvalues<'a>>),
}

impl<'a> Fitting<'a> {
    fn new(campaign: Campaign<'a>) -> Result<Self, BuildError> {
        let study = campaign.study;
        let fit = ComponentFit::new(study)?;
        let is_grouped = study.spectrum.target == Target::Invariants && study.fit.method.fits_every_design();
        Ok(match is_grouped {
            true => Self::Grouped(Box::new(GroupedEigenvalues::new(study, fit))),
            false => Self::Ranked(RankedModes::new(fit)),
        })
    }

    /// What the fits have cost, where all of it is of use: the paper's method asks for larger designs itself.
    fn work(&self) -> u64 {
        match self {
            Self::Ranked(_) => 0,
            Self::Grouped(eigenvalues) => eigenvalues.work(),
        }
    }

    /// Why the last level cannot be the last word.
    fn refusal(&self) -> Option<BuildError> {
        match self {
            Self::Ranked(_) => None,
            Self::Grouped(eigenvalues) => eigenvalues.refusal().cloned(),
        }
    }

    fn fit(
        &mut self,
        evaluations: &mut Evaluations<'_>,
        can_grow: bool,
        observer: &dyn Observer,
    ) -> Result<Option<(Level, Vec<ComponentResult>)>, BuildError> {
        match self {
            Self::Ranked(modes) => modes.fit(evaluations, can_grow, observer),
            Self::Grouped(eigenvalues) => eigenvalues.fit(evaluations, can_grow, observer),
        }
    }
}
