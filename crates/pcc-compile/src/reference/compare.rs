//! A surrogate against its model on the same points.

use super::direct_computations::{ReferenceError, check_problem, for_each_chunk, surrogate_block};
use crate::campaign::{Campaign, Run};
use crate::mechanics::spectrum::{SpectrumError, decompose};
use nalgebra::Complex;
use pcc_evaluate::components::{Block, Component, Output, OutputKind};
use pcc_evaluate::evaluation::Plan;
use pcc_evaluate::foundation::Observer;
use pcc_evaluate::probability::random::Purpose;
use pcc_evaluate::probability::statistics::{Moments, Proportion};
use pcc_evaluate::surrogate::Surrogate;

/// Standard deviations below this share of the mean, and both below this share of a component's scale, are rounding.
const CONSTANT: f64 = 1e-12;

/// Errors of one component, relative to the model.
#[derive(Debug, Clone, PartialEq)]
pub struct ComponentError {
    /// Name of the component.
    pub name: String,
    /// Moments from the model.
    pub model: Moments,
    /// Moments from the surrogate.
    pub surrogate: Moments,
    /// What values of the component are of the order of, if that is known; else 0.
    pub scale: f64,
}

impl ComponentError {
    /// 100 |difference of the means|/|mean of the model|; 0 if both are zero but for rounding, `None` if only the
    /// model's is zero.
    pub fn mean_error_percent(&self) -> Option<f64> {
        let is_zero = |moments: &Moments| moments.mean().abs() < CONSTANT * self.scale;
        if is_zero(&self.model) && is_zero(&self.surrogate) {
            return Some(0.0);
        }
        relative_error_percent(self.surrogate.mean(), self.model.mean())
    }

    /// 100 |difference of the variances|/variance of the model; 0 if both only vary by rounding, `None` if only the
    /// model's is zero.
    pub fn variance_error_percent(&self) -> Option<f64> {
        let rounding = CONSTANT * self.model.mean().abs().max(self.scale);
        let is_constant = |moments: &Moments| moments.variance() <= rounding * rounding;
        if is_constant(&self.model) && is_constant(&self.surrogate) {
            return Some(0.0);
        }
        relative_error_percent(self.surrogate.variance(), self.model.variance())
    }
}

/// Model and surrogate on the same points.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Number of points.
    pub samples: u64,
    /// Points at which the model is stable.
    pub stable_model: u64,
    /// Points at which the surrogate is stable.
    pub stable_surrogate: u64,
    /// Points that the surrogate calls stable and the model unstable.
    pub falsely_stable: u64,
    /// Points that the surrogate calls unstable and the model stable.
    pub falsely_unstable: u64,
    /// Every component by id.
    pub components: Vec<ComponentError>,
}

impl Comparison {
    /// The model's share of stable points.
    pub fn proportion_model(&self) -> f64 {
        Proportion { hits: self.stable_model, samples: self.samples }.value()
    }

    /// The surrogate's share of stable points.
    pub fn proportion_surrogate(&self) -> f64 {
        Proportion { hits: self.stable_surrogate, samples: self.samples }.value()
    }

    /// 100 |difference of the proportions|/proportion of the model; `None` if the model is never stable and the
    /// surrogate sometimes is.
    pub fn relative_error_percent(&self) -> Option<f64> {
        relative_error_percent(self.stable_surrogate as f64, self.stable_model as f64)
    }

    /// Share of points on whose stability the two disagree, in percent.
    pub fn misclassified_percent(&self) -> f64 {
        100.0 * (self.falsely_stable + self.falsely_unstable) as f64 / self.samples as f64
    }
}

/// 100 |found − truth|/|truth|; 0 if they are equal, `None` if only the truth is zero.
fn relative_error_percent(found: f64, truth: f64) -> Option<f64> {
    if found == truth { Some(0.0) } else { (truth != 0.0).then(|| 100.0 * ((found - truth) / truth).abs()) }
}

/// Evaluates `surrogate` and the model of `study` at samples 0 … `samples` − 1 under `seed`.
///
/// # Errors
///
/// [`ReferenceError::OtherProblem`] if the surrogate was built for another problem, else as
/// [`super::monte_carlo`].
pub fn compare_with_model<'a>(
    surrogate: &Surrogate,
    campaign: impl Into<Campaign<'a>>,
    samples: u64,
    seed: u64,
    observer: &dyn Observer,
) -> Result<Comparison, ReferenceError> {
    let campaign = campaign.into();
    let study = campaign.study;
    check_problem(surrogate, study)?;
    let plan = Plan::new(surrogate);
    let mut comparison = Comparison::new(samples);
    for_each_chunk(campaign, samples, seed, Purpose::Evaluation, observer, |runner, points, runs| {
        let mut modes = surrogate.modes();
        modes.sort_unstable();
        if modes != runner.modes() {
            return Err(ReferenceError::other_problem(surrogate, study));
        }
        let block = surrogate_block(surrogate, &plan, points)?;
        comparison.classify(runs.iter().map(|run| run.spectrum.max_re()), &block);
        let at_point = |position: usize, i: usize| runs[i].eigenvalues[position];
        let mut errors = mode_errors(runner.modes(), surrogate, runs.len(), at_point, &block);
        let describe = |i: usize| study.inputs.describe(&study.inputs.physical(&points[i]));
        errors.extend(
            invariant_errors(surrogate, runs, &block)
                .map_err(|(i, cause)| ReferenceError::Spectrum { point: describe(i), cause })?,
        );
        comparison.merge(errors);
        Ok(())
    })?;
    Ok(comparison)
}

impl Comparison {
    /// Nothing compared yet, of so many points.
    pub(super) fn new(samples: u64) -> Self {
        Self {
            samples,
            stable_model: 0,
            stable_surrogate: 0,
            falsely_stable: 0,
            falsely_unstable: 0,
            components: Vec::new(),
        }
    }

    /// Counts on whose stability model, with this max Re λ at each point, and surrogate disagree.
    pub(super) fn classify(&mut self, max_re: impl Iterator<Item = f64>, block: &Block) {
        for (model, &found) in max_re.zip(&block.max_re) {
            let (model, found) = (model < 0.0, found < 0.0);
            self.stable_model += u64::from(model);
            self.stable_surrogate += u64::from(found);
            self.falsely_stable += u64::from(found && !model);
            self.falsely_unstable += u64::from(model && !found);
        }
    }

    pub(super) fn merge(&mut self, errors: Vec<ComponentError>) {
        if self.components.is_empty() {
            self.components = errors;
            return;
        }
        for (own, added) in self.components.iter_mut().zip(errors) {
            own.model.merge(&added.model);
            own.surrogate.merge(&added.surrogate);
        }
    }
}

/// Real or imaginary part.
type Part = fn(&Complex<f64>) -> f64;

/// Re λ and Im λ of every mode at so many points; `lambda(position, i)` is the model's eigenvalue of the mode at this
/// position of `modes`, at point i.
pub(super) fn mode_errors(
    modes: &[usize],
    surrogate: &Surrogate,
    points: usize,
    lambda: impl Fn(usize, usize) -> Complex<f64>,
    block: &Block,
) -> Vec<ComponentError> {
    let parts: [(&str, Part); 2] = [("re", |lambda| lambda.re), ("im", |lambda| lambda.im)];
    let order = surrogate.modes();
    let mut errors = Vec::with_capacity(2 * modes.len());
    for (at, mode) in modes.iter().enumerate() {
        let Some(position) = order.iter().position(|other| other == mode) else { continue };
        for (name, part) in parts {
            let model: Vec<f64> = (0..points).map(|i| part(&lambda(at, i))).collect();
            let found: Vec<f64> = block.eigenvalues[position].iter().map(part).collect();
            errors.push(ComponentError {
                name: format!("{name}_{mode}"),
                model: Moments::of(&model),
                surrogate: Moments::of(&found),
                scale: 0.0,
            });
        }
    }
    errors
}

/// The components of clusters, which are no eigenvalues themselves.
fn invariant_errors(
    surrogate: &Surrogate,
    runs: &[Run],
    block: &Block,
) -> Result<Vec<ComponentError>, (usize, SpectrumError)> {
    let clusters: Vec<&Output> = surrogate.outputs.iter().filter(|output| output.kind == OutputKind::Cluster).collect();
    let mut values = vec![Vec::with_capacity(runs.len()); surrogate.component_count()];
    let mut at_run = vec![0.0; surrogate.component_count()];
    for (i, run) in runs.iter().enumerate() {
        for output in &clusters {
            decompose(output, &run.spectrum, &mut at_run).map_err(|cause| (i, cause))?;
        }
        values.iter_mut().zip(&at_run).for_each(|(list, &value)| list.push(value));
    }
    let error = |component: &&Component| ComponentError {
        name: component.name.clone(),
        model: Moments::of(&values[component.id]),
        surrogate: Moments::of(&block.components[component.id]),
        scale: component.scale,
    };
    let components: Vec<&Component> = clusters.iter().flat_map(|output| &output.components).collect();
    Ok(components.iter().map(error).collect())
}
