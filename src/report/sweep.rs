//! The stability proportion along one input, or over two.

use super::coverage::Bounds;
use super::dependence::DependenceReport;
use super::eval::QuantileReport;
use super::extrapolation;
use super::judgement::judged_by;
use super::survey::{EventReport, LEVEL, events};
use pcc_evaluate::evaluation::{Cell, Condition, Sweep};
use pcc_evaluate::probability::inputs::Input;
use pcc_evaluate::probability::statistics::Interval;
use pcc_evaluate::session::Evaluation;
use pcc_evaluate::surrogate::Decision;
use serde::Serialize;

/// The answer of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SweepReport {
    /// The answer in a sentence.
    pub verdict: String,
    /// Name of the study.
    pub study: String,
    /// Always "surrogate".
    pub source: &'static str,
    /// Whether all points are there; false after an interruption.
    pub complete: bool,
    /// Numbers of the modes that the surrogate holds.
    pub modes: Vec<usize>,
    /// What stability is judged by.
    pub judged_by: String,
    /// Whether some eigenvalues can be real: then systems can diverge.
    #[serde(skip)]
    pub can_diverge: bool,
    /// Samples at each point: the same at all of them but for the inputs that are swept.
    pub samples: u64,
    /// Seed of the samples.
    pub seed: u64,
    /// How samples are drawn.
    pub sampler: &'static str,
    /// Independent randomisations of them.
    pub replicates: u32,
    /// Inputs that are confined or fixed.
    pub conditions: Vec<Condition>,
    /// How inputs depend on each other; absent if they do not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dependence: Option<DependenceReport>,
    /// Inputs that are swept, one or more.
    pub sweeps: Vec<Sweep>,
    /// The points, the last sweep varying fastest.
    pub points: Vec<SweepPoint>,
    /// Quantiles of max Re λ of the model minus its leave-one-out prediction, in 1/s, from the file: what the intervals
    /// do not hold.
    pub max_re_residuals: Vec<QuantileReport>,
    /// What to know where the model did not answer, and where it was not run; absent if there is nothing.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// The inputs of the surrogate, whose units and labels head columns and axes.
    #[serde(skip)]
    pub inputs: Vec<Input>,
    /// Files that were written.
    #[serde(skip)]
    pub files: Vec<String>,
    /// How many parts were put together.
    #[serde(skip)]
    pub merged_parts: Option<usize>,
    /// Wall-clock time.
    pub elapsed_seconds: f64,
}

/// One point of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SweepPoint {
    /// Values of the swept inputs, in physical units.
    pub values: Vec<f64>,
    /// Number of stable samples.
    pub stable_samples: u64,
    /// Their share.
    pub stable_proportion: f64,
    /// Share of the samples that are marginal: neither stable nor unstable as far as can be told.
    pub marginal_proportion: f64,
    /// Share of the samples that flutter: the eigenvalue that decides is complex.
    pub flutter_proportion: f64,
    /// Share of the samples that diverge: it is real.
    pub divergence_proportion: f64,
    /// Standard error of the share.
    pub standard_error: f64,
    /// Interval of the share: what the finite number of samples leaves open.
    pub interval: Interval,
    /// The share if max Re λ were larger or smaller by its residuals' central quantiles: what the surrogate leaves
    /// open; null if unknown.
    pub surrogate_band: Option<Interval>,
    /// Share of samples where the model did not answer, as far as its runs tell; absent if it answered everywhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unanswered_proportion: Option<f64>,
    /// Between what the shares lie, whatever it would have answered there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<Bounds>,
    /// Share of samples beyond all model runs in at least one input; absent if runs fill the laws of all inputs, and if
    /// the file does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extrapolated_proportion: Option<f64>,
    /// Other events that were counted.
    pub events: Vec<EventReport>,
}

impl SweepReport {
    /// The report of an answer to a question with sweeps.
    pub fn new(found: &Evaluation<'_>) -> Self {
        let Evaluation { surrogate, question, answer, .. } = found;
        let residuals = &surrogate.decision.max_re_residuals;
        let band = |cell: &Cell| {
            let [upper, lower] = [0, 1].map(|k| cell.share(LEVEL, |tally| tally.summary.stable_if_shifted[k]).value);
            (!residuals.is_empty()).then_some(Interval { lower, upper, level: Decision::BAND_LEVEL })
        };
        let point = |(number, cell): (usize, &Cell)| {
            let share = cell.share(LEVEL, |tally| tally.summary.stable);
            let summary = &cell.total.summary;
            let proportion = |hits: u64| hits as f64 / summary.samples().max(1) as f64;
            SweepPoint {
                marginal_proportion: proportion(summary.marginal()),
                flutter_proportion: proportion(summary.fluttering()),
                divergence_proportion: proportion(summary.divergent),
                values: values(&question.sweeps, number),
                stable_samples: summary.stable,
                stable_proportion: share.value,
                standard_error: share.standard_error,
                interval: share.interval,
                surrogate_band: band(cell),
                unanswered_proportion: found.unanswered_at.get(number).map(|unanswered| unanswered.proportion()),
                bounds: found.unanswered_at.get(number).map(Bounds::of),
                extrapolated_proportion: extrapolation::of(&cell.total).map(|(proportion, _)| proportion),
                events: events(question, cell),
            }
        };
        let mut report = Self {
            verdict: String::new(),
            study: surrogate.provenance.study_name.clone(),
            source: "surrogate",
            complete: found.is_complete,
            modes: surrogate.modes(),
            judged_by: judged_by(surrogate),
            can_diverge: surrogate.has_real_eigenvalues(),
            samples: question.samples,
            seed: question.seed,
            sampler: question.sampler.name(),
            replicates: question.replicates,
            conditions: question.conditions.clone(),
            dependence: DependenceReport::of(&surrogate.inputs),
            sweeps: question.sweeps.clone(),
            points: answer.cells.iter().enumerate().map(point).collect(),
            max_re_residuals: residuals.iter().map(|q| QuantileReport { level: q.level, value: q.value }).collect(),
            inputs: surrogate.inputs.inputs().to_vec(),
            files: Vec::new(),
            merged_parts: found.merged_parts,
            warnings: super::coverage::warning(found.surrogate).into_iter().collect(),
            elapsed_seconds: found.elapsed_seconds,
        };
        let proportions: Vec<_> = report.points.iter().map(|point| point.extrapolated_proportion).collect();
        report.warnings.extend(extrapolation::warning_of_sweep(surrogate, &proportions));
        report.verdict = report.verdict_sentence();
        report
    }

    /// The head of a column with the values of a sweep: `k_x, N/m`.
    pub(super) fn head(&self, sweep: &Sweep) -> String {
        self.input(sweep).map_or(sweep.input.clone(), Input::name_with_unit)
    }

    /// The title of an axis with the values of a sweep: `contact stiffness, N/m`.
    pub(super) fn title(&self, sweep: &Sweep) -> String {
        self.input(sweep).map_or(sweep.input.clone(), Input::title)
    }

    fn input(&self, sweep: &Sweep) -> Option<&Input> {
        self.inputs.iter().find(|input| input.name == sweep.input)
    }

    /// Whether samples of some point are neither stable nor unstable.
    pub(super) fn has_marginal(&self) -> bool {
        self.points.iter().any(|point| point.marginal_proportion > 0.0)
    }

    /// The points as CSV: values of the swept inputs, bounds of those that are confined, samples, stable samples,
    /// stable proportion, its interval, the band of the surrogate, the share of marginal samples where there are some,
    /// where systems can diverge the shares of flutter and divergence, the share of each event.
    ///
    /// # Errors
    ///
    /// [`csv::Error`], which writing to memory does not raise.
    pub fn to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let mut header: Vec<String> = self.sweeps.iter().map(|sweep| sweep.input.clone()).collect();
        let bounds = |condition: &Condition| ["lower", "upper"].map(|end| format!("{}_{end}", condition.input));
        header.extend(self.conditions.iter().flat_map(bounds));
        let columns = ["samples", "stable_samples", "stable_proportion", "lower", "upper", "band_lower", "band_upper"];
        header.extend(columns.map(str::to_owned));
        let has_marginal = self.has_marginal();
        header.extend(has_marginal.then(|| "marginal_proportion".to_owned()));
        if self.can_diverge {
            header.extend(["flutter_proportion", "divergence_proportion"].map(str::to_owned));
        }
        header.extend(self.points.first().iter().flat_map(|point| &point.events).map(|event| event.event.clone()));
        writer.write_record(&header)?;
        for point in &self.points {
            let mut row: Vec<String> = point.values.iter().map(f64::to_string).collect();
            row.extend(
                self.conditions.iter().flat_map(|condition| [condition.lower, condition.upper].map(|x| x.to_string())),
            );
            row.extend([self.samples, point.stable_samples].map(|number| number.to_string()));
            let Interval { lower, upper, .. } = point.interval;
            row.extend([point.stable_proportion, lower, upper].map(|share| share.to_string()));
            let band = point.surrogate_band.map_or([None; 2], |band| [Some(band.lower), Some(band.upper)]);
            row.extend(band.map(|share| share.map_or(String::new(), |share| share.to_string())));
            row.extend(has_marginal.then(|| point.marginal_proportion.to_string()));
            if self.can_diverge {
                row.extend([point.flutter_proportion, point.divergence_proportion].map(|share| share.to_string()));
            }
            row.extend(point.events.iter().map(|event| event.proportion.to_string()));
            writer.write_record(&row)?;
        }
        writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
    }
}

/// Values of all sweeps at point number `number`.
fn values(sweeps: &[Sweep], number: usize) -> Vec<f64> {
    let mut rest = number as u64;
    let mut values: Vec<f64> = sweeps
        .iter()
        .rev()
        .map(|sweep| {
            let points = u64::from(sweep.points);
            let value = sweep.value((rest % points) as u32);
            rest /= points;
            value
        })
        .collect();
    values.reverse();
    values
}
