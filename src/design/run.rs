//! Direct computations at points of the input space, with errors that name the point.

use crate::model::{Model, ModelError};
use crate::parallel::try_map;
use crate::progress::{Interrupted, Observer};
use crate::spectrum::{Spectrum, SpectrumError};
use crate::study::Study;
use nalgebra::Complex;
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
    /// The user asked to stop.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

/// One direct computation, seen as a study asks.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// All modes.
    pub spectrum: Spectrum,
    /// Eigenvalues of the study's modes.
    pub eigenvalues: Vec<Complex<f64>>,
}

/// Runs the model of a study, and sees to it that all points have the same number of oscillating modes.
pub struct Runner<'a> {
    study: &'a Study,
    model: Box<dyn Model>,
    /// The first point, and how many modes oscillate there.
    first: Option<(Vec<f64>, usize)>,
    modes: Vec<usize>,
}

impl<'a> Runner<'a> {
    /// Sets up the model.
    ///
    /// # Errors
    ///
    /// [`ModelError`].
    pub fn new(study: &'a Study) -> Result<Self, ModelError> {
        Ok(Self { study, model: study.model()?, first: None, modes: Vec::new() })
    }

    /// Frequency ranks of the study's modes; empty before the first run.
    pub fn modes(&self) -> &[usize] {
        &self.modes
    }

    /// Direct computations at physical points, in parallel and in order.
    ///
    /// # Errors
    ///
    /// [`RunError`] names the first point that failed.
    pub fn run(&mut self, points: &[Vec<f64>], observer: &dyn Observer) -> Result<Vec<Run>, RunError> {
        let spectra = try_map(points.len(), |i| {
            observer.check()?;
            let spectrum = self.direct_computation(&points[i])?;
            observer.advance(1);
            Ok::<_, RunError>(spectrum)
        })?;
        // Every point first: where the number of modes changes, a missing mode is the lesser news.
        for (point, spectrum) in points.iter().zip(&spectra) {
            self.check_mode_count(point, spectrum.count())?;
        }
        points.iter().zip(spectra).map(|(point, spectrum)| self.select(point, spectrum)).collect()
    }

    fn direct_computation(&self, point: &[f64]) -> Result<Spectrum, RunError> {
        let inputs = &self.study.inputs;
        let eigenvalues =
            self.model.eigenvalues(point).map_err(|cause| RunError::Model { point: inputs.describe(point), cause })?;
        Spectrum::new(&eigenvalues).map_err(|cause| RunError::Spectrum { point: inputs.describe(point), cause })
    }

    fn check_mode_count(&mut self, point: &[f64], count: usize) -> Result<(), RunError> {
        let inputs = &self.study.inputs;
        let (first_point, first_count) = self.first.get_or_insert_with(|| (point.to_vec(), count));
        if *first_count == count {
            return Ok(());
        }
        Err(RunError::ModeCount {
            first_point: inputs.describe(first_point),
            first_count: *first_count,
            point: inputs.describe(point),
            count,
        })
    }

    /// What the study asks of a spectrum.
    fn select(&mut self, point: &[f64], spectrum: Spectrum) -> Result<Run, RunError> {
        let Study { inputs, spectrum: asked, .. } = self.study;
        let unusable = |cause| RunError::Spectrum { point: inputs.describe(point), cause };
        self.modes = asked.modes.ranks(spectrum.count()).map_err(unusable)?;
        let eigenvalues = self.modes.iter().map(|&mode| spectrum.mode(mode)).collect::<Result<_, _>>();
        Ok(Run { eigenvalues: eigenvalues.map_err(unusable)?, spectrum })
    }
}
