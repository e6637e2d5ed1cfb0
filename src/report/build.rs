//! What a build spent, and how good its surrogate is.

use super::confidence::known_error;
use super::fit::{FitReport, share_of_variance};
use super::given::GivenReport;
use super::layout::{Facts, width, write_verdict, write_warnings};
use super::sight::Sight;
use super::smallest_share::{SmallestShare, estimated_error};
use pcc_compile::campaign::Failure;
use pcc_compile::compilation::BuiltFile;
use pcc_compile::study::{DesignKind, Study};
use pcc_evaluate::foundation::{count, plural};
use pcc_evaluate::probability::inputs::InputSpace;
use pcc_evaluate::surrogate::Surrogate;
use serde::Serialize;
use std::fmt;

/// More levels than this are abbreviated.
const MANY_LEVELS: usize = 6;

/// The result of a build.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BuildReport {
    /// The answer in a sentence.
    pub verdict: String,
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
    /// Estimated error of the stability proportion, in percent of itself; null if unknown.
    pub estimated_error_percent: Option<f64>,
    /// The smaller of the stable and the unstable share, with its estimated error; null if it was not judged.
    pub smallest_share: Option<SmallestShare>,
    /// Fit of every component.
    pub components: Vec<FitReport>,
    /// What to know before trusting the surrogate.
    pub warnings: Vec<String>,
    /// Runs that were given; absent if none were.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub data: Option<GivenReport>,
    /// Wall-clock time.
    pub elapsed_seconds: f64,
    /// Where the runs come from.
    #[serde(flatten)]
    pub runs: RecordedRuns,
}

/// Where the runs of a build come from.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

impl RecordedRuns {
    /// What to know of runs that failed.
    fn warning(&self) -> Option<String> {
        let first = self.failed.first()?;
        let failed = match self.failed.len() {
            1 => "1 model run failed".to_owned(),
            more => format!("{} model runs failed, the first", count(more as u64)),
        };
        Some(format!("{failed} at {}: {}", first.point, first.cause))
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
            data: built.given.as_ref().map(GivenReport::new),
            ..Self::new(&built.surrogate, file, built.bytes, built.elapsed_seconds, runs)
        }
    }

    fn new(surrogate: &Surrogate, file: String, bytes: u64, elapsed_seconds: f64, runs: RecordedRuns) -> Self {
        let mut report = Self {
            verdict: String::new(),
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
            warnings: FitReport::warnings_of(surrogate).into_iter().chain(runs.warning()).collect(),
            runs,
            estimated_error_percent: known_error(surrogate).map(|error| 100.0 * error),
            smallest_share: SmallestShare::of(surrogate),
            components: FitReport::of(surrogate),
            data: None,
            elapsed_seconds,
        };
        report.verdict = report.verdict(Sight::of(surrogate), estimated_error(surrogate));
        report
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

impl BuildReport {
    fn verdict(&self, sight: Option<Sight>, estimated_error: Option<String>) -> String {
        let runs = plural(self.direct_computations as usize, "model run");
        let derivatives = with_derivatives(self.runs_with_derivatives, self.direct_computations);
        let error = match (sight, estimated_error) {
            (Some(sight), _) => format!("it is {}", sight.words()),
            (None, Some(error)) => format!("estimated error {error}"),
            (None, None) => "its error is not estimated".to_owned(),
        };
        format!("{} is built from {runs}{derivatives}; {error}.", self.study)
    }

    fn facts(&self) -> Facts {
        let mut facts = Facts::default();
        if self.undamped {
            facts.add("damping", "none: eigenvalues come as λ and −λ", "");
        }
        if self.rigid_body_modes > 0 {
            facts.add(
                "rigid-body motion",
                format!("{} of the eigenvalues, zero and left out", self.rigid_body_modes),
                "",
            );
        }
        let runs = match self.elements {
            1 => format!("design levels {}", level_list(&self.levels)),
            many => format!("{} in the final mesh of {many} elements", count(self.final_mesh_computations)),
        };
        let earlier = match self.runs.reused {
            0 => String::new(),
            reused => format!(", {} of them recorded earlier", count(reused)),
        };
        facts.add(
            "model runs",
            format!("{}{earlier}, {runs}, seed {}", count(self.direct_computations), self.seed),
            "",
        );
        if let Some(data) = &self.data {
            data.add_to(&mut facts);
        }
        let worst = self.components.iter().filter(|fit| fit.s2.is_some()).min_by(|a, b| {
            let [a, b] = [a, b].map(|fit| fit.s2.unwrap_or(1.0));
            a.total_cmp(&b)
        });
        let worst =
            worst.map_or(String::new(), |fit| format!(", the least S² {} ({})", share_of_variance(fit.s2), fit.name));
        facts.add("components", format!("{}{worst}", self.components.len()), "");
        facts.add(
            "written to",
            format!("{} ({} bytes), after {:.2} s", self.file, count(self.bytes), self.elapsed_seconds),
            "",
        );
        facts
    }
}

impl fmt::Display for BuildReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = width(f);
        write_warnings(f, &self.warnings)?;
        write_verdict(f, &self.verdict)?;
        write!(f, "{:columns$}", self.facts())?;
        if f.alternate() { write!(f, "\n{:columns$}", FitReport::table(&self.components)) } else { Ok(()) }
    }
}
