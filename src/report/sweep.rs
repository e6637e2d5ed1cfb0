//! The stability proportion along one input, or over two.

use super::charts::short;
use super::eval::QuantileReport;
use super::eval_text::pace;
use super::judgement::judged_by;
use super::survey::{EventReport, LEVEL, conditions_text, events};
use super::table::{Align, Table, plain, significant};
use pcc_charts::{Axis, Cells, Chart, Color, Marks, Series, Symbol, sheet};
use pcc_evaluate::evaluation::{Cell, Condition, Sampler, Sweep};
use pcc_evaluate::foundation::count;
use pcc_evaluate::probability::statistics::Interval;
use pcc_evaluate::session::Evaluation;
use pcc_evaluate::surrogate::Decision;
use serde::Serialize;
use std::fmt;

/// Width of the longest bar, in characters.
const LONGEST_BAR: f64 = 40.0;

/// Lines and characters of a map on a terminal, at most.
const MOST_ROWS: u32 = 51;
const MOST_COLUMNS: u32 = 101;

/// The answer of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepReport {
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
    /// Inputs that are swept, one or more.
    pub sweeps: Vec<Sweep>,
    /// The points, the last sweep varying fastest.
    pub points: Vec<SweepPoint>,
    /// Quantiles of max Re λ of the model minus its leave-one-out prediction, in 1/s, from the file: what the intervals
    /// do not hold.
    pub max_re_residuals: Vec<QuantileReport>,
    /// What to know of a surrogate whose model did not answer everywhere; absent if it did.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
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
                events: events(question, cell),
            }
        };
        Self {
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
            sweeps: question.sweeps.clone(),
            points: answer.cells.iter().enumerate().map(point).collect(),
            max_re_residuals: residuals.iter().map(|q| QuantileReport { level: q.level, value: q.value }).collect(),
            files: Vec::new(),
            merged_parts: found.merged_parts,
            warnings: super::coverage::warning(found.surrogate).into_iter().collect(),
            elapsed_seconds: found.elapsed_seconds,
        }
    }

    /// Whether samples of some point are neither stable nor unstable.
    fn has_marginal(&self) -> bool {
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

impl fmt::Display for SweepReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (points, each) = (count(self.points.len() as u64), count(self.samples));
        let how = pace(self.samples as f64 * self.points.len() as f64, self.elapsed_seconds, self.merged_parts);
        writeln!(
            f,
            "{}: {points} points with {each} samples each of the surrogate {how}, seed {}\n",
            self.study, self.seed
        )?;
        if !self.complete {
            let all: u64 = self.sweeps.iter().map(|sweep| u64::from(sweep.points)).product();
            let tables = "no table or chart is written";
            writeln!(f, "  incomplete             interrupted after {points} of {} points; {tables}", count(all))?;
        }
        if self.sampler != Sampler::MonteCarlo.name() {
            writeln!(f, "  sampler                {}, {} replicates", self.sampler, self.replicates)?;
        }
        if !self.conditions.is_empty() {
            writeln!(f, "  where                  {}", conditions_text(&self.conditions))?;
        }
        writeln!(f, "  judged by              {}", self.judged_by)?;
        writeln!(f, "  surrogate band         {}\n", self.width_of_band())?;
        match self.sweeps.len() {
            _ if self.points.is_empty() => {}
            2 => self.write_map(f)?,
            _ => writeln!(f, "{}from, to: 95 % sampling interval", self.table())?,
        }
        self.warnings.iter().try_for_each(|warning| writeln!(f, "\nwarning: {warning}"))?;
        match self.files.is_empty() {
            true => Ok(()),
            false => writeln!(f, "\nwritten to {}", self.files.join(", ")),
        }
    }
}

impl SweepReport {
    /// How much the band of the surrogate can differ from the share, at the worst point.
    fn width_of_band(&self) -> String {
        let bands = self.points.iter().filter_map(|point| Some((point.stable_proportion, point.surrogate_band?)));
        let widest = bands.map(|(share, band)| (band.upper - share).max(share - band.lower)).reduce(f64::max);
        match widest {
            Some(widest) => {
                format!("up to {} % away from the share, at the worst point", significant(100.0 * widest, 2))
            }
            None if self.max_re_residuals.is_empty() => "unknown: no point could be left out".to_owned(),
            None => "of no point yet".to_owned(),
        }
    }

    /// One line per point, with a bar.
    fn table(&self) -> Table {
        let percent = |share: f64| format!("{:.3} %", 100.0 * share);
        let right = Align::Right;
        let mut columns: Vec<(&str, Align)> = self.sweeps.iter().map(|sweep| (sweep.input.as_str(), right)).collect();
        columns.extend([("stable", right), ("from", right), ("to", right)]);
        let has_marginal = self.has_marginal();
        columns.extend(has_marginal.then_some(("marginal", right)));
        if self.can_diverge {
            columns.extend([("flutter", right), ("divergence", right)]);
        }
        let events = self.points.first().map_or(&[][..], |point| &point.events);
        columns.extend(events.iter().map(|event| (event.event.as_str(), right)));
        columns.push(("", Align::Left));
        let mut table = Table::new(&columns);
        for point in &self.points {
            let mut row: Vec<String> = point.values.iter().map(|&value| plain(value)).collect();
            row.extend([point.stable_proportion, point.interval.lower, point.interval.upper].map(percent));
            row.extend(has_marginal.then(|| percent(point.marginal_proportion)));
            if self.can_diverge {
                row.extend([point.flutter_proportion, point.divergence_proportion].map(percent));
            }
            row.extend(point.events.iter().map(|event| percent(event.proportion)));
            row.push("█".repeat((LONGEST_BAR * point.stable_proportion.clamp(0.0, 1.0)).round() as usize));
            table.row(row);
        }
        table
    }

    /// One character per point: rows are the first sweep, from its last value down, columns the second.
    fn write_map(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [vertical, horizontal] = &self.sweeps[..] else { return Ok(()) };
        let columns = horizontal.points as usize;
        let (row_step, column_step) = (vertical.points.div_ceil(MOST_ROWS), horizontal.points.div_ceil(MOST_COLUMNS));
        let label = |row: usize| plain(vertical.value(row as u32));
        let width = (0..vertical.points as usize).map(|row| label(row).chars().count()).max().unwrap_or(0);
        writeln!(f, "{:>width$}   stable: 0 to 9 tenths, · none, # all", vertical.input)?;
        let rows = self.points.chunks(columns).enumerate().filter(|(row, _)| row.is_multiple_of(row_step as usize));
        for (row, points) in rows.collect::<Vec<_>>().into_iter().rev() {
            let shown = points.iter().step_by(column_step as usize);
            let line: String = shown.map(|point| symbol(point, self.samples)).collect();
            writeln!(f, "{:>width$}  |{line}", label(row))?;
        }
        let (from, to) = (plain(horizontal.from), plain(horizontal.to));
        let gap =
            columns.div_ceil(column_step as usize).saturating_sub(from.chars().count() + to.chars().count()).max(1);
        writeln!(f, "{:width$}   {from}{}{to}  {}", "", " ".repeat(gap), horizontal.input)?;
        if row_step > 1 || column_step > 1 {
            writeln!(
                f,
                "shown: one of {row_step} rows and one of {column_step} columns; --table and --chart have all"
            )?;
        }
        Ok(())
    }
}

fn symbol(point: &SweepPoint, samples: u64) -> char {
    match point.stable_samples {
        0 => '·',
        stable if stable == samples => '#',
        _ => char::from_digit((10.0 * point.stable_proportion) as u32, 10).unwrap_or('9'),
    }
}

/// A picture of the sweep, as an SVG file: a curve with its interval for one input, a map for two.
pub fn sweep_chart(report: &SweepReport) -> String {
    let chart = match &report.sweeps[..] {
        [sweep] => curve(report, sweep),
        [vertical, horizontal] => map(report, vertical, horizontal),
        _ => return String::new(),
    };
    sheet("", &chart.description.clone(), &[chart], 1)
}

/// " where k_p = 15800000"
fn title_of_conditions(report: &SweepReport) -> String {
    match report.conditions.is_empty() {
        true => String::new(),
        false => format!(" where {}", conditions_text(&report.conditions)),
    }
}

/// Points of a curve up to which each is marked.
const MARKED: usize = 51;

fn curve(report: &SweepReport, sweep: &Sweep) -> Chart {
    let points = |part: fn(&SweepPoint) -> f64| -> Vec<[f64; 2]> {
        report.points.iter().map(|point| [short(point.values[0]), short(100.0 * part(point))]).collect()
    };
    let line = |part: fn(&SweepPoint) -> f64| Marks::Line(points(part));
    let band = |end: fn(Interval) -> f64| {
        let ends = report
            .points
            .iter()
            .filter_map(|point| Some([short(point.values[0]), short(100.0 * end(point.surrogate_band?))]));
        Marks::Line(ends.collect())
    };
    let mut series = vec![
        Series::new("surrogate band", Color::Orange, band(|band| band.lower)),
        Series::new("surrogate band", Color::Orange, band(|band| band.upper)),
        Series::new("95 % interval", Color::Gray, line(|point| point.interval.lower)),
        Series::new("95 % interval", Color::Gray, line(|point| point.interval.upper)),
        Series::new("stable", Color::Blue, line(|point| point.stable_proportion)),
    ];
    if report.has_marginal() {
        series.push(Series::new("marginal", Color::Purple, line(|point| point.marginal_proportion)));
    }
    if report.can_diverge || report.has_marginal() {
        series.push(Series::new("flutter", Color::Red, line(|point| point.flutter_proportion)));
        series.push(Series::new("divergence", Color::Green, line(|point| point.divergence_proportion)));
    }
    if report.points.len() <= MARKED {
        let marks = Marks::Symbols(points(|point| point.stable_proportion), Symbol::Circle);
        series.push(Series::new("stable", Color::Blue, marks));
    }
    Chart {
        title: format!("{}: stability over {}{}", report.study, sweep.input, title_of_conditions(report)),
        description: format!(
            "Share of stable samples at {} values of {}, with its interval.",
            sweep.points, sweep.input
        ),
        x: Axis::linear(sweep.input.clone()),
        y: Axis::linear("stable, %").between(0.0, 100.0),
        series,
        guides: Vec::new(),
    }
}

fn map(report: &SweepReport, vertical: &Sweep, horizontal: &Sweep) -> Chart {
    let centres = |sweep: &Sweep| (0..sweep.points).map(|number| short(sweep.value(number))).collect();
    let cells = Cells {
        x: centres(horizontal),
        y: centres(vertical),
        values: report.points.iter().map(|point| point.stable_proportion).collect(),
    };
    Chart {
        title: format!(
            "{}: stability over {} and {}{}",
            report.study,
            vertical.input,
            horizontal.input,
            title_of_conditions(report)
        ),
        description: format!(
            "Share of stable samples at {} values of {} and {} of {}.",
            vertical.points, vertical.input, horizontal.points, horizontal.input
        ),
        x: Axis::linear(horizontal.input.clone()).between(horizontal.from, horizontal.to),
        y: Axis::linear(vertical.input.clone()).between(vertical.from, vertical.to),
        series: vec![Series::new("stable", Color::Blue, Marks::Cells(cells))],
        guides: Vec::new(),
    }
}
