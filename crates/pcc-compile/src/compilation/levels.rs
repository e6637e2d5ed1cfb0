//! The loop of the build: the paper's five steps (section 3.3.3), for all components on one design. A level is a design
//! of one size, with everything fitted anew.
//!
//! A build that ends early gives the level with the smallest estimated error. What the runs of later levels say of an
//! earlier one is part of that: the share of them that it calls otherwise than the model.

use super::components::{ComponentFit, ComponentResult};
use super::decision::{Before, Judged, Previous, Purpose, judge};
use super::evaluations::{Evaluations, Level, groups};
use super::grouped::GroupedEigenvalues;
use super::level_remark::{Spent, remark, slowest};
use super::ranked::RankedModes;
use super::stopping::{EarlyEnd, StoppingRule};
use super::{BuildError, Built, record, rigid_body_modes};
use crate::campaign::Campaign;
use crate::mechanics::model::Model;
use crate::mechanics::spectrum::Target;
use crate::study::Study;
use pcc_evaluate::components::Output;
use pcc_evaluate::evaluation::{Plan, evaluate_points};
use pcc_evaluate::foundation::{Observer, is_interruption};
use pcc_evaluate::surrogate::Surrogate;
use std::time::Instant;

/// A level takes the place of an earlier one unless its estimated error is so many times as large.
const MUCH_WORSE: f64 = 1.5;

/// Builds level by level, until the stopping rule holds.
pub(super) fn build(
    campaign: Campaign<'_>,
    model: Box<dyn Model>,
    observer: &dyn Observer,
) -> Result<Built, BuildError> {
    let mut levels = Levels::new(campaign, model)?;
    loop {
        match levels.next(observer) {
            Ok(None) => {}
            Ok(Some(surrogate)) => {
                let end = levels.early_end;
                return Ok(levels.ended(surrogate, end));
            }
            Err(error) if is_interruption(&error) && observer.takes_what_there_is() => {
                let best = levels.best().ok_or(error)?;
                return Ok(levels.ended(best, Some(EarlyEnd::Interrupted)));
            }
            Err(error) => return Err(error),
        }
        if let Some(end) = levels.early_end
            && let Some(best) = levels.best()
        {
            return Ok(levels.ended(best, Some(end)));
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

/// The levels so far.
struct Levels<'a> {
    study: &'a Study,
    fitting: Fitting<'a>,
    evaluations: Evaluations<'a>,
    stopping: StoppingRule,
    /// Sizes of the levels, the last of which is the next or current one.
    sizes: Vec<u64>,
    grouping: Vec<Output>,
    previous: Option<Previous>,
    spent: Spent,
    /// Levels that could be the result.
    candidates: Vec<Candidate>,
    /// Why no further level is worth its runs.
    early_end: Option<EarlyEnd>,
}

impl<'a> Levels<'a> {
    fn new(campaign: Campaign<'a>, model: Box<dyn Model>) -> Result<Self, BuildError> {
        let study = campaign.study;
        let fitting = Fitting::new(campaign)?;
        Ok(Self {
            study,
            evaluations: Evaluations::new(campaign, model, matches!(fitting, Fitting::Ranked(_)))?,
            fitting,
            stopping: StoppingRule::new(study),
            sizes: vec![study.design.initial as u64],
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
        let size = self.sizes.last().map_or(0, |&size| size as usize);
        let start = Instant::now();
        self.evaluations.grow_to(size, observer)?;
        self.spent.runs += start.elapsed();
        let start = Instant::now();
        // Steps 2 and 3: what the components are, and their terms and coefficients.
        let next = self.study.design.next_size(size).filter(|_| !self.study.fit.method.has_fixed_design());
        let fitted = self.fitting.fit(&mut self.evaluations, next.is_some(), observer)?;
        // Step 4: a design that is too small for the terms that matter grows.
        let (level, fitted) = match (next, fitted) {
            (Some(next), None) => {
                self.sizes.push(next as u64);
                return Ok(None);
            }
            (None, None) => (self.evaluations.by_rank()?, Vec::new()),
            (_, Some(fitted)) => fitted,
        };
        let is_regrouped = groups(&level.outputs) != groups(&self.grouping);
        self.grouping.clone_from(&level.outputs);
        // Step 5: enough, or the next level.
        let runs = self.evaluations.runs();
        let mut surrogate = record::surrogate(self.study, &self.evaluations, &level, &fitted, &self.sizes);
        let slowest = slowest(&level.outputs, &fitted);
        let results: Vec<_> = fitted.into_iter().map(|fit| fit.result).collect();
        let is_last = next.is_none() || self.stopping.needs_no_judgement(&results);
        let before = self.previous.as_ref().map(|previous| Before { previous, is_regrouped });
        let tolerance = self.study.fit.proportion_tolerance;
        let judged = Judged { surrogate: &surrogate, fitted: &results, values: &level.values, runs };
        let mut judgement = judge(judged, before, Purpose { tolerance, is_last }, observer)?;
        self.previous = judgement.previous.take();
        record::judged(&mut surrogate, &judgement, runs);
        self.spent.fits += start.elapsed();
        observer.remark(&remark((size, tolerance), slowest, &judgement, self.spent));
        self.stopping.note(judgement.reducible_error.or(judgement.error), size);
        let is_enough = self.stopping.holds(&results, &judgement);
        if next.is_none() && !is_enough && !self.study.fit.method.has_fixed_design() {
            self.early_end = self.stopping.end_at_largest_design(&results);
        }
        let Some(next) = next.filter(|_| !is_enough) else {
            return match self.fitting.refusal() {
                Some(refusal) => Err(refusal),
                None => Ok(Some(surrogate)),
            };
        };
        if self.fitting.refusal().is_none() {
            let reference = judgement.share.map_or(1.0, |share| share.reference());
            self.candidates.push(Candidate { surrogate, error: judgement.error, reference });
        }
        self.early_end = self.stopping.early_end(&results, self.fitting.work());
        self.sizes.push(next as u64);
        Ok(None)
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
        let later: Vec<usize> = (known..samples.len()).collect();
        let points: Vec<&[f64]> = later.iter().map(|&i| samples.point(i)).collect();
        let block = evaluate_points(surrogate, &Plan::new(surrogate), &points);
        let differs = |(&i, &excess): (&usize, &f64)| {
            (excess <= 0.0) != (self.evaluations.runs()[i].spectrum.top().excess <= 0.0)
        };
        let denied = later.iter().zip(&block.excess).filter(|&pair| differs(pair)).count();
        if denied == 0 { 0.0 } else { denied as f64 / later.len() as f64 }
    }

    /// The result: a level, with all runs that were spent.
    fn ended(&self, mut surrogate: Surrogate, early_end: Option<EarlyEnd>) -> Built {
        record::ended(&mut surrogate, &self.evaluations, early_end);
        surrogate.self_test = surrogate.make_self_test(record::self_test_points(self.study));
        Built { surrogate, rigid_body_modes: rigid_body_modes(self.evaluations.runs()) }
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
