//! Builds by quadrature: full expansions on one element (gPC) or on several (multi-element gPC), each with a tensor
//! Gauss rule of its own.
//!
//! Elements are divided one by one, as [`crate::fitting::fit::multi_element`] says, until none needs it, or the study's
//! number of elements or of model runs would be exceeded. The runs of a divided element are spent: they count, but its
//! parts have nodes of their own. Modes are grouped by the spectra at the nodes of all elements; if new nodes change
//! the groups, all elements are projected anew from the runs at hand, and divided further if the new components ask for
//! it, until the groups stay.

use super::evaluations::groups;
use super::{BuildError, Built, decision, record};
use crate::campaign::{Campaign, Run, RunError, Runner};
use crate::fitting::design::{Samples, TensorGauss};
use crate::fitting::fit::gpc::{Projection, project, total_degree};
use crate::fitting::fit::multi_element::{Division, EQUAL, MultiElement, division};
use crate::fitting::fit::{FitMethod, Fitted};
use crate::fitting::regression::ErrorMeasures;
use crate::mechanics::model::Model;
use crate::mechanics::spectrum::Spectrum;
use crate::study::Study;
use pcc_evaluate::components::Output;
use pcc_evaluate::foundation::Observer;
use pcc_evaluate::polynomials::{IndexSet, Mesh, MultiIndex, Recurrence};
use pcc_evaluate::surrogate::{Counts, StopReason, TrainedDomain};

/// Nodes whose coordinates are held in memory together.
const BLOCK: usize = 4096;

/// Builds the surrogate of a study whose method is a quadrature.
pub(super) fn build(
    campaign: Campaign<'_>,
    model: Box<dyn Model>,
    observer: &dyn Observer,
) -> Result<Built, BuildError> {
    let mut elements = Elements::new(campaign.study, Runner::of(campaign, model), observer)?;
    elements.run(0)?;
    elements.levels.push(elements.spent);
    loop {
        elements.project_all()?;
        elements.divide()?;
        // With the spectra of new nodes other modes may come close.
        let outputs = elements.outputs_of_all()?;
        let is_settled = groups(&outputs) == groups(&elements.outputs);
        elements.outputs = outputs;
        if is_settled {
            return elements.into_surrogate();
        }
    }
}

/// A mesh with the answers of the model at the nodes of every element, and the projections of all components on it.
struct Elements<'a> {
    study: &'a Study,
    runner: Runner<'a>,
    observer: &'a dyn Observer,
    grid: TensorGauss,
    recurrences: Vec<Recurrence>,
    indices: IndexSet,
    mesh: Mesh,
    /// Per element, one run per node.
    runs: Vec<Vec<Run>>,
    outputs: Vec<Output>,
    /// Per element, one per component.
    projections: Vec<Vec<Projection>>,
    divisions: Vec<Division>,
    /// All model runs so far.
    spent: u64,
    /// The same after the first element and after each division.
    levels: Vec<u64>,
}

impl<'a> Elements<'a> {
    fn new(study: &'a Study, runner: Runner<'a>, observer: &'a dyn Observer) -> Result<Self, BuildError> {
        let degree = study.fit.method.max_degree();
        let nodes = usize::from(degree) + 1;
        let inputs = study.inputs.inputs();
        let recurrences: Vec<_> = inputs.iter().map(|input| input.marginal.family().recurrence(nodes)).collect();
        Ok(Self {
            study,
            runner,
            observer,
            grid: TensorGauss::new(&recurrences, nodes),
            recurrences,
            indices: total_degree(inputs.len(), degree)?,
            mesh: Mesh::whole(inputs.len()),
            runs: vec![Vec::new()],
            outputs: Vec::new(),
            projections: vec![Vec::new()],
            divisions: vec![Division { urgency: 0.0, inputs: Vec::new() }],
            spent: 0,
            levels: Vec::new(),
        })
    }

    /// Runs the model at the nodes of an element.
    fn run(&mut self, element: usize) -> Result<(), BuildError> {
        let space = &self.mesh.elements()[element];
        let count = self.grid.len();
        let mut runs = Vec::with_capacity(count);
        self.observer.begin("model runs", count as u64);
        for start in (0..count).step_by(BLOCK) {
            let nodes = self.grid.nodes(start..count.min(start + BLOCK));
            let physical = |local: &[f64]| self.study.inputs.physical(&space.standardized(local));
            let points: Vec<Vec<f64>> = nodes.points().map(physical).collect();
            runs.extend(self.runner.run(&points, self.observer)?);
        }
        self.observer.finish();
        self.runs[element] = runs;
        self.spent += count as u64;
        Ok(())
    }

    /// Groups modes by all spectra and projects the components on every element.
    fn project_all(&mut self) -> Result<(), BuildError> {
        self.outputs = self.outputs_of_all()?;
        (0..self.runs.len()).try_for_each(|element| self.project(element))
    }

    fn outputs_of_all(&self) -> Result<Vec<Output>, BuildError> {
        let spectra: Vec<Spectrum> = self.runs.iter().flatten().map(|run| run.spectrum.clone()).collect();
        self.study.spectrum.target.outputs(self.runner.modes(), &spectra).map_err(|cause| {
            let point = super::evaluations::where_shown(&cause).map(|at| self.physical_node(at)).unwrap_or_default();
            BuildError::Clusters { point: self.study.inputs.describe(&point), cause }
        })
    }

    /// The node with this number, counted through all elements.
    fn physical_node(&self, number: usize) -> Vec<f64> {
        let (element, node) = (number / self.grid.len(), number % self.grid.len());
        let local = self.grid.nodes(node..node + 1);
        self.study.inputs.physical(&self.mesh.elements()[element].standardized(local.point(0)))
    }

    fn project(&mut self, element: usize) -> Result<(), BuildError> {
        let values = self.values(element)?;
        let of_output = |output: &Output| super::group_fits::resolutions(output, &self.runs[element]);
        let resolutions: Vec<f64> = self.outputs.iter().flat_map(of_output).collect();
        let projections = project(&self.grid, &self.recurrences, &self.indices, &values, &resolutions, self.observer)?;
        if let FitMethod::MultiElement(settings) = &self.study.fit.method {
            let weight = self.mesh.elements()[element].weight;
            self.divisions[element] = division(&projections, &self.indices, settings, weight);
        }
        self.projections[element] = projections;
        Ok(())
    }

    /// The values of all components by id at the nodes of an element.
    fn values(&self, element: usize) -> Result<Vec<Vec<f64>>, BuildError> {
        let at = |i: usize| self.physical_node(element * self.grid.len() + i);
        let found = super::evaluations::component_values(&self.outputs, &self.runs[element]);
        found.map_err(|(i, cause)| RunError::Spectrum { point: self.study.inputs.describe(&at(i)), cause }.into())
    }

    /// Divides elements until none needs it or the study's limits are reached.
    fn divide(&mut self) -> Result<(), BuildError> {
        let FitMethod::MultiElement(settings) = &self.study.fit.method else { return Ok(()) };
        while let Some((element, inputs)) = self.next_division(settings) {
            for part in self.mesh.halve(element, &inputs) {
                if part == self.runs.len() {
                    self.runs.push(Vec::new());
                    self.projections.push(Vec::new());
                    self.divisions.push(Division { urgency: 0.0, inputs: Vec::new() });
                }
                self.run(part)?;
                self.project(part)?;
            }
            self.levels.push(self.spent);
        }
        Ok(())
    }

    /// The inputs along which an element asks to be halved and can be.
    fn divisible_inputs(&self, element: usize) -> impl Iterator<Item = usize> {
        self.divisions[element].inputs.iter().copied().filter(move |&input| self.mesh.can_halve(element, input))
    }

    /// Whether an element is to be divided. What decays completely asks for nothing, even if θ₁ is zero.
    fn asks(&self, element: usize, settings: &MultiElement) -> bool {
        let urgency = self.divisions[element].urgency;
        urgency > 0.0 && urgency >= settings.theta_1 && self.divisible_inputs(element).next().is_some()
    }

    /// The element that needs it most, and the inputs along which the limits leave room for halves.
    fn next_division(&self, settings: &MultiElement) -> Option<(usize, Vec<usize>)> {
        let runs_left = (self.study.design.maximum as u64).saturating_sub(self.spent) / self.grid.len() as u64;
        let room = settings.elements - self.runs.len();
        let urgency = |element: usize| self.divisions[element].urgency;
        let candidates = (0..self.divisions.len()).filter(|&element| self.asks(element, settings));
        let element =
            candidates.reduce(|most, next| if urgency(next) > (1.0 + EQUAL) * urgency(most) { next } else { most })?;
        let mut inputs: Vec<usize> = self.divisible_inputs(element).collect();
        let fits = |along: usize| {
            let parts = 1u64.checked_shl(along as u32).unwrap_or(u64::MAX);
            parts - 1 <= room as u64 && parts <= runs_left
        };
        while !inputs.is_empty() && !fits(inputs.len()) {
            inputs.pop();
        }
        (!inputs.is_empty()).then_some((element, inputs))
    }

    /// The box of the nodes. Variables without bounds have one element, and grids their outermost nodes at both ends.
    fn trained_domain(&self) -> Option<TrainedDomain> {
        let last = self.grid.len() - 1;
        let ends = [0..1, last..last + 1].map(|numbers| self.grid.nodes(numbers));
        TrainedDomain::of(&self.study.inputs, ends.iter().flat_map(Samples::points))
    }

    fn into_surrogate(self) -> Result<Built, BuildError> {
        let node_weights: Vec<f64> = self.grid.weights(0..self.grid.len()).collect();
        let weights: Vec<f64> = self
            .mesh
            .elements()
            .iter()
            .flat_map(|element| node_weights.iter().map(|weight| weight * element.weight))
            .collect();
        let mut values = vec![Vec::with_capacity(weights.len()); self.projections[0].len()];
        for element in 0..self.runs.len() {
            values.iter_mut().zip(self.values(element)?).for_each(|(all, part)| all.extend(part));
        }
        let of_output = |output: &Output| super::group_fits::resolutions(output, self.runs.iter().flatten());
        let resolutions = self.outputs.iter().flat_map(of_output);
        // Zero for components that do not vary over all elements.
        let variance = |(values, resolution): (&Vec<f64>, f64)| {
            Some(weighted_variance(values, &weights))
                .filter(|variance| *variance > resolution * resolution)
                .unwrap_or(0.0)
        };
        let variances: Vec<f64> = values.iter().zip(resolutions).map(variance).collect();
        let is_done = self.is_done();
        let fitted: Vec<Vec<Fitted>> = self
            .projections
            .iter()
            .map(|parts| parts.iter().zip(&variances).map(|(part, &v)| self.fitted(part, v, is_done)).collect())
            .collect();
        let final_mesh = weights.len() as u64;
        let counts =
            Counts { values: final_mesh, gradients: 0, failed: 0, final_mesh, direct_computations: self.spent };
        let trained_domain = self.trained_domain();
        let mut surrogate =
            record::of_elements(self.study, self.mesh, self.outputs, &fitted, counts, self.levels.clone());
        surrogate.trained_domain = trained_domain;
        let runs: Vec<Run> = self.runs.into_iter().flatten().collect();
        let judgement = decision::judge_by_nodes(&surrogate, &values, &runs, &weights);
        record::judged(&mut surrogate, &judgement, &runs);
        surrogate.self_test = surrogate.make_self_test(record::self_test_points(self.study));
        let rigid_body_modes = super::rigid_body_modes(&runs);
        Ok(Built { surrogate, rigid_body_modes, given: None })
    }

    /// Whether no element asks to be divided any more.
    fn is_done(&self) -> bool {
        match &self.study.fit.method {
            FitMethod::MultiElement(settings) => !(0..self.runs.len()).any(|element| self.asks(element, settings)),
            _ => false,
        }
    }

    /// Errors are relative to the variance over all elements.
    fn fitted(&self, projection: &Projection, variance: f64, is_done: bool) -> Fitted {
        // Inside an element a component can be constant that varies from one to the next.
        let varies = variance > 0.0;
        let (indices, coefficients, degree) = if varies && projection.variance > 0.0 {
            (self.indices.clone(), projection.coefficients.clone(), self.study.fit.method.max_degree())
        } else {
            let constant = MultiIndex::constant(self.study.inputs.dimension());
            (IndexSet::from_unsorted(vec![constant]), projection.coefficients[..1].to_vec(), 0)
        };
        let r2 = 1.0 - projection.mean_square_residual / variance;
        Fitted {
            indices,
            coefficients,
            errors: varies.then_some(ErrorMeasures { r2, s2: None, corrected_s2: None }),
            leave_one_out_residuals: None,
            blind_residuals: None,
            derivative_weight: None,
            degree,
            stop: match (varies, &self.study.fit.method) {
                (false, _) => StopReason::Constant,
                (true, FitMethod::MultiElement(_)) if is_done => StopReason::Settled,
                (true, FitMethod::MultiElement(_)) => StopReason::Limited,
                (true, _) => StopReason::GivenDegree,
            },
        }
    }
}

/// Σ w_i (y_i − Σ w_k y_k)².
fn weighted_variance(values: &[f64], weights: &[f64]) -> f64 {
    let mean: f64 = values.iter().zip(weights).map(|(value, weight)| weight * value).sum();
    values.iter().zip(weights).map(|(value, weight)| weight * (value - mean).powi(2)).sum()
}
