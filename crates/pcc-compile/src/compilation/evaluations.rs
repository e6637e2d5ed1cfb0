//! The design points and what the model answered there.

use super::BuildError;
use super::group_fits::{gradients, resolutions};
use crate::campaign::{Campaign, Failure, Run, RunError, Runner, agree_on_rigid_body_motion};
use crate::fitting::design::{NestedLatinHypercube, Samples};
use crate::fitting::regression::{Gradients, Response};
use crate::mechanics::model::Model;
use crate::mechanics::spectrum::{
    ClusterError, Computation, Groups, Labels, Reductions, Spectrum, SpectrumError, Vectors,
    components as components_at,
};
use crate::study::{Derivatives, DesignKind, Study};
use crate::tables::GivenRun;
use nalgebra::Complex;
use pcc_evaluate::components::Output;
use pcc_evaluate::foundation::Observer;
use pcc_evaluate::surrogate::{Band, Coverage};

/// Fewer runs say nothing of how a component varies.
const LEAST_RUNS: usize = 2;

/// What a fit needs of a design and the answers there.
#[derive(Debug)]
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
    pub resolutions: Vec<f64>,
    /// Whether eigenvalues of runs with vectors could not be followed by them.
    pub is_by_modulus: bool,
    /// The band of frequencies that chose its modes.
    pub band: Option<Band>,
}

impl Level {
    /// What each component is fitted to.
    pub fn responses(&self) -> Vec<Response<'_>> {
        responses(&self.values, self.gradients.as_deref(), &self.resolutions)
    }
}

/// What components with these values, derivatives and resolutions are fitted to.
pub(super) fn responses<'v>(
    values: &'v [Vec<f64>],
    gradients: Option<&'v [Gradients]>,
    resolutions: &[f64],
) -> Vec<Response<'v>> {
    let response = |id: usize| {
        let gradients = gradients.map(|all| &all[id]).filter(|one| !one.points.is_empty());
        Response { gradients, ..Response::of(&values[id], resolutions[id]) }
    };
    (0..values.len()).map(response).collect()
}

/// The modes and real eigenvalues of each output.
pub(super) fn groups(outputs: &[Output]) -> Vec<(&[usize], &[usize])> {
    outputs.iter().map(|output| (output.modes.as_slice(), output.reals.as_slice())).collect()
}

/// Why a run was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Origin {
    /// The design asked for it.
    Design,
    /// It was given.
    Given,
    /// Its point was chosen beside the design.
    Chosen,
}

/// Numbers of points whose runs have ended, by their origin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Sizes {
    /// Of the design.
    pub design: usize,
    /// Given.
    pub given: usize,
    /// Chosen beside the design.
    pub chosen: usize,
}

impl Sizes {
    /// Number of all of them.
    pub fn sum(self) -> usize {
        self.design + self.given + self.chosen
    }
}

/// A growing design with one model run per point. No point is run twice. Points whose runs failed, if the study skips
/// those, are no samples.
pub(super) struct Evaluations<'a> {
    study: &'a Study,
    campaign: Campaign<'a>,
    design: NestedLatinHypercube,
    runner: Runner<'a>,
    /// Standardized coordinates of all points whose runs have ended, in the order of the runs.
    tried: Vec<f64>,
    /// For each sample, its number among these points.
    answered: Vec<usize>,
    /// Why each of these was run.
    origins: Vec<Origin>,
    runs: Vec<Run>,
    /// The run nearest the middle of the inputs on the first level: where labels get their names.
    root: Option<usize>,
}

impl<'a> Evaluations<'a> {
    /// With `ranks`, modes have frequency ranks and must be as many at every point; else eigenvalues are followed.
    pub fn new(campaign: Campaign<'a>, model: Box<dyn Model>, ranks: bool) -> Result<Self, BuildError> {
        let study = campaign.study;
        let runner = Runner::of(campaign, model);
        let given_have = study.data.as_ref().is_some_and(|data| data.runs.has_derivatives);
        let has_derivatives = runner.model_has_derivatives() || given_have;
        if study.fit.derivatives == Derivatives::Always && !has_derivatives {
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
            runner: if ranks { runner } else { runner.without_ranks() }.with_derivatives(study.uses_derivatives()),
            tried: Vec::new(),
            answered: Vec::new(),
            origins: Vec::new(),
            runs: Vec::new(),
            root: None,
        })
    }

    /// Grows the design and runs the model at its new points.
    ///
    /// # Errors
    ///
    /// [`BuildError`] if a run fails that the study does not skip, or if too many fail.
    pub fn grow_to(&mut self, size: usize, observer: &dyn Observer) -> Result<(), BuildError> {
        let old = self.design.len();
        self.design.grow_to(size);
        let design = self.design.placed(|units| self.study.inputs.place(units));
        self.run(design.points().skip(old), Origin::Design, observer)?;
        self.check_failures()
    }

    /// Takes runs that are given.
    ///
    /// # Errors
    ///
    /// [`BuildError`] if their answers cannot be those of one model, or too many have failed.
    pub fn take(&mut self, given: &[&GivenRun]) -> Result<(), BuildError> {
        let answers = given.iter().map(|run| (run.point.as_slice(), computation(run))).collect();
        let runs = self.runner.take(answers)?;
        for (given, run) in given.iter().zip(runs) {
            let point = self.study.inputs.standardized(&given.point);
            self.settle(&point, run, Origin::Given);
        }
        self.check_failures()
    }

    /// Runs the model at standardized points that are none of the design.
    ///
    /// # Errors
    ///
    /// As [`Evaluations::grow_to`].
    pub fn add(&mut self, points: &[Vec<f64>], observer: &dyn Observer) -> Result<(), BuildError> {
        self.run(points.iter().map(Vec::as_slice), Origin::Chosen, observer)?;
        self.check_failures()
    }

    /// Given runs that are not taken, with their standardized points: seen as those that are.
    ///
    /// # Errors
    ///
    /// As [`Evaluations::take`].
    pub fn outside(&mut self, given: &[&GivenRun]) -> Result<(Samples, Vec<Run>), BuildError> {
        let answers = given.iter().map(|run| (run.point.as_slice(), computation(run))).collect();
        let mut runs: Vec<Run> = self.runner.take(answers)?.into_iter().flatten().collect();
        agree_on_rigid_body_motion(&mut runs, super::rigid_body_modes(&self.runs));
        let points = given.iter().flat_map(|run| self.study.inputs.standardized(&run.point)).collect();
        Ok((Samples::new(self.study.inputs.dimension(), points), runs))
    }

    /// Number of points whose runs have ended.
    pub fn sizes(&self) -> Sizes {
        let count = |origin: Origin| self.origins.iter().filter(|&&own| own == origin).count();
        Sizes { design: count(Origin::Design), given: count(Origin::Given), chosen: count(Origin::Chosen) }
    }

    /// Whether sample `i` was chosen beside the design, so that it stands for no others.
    pub fn is_chosen(&self, i: usize) -> bool {
        self.origins[self.answered[i]] == Origin::Chosen
    }

    /// Whether the answers of a design of this size are there, or can be had.
    pub fn can_grow_to(&self, size: usize) -> bool {
        let Some(ledger) = self.campaign.ledger.filter(|ledger| ledger.settles()) else { return true };
        let mut design = self.design.clone();
        design.grow_to(size);
        let design = design.placed(|units| self.study.inputs.place(units));
        let mut new = design.points().skip(self.design.len());
        new.all(|point| ledger.find(&self.study.inputs.physical(point)).is_some())
    }

    /// What a fit needs of all points, with modes by frequency rank.
    ///
    /// # Errors
    ///
    /// [`BuildError`] if modes cannot be grouped.
    pub fn by_rank(&self) -> Result<Level, BuildError> {
        let outputs = self.outputs()?;
        Ok(Level {
            samples: self.samples(),
            values: self.components(&outputs)?,
            gradients: self.gradients(&outputs),
            resolutions: outputs.iter().flat_map(|output| resolutions(output, &self.runs)).collect(),
            outputs,
            is_by_modulus: false,
            band: None,
        })
    }

    /// Follows all eigenvalues over the design: their labels and finest groups. Rigid-body motion is as many
    /// eigenvalues as are negligible at every run, since a slow one may be so at some.
    ///
    /// # Errors
    ///
    /// [`RunError::EigenvalueCount`] if runs have different numbers of eigenvalues.
    pub fn follow(&mut self) -> Result<(Labels, Groups), BuildError> {
        agree_on_rigid_body_motion(&mut self.runs, usize::MAX);
        let samples = self.samples();
        let describe = |i: usize| self.study.inputs.describe(&self.study.inputs.physical(samples.point(i)));
        let count = |run: &Run| run.spectrum.eigenvalues().len();
        let first_count = self.runs.first().map_or(0, count);
        if let Some(other) = self.runs.iter().position(|run| count(run) != first_count) {
            let (first_point, point) = (describe(0), describe(other));
            let count = count(&self.runs[other]);
            return Err(RunError::EigenvalueCount { first_point, first_count, point, count }.into());
        }
        let points: Vec<&[f64]> = samples.points().collect();
        let middle = self.study.inputs.middle();
        let from_center =
            |run: &usize| points[*run].iter().zip(&middle).map(|(xi, center)| (xi - center).powi(2)).sum::<f64>();
        let nearest = || (0..points.len()).reduce(|a, b| if from_center(&b) < from_center(&a) { b } else { a });
        let root = self.root.or_else(nearest).unwrap_or(0);
        let spectra: Vec<&Spectrum> = self.runs.iter().map(|run| &run.spectrum).collect();
        let vectors: Option<Vec<Vectors>> =
            self.runs.iter().map(|run| run.reductions.as_ref()?.vectors(&run.spectrum)).collect();
        let labels = match vectors {
            Some(vectors) => Labels::following(&points, root, &vectors, &spectra),
            None => Labels::by_modulus(&spectra),
        };
        let groups = Groups::new(&labels, &spectra);
        self.root = Some(root);
        Ok((labels, groups))
    }

    /// Whether the model is undamped with symmetric matrices, so that λ² is real.
    pub fn is_self_adjoint(&self) -> bool {
        self.runs.iter().all(|run| run.spectrum.is_undamped()) && self.runner.is_self_adjoint()
    }

    /// Whether runs come with derivatives.
    pub fn has_derivatives(&self) -> bool {
        self.study.uses_derivatives() && (self.runner.has_derivatives() || self.sizes().given > 0)
    }

    fn run<'p>(
        &mut self,
        standardized: impl Iterator<Item = &'p [f64]>,
        origin: Origin,
        observer: &dyn Observer,
    ) -> Result<(), RunError> {
        let standardized: Vec<&[f64]> = standardized.collect();
        let points: Vec<Vec<f64>> = standardized.iter().map(|point| self.study.inputs.physical(point)).collect();
        observer.begin("model runs", points.len() as u64);
        let runs = self.runner.run_skipping(&points, observer);
        observer.finish();
        for (point, run) in standardized.into_iter().zip(runs?) {
            self.settle(point, run, origin);
        }
        Ok(())
    }

    /// Takes note of how a run has ended.
    fn settle(&mut self, point: &[f64], run: Option<Run>, origin: Origin) {
        if let Some(run) = run {
            self.answered.push(self.origins.len());
            self.runs.push(run);
        }
        self.origins.push(origin);
        self.tried.extend_from_slice(point);
    }

    /// Whether enough runs answered: those that failed leave holes in the design, and more than half of it is no
    /// design.
    fn check_failures(&self) -> Result<(), BuildError> {
        let (failed, answered) = (self.failed(), self.runs.len());
        if failed <= answered && answered >= LEAST_RUNS {
            return Ok(());
        }
        if failed == 0 {
            return Err(BuildError::TooFewRuns { runs: answered, least: LEAST_RUNS });
        }
        let first = self.campaign.ledger.and_then(|ledger| ledger.failures().into_iter().next());
        let describe = |failure: Failure| (self.study.inputs.describe(&failure.point), failure.cause);
        let (point, cause) = first.map_or_else(Default::default, describe);
        Err(BuildError::TooManyFailures { failed, runs: failed + answered, point, cause })
    }

    /// Number of runs that failed.
    pub fn failed(&self) -> usize {
        self.origins.len() - self.runs.len()
    }

    /// The runs, if some failed.
    pub fn coverage(&self) -> Option<Coverage> {
        let (points, mut answered, mut unanswered) = (self.points(), Vec::new(), Vec::new());
        for i in 0..points.len() {
            let runs = if self.answered.binary_search(&i).is_ok() { &mut answered } else { &mut unanswered };
            runs.push(points.point(i).to_vec());
        }
        (self.failed() > 0).then_some(Coverage { answered, unanswered })
    }

    /// All points whose runs have ended, in standardized coordinates.
    pub fn points(&self) -> Samples {
        Samples::new(self.study.inputs.dimension(), self.tried.clone())
    }

    /// The points whose runs answered, in standardized coordinates.
    pub fn samples(&self) -> Samples {
        let points = self.points();
        if self.answered.len() == points.len() {
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
    /// without. Runs in which an output's modes cannot be separated from the rest of the spectrum have none for its
    /// components.
    fn gradients(&self, outputs: &[Output]) -> Option<Vec<Gradients>> {
        if !self.has_derivatives() {
            return None;
        }
        let samples = self.samples();
        let of_output = |output: &Output| {
            let slopes = |(i, run): (usize, &Run)| {
                let mode = |&mode: &usize| run.spectrum.mode(mode).ok();
                let lambdas: Vec<Complex<f64>> = output.modes.iter().map(mode).collect::<Option<_>>()?;
                Some((i, run.reductions.as_ref()?.differentiate(output.kind, &lambdas)?))
            };
            let found: Vec<(usize, Vec<Vec<f64>>)> = self.runs.iter().enumerate().filter_map(slopes).collect();
            gradients(&found, output.components.len(), &samples, self.study)
        };
        Some(outputs.iter().flat_map(of_output).collect())
    }
}

/// What a given run answered, or why it failed.
fn computation(run: &GivenRun) -> Result<Computation, String> {
    let answer = run.answer.as_ref().map_err(Clone::clone)?;
    let (of, slopes): (Vec<_>, Vec<_>) =
        answer.slopes.iter().map(|(k, slopes)| (answer.eigenvalues[*k], slopes.clone())).unzip();
    let reductions = Reductions::of_slopes(&of, &slopes);
    Ok(Computation { reductions, ..Computation::of_eigenvalues(answer.eigenvalues.clone()) })
}

/// The values of each component of `outputs`, by id: one value per run; or the first run without one.
pub(super) fn component_values(outputs: &[Output], runs: &[Run]) -> Result<Vec<Vec<f64>>, (usize, SpectrumError)> {
    let count = outputs.iter().map(|output| output.components.len()).sum();
    let mut components = vec![Vec::with_capacity(runs.len()); count];
    for (i, run) in runs.iter().enumerate() {
        let values = components_at(outputs, &run.spectrum).map_err(|cause| (i, cause))?;
        components.iter_mut().zip(values).for_each(|(list, value)| list.push(value));
    }
    Ok(components)
}

/// The position of the spectrum that shows why modes could not be grouped.
pub(super) fn where_shown(cause: &ClusterError) -> Option<usize> {
    match *cause {
        ClusterError::Split { at, .. } | ClusterError::NearRealAxis { at, .. } => Some(at),
        ClusterError::TooMany { .. } => None,
    }
}
