//! The build: design → model runs → components → one sparse expansion each → surrogate.

mod decision;
mod evaluations;
mod record;

use evaluations::Evaluations;

use crate::design::RunError;
use crate::fit::Fitted;
use crate::fit::stepwise::{self, Outcome};
use crate::index_set::{Hyperbolic, IndexSetError, MultiIndex};
use crate::input::Input;
use crate::model::ModelError;
use crate::parallel::try_map;
use crate::progress::{Interrupted, Observer};
use crate::regression::{BasisTables, Response};
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
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl BuildError {
    /// Whether the user asked to stop.
    pub fn is_interruption(&self) -> bool {
        matches!(self, Self::Interrupted(_) | Self::Run(RunError::Interrupted(_)))
    }
}

/// Error of an eigenvalue relative to the largest one: components that vary by less do not vary.
const SOLVER_ACCURACY: f64 = 1e-13;

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
    let shells =
        Hyperbolic { inputs: study.inputs.dimension(), q_norm: study.fit.q_norm }.shells(study.fit.max_degree)?;
    let mut evaluations = Evaluations::new(study)?;
    let mut levels = Vec::new();
    let mut size = study.design.initial;
    loop {
        levels.push(size as u64);
        evaluations.grow_to(size, observer)?;
        let fit = ComponentFit::new(study, &evaluations, &shells);
        let outcomes = fit.search(observer)?;
        let too_few = outcomes.iter().any(|outcome| matches!(outcome, Outcome::TooFewSamples { .. }));
        match study.design.next_size(size) {
            Some(next) if too_few => size = next,
            _ => {
                let fitted = fit.settle(outcomes, observer)?;
                return Ok(record::surrogate(study, &evaluations, fitted, levels));
            }
        }
    }
}

/// The fit of all components on the current design.
struct ComponentFit<'a> {
    study: &'a Study,
    shells: &'a [Vec<MultiIndex>],
    tables: BasisTables,
    /// Values by component id, one per point.
    components: Vec<Vec<f64>>,
    /// Differences up to this size are rounding of the eigenvalue solver.
    resolution: f64,
}

impl<'a> ComponentFit<'a> {
    fn new(study: &'a Study, evaluations: &Evaluations<'_>, shells: &'a [Vec<MultiIndex>]) -> Self {
        let degree = usize::from(study.fit.max_degree);
        let recurrence = |input: &Input| input.marginal.family().recurrence(degree);
        let recurrences: Vec<_> = study.inputs.inputs().iter().map(recurrence).collect();
        Self {
            study,
            shells,
            tables: BasisTables::new(&evaluations.samples(), &recurrences, degree),
            components: evaluations.components(),
            resolution: SOLVER_ACCURACY * evaluations.largest_eigenvalue(),
        }
    }

    fn response(&self, id: usize) -> Response<'_> {
        Response { values: &self.components[id], resolution: self.resolution }
    }

    /// The study's method on every component.
    fn search(&self, observer: &dyn Observer) -> Result<Vec<Outcome>, Interrupted> {
        observer.begin("fitting components", self.components.len() as u64);
        let outcomes = try_map(self.components.len(), |id| {
            let outcome = stepwise::fit(&self.tables, self.response(id), self.shells, &self.study.fit, observer);
            observer.advance(1);
            outcome
        });
        observer.finish();
        outcomes
    }

    /// The fits, with what the design can carry for components that asked for more.
    fn settle(&self, outcomes: Vec<Outcome>, observer: &dyn Observer) -> Result<Vec<Fitted>, Interrupted> {
        let settled = outcomes.into_iter().enumerate().map(|(id, outcome)| match outcome {
            Outcome::Fitted(fitted) => Ok(fitted),
            Outcome::TooFewSamples { indices, degree } => {
                stepwise::settle(&self.tables, self.response(id), &indices, degree, observer)
            }
        });
        settled.collect()
    }
}
