//! The design points and what the model answered there.

use crate::design::{NestedLatinHypercube, Run, RunError, Runner, Samples};
use crate::model::ModelError;
use crate::progress::Observer;
use crate::spectrum::Output;
use crate::study::Study;

/// A growing design with one model run per point. No point is run twice.
pub(super) struct Evaluations<'a> {
    study: &'a Study,
    design: NestedLatinHypercube,
    runner: Runner<'a>,
    runs: Vec<Run>,
}

impl<'a> Evaluations<'a> {
    pub fn new(study: &'a Study) -> Result<Self, ModelError> {
        Ok(Self {
            study,
            design: NestedLatinHypercube::new(study.inputs.dimension(), study.seed),
            runner: Runner::new(study)?,
            runs: Vec::new(),
        })
    }

    /// Grows the design and runs the model at its new points.
    pub fn grow_to(&mut self, size: usize, observer: &dyn Observer) -> Result<(), RunError> {
        let old = self.design.len();
        self.design.grow_to(size);
        let samples = self.samples();
        let points: Vec<Vec<f64>> = samples.points().skip(old).map(|point| self.study.inputs.physical(point)).collect();
        observer.begin("model runs", points.len() as u64);
        let runs = self.runner.run(&points, observer);
        observer.finish();
        self.runs.append(&mut runs?);
        Ok(())
    }

    /// The points in standardized coordinates.
    pub fn samples(&self) -> Samples {
        let inputs = self.study.inputs.inputs();
        self.design.samples(|j, unit| inputs[j].marginal.standardized_quantile(unit))
    }

    /// The model runs, point by point.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// What the study's components form.
    pub fn outputs(&self) -> Vec<Output> {
        self.study.spectrum.target.outputs(self.runner.modes())
    }

    /// The values of each component, by id: one value per point.
    pub fn components(&self) -> Vec<Vec<f64>> {
        let count = self.runs.first().map_or(0, |run| run.components.len());
        (0..count).map(|id| self.runs.iter().map(|run| run.components[id]).collect()).collect()
    }

    /// max |λ| over all points, in 1/s.
    pub fn largest_eigenvalue(&self) -> f64 {
        self.runs.iter().map(|run| run.spectrum.largest()).fold(0.0, f64::max)
    }
}
