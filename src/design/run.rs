//! Direct computations at points of the input space, with errors that name the point.

use crate::model::{Linearization, Model, ModelError};
use crate::numerics::eigenvalues::SchurForm;
use crate::parallel::try_map;
use crate::progress::{Interrupted, Observer};
use crate::spectrum::{ReducedSystem, Spectrum, SpectrumError};
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
    /// The system with its derivatives, as the study's modes see it: if derivatives were asked for and the modes can be
    /// separated from the rest of the spectrum.
    pub reduced: Option<ReducedSystem>,
}

/// Runs the model of a study, and sees to it that all points have the same number of oscillating modes.
pub struct Runner<'a> {
    study: &'a Study,
    model: Box<dyn Model>,
    with_derivatives: bool,
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
        Ok(Self::of(study, study.model()?))
    }

    /// Runs `model` in place of the study's.
    pub fn of(study: &'a Study, model: Box<dyn Model>) -> Self {
        Self { study, model, with_derivatives: false, first: None, modes: Vec::new() }
    }

    /// Asks the model for derivatives, too, if it has them.
    #[must_use]
    pub fn with_derivatives(self, wanted: bool) -> Self {
        Self { with_derivatives: wanted && self.model.has_derivatives(), ..self }
    }

    /// Whether runs come with derivatives.
    pub fn has_derivatives(&self) -> bool {
        self.with_derivatives
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
            let answer = self.direct_computation(&points[i])?;
            observer.advance(1);
            Ok::<_, RunError>(answer)
        })?;
        // Every point first: where the number of modes changes, a missing mode is the lesser news.
        for (point, (spectrum, _)) in points.iter().zip(&spectra) {
            self.check_mode_count(point, spectrum.count())?;
        }
        points.iter().zip(spectra).map(|(point, (spectrum, reduced))| self.select(point, spectrum, reduced)).collect()
    }

    fn direct_computation(&self, point: &[f64]) -> Result<(Spectrum, Option<ReducedSystem>), RunError> {
        let inputs = &self.study.inputs;
        let failed = |cause| RunError::Model { point: inputs.describe(point), cause };
        let unusable = |cause| RunError::Spectrum { point: inputs.describe(point), cause };
        let linearization = if self.with_derivatives { self.model.linearization(point).map_err(failed)? } else { None };
        let Some(Linearization { state_matrix, derivatives }) = linearization else {
            let eigenvalues = self.model.eigenvalues(point).map_err(failed)?;
            return Ok((Spectrum::new(&eigenvalues).map_err(unusable)?, None));
        };
        let (found, expected) = (
            derivatives.iter().filter(|derivative| derivative.shape() == state_matrix.shape()).count(),
            inputs.dimension(),
        );
        if (found, derivatives.len()) != (expected, expected) {
            return Err(failed(ModelError::Derivatives { found, expected }));
        }
        let schur = SchurForm::new(state_matrix).map_err(|cause| failed(cause.into()))?;
        let spectrum = Spectrum::new(&schur.eigenvalues()).map_err(unusable)?;
        // A missing mode is reported once the number of modes is known to be the same everywhere.
        let modes = self.study.spectrum.modes.ranks(spectrum.count()).ok();
        let reduced = modes.and_then(|modes| ReducedSystem::new(&schur, &derivatives, &spectrum, &modes));
        Ok((spectrum, reduced))
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
    fn select(&mut self, point: &[f64], spectrum: Spectrum, reduced: Option<ReducedSystem>) -> Result<Run, RunError> {
        let Study { inputs, spectrum: asked, .. } = self.study;
        let unusable = |cause| RunError::Spectrum { point: inputs.describe(point), cause };
        self.modes = asked.modes.ranks(spectrum.count()).map_err(unusable)?;
        let eigenvalues = self.modes.iter().map(|&mode| spectrum.mode(mode)).collect::<Result<_, _>>();
        Ok(Run { eigenvalues: eigenvalues.map_err(unusable)?, spectrum, reduced })
    }
}
