//! A surrogate against its model on the same points.

use super::direct_computations::{ReferenceError, check_problem, for_each_chunk, surrogate_block};
use super::matching::{Matching, by_output};
use super::verdicts::{Judged, Verdicts};
use crate::campaign::Campaign;
use crate::mechanics::spectrum::{Spectrum, components_of};
use nalgebra::Complex;
use pcc_evaluate::components::{Block, Component, Label, Output, OutputKind, Verdict};
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
    /// What each says of stability.
    pub verdicts: Verdicts,
    /// Number of eigenvalues of the model that are rigid-body motion.
    pub rigid_body_modes: usize,
    /// Every component by id.
    pub components: Vec<ComponentError>,
}

impl Comparison {
    /// The model's share of stable points.
    pub fn proportion_model(&self) -> f64 {
        self.share(self.verdicts.model(0))
    }

    /// The surrogate's share of stable points.
    pub fn proportion_surrogate(&self) -> f64 {
        self.share(self.verdicts.surrogate(0))
    }

    /// The shares of marginal points, by the model and by the surrogate.
    pub fn marginal(&self) -> [f64; 2] {
        [self.verdicts.model(1), self.verdicts.surrogate(1)].map(|hits| self.share(hits))
    }

    /// The shares of unstable points, by the model and by the surrogate.
    pub fn unstable(&self) -> [f64; 2] {
        [self.verdicts.model(2), self.verdicts.surrogate(2)].map(|hits| self.share(hits))
    }

    /// The shares of points with a verdict, by the model and by the surrogate.
    pub fn shares_of(&self, verdict: Verdict) -> [f64; 2] {
        self.verdicts.of(verdict).map(|hits| self.share(hits))
    }

    fn share(&self, hits: u64) -> f64 {
        Proportion { hits, samples: self.samples - self.verdicts.failed() }.value()
    }

    /// 100 |difference of the proportions|/proportion of the model, where points at which the model failed are as far
    /// off as they can be; `None` if the model is never stable and the surrogate sometimes is.
    pub fn relative_error_percent(&self) -> Option<f64> {
        self.relative_error_of(0)
    }

    /// The same of unstable points.
    pub fn relative_error_of_unstable_percent(&self) -> Option<f64> {
        self.relative_error_of(2)
    }

    /// The same of points with a verdict.
    pub fn relative_error_of_verdict_percent(&self, verdict: Verdict) -> Option<f64> {
        self.relative_error(self.verdicts.of(verdict))
    }

    fn relative_error_of(&self, class: usize) -> Option<f64> {
        self.relative_error([self.verdicts.model(class), self.verdicts.surrogate(class)])
    }

    fn relative_error(&self, [truth, found]: [u64; 2]) -> Option<f64> {
        let off = found.abs_diff(truth) + self.verdicts.failed();
        relative_error_percent((truth + off) as f64, truth as f64)
    }

    /// Points that the surrogate calls stable and the model does not.
    pub fn falsely_stable(&self) -> u64 {
        self.verdicts.of_stable().falsely_claimed
    }

    /// Points that the surrogate calls marginal and the model does not.
    pub fn falsely_marginal(&self) -> u64 {
        self.verdicts.of_marginal().falsely_claimed
    }

    /// Points that the surrogate calls unstable and the model does not.
    pub fn falsely_unstable(&self) -> u64 {
        self.verdicts.of_unstable().falsely_claimed
    }

    /// Share of points on whose stability the two disagree, or the model failed, in percent.
    pub fn misclassified_percent(&self) -> f64 {
        let judged = self.falsely_stable() + self.falsely_marginal() + self.falsely_unstable();
        let all = judged + self.verdicts.failed();
        100.0 * all as f64 / self.samples as f64
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
    let matching = Matching::new(surrogate, study.spectrum.target);
    for_each_chunk(campaign, samples, seed, Purpose::Evaluation, observer, |points, runs, failed| {
        comparison.verdicts.count_failures(&surrogate_block(surrogate, &plan, failed)?);
        if runs.is_empty() {
            return Ok(());
        }
        let block = surrogate_block(surrogate, &plan, points)?;
        comparison.classify(runs.iter().map(|run| Judged::of(&run.spectrum)), &block);
        comparison.rigid_body_modes = runs.first().map_or(0, |run| run.spectrum.rigid_body_modes());
        let spectra: Vec<&Spectrum> = runs.iter().map(|run| &run.spectrum).collect();
        comparison.merge(errors(surrogate, &matching, &spectra, &block));
        Ok(())
    })?;
    Ok(comparison)
}

impl Comparison {
    /// Nothing compared yet, of so many points.
    pub(super) fn new(samples: u64) -> Self {
        Self { samples, verdicts: Verdicts::default(), rigid_body_modes: 0, components: Vec::new() }
    }

    /// Points at which the model has as many eigenvalues as the surrogate: errors of components are over these.
    pub fn matched_points(&self) -> u64 {
        self.components.first().map_or(0, |component| component.model.count())
    }

    /// Counts on whose stability model and surrogate disagree.
    pub(super) fn classify(&mut self, model: impl Iterator<Item = Judged>, block: &Block) {
        self.verdicts.classify(model, block);
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

/// Errors of every mode and real eigenvalue, in the order of their numbers, then of the components of groups, at the
/// points where the model has as many eigenvalues as the surrogate.
pub(super) fn errors(
    surrogate: &Surrogate,
    matching: &Matching,
    spectra: &[&Spectrum],
    block: &Block,
) -> Vec<ComponentError> {
    let matched = matched(matching, spectra, block);
    let mut errors = errors_of_labels(surrogate, &matched, block);
    errors.extend(invariant_errors(surrogate, &matched, block));
    errors
}

/// The model's eigenvalues by label, with the numbers of the points at which it has enough.
type Matched = Vec<(usize, Vec<Complex<f64>>)>;

fn matched(matching: &Matching, spectra: &[&Spectrum], block: &Block) -> Matched {
    let predicted = |i: usize| -> Vec<Complex<f64>> { block.eigenvalues.iter().map(|list| list[i]).collect() };
    let found = |(i, spectrum): (usize, &&Spectrum)| Some((i, matching.find(&predicted(i), spectrum)?));
    spectra.iter().enumerate().filter_map(found).collect()
}

/// Errors of every mode and real eigenvalue alone.
pub(super) fn eigenvalue_errors(
    surrogate: &Surrogate,
    matching: &Matching,
    spectra: &[&Spectrum],
    block: &Block,
) -> Vec<ComponentError> {
    errors_of_labels(surrogate, &matched(matching, spectra, block), block)
}

/// Re λ and Im λ of every mode, then the real eigenvalues.
fn errors_of_labels(
    surrogate: &Surrogate,
    matched: &[(usize, Vec<Complex<f64>>)],
    block: &Block,
) -> Vec<ComponentError> {
    let mut labels: Vec<(usize, Label)> = surrogate.labels().into_iter().enumerate().collect();
    labels.sort_by_key(|(_, label)| label.column());
    let of_label = |(position, label): (usize, Label)| {
        let error = |name: String, part: Part| ComponentError {
            name,
            model: Moments::of(&matched.iter().map(|(_, lambdas)| part(&lambdas[position])).collect::<Vec<_>>()),
            surrogate: Moments::of(
                &matched.iter().map(|(i, _)| part(&block.eigenvalues[position][*i])).collect::<Vec<_>>(),
            ),
            // Growth rates of undamped modes are rounding beside their frequencies.
            scale: matched.iter().map(|(_, lambdas)| lambdas[position].norm()).fold(0.0, f64::max),
        };
        let growth_rate = error(label.growth_rate(), |lambda| lambda.re);
        match label {
            Label::Mode(mode) => vec![growth_rate, error(format!("im_{mode}"), |lambda| lambda.im)],
            Label::Second(_) | Label::Real(_) => vec![growth_rate],
        }
    };
    labels.into_iter().flat_map(of_label).collect()
}

/// The components of groups, which are no eigenvalues themselves.
fn invariant_errors(
    surrogate: &Surrogate,
    matched: &[(usize, Vec<Complex<f64>>)],
    block: &Block,
) -> Vec<ComponentError> {
    let is_own_eigenvalue = |output: &Output| output.components.len() == 1 || output.kind == OutputKind::Eigenvalue;
    let mut values: Vec<Vec<f64>> = vec![Vec::with_capacity(matched.len()); surrogate.component_count()];
    for (_, lambdas) in matched {
        for (output, (kind, own)) in surrogate.outputs.iter().zip(by_output(surrogate, lambdas)) {
            let components = components_of(kind, own);
            // Eigenvalues that are not closed under conjugation have fewer factors.
            for (k, component) in output.components.iter().enumerate() {
                values[component.id].push(components.get(k).copied().unwrap_or(f64::NAN));
            }
        }
    }
    let error = |component: &Component| {
        let both: (Vec<f64>, Vec<f64>) = values[component.id]
            .iter()
            .zip(matched)
            .filter(|(value, _)| value.is_finite())
            .map(|(&value, (i, _))| (value, block.components[component.id][*i]))
            .unzip();
        ComponentError {
            name: component.name.clone(),
            model: Moments::of(&both.0),
            surrogate: Moments::of(&both.1),
            scale: component.scale,
        }
    };
    let groups = surrogate.outputs.iter().filter(|output| !is_own_eigenvalue(output));
    groups.flat_map(|output| &output.components).map(error).collect()
}
