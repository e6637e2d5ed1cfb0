//! What a build spent and how well each component is fitted.

use super::table::{Align, Table, significant};
use pcc_compile::campaign::Failure;
use pcc_compile::compilation::BuiltFile;
use pcc_compile::study::{DesignKind, Study};
use pcc_evaluate::foundation::count;
use pcc_evaluate::probability::inputs::InputSpace;
use pcc_evaluate::surrogate::{Setting, SettingValue, StopReason, Surrogate};
use serde::Serialize;
use std::fmt;

/// S² below which a component is called poorly fitted.
const POOR: f64 = 0.9;

/// Estimated relative error of the proportion from which a study that set no tolerance is warned.
const LARGE_ERROR: f64 = 0.05;

/// More levels than this are abbreviated.
const MANY_LEVELS: usize = 6;

/// Shares of the variance above this are shown by what they leave.
const ALMOST_ONE: f64 = 1.0 - 5e-6;

/// The result of a build.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BuildReport {
    /// Name of the study.
    pub study: String,
    /// Where the surrogate is.
    pub file: String,
    /// Size of the file.
    pub bytes: u64,
    /// Seed of the design.
    pub seed: u64,
    /// Every model run the build spent.
    pub direct_computations: u64,
    /// Runs whose derivatives entered the fit.
    pub runs_with_derivatives: u64,
    /// Elements, each with expansions of its own.
    pub elements: usize,
    /// Model runs of the final mesh of elements, those of divided ones left out.
    pub final_mesh_computations: u64,
    /// Number of points of each design level.
    pub levels: Vec<u64>,
    /// Number of eigenvalues that are rigid-body motion, zero at every run, and left out.
    pub rigid_body_modes: usize,
    /// Whether no mode decays but what grows elsewhere.
    pub undamped: bool,
    /// Fit of every component.
    pub components: Vec<FitReport>,
    /// What to know before trusting the surrogate.
    pub warnings: Vec<String>,
    /// Wall-clock time.
    pub elapsed_seconds: f64,
    /// Where the runs come from.
    #[serde(flatten)]
    pub runs: RecordedRuns,
}

/// Where the runs of a build come from.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct RecordedRuns {
    /// The journal they are recorded in.
    pub journal: Option<String>,
    /// Runs that were recorded there already.
    #[serde(rename = "reused_runs")]
    pub reused: u64,
    /// Runs that failed and were left out.
    #[serde(rename = "failed_runs")]
    pub failed: Vec<FailedRun>,
}

/// A run that failed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FailedRun {
    /// The inputs with their values.
    pub point: String,
    /// Why.
    pub cause: String,
}

impl FailedRun {
    /// A failure at a point of these inputs.
    fn new(inputs: &InputSpace, failure: &Failure) -> Self {
        Self { point: inputs.describe(&failure.point), cause: failure.cause.clone() }
    }
}

/// The word for why a build ended early, if it did.
fn ended_early(surrogate: &Surrogate) -> Option<&str> {
    let setting = surrogate.training.settings.iter().find(|setting| setting.key == "ended")?;
    match &setting.value {
        SettingValue::Text(reason) => Some(reason),
        _ => None,
    }
}

/// Why a build ended before everything was as good as the study asks for.
fn ended(reason: &str, surrogate: &Surrogate) -> String {
    let runs = count(surrogate.training.counts.direct_computations);
    let best = match surrogate.training.levels.last() {
        Some(&last) if last < surrogate.training.counts.direct_computations => {
            format!(", of which the first {} gave the best fit,", count(last))
        }
        _ => String::new(),
    };
    let why = match reason {
        "error-stalled" => {
            "because the estimated error of the proportion hardly falls any more, as where answers are noisy or have kinks"
        }
        "fits-cost-more" => {
            "because fits take far longer than the runs of this model; set design.maximum to let it go on"
        }
        "largest-design" => "because design.maximum allows no more",
        "interrupted" => "because it was stopped",
        other => other,
    };
    format!("the build ended after {runs} model runs{best} {why}")
}

impl RecordedRuns {
    /// What to know of runs that failed.
    fn warning(&self) -> Option<String> {
        let first = self.failed.first()?;
        let failed = match self.failed.len() {
            1 => "1 model run failed and was left out, nothing in its place; it was".to_owned(),
            more => {
                format!("{} model runs failed and were left out, nothing in their place; the first", count(more as u64))
            }
        };
        Some(format!("{failed} at {}: {}", first.point, first.cause))
    }
}

/// Fit of one component.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitReport {
    /// Name.
    pub name: String,
    /// Degree p at which the search ended.
    pub degree: u16,
    /// Number of terms.
    pub terms: usize,
    /// R² on the design.
    pub r2: Option<f64>,
    /// Leave-one-out S².
    pub s2: Option<f64>,
    /// S² with the correction for small designs.
    pub corrected_s2: Option<f64>,
    /// Why the search ended.
    pub stop: &'static str,
}

impl FitReport {
    /// The fits of all components.
    pub fn of(surrogate: &Surrogate) -> Vec<Self> {
        let report = |component: &pcc_evaluate::components::Component| {
            let fit = surrogate.fit_of(component.id);
            Self {
                name: component.name.clone(),
                degree: fit.degree,
                terms: fit.terms,
                r2: fit.r2,
                s2: fit.s2,
                corrected_s2: fit.corrected_s2,
                stop: fit.stop.describe(),
            }
        };
        surrogate.components().into_iter().map(report).collect()
    }

    /// What a user must know before trusting the surrogate: components that are fitted poorly or not judged at all.
    pub fn warnings(fits: &[Self]) -> Vec<String> {
        let warning = |fit: &Self| {
            let name = &fit.name;
            match fit.s2 {
                _ if fit.has_stalled() => None,
                Some(s2) if s2 < 0.0 => Some(format!(
                    "{name} is predicted worse than by its mean (S² {s2:.2}); do not trust what depends on it"
                )),
                Some(s2) if s2 < POOR => Some(format!("{name} is poorly fitted (S² {s2:.2})")),
                None if fit.r2.is_some() => Some(format!("{name} could not be judged by leaving out points")),
                _ => None,
            }
        };
        fits.iter().filter_map(warning).chain(Self::stalled(fits)).collect()
    }

    /// Components of which more runs would not be known better.
    fn stalled(fits: &[Self]) -> Option<String> {
        let names: Vec<&str> = fits.iter().filter(|fit| fit.has_stalled()).map(|fit| fit.name.as_str()).collect();
        (!names.is_empty()).then(|| {
            format!(
                "the errors of {} no longer fall with more runs: what is left of them is noise of the model's answers, or detail \
                 beyond designs of this size",
                names.join(", ")
            )
        })
    }

    fn has_stalled(&self) -> bool {
        self.stop == StopReason::Stalled.describe()
    }

    /// The same for a method, which says what else there is to know and what can be done.
    fn warnings_by_method(surrogate: &Surrogate, fits: &[Self]) -> Vec<String> {
        let has = |stop: StopReason| fits.iter().any(|fit| fit.stop == stop.describe());
        if is_quadrature(surrogate) {
            let is_poor = |fit: &&Self| fit.r2.is_some_and(|r2| r2 < POOR);
            let misfit = |fit: &Self| {
                format!("{} is poorly fitted at the nodes already (R² {:.2})", fit.name, fit.r2.unwrap_or(0.0))
            };
            let mut warnings: Vec<String> = fits.iter().filter(is_poor).map(misfit).collect();
            warnings.push(
                "quadrature leaves no point out, so nothing is known of the error between its nodes; check with pcc compare or \
                 certify"
                    .to_owned(),
            );
            if has(StopReason::Limited) {
                warnings.push(
                    "elements that fit.theta_1 asks to divide are left; raise fit.elements or design.maximum for more"
                        .to_owned(),
                );
            }
            return warnings;
        }
        let mut warnings = Self::warnings(fits);
        match surrogate.training.method.as_str() {
            "gpc" if has(StopReason::DesignExhausted) => {
                warnings.push("the points hardly determine all terms; raise fit.oversampling or lower the degree".to_owned());
            }
            "gpc" => warnings.push(
                "one design does not tell how far the proportion is off, and S² says little of it; check with pcc compare or certify"
                    .to_owned(),
            ),
            _ if has(StopReason::DesignExhausted) && ended_early(surrogate).is_none() => warnings
                .push("the design reached design.maximum before the fit was accurate; raise it for more".to_owned()),
            _ => {}
        }
        warnings
    }

    /// The same, and what is known of the proportion.
    pub fn warnings_of(surrogate: &Surrogate) -> Vec<String> {
        let mut warnings: Vec<String> = super::coverage::warning(surrogate).into_iter().collect();
        warnings.extend(Self::warnings_by_method(surrogate, &Self::of(surrogate)));
        let setting = |key: &str| surrogate.training.settings.iter().find(|setting| setting.key == key);
        let asked = setting("proportion_tolerance");
        let tolerance = asked.and_then(|setting| match setting.value {
            SettingValue::Number(tolerance) => Some(tolerance),
            _ => None,
        });
        let counts = surrogate.training.counts;
        let unlisted = setting("unlisted_runs");
        if let Some(Setting { value: SettingValue::Integer(unlisted), .. }) = unlisted {
            let error = surrogate.decision.proportion_error.map_or(String::new(), |error| {
                format!(", and the proportion may be off by {} % of itself", significant(100.0 * error, 2))
            });
            let advice = match surrogate.verdict.band {
                Some(_) => "widen spectrum.frequencies",
                None => "target = \"invariants\" without spectrum.modes holds all eigenvalues",
            };
            warnings.push(format!(
                "in {unlisted} of {} model runs an eigenvalue that the surrogate does not hold decides whether the \
                 system is stable{error}; {advice}",
                counts.final_mesh
            ));
        }
        if setting("derivatives").is_some() && counts.gradients < counts.values {
            let close = match setting("without_derivatives") {
                Some(Setting { value: SettingValue::Text(names), .. }) => names.as_str(),
                _ => "a group of modes",
            };
            warnings.push(format!(
                "in {} of {} model runs {close} came too close to other modes for derivatives; values alone entered the fit there",
                counts.values - counts.gradients,
                counts.values
            ));
        }
        if setting("labels").is_some() {
            warnings.push(
                "eigenvalues could not be followed by their vectors in every run; they are told apart by |λ|, and those \
                 that change places are fitted together"
                    .to_owned(),
            );
        }
        warnings.extend(Self::distrusted(surrogate));
        warnings.extend(ended_early(surrogate).map(|reason| ended(reason, surrogate)));
        match (surrogate.decision.proportion_error, tolerance) {
            (Some(error), tolerance) if unlisted.is_none() && error > tolerance.unwrap_or(LARGE_ERROR) => warnings.push(format!(
                "the proportion may be off by {} % of itself; if it is very small, that is how well it can be judged; \
                 else raise design.maximum or choose another fit.method, and check with pcc compare or certify",
                significant(100.0 * error, 2)
            )),
            (None, Some(_)) => warnings.push(
                "the error of the proportion could not be estimated: that takes two design levels".to_owned(),
            ),
            _ => {}
        }
        warnings
    }

    /// Components whose derivatives got no weight because they contradict the values.
    fn distrusted(surrogate: &Surrogate) -> Option<String> {
        let weights = surrogate.training.settings.iter().find(|setting| setting.key == "derivative_weights")?;
        let SettingValue::Text(weights) = &weights.value else { return None };
        // One word for all components, or a word each.
        let words: Vec<&str> = weights.split(' ').collect();
        let has_none = |id: usize| words.get(if words.len() == 1 { 0 } else { id }) == Some(&"0");
        let names: Vec<String> =
            surrogate.components().iter().filter(|c| has_none(c.id)).map(|component| component.name.clone()).collect();
        (!names.is_empty()).then(|| {
            format!(
                "the derivatives of {} do not fit the values, as where answers have kinks or noise, and were not used",
                names.join(", ")
            )
        })
    }

    /// A table of fits.
    pub fn table(fits: &[Self]) -> Table {
        let right = Align::Right;
        let mut table = Table::new(&[
            ("component", Align::Left),
            ("degree", right),
            ("terms", right),
            ("R²", right),
            ("S²", right),
            ("S² corrected", right),
            ("search ended at", Align::Left),
        ]);
        let share = |share: Option<f64>| match share {
            None => "–".to_owned(),
            Some(share) if share > ALMOST_ONE => format!("1 − {:.0e}", (1.0 - share).max(f64::EPSILON)),
            Some(share) => format!("{share:.5}"),
        };
        for fit in fits {
            table.row([
                fit.name.clone(),
                fit.degree.to_string(),
                fit.terms.to_string(),
                share(fit.r2),
                share(fit.s2),
                share(fit.corrected_s2),
                fit.stop.to_owned(),
            ]);
        }
        table
    }
}

impl BuildReport {
    /// The report of the surrogate of `study`, which was written to `file`.
    pub fn of_file(study: &Study, built: &BuiltFile, file: String) -> Self {
        let runs = RecordedRuns {
            journal: built.journal.as_ref().map(|journal| journal.display().to_string()),
            reused: built.reused,
            failed: built.failures.iter().map(|failure| FailedRun::new(&study.inputs, failure)).collect(),
        };
        Self {
            rigid_body_modes: built.rigid_body_modes,
            ..Self::new(&built.surrogate, file, built.bytes, built.elapsed_seconds, runs)
        }
    }

    fn new(surrogate: &Surrogate, file: String, bytes: u64, elapsed_seconds: f64, runs: RecordedRuns) -> Self {
        Self {
            study: surrogate.provenance.study_name.clone(),
            file,
            bytes,
            seed: surrogate.training.seed,
            direct_computations: surrogate.training.counts.direct_computations,
            runs_with_derivatives: surrogate.training.counts.gradients,
            elements: surrogate.mesh.elements().len(),
            final_mesh_computations: surrogate.training.counts.final_mesh,
            levels: surrogate.training.levels.clone(),
            rigid_body_modes: surrogate.verdict.rigid_body_modes,
            undamped: surrogate.is_undamped(),
            warnings: runs.warning().into_iter().chain(FitReport::warnings_of(surrogate)).collect(),
            runs,
            components: FitReport::of(surrogate),
            elapsed_seconds,
        }
    }
}

/// Whether the model was run at the nodes of a tensor Gauss rule.
pub(super) fn is_quadrature(surrogate: &Surrogate) -> bool {
    surrogate.training.design == DesignKind::TensorGauss.name()
}

/// How many of the runs came with derivatives, to follow the number of runs.
pub(super) fn with_derivatives(gradients: u64, runs: u64) -> String {
    match gradients {
        0 => String::new(),
        all if all == runs => " with derivatives".to_owned(),
        some => format!(", {} with derivatives", count(some)),
    }
}

/// Levels of a design; many by the first two and the last.
pub(super) fn level_list(levels: &[u64]) -> String {
    match levels {
        [first, second, .., last] if levels.len() > MANY_LEVELS => format!("{first} → {second} → … → {last}"),
        _ => levels.iter().map(u64::to_string).collect::<Vec<_>>().join(" → "),
    }
}

impl fmt::Display for BuildReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{}: {} model runs{}{} ({}), {:.2} s, seed {}\n",
            self.study,
            count(self.direct_computations),
            with_derivatives(self.runs_with_derivatives, self.direct_computations),
            match self.runs.reused {
                0 => String::new(),
                reused => format!(", {} of them recorded earlier", count(reused)),
            },
            match self.elements {
                1 => format!("design levels {}", level_list(&self.levels)),
                many => format!("{} in the final mesh of {many} elements", count(self.final_mesh_computations)),
            },
            self.elapsed_seconds,
            self.seed
        )?;
        if self.undamped {
            writeln!(f, "The system is undamped: eigenvalues come as λ and −λ.\n")?;
        }
        if self.rigid_body_modes > 0 {
            writeln!(f, "Rigid-body motion: {} of the eigenvalues, zero and left out.\n", self.rigid_body_modes)?;
        }
        writeln!(f, "{}", FitReport::table(&self.components))?;
        self.warnings.iter().try_for_each(|warning| writeln!(f, "warning: {warning}"))?;
        writeln!(f, "written to {} ({} bytes)", self.file, count(self.bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::artifact::decode;

    #[test]
    fn runs_without_derivatives_are_counted_and_reported() {
        let mut surrogate = decode(include_bytes!("../../surrogates/clutch-r1.pcc")).unwrap().surrogate;
        assert_eq!(FitReport::warnings_of(&surrogate), Vec::<String>::new());
        let runs = surrogate.training.counts.values;
        assert_eq!(with_derivatives(surrogate.training.counts.gradients, runs), " with derivatives");
        surrogate.training.counts.gradients -= 2;
        assert_eq!(with_derivatives(surrogate.training.counts.gradients, runs), ", 13 with derivatives");
        let said = "in 2 of 15 model runs a group of modes came too close to other modes for derivatives";
        assert!(FitReport::warnings_of(&surrogate)[0].starts_with(said));

        surrogate.training.counts.gradients += 2;
        let weights = surrogate.training.settings.iter_mut().find(|setting| setting.key == "derivative_weights");
        weights.unwrap().value = SettingValue::Text("1 0 1 1 1 1 0.1 0".to_owned());
        let said = "the derivatives of im_1, im_c0_3_4 do not fit the values";
        assert!(FitReport::warnings_of(&surrogate)[0].starts_with(said));

        let labels = Setting { key: "labels".to_owned(), value: SettingValue::Text("modulus".to_owned()) };
        surrogate.training.settings.push(labels);
        assert!(FitReport::warnings_of(&surrogate)[0].contains("told apart by |λ|"));
    }
}
