//! A surrogate judged against its model.

use super::dependence::DependenceReport;
use super::layout::{Facts, width, write_verdict, write_warnings};
use super::numbers::{share, significant};
use super::smallest_share::ComparedShare;
use super::survey::LEVEL;
use super::table::{Align, Table};
use pcc_compile::reference::Comparison;
use pcc_evaluate::foundation::{count, plural};
use pcc_evaluate::surrogate::Surrogate;
use serde::Serialize;
use std::fmt;

/// Relative errors below this are not worth digits, in percent.
const SMALLEST_ERROR: f64 = 1e-4;

/// The true error is seldom more than three times the estimated one.
const SEVERAL: f64 = 3.0;

/// Surrogate and model on the same points.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CompareReport {
    /// The answer in a sentence.
    pub verdict: String,
    /// Name of the study.
    pub study: String,
    /// Number of points.
    pub samples: u64,
    /// Seed of the points.
    pub seed: u64,
    /// Model runs the surrogate was built from.
    pub direct_computations: u64,
    /// The model's share of stable points.
    pub proportion_model: f64,
    /// The surrogate's share of stable points.
    pub proportion_surrogate: f64,
    /// Whether the true share differs from the surrogate's by more than the surrogate says of its error.
    pub contradicts_surrogate: bool,
    /// Relative error of the share; null if the model is never stable and the surrogate sometimes is.
    pub relative_error_percent: Option<f64>,
    /// The smallest of the stable and the unstable share and those that `fit.shares` names, of those that occur.
    pub smallest_share: ComparedShare,
    /// Points on whose stability the two disagree.
    pub misclassified_percent: f64,
    /// The model's share of marginal points.
    pub marginal_model: f64,
    /// The surrogate's share of marginal points.
    pub marginal_surrogate: f64,
    /// The model's share of unstable points.
    pub unstable_model: f64,
    /// The surrogate's share of unstable points.
    pub unstable_surrogate: f64,
    /// Points that the surrogate calls stable and the model does not.
    pub falsely_stable: u64,
    /// Points that the surrogate calls marginal and the model does not.
    pub falsely_marginal: u64,
    /// Points that the surrogate calls unstable and the model does not.
    pub falsely_unstable: u64,
    /// Points at which the model failed, counted as disagreement.
    pub failed: u64,
    /// Number of eigenvalues of the model that are rigid-body motion, and left out.
    pub rigid_body_modes: usize,
    /// Points at which the model has as many eigenvalues as the surrogate: errors of components are over these.
    pub matched_points: u64,
    /// Largest error of the mean of Re λ among the modes: the paper's mean error.
    pub largest_mean_error_percent: Option<f64>,
    /// Largest error of the variance of Re λ among the modes: the paper's variance error.
    pub largest_variance_error_percent: Option<f64>,
    /// How inputs depend on each other; absent if they do not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dependence: Option<DependenceReport>,
    /// Every component.
    pub components: Vec<ComponentErrors>,
    /// Wall-clock time.
    pub elapsed_seconds: f64,
}

/// Errors of one component.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ComponentErrors {
    /// Name.
    pub name: String,
    /// Mean of the model.
    pub mean_model: f64,
    /// Mean of the surrogate.
    pub mean_surrogate: f64,
    /// Relative error of the mean; null if the model's is zero.
    pub mean_error_percent: Option<f64>,
    /// Variance of the model.
    pub variance_model: f64,
    /// Variance of the surrogate.
    pub variance_surrogate: f64,
    /// Relative error of the variance; null if the model's is zero.
    pub variance_error_percent: Option<f64>,
}

impl CompareReport {
    /// The report of a comparison of `surrogate` with the model of the study of this name.
    pub fn new(study: &str, surrogate: &Surrogate, comparison: &Comparison, seed: u64, elapsed_seconds: f64) -> Self {
        let components: Vec<ComponentErrors> = comparison
            .components
            .iter()
            .map(|component| ComponentErrors {
                name: component.name.clone(),
                mean_model: component.model.mean(),
                mean_surrogate: component.surrogate.mean(),
                mean_error_percent: component.mean_error_percent(),
                variance_model: component.model.variance(),
                variance_surrogate: component.surrogate.variance(),
                variance_error_percent: component.variance_error_percent(),
            })
            .collect();
        let largest = |error: fn(&ComponentErrors) -> Option<f64>| {
            let real_parts = components.iter().filter(|component| component.name.starts_with("re_"));
            real_parts.filter_map(error).reduce(f64::max)
        };
        let mut report = Self {
            verdict: String::new(),
            study: study.to_owned(),
            samples: comparison.samples,
            seed,
            direct_computations: surrogate.training.counts.direct_computations,
            proportion_model: comparison.proportion_model(),
            proportion_surrogate: comparison.proportion_surrogate(),
            contradicts_surrogate: contradicts(surrogate, comparison),
            relative_error_percent: comparison.relative_error_percent(),
            smallest_share: ComparedShare::of(surrogate, comparison),
            misclassified_percent: comparison.misclassified_percent(),
            marginal_model: comparison.marginal()[0],
            marginal_surrogate: comparison.marginal()[1],
            unstable_model: comparison.unstable()[0],
            unstable_surrogate: comparison.unstable()[1],
            falsely_stable: comparison.falsely_stable(),
            falsely_marginal: comparison.falsely_marginal(),
            falsely_unstable: comparison.falsely_unstable(),
            failed: comparison.verdicts.failed(),
            rigid_body_modes: comparison.rigid_body_modes,
            matched_points: comparison.matched_points(),
            largest_mean_error_percent: largest(|component| component.mean_error_percent),
            largest_variance_error_percent: largest(|component| component.variance_error_percent),
            dependence: DependenceReport::of(&surrogate.inputs),
            components,
            elapsed_seconds,
        };
        report.verdict = report.verdict();
        report
    }
}

/// Whether the model's share differs from the surrogate's by more than a few times its estimated error, at 95 %.
fn contradicts(surrogate: &Surrogate, comparison: &Comparison) -> bool {
    let [lower, upper] = comparison.verdicts.of_unstable().difference(LEVEL);
    // A surrogate that says nothing of its error is not contradicted.
    let Some(relative) = surrogate.decision.proportion_error else { return false };
    // What it says its error of is the share that is not unstable.
    let share = 1.0 - comparison.unstable()[1];
    let stated = SEVERAL * (relative * share).max(SMALLEST_ERROR / 100.0);
    lower > stated || upper < -stated
}

/// Three digits, a bound below those that mean something, or a dash where an error has no meaning.
fn percentage(error: Option<f64>) -> String {
    match error {
        None => "–".to_owned(),
        Some(error) if error > 0.0 && error < SMALLEST_ERROR => format!("< {SMALLEST_ERROR}"),
        Some(error) => significant(error, 3),
    }
}

impl CompareReport {
    fn verdict(&self) -> String {
        let all = plural(self.samples as usize, "point");
        let [model, surrogate] = [self.proportion_model, self.proportion_surrogate];
        let stable = match share(model) == share(surrogate) {
            true => format!("{} are stable", share(model)),
            false => format!("{} are stable by the model, {} by the surrogate", share(model), share(surrogate)),
        };
        let agreement = match self.misclassified_percent {
            0.0 => format!("surrogate and model agree on all of {all}"),
            percent => format!("surrogate and model disagree on {} of {all}", share(percent / 100.0)),
        };
        format!("{}: {agreement}; {stable}.", self.study)
    }

    fn facts(&self) -> Facts {
        let mut facts = Facts::default();
        let ComparedShare { name, relative_error_percent, .. } = self.smallest_share;
        let error = format!("{} % of the {name} share", percentage(relative_error_percent));
        facts.add("stable, model", share(self.proportion_model), "");
        let error = match self.failed {
            0 => format!("relative error {error}"),
            _ => format!("relative error at most {error}, if all that failed disagree"),
        };
        facts.add("stable, surrogate", share(self.proportion_surrogate), error);
        if self.marginal_model + self.marginal_surrogate > 0.0 {
            let shares =
                |model, surrogate| format!("{} by the model, {} by the surrogate", share(model), share(surrogate));
            facts.add("marginal", shares(self.marginal_model, self.marginal_surrogate), "");
            facts.add("unstable", shares(self.unstable_model, self.unstable_surrogate), "");
        }
        if self.rigid_body_modes > 0 {
            facts.add(
                "rigid-body motion",
                format!("{} of the eigenvalues, zero and left out", self.rigid_body_modes),
                "",
            );
        }
        if let Some(dependence) = &self.dependence {
            facts.add("dependence", dependence.in_words(), "correlations of ranks");
        }
        let marginal = match self.falsely_marginal {
            0 => String::new(),
            marginal => format!(", {} falsely marginal", count(marginal)),
        };
        let how = format!(
            "{} falsely stable{marginal}, {} falsely unstable",
            count(self.falsely_stable),
            count(self.falsely_unstable)
        );
        facts.add("misclassified", share(self.misclassified_percent / 100.0), how);
        if self.failed > 0 {
            let failed = plural(self.failed as usize, "model run");
            facts.add("failed", failed, "counted as disagreement; shares are of the others");
        }
        let [mean, variance] = [self.largest_mean_error_percent, self.largest_variance_error_percent].map(percentage);
        facts.add("largest error", format!("mean {mean} %, variance {variance} % (of Re λ)"), "");
        let unmatched = self.samples - self.failed - self.matched_points;
        if unmatched > 0 {
            let matched = plural(self.matched_points as usize, "point");
            let why = format!("compared; at the other {} the model has fewer eigenvalues", count(unmatched));
            facts.add("components", matched, why);
        }
        facts
    }
}

impl fmt::Display for CompareReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = width(f);
        if self.contradicts_surrogate {
            let warning = "the model contradicts the surrogate by more than it says of its error; build with more runs";
            write_warnings(f, &[warning.to_owned()])?;
        }
        write_verdict(f, &self.verdict)?;
        writeln!(f, "{:columns$}", self.facts())?;
        if f.alternate() {
            let units = "re in 1/s, im in rad/s; variances in their squares";
            writeln!(f, "{:columns$}{units}\n", self.component_table())?;
        }
        let all = if f.alternate() { "" } else { "; all components: --details" };
        writeln!(
            f,
            "{} in {:.2} s, seed {}{all}",
            plural(self.samples as usize, "direct computation"),
            self.elapsed_seconds,
            self.seed
        )
    }
}

impl CompareReport {
    pub(super) fn component_table(&self) -> Table {
        let right = Align::Right;
        let mut table = Table::new(&[
            ("component", Align::Left),
            ("mean, model", right),
            ("surrogate", right),
            ("error %", right),
            ("variance, model", right),
            ("surrogate", right),
            ("error %", right),
        ]);
        for component in &self.components {
            table.row([
                component.name.clone(),
                significant(component.mean_model, 6),
                significant(component.mean_surrogate, 6),
                percentage(component.mean_error_percent),
                significant(component.variance_model, 5),
                significant(component.variance_surrogate, 5),
                percentage(component.variance_error_percent),
            ]);
        }
        table
    }
}
