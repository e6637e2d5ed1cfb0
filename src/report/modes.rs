//! The modes of a model at a point, and along one input.

use super::layout::{width, wrapped, write_verdict, write_warnings};
use super::numbers::{plain, significant};
use super::table::{Align, Table};
use pcc_compile::reference::{ModeAtPoint, ModesAlong};
use pcc_evaluate::components::{Label, Verdict};
use pcc_evaluate::probability::inputs::{Input, InputSpace};
use serde::Serialize;
use std::f64::consts::TAU;
use std::fmt;

/// Values of a line that the terminal shows: of more, some of them.
const SHOWN: usize = 12;

/// The modes of a model.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ModesReport {
    /// The answer in a sentence.
    pub verdict: String,
    /// Name of the study.
    pub study: String,
    /// The inputs, in physical units; of the input that varies its first value.
    pub at: Vec<InputValue>,
    /// Number of eigenvalues that are rigid-body motion, and left out.
    pub rigid_body_modes: usize,
    /// The modes at the point; along an input, at its first value.
    pub modes: Vec<ModeReport>,
    /// The modes along an input; absent if none varies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub along: Option<AlongReport>,
    /// What to know of the point; absent if there is nothing.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// Files that were written; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<String>,
}

/// An input at a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InputValue {
    /// Name.
    pub name: String,
    /// Value, in physical units.
    pub value: f64,
}

/// An eigenvalue.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ModeReport {
    /// Its name: `1` is a mode, `1_b` its second eigenvalue where it does not oscillate, `real_1` a real eigenvalue.
    pub name: String,
    /// Growth rate Re λ, in 1/s.
    pub re: f64,
    /// Angular frequency Im λ, in rad/s; 0 where it does not oscillate.
    pub im: f64,
    /// Im λ/2π.
    pub frequency_hz: f64,
    /// −Re λ/|λ|; null where λ is zero.
    pub damping_ratio: Option<f64>,
    /// How far λ may be from the true one because the solver rounds, in 1/s.
    pub error: f64,
    /// stable, marginal, flutter or divergence.
    pub verdict: &'static str,
}

/// Modes along an input.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AlongReport {
    /// Name of the input.
    pub input: String,
    /// The points, in their order.
    pub points: Vec<AlongPoint>,
    #[serde(skip)]
    pub(super) title: String,
}

/// The modes at one value of an input.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AlongPoint {
    /// The value, in physical units.
    pub value: f64,
    /// max Re λ, in 1/s.
    pub max_re: f64,
    /// stable, marginal, flutter or divergence.
    pub verdict: &'static str,
    /// The modes; null where the model has fewer eigenvalues than at the first point.
    pub modes: Vec<Option<ModeReport>>,
}

impl ModesReport {
    /// The report of modes at one physical point, or along input number `along` from there.
    pub fn new(
        study: &str,
        inputs: &InputSpace,
        points: &[Vec<f64>],
        along: Option<usize>,
        found: &ModesAlong,
    ) -> Self {
        let rows = |modes: &[Option<ModeAtPoint>]| -> Vec<Option<ModeReport>> {
            found.labels.iter().zip(modes).filter(|(label, mode)| is_shown(**label, mode)).map(row).collect()
        };
        let first = points.first().map(Vec::as_slice).unwrap_or_default();
        let at = inputs.names().zip(first).map(|(name, &value)| InputValue { name: name.to_owned(), value });
        let point =
            |((point, modes), top): ((&Vec<f64>, &Vec<Option<ModeAtPoint>>), &pcc_evaluate::components::Top)| {
                let value = along.and_then(|j| point.get(j)).copied().unwrap_or_default();
                AlongPoint { value, max_re: top.max_re, verdict: top.verdict().name(), modes: rows(modes) }
            };
        let along_report = along.map(|j| {
            let Input { name, .. } = &inputs.inputs()[j];
            let points = points.iter().zip(&found.points).zip(&found.tops).map(point).collect();
            AlongReport { input: name.clone(), points, title: inputs.inputs()[j].title() }
        });
        let mut report = Self {
            verdict: String::new(),
            study: study.to_owned(),
            at: at.collect(),
            rigid_body_modes: found.rigid_body_modes,
            modes: found.points.first().map(|modes| rows(modes).into_iter().flatten().collect()).unwrap_or_default(),
            along: along_report,
            warnings: beyond(inputs, points),
            files: Vec::new(),
        };
        report.verdict = report.sentence(found);
        report
    }

    fn sentence(&self, found: &ModesAlong) -> String {
        let verdict = |number: usize| found.tops[number].verdict();
        let Some(along) = &self.along else {
            let Some(top) = found.tops.first() else { return format!("{}: no point.", self.study) };
            let growth = significant(top.max_re, 4);
            return match top.verdict() {
                Verdict::Stable => format!("{} is stable here: max Re λ {growth} 1/s.", self.study),
                Verdict::Marginal => format!("{} is marginal here: it neither grows nor decays.", self.study),
                Verdict::Flutter => {
                    let frequency = significant(top.frequency.abs() / TAU, 4);
                    format!("{} flutters here with {frequency} Hz: max Re λ {growth} 1/s.", self.study)
                }
                Verdict::Divergence => format!("{} diverges here: max Re λ {growth} 1/s.", self.study),
            };
        };
        let changes: Vec<String> = (1..along.points.len())
            .filter(|&number| verdict(number) != verdict(number - 1))
            .map(|number| {
                let [from, to] = [number - 1, number].map(|number| plain(along.points[number].value));
                format!("{} from between {from} and {to}", verdict(number).name())
            })
            .collect();
        let begin = along.points.first().map_or("", |point| point.verdict);
        match changes.is_empty() {
            true => format!("{} over {}: {begin} at all {} values.", self.study, along.input, along.points.len()),
            false => format!("{} over {}: {begin} at first, {}.", self.study, along.input, changes.join(", ")),
        }
    }

    /// The modes along an input as CSV: the value, and re, im of each.
    ///
    /// # Errors
    ///
    /// None that memory does not make.
    pub fn to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        if let Some(along) = &self.along {
            let names = along.names();
            let header = names.iter().flat_map(|name| columns(name));
            let ends = ["max_re", "verdict"].map(str::to_owned);
            writer.write_record(std::iter::once(along.input.clone()).chain(header).chain(ends))?;
            for point in &along.points {
                let cells = names.iter().flat_map(|name| {
                    let mode = point.modes.iter().flatten().find(|mode| mode.name == *name);
                    let parts =
                        mode.map_or([String::new(), String::new()], |mode| [mode.re, mode.im].map(|x| x.to_string()));
                    parts.into_iter().take(columns(name).len())
                });
                let ends = [point.max_re.to_string(), point.verdict.to_owned()];
                writer.write_record(std::iter::once(point.value.to_string()).chain(cells).chain(ends))?;
            }
        }
        writer.into_inner().map_err(|error| error.into_error().into())
    }
}

impl AlongReport {
    /// Names of all eigenvalues that occur, in the order of their columns.
    pub(super) fn names(&self) -> Vec<String> {
        let mut names: Vec<&str> =
            self.points.iter().flat_map(|point| point.modes.iter().flatten()).map(|mode| mode.name.as_str()).collect();
        let order = |name: &str| {
            let number: usize = name.trim_start_matches("real_").trim_end_matches("_b").parse().unwrap_or(usize::MAX);
            (name.starts_with("real_"), number, name.ends_with("_b"))
        };
        names.sort_by_key(|name| order(name));
        names.dedup();
        names.into_iter().map(str::to_owned).collect()
    }

    /// The values that the terminal shows: evenly spread, the first and the last among them.
    fn shown(&self) -> Vec<&AlongPoint> {
        let count = self.points.len().min(SHOWN);
        (0..count).map(|k| &self.points[k * (self.points.len() - 1) / (count - 1).max(1)]).collect()
    }
}

/// The columns of an eigenvalue: re and im, or re alone of one that does not oscillate.
fn columns(name: &str) -> Vec<String> {
    match (name.starts_with("real_"), name.ends_with("_b")) {
        (true, _) => vec![name.to_owned()],
        (_, true) => vec![format!("re_{name}")],
        _ => vec![format!("re_{name}"), format!("im_{name}")],
    }
}

/// While a mode oscillates, its second eigenvalue is the conjugate of the first.
fn is_shown(label: Label, mode: &Option<ModeAtPoint>) -> bool {
    !matches!(label, Label::Second(_)) || mode.is_some_and(|mode| mode.eigenvalue.im == 0.0)
}

fn row((label, mode): (&Label, &Option<ModeAtPoint>)) -> Option<ModeReport> {
    let ModeAtPoint { eigenvalue, error, verdict } = (*mode)?;
    let name = match label {
        Label::Mode(mode) => mode.to_string(),
        Label::Second(mode) => format!("{mode}_b"),
        Label::Real(number) => format!("real_{number}"),
    };
    Some(ModeReport {
        name,
        re: eigenvalue.re,
        im: eigenvalue.im,
        frequency_hz: eigenvalue.im / TAU,
        damping_ratio: (eigenvalue.norm() > 0.0).then(|| -eigenvalue.re / eigenvalue.norm()),
        error,
        verdict: verdict.name(),
    })
}

/// Inputs that leave their laws.
fn beyond(inputs: &InputSpace, points: &[Vec<f64>]) -> Vec<String> {
    let leaves = |j: usize, input: &Input| points.iter().any(|point| !input.marginal.contains(point[j]));
    let outside = inputs.inputs().iter().enumerate().filter(|(j, input)| leaves(*j, input));
    outside.map(|(_, input)| format!("{} leaves its law here; the model was run all the same", input.name)).collect()
}

impl fmt::Display for ModesReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = width(f);
        write_warnings(f, &self.warnings)?;
        write_verdict(f, &self.verdict)?;
        match &self.along {
            None => writeln!(f, "{:columns$}", self.mode_table())?,
            Some(along) => writeln!(f, "{:columns$}", along.table())?,
        }
        let fixed = self.at.iter().filter(|input| self.along.as_ref().is_none_or(|along| along.input != input.name));
        let at: Vec<String> = fixed.map(|input| format!("{} = {}", input.name, plain(input.value))).collect();
        if !at.is_empty() {
            writeln!(f, "{}", wrapped(&format!("at {}", at.join(", ")), columns, 3))?;
        }
        if self.rigid_body_modes > 0 {
            let left_out =
                format!("rigid-body motion: {} of the eigenvalues, zero and left out", self.rigid_body_modes);
            writeln!(f, "{}", wrapped(&left_out, columns, 3))?;
        }
        self.files.iter().try_for_each(|file| writeln!(f, "written to {file}"))
    }
}

impl ModesReport {
    fn mode_table(&self) -> Table {
        let right = Align::Right;
        let mut table = Table::new(&[
            ("mode", Align::Left),
            ("frequency, Hz", right),
            ("Re λ, 1/s", right),
            ("Im λ, rad/s", right),
            ("damping ratio", right),
            ("error, 1/s", right),
            ("", Align::Left),
        ]);
        for mode in &self.modes {
            table.row([
                mode.name.clone(),
                significant(mode.frequency_hz, 6),
                significant(mode.re, 6),
                significant(mode.im, 6),
                mode.damping_ratio.map_or("–".to_owned(), |ratio| significant(ratio, 4)),
                significant(mode.error, 1),
                mode.verdict.to_owned(),
            ]);
        }
        table
    }
}

impl AlongReport {
    /// What grows or decays the most at some values, and how often it swings.
    fn table(&self) -> Table {
        let right = Align::Right;
        let mut table = Table::new(&[
            (self.input.as_str(), right),
            ("max Re λ, 1/s", right),
            ("of mode", Align::Left),
            ("frequency, Hz", right),
            ("", Align::Left),
        ]);
        for point in self.shown() {
            let top = point.modes.iter().flatten().max_by(|a, b| a.re.total_cmp(&b.re));
            table.row([
                plain(point.value),
                significant(point.max_re, 5),
                top.map(|mode| mode.name.clone()).unwrap_or_default(),
                top.map(|mode| significant(mode.frequency_hz, 5)).unwrap_or_default(),
                point.verdict.to_owned(),
            ]);
        }
        table
    }
}
