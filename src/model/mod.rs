//! Models: from parameters to the eigenvalues of a linearised system.

mod clutch;
mod parameter;
mod second_order;

pub use clutch::{CLUTCH_PARAMETERS, Clutch};
pub use parameter::{Parameter, Range};
pub use second_order::{Linearization, SecondOrder};

use crate::numerics::eigenvalues::EigenvalueError;
use nalgebra::Complex;
use thiserror::Error;

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
    /// The mass matrix cannot be inverted.
    #[error("the mass matrix is singular")]
    SingularMass,
    /// The eigenvalue solver failed.
    #[error(transparent)]
    Eigenvalues(#[from] EigenvalueError),
}

/// A system whose eigenvalues depend on parameters.
///
/// One call of [`Model::eigenvalues`] or of [`Model::linearization`] is one direct computation. Calls come from several threads
/// at once.
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
}
