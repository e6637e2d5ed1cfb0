//! The design points and what the model answered there.

use super::BuildError;
use crate::design::{ModeCount, NestedLatinHypercube, RunError, Samples, direct_computation};
use crate::model::Model;
use crate::parallel::try_map;
use crate::progress::Observer;
use crate::spectrum::{Output, Spectrum};
use crate::study::Study;

/// A growing design with one spectrum per point. No point is run twice.
pub(super) struct Evaluations<'a> {
    study: &'a Study,
    design: NestedLatinHypercube,
    spectra: Vec<Spectrum>,
    modes: Vec<usize>,
    mode_count: ModeCount,
}

/// One point with its spectrum.
struct Run {
    physical: Vec<f64>,
    spectrum: Spectrum,
    modes: Vec<usize>,
}

impl<'a> Evaluations<'a> {
    pub fn new(study: &'a Study) -> Self {
        Self {
            study,
            design: NestedLatinHypercube::new(study.inputs.dimension(), study.seed),
            spectra: Vec::new(),
            modes: Vec::new(),
            mode_count: ModeCount::default(),
        }
    }

    /// Grows the design and runs the model at its new points, in parallel.
    pub fn grow_to(&mut self, size: usize, model: &dyn Model, observer: &dyn Observer) -> Result<(), BuildError> {
        let inputs = &self.study.inputs;
        let old = self.design.len();
        self.design.grow_to(size);
        let samples = self.samples();
        observer.begin("model runs", (size - old) as u64);
        let runs = try_map(size - old, |new| {
            if observer.interrupted() {
                return Err(BuildError::Interrupted);
            }
            let run = self.run(model, inputs.physical(samples.point(old + new)))?;
            observer.advance(1);
            Ok(run)
        });
        observer.finish();
        for Run { physical, spectrum, modes } in runs? {
            self.mode_count.check(inputs, &physical, &spectrum)?;
            self.modes = modes;
            self.spectra.push(spectrum);
        }
        Ok(())
    }

    /// One direct computation, with the ranks of the study's modes at this point.
    fn run(&self, model: &dyn Model, physical: Vec<f64>) -> Result<Run, RunError> {
        let inputs = &self.study.inputs;
        let spectrum = direct_computation(model, inputs, &physical)?;
        let modes = self.study.spectrum.modes.ranks(spectrum.count());
        let modes = modes.map_err(|cause| RunError::Spectrum { point: inputs.describe(&physical), cause })?;
        Ok(Run { physical, spectrum, modes })
    }

    /// The points in standardized coordinates.
    pub fn samples(&self) -> Samples {
        let inputs = self.study.inputs.inputs();
        self.design.samples(|j, unit| inputs[j].marginal.standardized_quantile(unit))
    }

    /// The spectra, point by point.
    pub fn spectra(&self) -> &[Spectrum] {
        &self.spectra
    }

    /// What the study's components form.
    pub fn outputs(&self) -> Vec<Output> {
        self.study.spectrum.target.outputs(&self.modes)
    }

    /// The values of each component, by id: one value per point.
    pub fn components(&self) -> Result<Vec<Vec<f64>>, RunError> {
        let target = self.study.spectrum.target;
        let mut components = Vec::new();
        for (spectrum, point) in self.spectra.iter().zip(self.samples().points()) {
            let values = target.components(&self.modes, spectrum).map_err(|cause| {
                let physical = self.study.inputs.physical(point);
                RunError::Spectrum { point: self.study.inputs.describe(&physical), cause }
            })?;
            components.resize_with(values.len(), Vec::new);
            for (component, value) in components.iter_mut().zip(values) {
                component.push(value);
            }
        }
        Ok(components)
    }
}
