//! The build: from a study to a surrogate, level by level, until the stopping rule holds.

mod components;
mod decision;
mod elements;
mod error;
mod evaluations;
mod group_fits;
mod grouped;
mod grouping;
mod infinite;
mod numbering;
mod ranked;
mod record;
mod stopping;
#[cfg(test)]
mod tests;
mod to_file;
mod undecided;
mod unseen;

pub use error::BuildError;
pub use to_file::{BuildFileError, BuiltFile, build_to_file};

use crate::campaign::{Campaign, Ledger, Run};
use crate::mechanics::model::Model;
use crate::mechanics::spectrum::Target;
use components::{ComponentFit, ComponentResult};
use decision::judge;
use evaluations::{Evaluations, Level, groups};
use grouped::GroupedEigenvalues;
use pcc_evaluate::foundation::Observer;
use pcc_evaluate::surrogate::Surrogate;
use ranked::RankedModes;
use stopping::StoppingRule;

/// Builds the surrogate of a study, or of a campaign that keeps books of its runs, on the current rayon thread pool:
/// the same bits for any number of threads.
///
/// Methods by quadrature run the model at the nodes of their rules, element by element. For the others, derivatives
/// enter the fit beside the values if the study wants them and the model has them. All components share one nested
/// design. Level by level it grows by one step until every component is fitted well enough and, if the study asks for
/// it, the estimated error of the stability proportion is small enough, or has not fallen while the design grew by four
/// levels to twice its size. Eigenvalues are followed and grouped anew at each level; no model run is repeated or
/// dropped.
///
/// # Errors
///
/// [`BuildError`] names the point at which a model run failed, or the study's setting that asks for too much.
///
/// # Examples
///
/// ```
/// use pcc_compile::compilation::build;
/// use pcc_compile::study::Study;
/// use pcc_evaluate::foundation::Silent;
/// let study = Study::from_toml(include_str!("../../../../surrogates/clutch-r1-eigenvalues.toml"))?;
/// let surrogate = build(&study, &Silent)?;
/// assert_eq!(surrogate.modes(), [3, 4]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn build<'a>(campaign: impl Into<Campaign<'a>>, observer: &dyn Observer) -> Result<Surrogate, BuildError> {
    let campaign = campaign.into();
    build_with(campaign, campaign.study.model()?, observer)
}

/// The build with a model of your own in place of the study's, whose inputs it takes. The hashes in the surrogate are
/// still those of the study: `compare` and `certify` would run the study's model.
///
/// # Errors
///
/// As [`build`].
pub fn build_with<'a>(
    campaign: impl Into<Campaign<'a>>,
    model: Box<dyn Model>,
    observer: &dyn Observer,
) -> Result<Surrogate, BuildError> {
    built(campaign.into(), model, observer).map(|built| built.surrogate)
}

/// A surrogate, and what it does not say of its model.
struct Built {
    surrogate: Surrogate,
    /// Number of eigenvalues that are rigid-body motion.
    rigid_body_modes: usize,
}

fn built(campaign: Campaign<'_>, model: Box<dyn Model>, observer: &dyn Observer) -> Result<Built, BuildError> {
    let Campaign { study, ledger } = campaign;
    let blank = Ledger::blank(study);
    let campaign = Campaign { study, ledger: Some(ledger.unwrap_or(&blank)) };
    match study.fit.method.is_quadrature() {
        true => elements::build(campaign, model, observer),
        false => by_levels(campaign, model, observer),
    }
}

/// The paper's five steps (section 3.3.3), for all components on one design: a level is a design of one size, with
/// everything fitted anew.
fn by_levels(campaign: Campaign<'_>, model: Box<dyn Model>, observer: &dyn Observer) -> Result<Built, BuildError> {
    let study = campaign.study;
    let mut fitting = Fitting::new(campaign)?;
    let mut evaluations = Evaluations::new(campaign, model, matches!(fitting, Fitting::Ranked(_)))?;
    let mut stopping = StoppingRule::new(study);
    let (mut sizes, mut grouping, mut previous) = (Vec::new(), Vec::new(), None);
    let mut size = study.design.initial;
    loop {
        // Step 1: the design, and the model at its points.
        sizes.push(size as u64);
        evaluations.grow_to(size, observer)?;
        // Steps 2 and 3: what the components are, and their terms and coefficients.
        let next = study.design.next_size(size).filter(|_| !study.fit.method.has_fixed_design());
        let fitted = fitting.fit(&mut evaluations, next.is_some(), observer)?;
        // Step 4: a design that is too small for the terms that matter grows.
        let (level, fitted) = match (next, fitted) {
            (Some(next), None) => {
                size = next;
                continue;
            }
            (None, None) => (evaluations.by_rank()?, Vec::new()),
            (_, Some(fitted)) => fitted,
        };
        if groups(&level.outputs) != groups(&grouping) {
            previous = None;
        }
        grouping.clone_from(&level.outputs);
        // Step 5: enough, or the next level.
        let mut surrogate = record::surrogate(study, &evaluations, &level, &fitted, &sizes);
        let results: Vec<_> = fitted.into_iter().map(|fit| fit.result).collect();
        let is_last = next.is_none() || stopping.needs_no_judgement(&results);
        let judgement = judge(&surrogate, &results, &level.values, evaluations.runs(), previous, is_last, observer)?;
        record::judged(&mut surrogate, &judgement, evaluations.runs());
        previous = judgement.previous;
        stopping.note(judgement.reducible_error, size);
        match next {
            Some(next) if !stopping.holds(&results, &judgement, size) => size = next,
            _ => {
                if let Some(refusal) = fitting.refusal() {
                    return Err(refusal);
                }
                surrogate.self_test = surrogate.make_self_test(record::self_test_points(study));
                let rigid_body_modes = rigid_body_modes(evaluations.runs());
                return Ok(Built { surrogate, rigid_body_modes });
            }
        }
    }
}

/// How much is rigid-body motion in all of these runs.
fn rigid_body_modes(runs: &[Run]) -> usize {
    runs.iter().map(|run| run.spectrum.rigid_body_modes()).min().unwrap_or(0)
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

    /// Why the last level cannot be the last word.
    fn refusal(self) -> Option<BuildError> {
        match self {
            Self::Ranked(_) => None,
            Self::Grouped(eigenvalues) => eigenvalues.refusal(),
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
