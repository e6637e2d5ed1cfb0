//! Direct computations at points of the input space, with errors that name the point.

use crate::input::InputSpace;
use crate::model::{Model, ModelError};
use crate::spectrum::{Spectrum, SpectrumError};
use thiserror::Error;

/// Why a direct computation gave no spectrum. `point` lists the inputs with their values.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RunError {
    /// The model failed.
    #[error("the model run at {point} failed: {cause}")]
    Model {
        /// Where.
        point: String,
        /// Why.
        cause: ModelError,
    },
    /// Its eigenvalues cannot be sorted into modes, or a mode of `spectrum.modes` is missing.
    #[error("spectrum.modes: {cause}; found at {point}")]
    Spectrum {
        /// Where.
        point: String,
        /// Why.
        cause: SpectrumError,
    },
    /// Two runs found different numbers of oscillating modes, so ranks do not name the same modes.
    #[error(
        "{first_count} modes oscillate at {first_point}, but {count} at {point}; modes cannot be numbered by frequency \
         over this input space: narrow the inputs"
    )]
    ModeCount {
        /// A first point.
        first_point: String,
        /// Number of oscillating modes there.
        first_count: usize,
        /// A second point.
        point: String,
        /// Number of oscillating modes there.
        count: usize,
    },
}

/// Runs the model at a physical point.
///
/// # Errors
///
/// [`RunError::Model`] and [`RunError::Spectrum`].
pub fn direct_computation(model: &dyn Model, inputs: &InputSpace, physical: &[f64]) -> Result<Spectrum, RunError> {
    let eigenvalues =
        model.eigenvalues(physical).map_err(|cause| RunError::Model { point: inputs.describe(physical), cause })?;
    Spectrum::new(&eigenvalues).map_err(|cause| RunError::Spectrum { point: inputs.describe(physical), cause })
}

/// The number of oscillating modes at the first point seen, which every other point must share.
#[derive(Debug, Clone, Default)]
pub struct ModeCount(Option<(Vec<f64>, usize)>);

impl ModeCount {
    /// Compares the spectrum at a physical point with the first one.
    ///
    /// # Errors
    ///
    /// [`RunError::ModeCount`] shows both points.
    pub fn check(&mut self, inputs: &InputSpace, physical: &[f64], spectrum: &Spectrum) -> Result<usize, RunError> {
        let count = spectrum.count();
        match &self.0 {
            None => self.0 = Some((physical.to_vec(), count)),
            Some((first, first_count)) if *first_count != count => {
                return Err(RunError::ModeCount {
                    first_point: inputs.describe(first),
                    first_count: *first_count,
                    point: inputs.describe(physical),
                    count,
                });
            }
            Some(_) => {}
        }
        Ok(count)
    }
}
