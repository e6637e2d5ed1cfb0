//! The stability proportion along one input, or over two.

use super::charts::short;
use super::survey::{EventReport, LEVEL, conditions_text, events};
use super::table::{Align, Table, count, plain};
use crate::eval::{Answer, Cell, Condition, Question, Sweep};
use crate::plot::{Axis, Cells, Chart, Color, Marks, Series, sheet};
use crate::statistics::Interval;
use crate::surrogate::Surrogate;
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
    /// Interval of the share: what the finite number of samples leaves open.
    pub interval: Interval,
    /// Other events that were counted.
    pub events: Vec<EventReport>,
}

impl SweepReport {
    /// The report of an answer to a question with sweeps.
    pub fn new(surrogate: &Surrogate, question: &Question, answer: &Answer, elapsed_seconds: f64) -> Self {
        let point = |(number, cell): (usize, &Cell)| {
            let share = cell.share(LEVEL, |tally| tally.summary.stable);
            SweepPoint {
                values: values(&question.sweeps, number),
                stable_samples: cell.total.summary.stable,
                stable_proportion: share.value,
                interval: share.interval,
                events: events(question, cell),
            }
        };
        Self {
            study: surrogate.provenance.study_name.clone(),
            source: "surrogate",
            complete: answer.is_complete,
            samples: question.samples,
            seed: question.seed,
            sampler: question.sampler.name(),
            replicates: question.replicates,
            conditions: question.conditions.clone(),
            sweeps: question.sweeps.clone(),
            points: answer.cells.iter().enumerate().map(point).collect(),
            elapsed_seconds,
        }
    }

    /// The points as CSV: values, samples, stable samples, stable proportion, its interval, the share of each event.
    ///
    /// # Errors
    ///
    /// [`csv::Error`], which writing to memory does not raise.
    pub fn to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let mut header: Vec<String> = self.sweeps.iter().map(|sweep| sweep.input.clone()).collect();
        header.extend(["samples", "stable_samples", "stable_proportion", "lower", "upper"].map(str::to_owned));
        header.extend(self.points.first().iter().flat_map(|point| &point.events).map(|event| event.event.clone()));
        writer.write_record(&header)?;
        for point in &self.points {
            let mut row: Vec<String> = point.values.iter().map(f64::to_string).collect();
            row.extend([self.samples, point.stable_samples].map(|number| number.to_string()));
            let Interval { lower, upper, .. } = point.interval;
            row.extend([point.stable_proportion, lower, upper].map(|share| share.to_string()));
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
        let samples = self.samples as f64 * self.points.len() as f64;
        let rate = super::eval_text::rounded(samples / self.elapsed_seconds.max(1e-9));
        writeln!(
            f,
            "{}: {} points with {} samples each of the surrogate in {:.2} s ({rate} per second), seed {}",
            self.study,
            count(self.points.len() as u64),
            count(self.samples),
            self.elapsed_seconds,
            self.seed
        )?;
        if !self.complete {
            writeln!(f, "incomplete: interrupted before the last points")?;
        }
        if !self.conditions.is_empty() {
            writeln!(f, "where {}", conditions_text(&self.conditions))?;
        }
        match self.sweeps.len() {
            2 => self.write_map(f),
            _ => write!(f, "\n{}", self.table()),
        }
    }
}

impl SweepReport {
    /// One line per point, with a bar.
    fn table(&self) -> Table {
        let percent = |share: f64| format!("{:.3} %", 100.0 * share);
        let right = Align::Right;
        let mut columns: Vec<(&str, Align)> = self.sweeps.iter().map(|sweep| (sweep.input.as_str(), right)).collect();
        columns.extend([("stable", right), ("from", right), ("to", right)]);
        let events = self.points.first().map_or(&[][..], |point| &point.events);
        columns.extend(events.iter().map(|event| (event.event.as_str(), right)));
        columns.push(("", Align::Left));
        let mut table = Table::new(&columns);
        for point in &self.points {
            let mut row: Vec<String> = point.values.iter().map(|&value| plain(value)).collect();
            row.extend([point.stable_proportion, point.interval.lower, point.interval.upper].map(percent));
            row.extend(point.events.iter().map(|event| percent(event.proportion)));
            row.push("█".repeat((LONGEST_BAR * point.stable_proportion).round() as usize));
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
        writeln!(f, "\n{:>width$}   stable: 0 to 9 tenths, · none, # all", vertical.input)?;
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

fn curve(report: &SweepReport, sweep: &Sweep) -> Chart {
    let line = |part: fn(&SweepPoint) -> f64| {
        let points = report.points.iter().map(|point| [short(point.values[0]), short(100.0 * part(point))]);
        Marks::Line(points.collect())
    };
    Chart {
        title: format!("{}: stability over {}", report.study, sweep.input),
        description: format!(
            "Share of stable samples at {} values of {}, with its interval.",
            sweep.points, sweep.input
        ),
        x: Axis::linear(sweep.input.clone()),
        y: Axis::linear("stable, %").between(0.0, 100.0),
        series: vec![
            Series::new("95 % interval", Color::Gray, line(|point| point.interval.lower)),
            Series::new("95 % interval", Color::Gray, line(|point| point.interval.upper)),
            Series::new("stable", Color::Blue, line(|point| point.stable_proportion)),
        ],
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
        title: format!("{}: stability over {} and {}", report.study, vertical.input, horizontal.input),
        description: format!(
            "Share of stable samples at {} values of {} and {} of {}.",
            vertical.points, vertical.input, horizontal.points, horizontal.input
        ),
        x: Axis::linear(horizontal.input.clone()),
        y: Axis::linear(vertical.input.clone()),
        series: vec![Series::new("stable", Color::Blue, Marks::Cells(cells))],
        guides: Vec::new(),
    }
}
