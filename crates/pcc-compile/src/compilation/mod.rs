//! The build: from a study to a surrogate, level by level, until the stopping rule holds.

mod blindness;
mod components;
mod decision;
mod elements;
mod end_levels;
mod error;
mod error_history;
mod evaluations;
mod given;
mod given_use;
mod group_fits;
mod grouped;
mod grouping;
mod infinite;
mod judged_points;
mod judgement;
mod level_remark;
mod levels;
mod mass;
mod named_shares;
mod near_boundary;
mod numbering;
mod ranked;
mod record;
mod stopping;
#[cfg(test)]
mod tests;
mod to_file;
mod trials;
mod uncovered;
mod undecided;
mod unseen;
mod validation;

pub use error::BuildError;
pub use given_use::GivenUse;
pub use to_file::{BuildFileError, BuiltFile, build_to_file};
pub use uncovered::Uncovered;
pub use validation::Validation;

use crate::campaign::{Campaign, Ledger, Run};
use crate::mechanics::model::Model;
use pcc_evaluate::foundation::Observer;
use pcc_evaluate::surrogate::Surrogate;

/// Builds the surrogate of a study, or of a campaign that keeps books of its runs, on the current rayon thread pool:
/// the same bits for any number of threads.
///
/// Methods by quadrature run the model at the nodes of their rules, element by element. For the others, derivatives
/// enter the fit beside the values if the study wants them and the model has them. All components share one nested
/// design. Level by level it grows by one step until every component is fitted well enough and, if the study asks for
/// it, the estimated error of the stability proportion is small enough, or has not fallen while the design grew by four
/// levels to twice its size, or, of models that pcc computes, until the fits cost more than they are worth; the best
/// level is the result then. Eigenvalues are followed and grouped anew at each level; no model run is repeated or
/// dropped. The observer may ask to stop and [take what there is](Observer::takes_what_there_is).
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
    /// What became of runs that were given.
    given: Option<GivenUse>,
}

fn built(campaign: Campaign<'_>, model: Box<dyn Model>, observer: &dyn Observer) -> Result<Built, BuildError> {
    let Campaign { study, ledger, counts_failures } = campaign;
    let blank = Ledger::blank(study);
    let campaign = Campaign { study, ledger: Some(ledger.unwrap_or(&blank)), counts_failures };
    match study.fit.method.is_quadrature() {
        true => elements::build(campaign, model, observer),
        false => levels::build(campaign, model, observer),
    }
}

/// How much is rigid-body motion in all of these runs.
fn rigid_body_modes(runs: &[Run]) -> usize {
    runs.iter().map(|run| run.spectrum.rigid_body_modes()).min().unwrap_or(0)
}
