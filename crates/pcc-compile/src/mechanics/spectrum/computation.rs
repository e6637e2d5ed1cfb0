//! What one run of a model gave, before it is known which modes a study groups.

use super::derivatives::ReducedSystem;
use nalgebra::Complex;

/// The answer of one direct computation.
#[derive(Debug, Clone, PartialEq)]
pub struct Computation {
    /// Eigenvalues λ, in 1/s, as the model gave them: all of them, or those it was asked for.
    pub eigenvalues: Vec<Complex<f64>>,
    /// The system with its derivatives, if they were asked for.
    pub reduction: Option<Reduction>,
}

/// What became of the derivatives of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Reduction {
    /// The modes with these frequency ranks cannot be separated from the rest of the spectrum.
    Inseparable(Vec<usize>),
    /// The system on the invariant subspace of its modes.
    Reduced(ReducedSystem),
}

impl Reduction {
    /// Frequency ranks of the modes that it is about, from 1.
    pub fn modes(&self) -> &[usize] {
        match self {
            Self::Inseparable(modes) => modes,
            Self::Reduced(system) => system.modes(),
        }
    }

    /// The system, unless its modes could not be separated.
    pub fn system(&self) -> Option<&ReducedSystem> {
        match self {
            Self::Inseparable(_) => None,
            Self::Reduced(system) => Some(system),
        }
    }
}
