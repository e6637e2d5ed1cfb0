//! The design points and what the model answered there.

use super::BuildError;
use crate::campaign::{Campaign, Run, RunError, Runner};
use crate::fitting::design::{NestedLatinHypercube, Samples};
use crate::fitting::regression::Gradients;
use crate::mechanics::model::Model;
use crate::mechanics::spectrum::{ClusterError, Spectrum, SpectrumError, components as components_of};
use crate::study::{Derivatives, DesignKind, Study};
use pcc_evaluate::components::Output;
use pcc_evaluate::foundation::Observer;

/// Error of an eigenvalue relative to the largest one: components that vary by less do not vary.
const SOLVER_ACCURACY: f64 = 1e-13;

/// A growing design with one model run per point. No point is run twice. Points whose runs failed, if the study skips those,
/// are no samples.
pub(super) struct Evaluations<'a> {
    study: &'a Study,
    design: NestedLatinHypercube,
    runner: Runner<'a>,
    /// For each sample, its point of the design.
    answered: Vec<usize>,
    runs: Vec<Run>,
}

impl<'a> Evaluations<'a> {
    pub fn new(campaign: Campaign<'a>, model: Box<dyn Model>) -> Result<Self, BuildError> {
        let study = campaign.study;
        if study.fit.derivatives == Derivatives::Always && !model.has_derivatives() {
            return Err(BuildError::NoDerivatives);
        }
        Ok(Self {
            study,
            design: match study.design.kind {
                DesignKind::NestedLhs => NestedLatinHypercube::new(study.inputs.dimension(), study.seed),
                // Tensor grids belong to builds by quadrature, which do not come here.
                DesignKind::NestedMaximinLhs | DesignKind::TensorGauss => {
                    NestedLatinHypercube::spread_out(study.inputs.dimension(), study.seed)
                }
            },
            runner: Runner::of(campaign, model).with_derivatives(study.uses_derivatives()),
            answered: Vec::new(),
            runs: Vec::new(),
        })
    }

    /// Grows the design and runs the model at its new points.
    pub fn grow_to(&mut self, size: usize, observer: &dyn Observer) -> Result<(), RunError> {
        let old = self.design.len();
        self.design.grow_to(size);
        let standardized = self.points();
        let new_points = standardized.points().skip(old);
        let points: Vec<Vec<f64>> = new_points.map(|point| self.study.inputs.physical(point)).collect();
        observer.begin("model runs", points.len() as u64);
        let runs = self.runner.run_some(&points, observer);
        observer.finish();
        for (i, run) in (old..).zip(runs?) {
            if let Some(run) = run {
                self.answered.push(i);
                self.runs.push(run);
            }
        }
        Ok(())
    }

    /// Number of runs that failed.
    pub fn failed(&self) -> usize {
        self.design.len() - self.runs.len()
    }

    /// All points of the design in standardized coordinates.
    fn points(&self) -> Samples {
        let inputs = self.study.inputs.inputs();
        self.design.samples(|j, unit| inputs[j].marginal.standardized_quantile(unit))
    }

    /// The points whose runs answered, in standardized coordinates.
    pub fn samples(&self) -> Samples {
        let points = self.points();
        if self.failed() == 0 {
            return points;
        }
        let answered = self.answered.iter().flat_map(|&i| points.point(i)).copied();
        Samples::new(points.dimension(), answered.collect())
    }

    /// The model runs, point by point.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// What the study's components form, with modes grouped by the spectra found so far.
    pub fn outputs(&self) -> Result<Vec<Output>, BuildError> {
        let spectra: Vec<Spectrum> = self.runs.iter().map(|run| run.spectrum.clone()).collect();
        self.study.spectrum.target.outputs(self.runner.modes(), &spectra).map_err(|cause| {
            let at = where_shown(&cause).unwrap_or(0);
            let inputs = &self.study.inputs;
            BuildError::Clusters { point: inputs.describe(&inputs.physical(self.samples().point(at))), cause }
        })
    }

    /// The values of each component of `outputs`, by id: one value per point.
    pub fn components(&self, outputs: &[Output]) -> Result<Vec<Vec<f64>>, BuildError> {
        component_values(outputs, &self.runs).map_err(|(i, cause)| {
            let point = self.study.inputs.describe(&self.study.inputs.physical(self.samples().point(i)));
            RunError::Spectrum { point, cause }.into()
        })
    }

    /// The derivatives of each component of `outputs`, by id, in standardized variables; `None` if the runs come without. Runs in
    /// which an output's modes, or all modes of the study together, cannot be separated from the rest of the spectrum have none
    /// for its components.
    pub fn gradients(&self, outputs: &[Output]) -> Option<Vec<Gradients>> {
        if !self.runner.has_derivatives() {
            return None;
        }
        let (samples, inputs) = (self.samples(), self.study.inputs.inputs());
        let mut gradients = Vec::new();
        for output in outputs {
            let slopes = |(i, run): (usize, &Run)| Some((i, run.reduced.as_ref()?.differentiate(output)?));
            let found: Vec<(usize, Vec<Vec<f64>>)> = self.runs.iter().enumerate().filter_map(slopes).collect();
            for position in 0..output.components.len() {
                // ∂y/∂ξ_j = ∂y/∂x_j · dx_j/dξ_j
                let standardized = inputs.iter().enumerate().flat_map(|(j, input)| {
                    let chained = |(i, by_input): &(usize, Vec<Vec<f64>>)| {
                        by_input[j][position] * input.marginal.slope(samples.point(*i)[j])
                    };
                    found.iter().map(chained).collect::<Vec<f64>>()
                });
                gradients.push(Gradients {
                    slopes: standardized.collect(),
                    points: found.iter().map(|(i, _)| *i).collect(),
                });
            }
        }
        Some(gradients)
    }

    /// Differences of each component of `outputs` up to this size are rounding of the eigenvalue solver.
    pub fn resolutions(&self, outputs: &[Output]) -> Vec<f64> {
        resolutions(outputs, &self.runs)
    }
}

/// The values of each component of `outputs`, by id: one value per run; or the first run without one.
pub(super) fn component_values(outputs: &[Output], runs: &[Run]) -> Result<Vec<Vec<f64>>, (usize, SpectrumError)> {
    let count = outputs.iter().map(|output| output.components.len()).sum();
    let mut components = vec![Vec::with_capacity(runs.len()); count];
    for (i, run) in runs.iter().enumerate() {
        let values = components_of(outputs, &run.spectrum).map_err(|cause| (i, cause))?;
        components.iter_mut().zip(values).for_each(|(list, value)| list.push(value));
    }
    Ok(components)
}

/// Differences of each component of `outputs` up to this size are rounding of the eigenvalue solver in these runs.
pub(super) fn resolutions<'a>(outputs: &[Output], runs: impl IntoIterator<Item = &'a Run>) -> Vec<f64> {
    let largest = runs.into_iter().map(|run| run.spectrum.largest()).fold(0.0, f64::max);
    let mut resolutions = vec![0.0; outputs.iter().map(|output| output.components.len()).sum()];
    for output in outputs {
        for (position, component) in output.components.iter().enumerate() {
            // A coefficient of degree j in distances from the mean has the scale Rʲ: it moves by j Rʲ⁻¹ per unit of λ.
            let others = (position / 2) as f64;
            let radius = component.scale.powf(1.0 / (others + 1.0));
            resolutions[component.id] = SOLVER_ACCURACY * largest * (others + 1.0) * radius.powf(others);
        }
    }
    resolutions
}

/// The position of the spectrum that shows why modes could not be grouped.
pub(super) fn where_shown(cause: &ClusterError) -> Option<usize> {
    match *cause {
        ClusterError::Split { at, .. } | ClusterError::NearRealAxis { at, .. } => Some(at),
        ClusterError::TooMany { .. } => None,
    }
}
