//! The design points and what the model answered there.

use super::BuildError;
use crate::campaign::{Campaign, Failure, Run, RunError, Runner};
use crate::fitting::design::{NestedLatinHypercube, Samples};
use crate::fitting::regression::{Gradients, Response};
use crate::mechanics::model::Model;
use crate::mechanics::spectrum::{ClusterError, Spectrum, SpectrumError, components as components_of};
use crate::study::{Derivatives, DesignKind, Study};
use pcc_evaluate::components::Output;
use pcc_evaluate::foundation::Observer;

/// Error of an eigenvalue relative to the largest one: components that vary by less do not vary.
const SOLVER_ACCURACY: f64 = 1e-13;

/// Fewer runs say nothing of how a component varies.
const LEAST_RUNS: usize = 2;

/// What a fit needs of a design and the answers there.
pub(super) struct Level {
    /// The points whose runs answered, in standardized coordinates.
    pub samples: Samples,
    /// What the study's components form, with modes grouped by the spectra found so far.
    pub outputs: Vec<Output>,
    /// Per component, one value per point.
    pub values: Vec<Vec<f64>>,
    /// Per component its derivatives, if the runs come with any.
    pub gradients: Option<Vec<Gradients>>,
    /// Per component, differences up to this size are rounding of the eigenvalue solver.
    resolutions: Vec<f64>,
}

impl Level {
    /// What each component is fitted to.
    pub fn responses(&self) -> Vec<Response<'_>> {
        let response = |id: usize| {
            let gradients = self.gradients.as_ref().map(|all| &all[id]).filter(|one| !one.points.is_empty());
            Response { gradients, ..Response::of(&self.values[id], self.resolutions[id]) }
        };
        (0..self.values.len()).map(response).collect()
    }
}

/// The modes of each output.
pub(super) fn groups(outputs: &[Output]) -> Vec<&[usize]> {
    outputs.iter().map(|output| output.modes.as_slice()).collect()
}

/// A growing design with one model run per point. No point is run twice. Points whose runs failed, if the study skips
/// those, are no samples.
pub(super) struct Evaluations<'a> {
    study: &'a Study,
    campaign: Campaign<'a>,
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
            campaign,
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

    /// Grows the design, runs the model at its new points, and says what a fit needs of all points.
    ///
    /// # Errors
    ///
    /// [`BuildError`] if a run fails that the study does not skip, if too many fail, or if modes cannot be grouped.
    pub fn grow_to(&mut self, size: usize, observer: &dyn Observer) -> Result<Level, BuildError> {
        self.run(size, observer)?;
        self.check_failures()?;
        let outputs = self.outputs()?;
        Ok(Level {
            samples: self.samples(),
            values: self.components(&outputs)?,
            gradients: self.gradients(&outputs),
            resolutions: resolutions(&outputs, &self.runs),
            outputs,
        })
    }

    fn run(&mut self, size: usize, observer: &dyn Observer) -> Result<(), RunError> {
        let old = self.design.len();
        self.design.grow_to(size);
        let standardized = self.points();
        let new_points = standardized.points().skip(old);
        let points: Vec<Vec<f64>> = new_points.map(|point| self.study.inputs.physical(point)).collect();
        observer.begin("model runs", points.len() as u64);
        let runs = self.runner.run_skipping(&points, observer);
        observer.finish();
        for (i, run) in (old..).zip(runs?) {
            if let Some(run) = run {
                self.answered.push(i);
                self.runs.push(run);
            }
        }
        Ok(())
    }

    /// Whether enough runs answered: those that failed leave holes in the design, and more than half of it is no
    /// design.
    fn check_failures(&self) -> Result<(), BuildError> {
        let (failed, answered) = (self.failed(), self.runs.len());
        if failed <= answered && answered >= LEAST_RUNS {
            return Ok(());
        }
        let first = self.campaign.ledger.and_then(|ledger| ledger.failures().into_iter().next());
        let describe = |failure: Failure| (self.study.inputs.describe(&failure.point), failure.cause);
        let (point, cause) = first.map_or_else(Default::default, describe);
        Err(BuildError::TooManyFailures { failed, runs: failed + answered, point, cause })
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
    fn samples(&self) -> Samples {
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
    fn outputs(&self) -> Result<Vec<Output>, BuildError> {
        let spectra: Vec<Spectrum> = self.runs.iter().map(|run| run.spectrum.clone()).collect();
        self.study.spectrum.target.outputs(self.runner.modes(), &spectra).map_err(|cause| {
            let at = where_shown(&cause).unwrap_or(0);
            let inputs = &self.study.inputs;
            BuildError::Clusters { point: inputs.describe(&inputs.physical(self.samples().point(at))), cause }
        })
    }

    /// The values of each component of `outputs`, by id: one value per point.
    fn components(&self, outputs: &[Output]) -> Result<Vec<Vec<f64>>, BuildError> {
        component_values(outputs, &self.runs).map_err(|(i, cause)| {
            let point = self.study.inputs.describe(&self.study.inputs.physical(self.samples().point(i)));
            RunError::Spectrum { point, cause }.into()
        })
    }

    /// The derivatives of each component of `outputs`, by id, in standardized variables; `None` if the runs come
    /// without. Runs in which an output's modes, or all modes of the study together, cannot be separated from the rest
    /// of the spectrum have none for its components.
    fn gradients(&self, outputs: &[Output]) -> Option<Vec<Gradients>> {
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
