//! What is inside a surrogate file.

use super::build::{level_list, with_derivatives};
use super::certify::CertificateReport;
use super::confidence::known_error;
use super::dependence::DependenceReport;
use super::fit::FitReport;
use super::judgement::{MarginReport, judged_by, outside_band};
use super::layout::{Facts, width, write_verdict, write_warnings};
use super::numbers::{share, significant};
use super::sight::Sight;
use super::smallest_share::{SmallestShare, estimated_error};
use super::table::{Align, Table};
use pcc_evaluate::artifact::{Artifact, Format};
use pcc_evaluate::evaluation::{Plan, self_test_difference};
use pcc_evaluate::foundation::{count, plural};
use pcc_evaluate::surrogate::{Setting, SettingValue, Surrogate};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// The content of a surrogate file.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InspectReport {
    /// What it is in a sentence.
    pub verdict: String,
    /// Where the file is.
    pub file: String,
    /// Its size.
    pub bytes: u64,
    /// Binary or JSON.
    pub encoding: &'static str,
    /// Version of the format, as in 1.0.
    pub format: String,
    /// Version of pcc that built it.
    pub tool_version: String,
    /// Name of the study.
    pub study: String,
    /// Hash of model, constants, inputs and spectrum.
    pub problem_hash: String,
    /// Hash of the whole study.
    pub study_hash: String,
    /// Hash of what determines the answers.
    pub content_id: String,
    /// Kinds of optional sections this version does not know.
    pub unknown_sections: Vec<u16>,
    /// Every model run the build spent.
    pub direct_computations: u64,
    /// Runs whose derivatives entered the fit.
    pub runs_with_derivatives: u64,
    /// Elements, each with expansions of its own.
    pub elements: usize,
    /// Model runs of the final mesh of elements, those of divided ones left out.
    pub final_mesh_computations: u64,
    /// Runs that failed.
    pub failed_runs: u64,
    /// Fitting method.
    pub method: String,
    /// Its settings.
    pub settings: BTreeMap<String, serde_json::Value>,
    /// Kind of design.
    pub design: String,
    /// Number of points of each design level.
    pub levels: Vec<u64>,
    /// Seed of the design.
    pub seed: u64,
    /// Numbers of the modes it carries.
    pub modes: Vec<usize>,
    /// The eigenvalues it carries, by which stability is judged.
    pub judged_by: String,
    /// Number of eigenvalues of the model that are rigid-body motion, which takes no part in stability.
    pub rigid_body_modes: usize,
    /// Whether no mode decays but what grows elsewhere.
    pub undamped: bool,
    /// How far eigenvalues must stay from instability; null if only the sign of Re λ counts.
    pub margin: Option<MarginReport>,
    /// Growth rates up to this, in 1/s, are taken for zero.
    pub tolerance: f64,
    /// The band of frequencies that chose the modes, and what lies outside; null if it was none.
    pub band: Option<String>,
    /// The uncertain inputs.
    pub inputs: Vec<InputReport>,
    /// How they depend on each other; absent if they do not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dependence: Option<DependenceReport>,
    /// Fit of every component.
    pub components: Vec<FitReport>,
    /// What to know before trusting the surrogate.
    pub warnings: Vec<String>,
    /// Terms after merging all components, and operations per evaluation.
    pub plan: PlanReport,
    /// Estimated error of the stability proportion, in percent of itself; null if unknown.
    pub estimated_error_percent: Option<f64>,
    /// The smaller of the stable and the unstable share, with its estimated error; null if the file does not say.
    pub smallest_share: Option<SmallestShare>,
    /// The estimated error in words.
    #[serde(skip)]
    pub error_words: Option<String>,
    /// Largest relative difference between the self-test and this evaluator.
    pub self_test_difference: f64,
    /// Largest difference allowed.
    pub self_test_tolerance: f64,
    /// Its certificates, oldest first.
    pub certificates: Vec<CertificateReport>,
}

/// One input.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InputReport {
    /// Name.
    pub name: String,
    /// What it is; null if the study does not say.
    pub label: Option<String>,
    /// Unit of its values; null if the study does not say.
    pub unit: Option<String>,
    /// Distribution.
    pub distribution: &'static str,
    /// Its parameters.
    pub parameters: BTreeMap<String, f64>,
    /// The levels of a discrete law; absent of others.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub levels: Vec<LevelReport>,
    /// Lower bound; null if there is none.
    pub lower: Option<f64>,
    /// Upper bound; null if there is none.
    pub upper: Option<f64>,
    /// Between which values the model was run; null where runs fill the law, and if the file does not say.
    pub trained: Option<TrainedReport>,
    /// Polynomial family.
    pub family: &'static str,
}

/// A single value that an input can take.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LevelReport {
    /// The value.
    pub value: f64,
    /// Its probability.
    pub proportion: f64,
}

/// Between which values of an input the model was run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrainedReport {
    /// The smallest.
    pub lower: f64,
    /// The largest.
    pub upper: f64,
}

/// Cost of one evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlanReport {
    /// Terms after merging all components.
    pub terms: usize,
    /// Floating-point operations per point.
    pub flops: usize,
}

impl InspectReport {
    /// The report of a file of so many bytes.
    pub fn new(artifact: &Artifact, file: String, bytes: u64) -> Self {
        let surrogate = &artifact.surrogate;
        let plan = Plan::new(surrogate);
        let mut report = Self {
            verdict: String::new(),
            file,
            bytes,
            encoding: match artifact.format {
                Format::Binary => "binary",
                Format::Json => "json",
            },
            format: format!("{}.{}", artifact.version.0, artifact.version.1),
            tool_version: surrogate.provenance.tool_version.clone(),
            study: surrogate.provenance.study_name.clone(),
            problem_hash: surrogate.provenance.problem_hash.clone(),
            study_hash: surrogate.provenance.study_hash.clone(),
            content_id: artifact.content_id.clone(),
            unknown_sections: artifact.unknown_sections.clone(),
            direct_computations: surrogate.training.counts.direct_computations,
            runs_with_derivatives: surrogate.training.counts.gradients,
            elements: surrogate.mesh.elements().len(),
            final_mesh_computations: surrogate.training.counts.final_mesh,
            failed_runs: surrogate.training.counts.failed,
            method: surrogate.training.method.clone(),
            settings: surrogate.training.settings.iter().map(setting).collect(),
            design: surrogate.training.design.clone(),
            levels: surrogate.training.levels.clone(),
            seed: surrogate.training.seed,
            modes: surrogate.modes(),
            judged_by: judged_by(surrogate),
            rigid_body_modes: surrogate.verdict.rigid_body_modes,
            undamped: surrogate.is_undamped(),
            margin: MarginReport::of(surrogate.verdict.margin),
            tolerance: surrogate.verdict.tolerance,
            band: outside_band(surrogate),
            inputs: (0..surrogate.inputs.dimension()).map(|j| input(surrogate, j)).collect(),
            dependence: DependenceReport::of(&surrogate.inputs),
            warnings: FitReport::warnings_of(surrogate),
            components: FitReport::of(surrogate),
            plan: PlanReport { terms: plan.terms(), flops: plan.flops() },
            estimated_error_percent: known_error(surrogate).map(|error| 100.0 * error),
            smallest_share: SmallestShare::of(surrogate),
            error_words: Sight::of(surrogate).map(Sight::words).or(estimated_error(surrogate)),
            self_test_difference: self_test_difference(surrogate),
            self_test_tolerance: surrogate.self_test.tolerance,
            certificates: CertificateReport::of(surrogate),
        };
        report.verdict = report.verdict();
        report
    }

    fn estimated_error(&self) -> String {
        match &self.error_words {
            Some(error) => error.clone(),
            None if self.components.iter().all(|fit| fit.s2.is_none()) => {
                "not estimated, because no point was left out".to_owned()
            }
            None if self.method == "gpc" => "not estimated, which takes two design levels and gPC has one".to_owned(),
            None => "not estimated, which takes two design levels".to_owned(),
        }
    }

    fn verdict(&self) -> String {
        let inputs = plural(self.inputs.len(), "uncertain input");
        let runs = plural(self.direct_computations as usize, "model run");
        let derivatives = with_derivatives(self.runs_with_derivatives, self.direct_computations);
        let test = if self.self_test_holds() { "" } else { " Its self-test FAILS: do not use it." };
        let Self { file, study, judged_by, .. } = self;
        format!("{file} is a surrogate of {study}: {inputs}, {judged_by}, from {runs}{derivatives}.{test}")
    }

    /// Whether the evaluator finds what the self-test expects.
    pub fn self_test_holds(&self) -> bool {
        self.self_test_difference <= self.self_test_tolerance
    }
}

fn setting(setting: &Setting) -> (String, serde_json::Value) {
    let value = match &setting.value {
        SettingValue::Integer(value) => (*value).into(),
        SettingValue::Number(value) => (*value).into(),
        SettingValue::Text(value) => value.clone().into(),
        SettingValue::Flag(value) => (*value).into(),
    };
    (setting.key.clone(), value)
}

fn input(surrogate: &Surrogate, j: usize) -> InputReport {
    let input = &surrogate.inputs.inputs()[j];
    let [lower, upper] = input.marginal.support().map(|end| end.is_finite().then_some(end));
    let parameter = |(name, value): (&'static str, f64)| (name.to_owned(), value);
    let all = input.marginal.parameters();
    let of = |wanted: &'static str| all.iter().filter(move |(name, _)| *name == wanted).map(|(_, value)| *value);
    let levels = of("value").zip(of("weight")).map(|(value, proportion)| LevelReport { value, proportion }).collect();
    InputReport {
        name: input.name.clone(),
        label: input.description.label().map(str::to_owned),
        unit: input.description.unit().map(str::to_owned),
        distribution: input.marginal.name(),
        parameters: all
            .iter()
            .copied()
            .filter(|(name, _)| !["value", "weight"].contains(name))
            .map(parameter)
            .collect(),
        levels,
        lower,
        upper,
        trained: surrogate.trained_interval(j).map(|[lower, upper]| TrainedReport { lower, upper }),
        family: input.marginal.family().name(),
    }
}

impl fmt::Display for InspectReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = width(f);
        write_warnings(f, &self.warnings)?;
        write_verdict(f, &self.verdict)?;
        write!(f, "{:columns$}", self.facts())?;
        if !f.alternate() {
            write!(f, "\n{:columns$}\n", self.input_table())?;
            if let Some(ranges) = self.range_table() {
                writeln!(f, "{ranges:columns$}")?;
            }
            return writeln!(f, "more: --details");
        }
        write!(f, "{:columns$}", self.further_facts())?;
        writeln!(f)?;
        // Too long for what stands before facts.
        self.hashes().iter().try_for_each(|(name, hash)| writeln!(f, "{name:<12}  {hash}"))?;
        let (inputs, components) = (self.input_table(), FitReport::table(&self.components));
        write!(f, "\n{inputs:columns$}")?;
        if let Some(ranges) = self.range_table() {
            write!(f, "\n{ranges:columns$}")?;
        }
        write!(f, "\n{components:columns$}")
    }
}

impl InspectReport {
    /// What most people want to know.
    pub(super) fn facts(&self) -> Facts {
        let mut facts = Facts::default();
        let runs = count(self.direct_computations);
        let failed = if self.failed_runs > 0 { format!(", {} failed", count(self.failed_runs)) } else { String::new() };
        facts.add("model runs", format!("{runs}{failed}, levels {}, seed {}", level_list(&self.levels), self.seed), "");
        facts.add("estimated error", self.estimated_error(), "");
        if self.rigid_body_modes > 0 {
            let motion = format!("{} eigenvalues, zero everywhere and left out", self.rigid_body_modes);
            facts.add("rigid-body motion", motion, "");
        }
        if self.undamped {
            facts.add("damping", "none: eigenvalues come as λ and −λ", "");
        }
        if let Some(band) = &self.band {
            facts.add("frequencies", band.clone(), "");
        }
        if let Some(dependence) = &self.dependence {
            facts.add("dependence", dependence.in_words(), "correlations of ranks");
        }
        let test = if self.self_test_holds() { "holds" } else { "FAILS" };
        facts.add("self-test", test, format!("largest difference {}", significant(self.self_test_difference, 2)));
        for certificate in &self.certificates {
            facts.add("certificate", certificate.to_string(), "");
        }
        for kind in &self.unknown_sections {
            facts.add("section", format!("of kind {kind}, skipped: this pcc does not know it"), "");
        }
        let (bytes, encoding) = (count(self.bytes), self.encoding);
        facts.add(
            "file",
            format!("{encoding}, format {}, {bytes} bytes, by pcc {}", self.format, self.tool_version),
            "",
        );
        facts
    }

    /// What else there is.
    pub(super) fn further_facts(&self) -> Facts {
        let mut facts = Facts::default();
        let settings: Vec<String> = self.settings.iter().map(|(key, value)| format!("{key} {value}")).collect();
        facts.add("design", self.design.clone(), "");
        if self.elements > 1 {
            let mesh =
                format!("{}, {} model runs in the final mesh", self.elements, count(self.final_mesh_computations));
            facts.add("elements", mesh, "");
        }
        facts.add("method", format!("{}: {}", self.method, settings.join(", ")), "");
        facts.add("evaluation", format!("{} terms, {} operations per point", self.plan.terms, self.plan.flops), "");
        facts
    }

    /// What tells problems and answers apart.
    pub(super) fn hashes(&self) -> [(&'static str, String); 2] {
        [("problem hash", self.problem_hash.clone()), ("content id", self.content_id.clone())]
    }

    pub(super) fn input_table(&self) -> Table {
        let right = Align::Right;
        let left = Align::Left;
        let mut columns = vec![("input", left), ("distribution", left)];
        // Bounds say all of uniform inputs, and little of others.
        let has_bounds_alone = self.inputs.iter().all(|input| input.distribution == "uniform");
        match has_bounds_alone {
            true => columns.extend([("lower", right), ("upper", right)]),
            false => columns.push(("parameters", left)),
        }
        let has_units = self.inputs.iter().any(|input| input.unit.is_some());
        columns.extend(has_units.then_some(("unit", left)));
        columns.push(("polynomials", left));
        columns.extend(self.inputs.iter().any(|input| input.label.is_some()).then_some(("label", left)));
        let mut inputs = Table::new(&columns);
        for input in &self.inputs {
            let parameters = match has_bounds_alone {
                true => {
                    [input.lower, input.upper].map(|end| end.map_or_else(String::new, |end| significant(end, 6))).into()
                }
                false => vec![input.parameters_in_words()],
            };
            let mut row = vec![input.name.as_str(), input.distribution];
            row.extend(parameters.iter().map(String::as_str));
            row.extend(has_units.then(|| input.unit.as_deref().unwrap_or_default()));
            row.extend([input.family, input.label.as_deref().unwrap_or_default()]);
            row.truncate(columns.len());
            inputs.row(row);
        }
        inputs
    }
}

impl InspectReport {
    /// Where the laws of the inputs begin and end, and where the model was run; `None` if all are uniform: bounds say
    /// that of them.
    pub(super) fn range_table(&self) -> Option<Table> {
        if self.inputs.iter().all(|input| input.distribution == "uniform") {
            return None;
        }
        let right = Align::Right;
        let mut columns = vec![("input", Align::Left), ("law from", right), ("to", right)];
        let is_trained = self.inputs.iter().any(|input| input.trained.is_some());
        columns.extend(is_trained.then_some([("model run from", right), ("to", right)]).into_iter().flatten());
        let mut table = Table::new(&columns);
        for input in &self.inputs {
            let end = |end: Option<f64>, infinite: &str| end.map_or_else(|| infinite.to_owned(), shortest);
            let law = [end(input.lower, "−∞"), end(input.upper, "∞")];
            let run = match input.trained {
                Some(found) => [found.lower, found.upper].map(|end| significant(end, 4)),
                None => ["everywhere".to_owned(), String::new()],
            };
            let row = [input.name.clone()].into_iter().chain(law).chain(run);
            table.row(row.take(columns.len()));
        }
        Some(table)
    }
}

impl InputReport {
    /// Like "mean 2e6, std 1e5", or "1 in 25 %, 2 in 75 %".
    fn parameters_in_words(&self) -> String {
        /// More levels are counted.
        const LISTED: usize = 6;
        let level = |level: &LevelReport| format!("{} in {}", shortest(level.value), share(level.proportion));
        match self.levels.len() {
            0 => {}
            1..=LISTED => return self.levels.iter().map(level).collect::<Vec<_>>().join(", "),
            more => return format!("{more} levels"),
        }
        let one = |(name, value): (&String, &f64)| format!("{name} {}", shortest(*value));
        self.parameters.iter().map(one).collect::<Vec<_>>().join(", ")
    }
}

/// Up to six digits, without zeros at the end.
fn shortest(value: f64) -> String {
    let rounded = significant(value, 6);
    match rounded.contains('.') && !rounded.contains('·') {
        true => rounded.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => rounded,
    }
}
