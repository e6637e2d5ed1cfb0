//! Many direct computations, seen as a study asks.

use crate::design::{ModeCount, RunError, direct_computation};
use crate::model::{Model, ModelError};
use crate::parallel::try_map;
use crate::spectrum::{Spectrum, SpectrumError};
use crate::study::Study;
use nalgebra::Complex;

/// One direct computation.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Standardized coordinates of the point.
    pub standardized: Vec<f64>,
    /// All modes.
    pub spectrum: Spectrum,
    /// Values of the study's components, by id.
    pub components: Vec<f64>,
    /// Eigenvalues of the study's modes.
    pub eigenvalues: Vec<Complex<f64>>,
}

/// Runs the model of a study, and sees to it that all points have the same number of oscillating modes.
pub struct Runner<'a> {
    study: &'a Study,
    model: Box<dyn Model>,
    mode_count: ModeCount,
    modes: Vec<usize>,
}

impl<'a> Runner<'a> {
    /// Sets up the model.
    ///
    /// # Errors
    ///
    /// [`ModelError`].
    pub fn new(study: &'a Study) -> Result<Self, ModelError> {
        Ok(Self { study, model: study.model()?, mode_count: ModeCount::default(), modes: Vec::new() })
    }

    /// Frequency ranks of the study's modes; empty before the first run.
    pub fn modes(&self) -> &[usize] {
        &self.modes
    }

    /// Direct computations at standardized points, in parallel and in order.
    ///
    /// # Errors
    ///
    /// [`RunError`] names the first point that failed.
    pub fn run(&mut self, points: &[Vec<f64>]) -> Result<Vec<Run>, RunError> {
        let (study, model) = (self.study, self.model.as_ref());
        let runs = try_map(points.len(), |i| run(study, model, points[i].clone()))?;
        let mut checked = Vec::new();
        for (physical, modes, run) in runs {
            self.mode_count.check(&study.inputs, &physical, &run.spectrum)?;
            self.modes = modes;
            checked.push(run);
        }
        Ok(checked)
    }
}

fn run(study: &Study, model: &dyn Model, standardized: Vec<f64>) -> Result<(Vec<f64>, Vec<usize>, Run), RunError> {
    let physical = study.inputs.physical(&standardized);
    let spectrum = direct_computation(model, &study.inputs, &physical)?;
    let selected = || -> Result<_, SpectrumError> {
        let modes = study.spectrum.modes.ranks(spectrum.count())?;
        let components = study.spectrum.target.components(&modes, &spectrum)?;
        let eigenvalues = modes.iter().map(|&mode| spectrum.mode(mode)).collect::<Result<_, _>>()?;
        Ok((modes, components, eigenvalues))
    };
    let (modes, components, eigenvalues) =
        selected().map_err(|cause| RunError::Spectrum { point: study.inputs.describe(&physical), cause })?;
    Ok((physical, modes, Run { standardized, spectrum, components, eigenvalues }))
}
