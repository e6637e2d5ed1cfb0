//! Models: from parameters to the eigenvalues of a linearised system.

mod clutch;
pub mod command;
mod function;
pub mod matrices;
mod not_numbers;
mod parameter;
mod printable;
mod second_order;
mod table;
pub mod um_bridge;

pub use clutch::{CLUTCH_PARAMETERS, Clutch};
pub use function::FunctionModel;
pub use parameter::{Parameter, Range};
pub use second_order::{Linearization, SecondOrder};
pub use table::TableModel;

use crate::numerics::eigenvalues::{EigenvalueError, eigenvalues};
use command::{CommandError, CommandFailure};
use matrices::MatricesError;
use nalgebra::Complex;
use thiserror::Error;
use um_bridge::{UmBridgeError, UmBridgeFailure};

/// Why a model could not be set up or run.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ModelError {
    /// The model has no parameter of this name.
    #[error("the model has no parameter {name}; it has {known}")]
    UnknownParameter {
        /// The name asked for.
        name: String,
        /// The names that exist.
        known: String,
    },
    /// A parameter has a value that makes no sense.
    #[error("{name} = {value}, but {name} must be {range}")]
    OutOfRange {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// A linearization has not one derivative per input, as large as the state matrix.
    #[error("the model gave {found} derivatives of the size of its state matrix; {expected} inputs need one each")]
    Derivatives {
        /// Derivatives of the right size.
        found: usize,
        /// Number of inputs.
        expected: usize,
    },
    /// Matrices of the user's cannot be used.
    #[error(transparent)]
    Matrices(Box<MatricesError>),
    /// A program of the user's gave no answer.
    #[error(transparent)]
    Command(Box<CommandError>),
    /// A server gave no answer.
    #[error(transparent)]
    UmBridge(Box<UmBridgeError>),
    /// Answers come in tables.
    #[error(
        "models of kind \"table\" are not run by pcc: write the points with pcc design STUDY --emit rows.csv, run them, and hand the \
         answers over with pcc ingest STUDY rows.csv"
    )]
    NotRun,
    /// The model is a function that nobody has given.
    #[error(
        "models of kind \"function\" are functions of the program that reads the study: run it there, in Python with \
         pcc.Study.read(STUDY, model=f)"
    )]
    NoFunction,
    /// A function was given to a model that is none.
    #[error(
        "a function takes the place of a model of kind \"function\", and this study's is of kind {kind:?}; leave the function \
         out, or write kind = \"function\""
    )]
    NotFunction {
        /// The kind of the study's model.
        kind: &'static str,
    },
    /// A function of the user's gave no answer.
    #[error("{0}")]
    Function(String),
    /// The mass matrix cannot be inverted.
    #[error("the mass matrix is singular")]
    SingularMass,
    /// The eigenvalue solver failed.
    #[error(transparent)]
    Eigenvalues(#[from] EigenvalueError),
}

impl From<MatricesError> for ModelError {
    fn from(error: MatricesError) -> Self {
        Self::Matrices(Box::new(error))
    }
}

impl From<CommandError> for ModelError {
    fn from(error: CommandError) -> Self {
        Self::Command(Box::new(error))
    }
}

impl From<UmBridgeError> for ModelError {
    fn from(error: UmBridgeError) -> Self {
        Self::UmBridge(Box::new(error))
    }
}

impl ModelError {
    /// Whether the model was run and failed, and not what it takes to run it.
    pub fn is_of_run(&self) -> bool {
        match self {
            Self::Command(error) => !error.failure.is_of_machine(),
            Self::UmBridge(error) => error.is_of_run,
            _ => true,
        }
    }

    /// Whether something else than the model ended the run: another attempt may go well.
    pub fn is_by_circumstances(&self) -> bool {
        match self {
            Self::Command(error) => matches!(error.failure, CommandFailure::Signal { .. }),
            Self::UmBridge(error) => matches!(error.failure, UmBridgeFailure::Closed { .. }),
            _ => false,
        }
    }

    /// How often a run was tried before this was its end.
    pub fn attempts(&self) -> u32 {
        match self {
            Self::Command(error) => error.attempts,
            Self::UmBridge(error) => error.attempts,
            _ => 1,
        }
    }
}

/// How many runs of a model go on at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Concurrency {
    /// As many as there are threads: the model computes in them.
    Threads,
    /// At most so many, whatever the number of threads: the model waits for programs.
    Jobs(usize),
    /// All in one call of [`Model::eigenvalues_together`].
    Together,
}

/// What one run of a model answers.
#[derive(Debug, Clone, PartialEq)]
pub enum ModelAnswer {
    /// The system, of which the eigenvalues follow.
    System(Box<Linearization>),
    /// All eigenvalues, in 1/s.
    Eigenvalues(Vec<Complex<f64>>),
}

impl ModelAnswer {
    /// All eigenvalues, in 1/s.
    ///
    /// # Errors
    ///
    /// [`ModelError::Eigenvalues`] if they cannot be computed.
    pub fn eigenvalues(self) -> Result<Vec<Complex<f64>>, ModelError> {
        match self {
            Self::System(system) => Ok(eigenvalues(system.state_matrix)?),
            Self::Eigenvalues(eigenvalues) => Ok(eigenvalues),
        }
    }
}

/// A system whose eigenvalues depend on parameters.
///
/// One call of [`Model::run`] is one direct computation. Calls come from several threads at once.
pub trait Model: Sync {
    /// All eigenvalues λ of the state matrix, in 1/s, at `point`: one value per uncertain input, in the order of the
    /// study's inputs and in physical units.
    ///
    /// # Errors
    ///
    /// A run that fails says why. It is never replaced by a guess.
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError>;

    /// Whether [`Model::linearization`] has an answer.
    fn has_derivatives(&self) -> bool {
        false
    }

    /// The state matrix at `point` with its derivative by each uncertain input; `None` from models that know only their
    /// eigenvalues.
    ///
    /// # Errors
    ///
    /// As [`Model::eigenvalues`].
    fn linearization(&self, point: &[f64]) -> Result<Option<Linearization>, ModelError> {
        let _ = point;
        Ok(None)
    }

    /// The same without derivatives: what eigenvalues alone are computed of.
    ///
    /// # Errors
    ///
    /// As [`Model::eigenvalues`].
    fn system(&self, point: &[f64]) -> Result<Option<Linearization>, ModelError> {
        self.linearization(point)
    }

    /// One direct computation: the system where the model knows it, with its derivatives if they are wanted, else its
    /// eigenvalues.
    ///
    /// # Errors
    ///
    /// As [`Model::eigenvalues`].
    fn run(&self, point: &[f64], with_derivatives: bool) -> Result<ModelAnswer, ModelError> {
        let system = if with_derivatives { self.linearization(point)? } else { self.system(point)? };
        match system {
            Some(system) => Ok(ModelAnswer::System(Box::new(system))),
            None => self.eigenvalues(point).map(ModelAnswer::Eigenvalues),
        }
    }

    /// How many runs may go on at once.
    fn concurrency(&self) -> Concurrency {
        Concurrency::Threads
    }

    /// [`Model::eigenvalues`] at many points, an answer each.
    fn eigenvalues_together(&self, points: &[&[f64]]) -> Vec<Result<Vec<Complex<f64>>, ModelError>> {
        points.iter().map(|point| self.eigenvalues(point)).collect()
    }

    /// Asks runs that are going on to end soon, and later ones not to start; they fail. For models that wait.
    fn interrupt(&self) {}
}
