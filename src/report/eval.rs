//! The answer of `eval` and `reference`: stability and what engineers read of each mode.

use super::confidence::Confidence;
use super::coverage::Bounds;
use super::dependence::DependenceReport;
use super::extrapolation;
use super::fit::FitReport;
use super::judgement::{MarginReport, judged_by, outside_band, rigid_body_modes, with_margin};
use super::sensitivity::{CriticalReport, SensitivityReport};
use super::shapley::ShapleyReport;
use super::sight::Sight;
use super::smallest_share::SmallestShare;
use super::survey::{EventReport, HistogramReport, LEVEL, QuantilesReport, events, histograms};
use pcc_compile::reference::Reference;
use pcc_evaluate::components::{EigenvalueSummary, Label, Margin, Output, Summary};
use pcc_evaluate::evaluation::{Condition, Question, Sampler};
use pcc_evaluate::foundation::count;
use pcc_evaluate::probability::inputs::{Input, InputSpace};
use pcc_evaluate::probability::statistics::{Interval, Moments, Proportion, Share};
use pcc_evaluate::session::Evaluation;
use pcc_evaluate::surrogate::{Quantile, Surrogate};
use serde::Serialize;
use std::f64::consts::TAU;

/// Statistics over samples, from a surrogate or from the model itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EvalReport {
    /// The answer in a sentence.
    pub verdict: String,
    /// Name of the study.
    pub study: String,
    /// Whether model or surrogate was sampled.
    pub source: &'static str,
    /// Number of samples.
    pub samples: u64,
    /// Number of samples that were asked for.
    pub requested_samples: u64,
    /// Whether these are all samples, and all else that was asked for; false after an interruption.
    pub complete: bool,
    /// Seed of the samples.
    pub seed: u64,
    /// How samples are drawn.
    pub sampler: &'static str,
    /// Independent randomisations that the samples are divided among; those that are complete.
    pub replicates: u32,
    /// Inputs that are confined or fixed.
    pub conditions: Vec<Condition>,
    /// How inputs depend on each other; absent if they do not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dependence: Option<DependenceReport>,
    /// Number of stable samples: the largest Re λ, with the margin, is negative.
    pub stable_samples: u64,
    /// Their share.
    pub stable_proportion: f64,
    /// Share of marginal samples: they are neither stable nor unstable as far as can be told.
    pub marginal_proportion: f64,
    /// Share of unstable samples.
    pub unstable_proportion: f64,
    /// Share of samples that are unstable and whose eigenvalue with the largest Re λ oscillates.
    pub flutter_proportion: f64,
    /// Share of samples that are unstable and whose eigenvalue with the largest Re λ is real.
    pub divergence_proportion: f64,
    /// Intervals of these shares: what the finite number of samples leaves open.
    pub intervals: Intervals,
    /// What stability is judged by.
    pub judged_by: String,
    /// Whether no mode decays but what grows elsewhere.
    pub undamped: bool,
    /// Number of eigenvalues that are rigid-body motion; null if the file does not say.
    pub rigid_body_modes: Option<usize>,
    /// How far eigenvalues must stay from instability; null if only the sign of Re λ counts.
    pub margin: Option<MarginReport>,
    /// The band of frequencies that chose the modes, and what lies outside; null if it was none.
    pub band: Option<String>,
    /// Standard error of the share: from the spread of replicates, or of independent samples.
    pub standard_error: f64,
    /// How sure that is.
    #[serde(flatten)]
    pub confidence: Confidence,
    /// The smaller of the stable and the unstable share as the build has judged it; null if that is unknown, for a part
    /// of the domain, and for a model.
    pub smallest_share: Option<SmallestShare>,
    /// Share of samples where the model did not answer, as far as its runs tell; absent if it answered everywhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unanswered_proportion: Option<f64>,
    /// Between what the shares lie, whatever it would have answered there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<Bounds>,
    /// Share of samples beyond all model runs in at least one input; absent if runs fill the laws of all inputs, if the
    /// file does not say, and for a model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extrapolated_proportion: Option<f64>,
    /// Between what the shares lie, whatever the model would say there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extrapolated_bounds: Option<Bounds>,
    /// Spectral abscissa max Re λ, in 1/s.
    pub max_re: Statistics,
    /// What engineers read, per mode.
    pub modes: Vec<ModeReport>,
    /// Real eigenvalues that belong to no mode.
    pub real_eigenvalues: Vec<RealReport>,
    /// Every component.
    pub components: Vec<ComponentReport>,
    /// Sobol' indices of what decides stability; absent for a model, and where inputs depend on each other.
    pub sensitivity: Option<SensitivityReport>,
    /// Shapley effects on what decides stability, where inputs depend on each other; absent elsewhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shapley: Option<ShapleyReport>,
    /// The critical value of an input, if asked for.
    pub critical: Option<CriticalReport>,
    /// Other events that were counted.
    pub events: Vec<EventReport>,
    /// Histograms that were asked for.
    pub histograms: Vec<HistogramReport>,
    /// Quantiles, if asked for.
    pub quantiles: Vec<QuantilesReport>,
    /// What to know before trusting a surrogate.
    pub warnings: Vec<String>,
    /// Quantiles of max Re λ of the model minus its leave-one-out prediction, in 1/s, from the file; empty for a model.
    pub max_re_residuals: Vec<QuantileReport>,
    /// Wall-clock time.
    pub elapsed_seconds: f64,
    /// What the text says besides.
    #[serde(skip)]
    pub only_in_text: OnlyInText,
}

/// What the text of an evaluation says, and its JSON does not.
#[derive(Debug, Clone, PartialEq)]
pub struct OnlyInText {
    /// Whether all samples are there, so that it is something else that is missing.
    pub has_all_samples: bool,
    /// How many parts were put together.
    pub merged_parts: Option<usize>,
    /// Randomisations that were asked for.
    pub requested_replicates: u32,
    /// The inputs of a surrogate, for units of conditions.
    pub inputs: Vec<Input>,
    /// What is known of it where an estimate is not.
    pub(super) sight: Option<Sight>,
}

/// Moments and range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Statistics {
    /// Mean.
    pub mean: f64,
    /// Unbiased variance.
    pub variance: f64,
    /// Smallest sample.
    pub minimum: f64,
    /// Largest sample.
    pub maximum: f64,
}

/// Intervals of shares.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Intervals {
    /// Of stable samples.
    pub stable: Interval,
    /// Of marginal ones.
    pub marginal: Interval,
    /// Of unstable ones.
    pub unstable: Interval,
    /// Of those that flutter.
    pub flutter: Interval,
    /// Of those that diverge.
    pub divergence: Interval,
}

/// One mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ModeReport {
    /// Its number, from 1.
    pub mode: usize,
    /// Im λ/2π, in Hz.
    pub frequency_hz: Statistics,
    /// The same of the samples in which this mode oscillates and is unstable; null if there are none.
    pub flutter_frequency_hz: Option<Statistics>,
    /// Re λ, in 1/s.
    pub growth_rate: Statistics,
    /// −Re λ/|λ|.
    pub damping_ratio: Statistics,
    /// Share of samples in which this mode is unstable.
    pub unstable_share: f64,
    /// Share of samples in which it is marginal.
    pub marginal_share: f64,
    /// Share of samples in which it oscillates.
    pub oscillating_share: f64,
    /// Share of samples in which its two eigenvalues are real and it does not diverge.
    pub overdamped_share: f64,
    /// Share of samples in which it oscillates and is unstable.
    pub flutter_share: f64,
    /// Share of samples in which it is real and unstable.
    pub divergence_share: f64,
}

/// A real eigenvalue that belongs to no mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RealReport {
    /// Its name.
    pub name: String,
    /// λ, in 1/s.
    pub growth_rate: Statistics,
    /// Share of samples in which it is unstable.
    pub divergence_share: f64,
}

/// One component.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ComponentReport {
    /// Name.
    pub name: String,
    /// Statistics of the samples.
    #[serde(flatten)]
    pub samples: Statistics,
    /// The same moments exactly, and Sobol' indices; absent for a model, and where inputs depend on each other.
    #[serde(flatten)]
    pub analysis: Option<Analysis>,
}

/// What follows from the coefficients without sampling.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Analysis {
    /// Mean from the coefficients.
    pub mean_from_coefficients: f64,
    /// Variance from the coefficients.
    pub variance_from_coefficients: f64,
    /// Sobol' indices per input; empty if the component does not vary.
    pub sobol: Vec<SobolReport>,
}

/// Sobol' indices of one input.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SobolReport {
    /// Name of the input.
    pub input: String,
    /// First order.
    pub first: f64,
    /// Total.
    pub total: f64,
}

/// A quantile of residuals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct QuantileReport {
    /// Probability to be undercut.
    pub level: f64,
    /// Its value.
    pub value: f64,
}

impl EvalReport {
    /// The report of a surrogate's samples; `None` if there are none.
    pub fn of_surrogate(found: &Evaluation<'_>) -> Option<Self> {
        let Evaluation { surrogate, question, answer, elapsed_seconds, .. } = found;
        let cell = answer.cells.first()?;
        let (name, summary) = (&surrogate.provenance.study_name, &cell.total.summary);
        let mut report = Self::new(name, "surrogate", &surrogate.outputs, summary, question.seed, *elapsed_seconds);
        let is_whole = question.conditions.is_empty();
        if is_whole && surrogate.inputs.dependence().is_none() {
            for (component, analysis) in report.components.iter_mut().zip(analyses(surrogate)) {
                component.analysis = Some(analysis);
            }
        }
        let (stable, share) = (summary.stable_proportion(), cell.share(LEVEL, |tally| tally.summary.stable));
        report.complete = found.is_complete;
        report.judged_by = judged_by(surrogate);
        report.undamped = surrogate.is_undamped();
        report.rigid_body_modes = rigid_body_modes(surrogate);
        report.margin = MarginReport::of(surrogate.verdict.margin);
        report.band = outside_band(surrogate);
        report.sampler = question.sampler.name();
        report.requested_samples = question.samples;
        report.replicates = cell.replicates.len().max(1) as u32;
        report.only_in_text = OnlyInText {
            has_all_samples: answer.is_complete,
            merged_parts: found.merged_parts,
            requested_replicates: question.replicates,
            inputs: surrogate.inputs.inputs().to_vec(),
            sight: Sight::of(surrogate),
        };
        report.conditions = question.conditions.clone();
        report.dependence = DependenceReport::of(&surrogate.inputs);
        report.standard_error = share.standard_error;
        let interval = |hits: fn(&Summary) -> u64| cell.share(LEVEL, |tally| hits(&tally.summary)).interval;
        report.intervals = Intervals {
            stable: share.interval,
            marginal: interval(Summary::marginal),
            unstable: interval(|summary| summary.unstable),
            flutter: interval(Summary::fluttering),
            divergence: interval(|summary| summary.divergent),
        };
        let not_unstable = 1.0 - report.unstable_proportion;
        report.confidence =
            Confidence::new(surrogate, (stable, not_unstable), summary.stable_if_shifted, share.interval);
        report.confidence.basis.replicates = cell.replicates.len().max(1) as u64;
        match is_whole {
            true => report.smallest_share = SmallestShare::of(surrogate),
            false => report.confidence.confine(),
        }
        let free = |name: &&str| !question.conditions.iter().any(|c| c.input == *name && c.lower == c.upper);
        report.sensitivity = found.sensitivities.as_ref().map(|indices| {
            let mut sensitivity = SensitivityReport::new(surrogate.inputs.names(), indices);
            sensitivity.inputs.retain(|input| free(&input.input.as_str()));
            sensitivity
        });
        report.shapley = found.effects.as_ref().map(|effects| {
            let mut shapley = ShapleyReport::new(surrogate.inputs.names(), effects);
            shapley.inputs.retain(|input| free(&input.input.as_str()));
            shapley
        });
        let inputs = surrogate.inputs.inputs();
        report.critical = found.critical.as_ref().map(|(input, values)| CriticalReport::new(&inputs[*input], values));
        report.unanswered_proportion = found.unanswered.map(|found| found.proportion());
        report.bounds = found.unanswered.as_ref().map(Bounds::of);
        let extrapolated = extrapolation::of(&cell.total);
        report.extrapolated_proportion = extrapolated.map(|(proportion, _)| proportion);
        report.extrapolated_bounds = extrapolated.map(|(_, bounds)| bounds);
        report.events = events(question, cell);
        (report.histograms, report.quantiles) = histograms(question, &answer.histograms);
        report.warnings = FitReport::warnings_of(surrogate);
        if is_whole && let Some(contradiction) = Confidence::contradiction(surrogate, stable.value()) {
            report.warnings.insert(0, contradiction);
        }
        report.warnings.extend(extrapolation::warning(surrogate, extrapolated));
        report.warnings.extend(unbalanced(question));
        let quantile = |quantile: &Quantile| QuantileReport { level: quantile.level, value: quantile.value };
        report.max_re_residuals = surrogate.decision.max_re_residuals.iter().map(quantile).collect();
        report.verdict = report.verdict_sentence();
        Some(report)
    }

    /// The report of direct computations that are judged with this margin.
    pub fn of_model(study: &str, reference: &Reference, margin: Margin, seed: u64, elapsed_seconds: f64) -> Self {
        let Reference { outputs, summary, rigid_body_modes, is_undamped } = reference;
        let mut report = Self {
            judged_by: with_margin("all eigenvalues".to_owned(), margin),
            undamped: *is_undamped,
            rigid_body_modes: Some(*rigid_body_modes),
            margin: MarginReport::of(margin),
            ..Self::new(study, "model", outputs, summary, seed, elapsed_seconds)
        };
        report.verdict = report.verdict_sentence();
        report
    }

    /// The same, which says how these inputs depend on each other.
    #[must_use]
    pub fn with_dependence_of(self, inputs: &InputSpace) -> Self {
        Self { dependence: DependenceReport::of(inputs), ..self }
    }

    fn new(
        study: &str,
        source: &'static str,
        outputs: &[Output],
        summary: &Summary,
        seed: u64,
        elapsed_seconds: f64,
    ) -> Self {
        let stable = summary.stable_proportion();
        let labelled: Vec<(Label, &EigenvalueSummary)> =
            outputs.iter().flat_map(Output::labels).zip(&summary.eigenvalues).collect();
        let proportion = |hits: u64| Proportion { hits, samples: stable.samples };
        let interval = |hits: u64| proportion(hits).interval(LEVEL);
        let (marginal, unstable) = (summary.marginal(), summary.unstable);
        let (flutter, divergence) = (summary.fluttering(), summary.divergent);
        let mut names: Vec<_> = outputs.iter().flat_map(|output| &output.components).collect();
        names.sort_by_key(|component| component.id);
        Self {
            verdict: String::new(),
            study: study.to_owned(),
            source,
            samples: stable.samples,
            requested_samples: stable.samples,
            complete: true,
            seed,
            sampler: Sampler::MonteCarlo.name(),
            replicates: 1,
            conditions: Vec::new(),
            dependence: None,
            stable_samples: stable.hits,
            stable_proportion: stable.value(),
            marginal_proportion: proportion(marginal).value(),
            unstable_proportion: proportion(unstable).value(),
            flutter_proportion: proportion(flutter).value(),
            divergence_proportion: proportion(divergence).value(),
            intervals: Intervals {
                stable: stable.interval(LEVEL),
                marginal: interval(marginal),
                unstable: interval(unstable),
                flutter: interval(flutter),
                divergence: interval(divergence),
            },
            judged_by: String::new(),
            undamped: false,
            rigid_body_modes: None,
            margin: None,
            band: None,
            standard_error: Share::of_replicates(&[stable], LEVEL).standard_error,
            confidence: Confidence::of_model(stable),
            smallest_share: None,
            unanswered_proportion: None,
            bounds: None,
            extrapolated_proportion: None,
            extrapolated_bounds: None,
            max_re: Statistics::of(&summary.max_re, 1.0),
            modes: modes(&labelled, stable.samples),
            real_eigenvalues: real_eigenvalues(&labelled, stable.samples),
            components: names
                .into_iter()
                .zip(&summary.components)
                .map(|(component, moments)| ComponentReport {
                    name: component.name.clone(),
                    samples: Statistics::of(moments, 1.0),
                    analysis: None,
                })
                .collect(),
            sensitivity: None,
            shapley: None,
            critical: None,
            events: Vec::new(),
            histograms: Vec::new(),
            quantiles: Vec::new(),
            warnings: Vec::new(),
            max_re_residuals: Vec::new(),
            elapsed_seconds,
            only_in_text: OnlyInText {
                has_all_samples: true,
                merged_parts: None,
                requested_replicates: 1,
                inputs: Vec::new(),
                sight: None,
            },
        }
    }
}

impl Statistics {
    fn of(moments: &Moments, unit: f64) -> Self {
        Self {
            mean: moments.mean() * unit,
            variance: moments.variance() * unit * unit,
            minimum: moments.minimum() * unit,
            maximum: moments.maximum() * unit,
        }
    }
}

fn modes(labelled: &[(Label, &EigenvalueSummary)], samples: u64) -> Vec<ModeReport> {
    let share = |count: u64| count as f64 / samples as f64;
    let report = |(label, summary): &(Label, &EigenvalueSummary)| {
        let EigenvalueSummary { unstable, marginal, real, divergent, .. } = **summary;
        Some(ModeReport {
            mode: label.mode()?,
            frequency_hz: Statistics::of(&summary.angular_frequency, 1.0 / TAU),
            flutter_frequency_hz: summary.flutter_frequency.map(|moments| Statistics::of(&moments, 1.0 / TAU)),
            growth_rate: Statistics::of(&summary.growth_rate, 1.0),
            damping_ratio: Statistics::of(&summary.damping_ratio, 1.0),
            unstable_share: share(unstable),
            marginal_share: share(marginal),
            oscillating_share: share(samples - real),
            overdamped_share: share(real - divergent),
            flutter_share: share(unstable - divergent),
            divergence_share: share(divergent),
        })
    };
    labelled.iter().filter_map(report).collect()
}

fn real_eigenvalues(labelled: &[(Label, &EigenvalueSummary)], samples: u64) -> Vec<RealReport> {
    let reals = labelled.iter().filter(|(label, _)| matches!(label, Label::Real(_)));
    let report = |(label, summary): &(Label, &EigenvalueSummary)| RealReport {
        name: label.growth_rate(),
        growth_rate: Statistics::of(&summary.growth_rate, 1.0),
        divergence_share: summary.unstable as f64 / samples as f64,
    };
    reals.map(report).collect()
}

fn analyses(surrogate: &Surrogate) -> Vec<Analysis> {
    let all_indices = surrogate.sobol_indices();
    let sobol = |id: usize| {
        let Some(indices) = all_indices[id].clone() else { return Vec::new() };
        let shares = indices.first.into_iter().zip(indices.total);
        let report =
            |(input, (first, total)): (&str, (f64, f64))| SobolReport { input: input.to_owned(), first, total };
        surrogate.inputs.names().zip(shares).map(report).collect()
    };
    let moments = surrogate.moments().into_iter().enumerate();
    moments
        .map(|(id, (mean, variance))| Analysis {
            mean_from_coefficients: mean,
            variance_from_coefficients: variance,
            sobol: sobol(id),
        })
        .collect()
}

/// Sobol' points are balanced in numbers that are powers of two.
fn unbalanced(question: &Question) -> Option<String> {
    let per_replicate = question.samples / u64::from(question.replicates.max(1));
    if question.sampler != Sampler::Sobol || per_replicate.is_power_of_two() {
        return None;
    }
    let nearest = per_replicate.checked_next_power_of_two()?.checked_mul(u64::from(question.replicates))?;
    Some(format!(
        "replicates of {} Sobol' points are less balanced than those of a power of two, and their interval is somewhat too \
         narrow; use -n {nearest}",
        count(per_replicate)
    ))
}
