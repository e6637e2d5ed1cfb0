//! The build: design → model runs → components → one sparse expansion each → surrogate.

mod decision;
mod evaluations;
mod record;

use evaluations::Evaluations;

use crate::design::RunError;
use crate::fit::Fitted;
use crate::fit::stepwise::{self, Outcome};
use crate::index_set::{Hyperbolic, IndexSetError, MultiIndex};
use crate::model::ModelError;
use crate::parallel::try_map;
use crate::progress::Observer;
use crate::regression::BasisTables;
use crate::study::Study;
use crate::surrogate::Surrogate;
use thiserror::Error;

/// Why a build gave no surrogate.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BuildError {
    /// The model could not be set up.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A model run failed; it is not replaced by a guess.
    #[error(transparent)]
    Run(#[from] RunError),
    /// There are too many candidate terms.
    #[error(transparent)]
    IndexSet(#[from] IndexSetError),
    /// The user asked to stop.
    #[error("interrupted")]
    Interrupted,
}

/// Builds the surrogate of a study on the current rayon thread pool: the same bits for any number of threads.
///
/// All components share one nested design. If any component needs more points than there are, the design grows by one
/// step and every component starts again from {0}; no model run is repeated or dropped.
///
/// # Errors
///
/// [`BuildError`] names the point at which a model run failed, or the study's setting that asks for too much.
///
/// # Examples
///
/// ```
/// use pcc::{build::build, progress::Silent, study::Study};
/// let study = Study::from_toml(include_str!("../../surrogates/clutch-r1-eigenvalues.toml"))?;
/// let surrogate = build(&study, &Silent)?;
/// assert_eq!(surrogate.modes(), [3, 4]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn build(study: &Study, observer: &dyn Observer) -> Result<Surrogate, BuildError> {
    let model = study.model()?;
    let shells =
        Hyperbolic { inputs: study.inputs.dimension(), q_norm: study.fit.q_norm }.shells(study.fit.max_degree)?;
    let mut evaluations = Evaluations::new(study);
    let mut levels = Vec::new();
    let mut size = study.design.initial;
    loop {
        levels.push(size as u64);
        evaluations.grow_to(size, model.as_ref(), observer)?;
        let values = evaluations.components()?;
        let outcomes = fit_components(study, &evaluations, &values, &shells, observer)?;
        let too_few = outcomes.iter().any(|outcome| matches!(outcome, Outcome::TooFewSamples { .. }));
        match study.design.next_size(size) {
            Some(next) if too_few => size = next,
            _ => {
                let fitted = outcomes.into_iter().map(Outcome::into_fitted).collect();
                return Ok(record::surrogate(study, &evaluations, &values, fitted, levels));
            }
        }
    }
}

/// Fits every component on the current design.
fn fit_components(
    study: &Study,
    evaluations: &Evaluations<'_>,
    components: &[Vec<f64>],
    shells: &[Vec<MultiIndex>],
    observer: &dyn Observer,
) -> Result<Vec<Outcome>, BuildError> {
    let recurrences: Vec<_> = study
        .inputs
        .inputs()
        .iter()
        .map(|input| input.marginal.family().recurrence(usize::from(study.fit.max_degree)))
        .collect();
    let tables = BasisTables::new(&evaluations.samples(), &recurrences, usize::from(study.fit.max_degree));
    observer.begin("fitting components", components.len() as u64);
    let outcomes = try_map(components.len(), |id| {
        if observer.interrupted() {
            return Err(BuildError::Interrupted);
        }
        let outcome = stepwise::fit(&tables, &components[id], shells, &study.fit);
        observer.advance(1);
        Ok(outcome)
    });
    observer.finish();
    outcomes
}

impl Outcome {
    fn into_fitted(self) -> Fitted {
        match self {
            Self::Fitted(fitted) | Self::TooFewSamples { best: fitted } => fitted,
        }
    }
}
