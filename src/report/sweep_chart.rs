//! A sweep as a picture: a curve with its interval for one input, a map for two.

use super::charts::short;
use super::survey::conditions_text;
use super::sweep::{SweepPoint, SweepReport};
use pcc_charts::{Axis, Cells, Chart, Color, Marks, Series, Symbol, sheet};
use pcc_evaluate::evaluation::Sweep;
use pcc_evaluate::probability::statistics::Interval;

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
        false => format!(" where {}", conditions_text(&report.conditions, &report.inputs)),
    }
}

/// Points of a curve up to which each is marked.
const MARKED: usize = 51;

/// Where less than this is unstable everywhere, that is what is drawn: beside 100 % it would not be seen.
const RARE: f64 = 0.01;

fn curve(report: &SweepReport, sweep: &Sweep) -> Chart {
    let is_rare = !report.has_marginal() && report.points.iter().all(|point| point.stable_proportion > 1.0 - RARE);
    let percent = |stable: f64| short(100.0 * if is_rare { 1.0 - stable } else { stable });
    let named = if is_rare { "unstable" } else { "stable" };
    let points = |part: fn(&SweepPoint) -> f64| -> Vec<[f64; 2]> {
        report.points.iter().map(|point| [short(point.values[0]), short(100.0 * part(point))]).collect()
    };
    let line = |part: fn(&SweepPoint) -> f64| Marks::Line(points(part));
    let shares = |part: fn(&SweepPoint) -> f64| -> Vec<[f64; 2]> {
        report.points.iter().map(|point| [short(point.values[0]), percent(part(point))]).collect()
    };
    let band = |end: fn(Interval) -> f64| {
        let ends = report
            .points
            .iter()
            .filter_map(|point| Some([short(point.values[0]), percent(end(point.surrogate_band?))]));
        Marks::Line(ends.collect())
    };
    let mut series = vec![
        Series::new("surrogate band", Color::Orange, band(|band| band.lower)),
        Series::new("surrogate band", Color::Orange, band(|band| band.upper)),
        Series::new("95 % interval", Color::Gray, Marks::Line(shares(|point| point.interval.lower))),
        Series::new("95 % interval", Color::Gray, Marks::Line(shares(|point| point.interval.upper))),
        Series::new(named, Color::Blue, Marks::Line(shares(|point| point.stable_proportion))),
    ];
    if report.has_marginal() {
        series.push(Series::new("marginal", Color::Purple, line(|point| point.marginal_proportion)));
    }
    if report.can_diverge || report.has_marginal() {
        series.push(Series::new("flutter", Color::Red, line(|point| point.flutter_proportion)));
        series.push(Series::new("divergence", Color::Green, line(|point| point.divergence_proportion)));
    }
    if report.points.len() <= MARKED {
        let marks = Marks::Symbols(shares(|point| point.stable_proportion), Symbol::Circle);
        series.push(Series::new(named, Color::Blue, marks));
    }
    Chart {
        title: format!("{}: stability over {}{}", report.study, sweep.input, title_of_conditions(report)),
        description: report.verdict.clone(),
        x: Axis::linear(report.title(sweep)),
        y: if is_rare { Axis::linear("unstable, %") } else { Axis::linear("stable, %").between(0.0, 100.0) },
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
        description: report.verdict.clone(),
        x: Axis::linear(report.title(horizontal)).between(horizontal.from, horizontal.to),
        y: Axis::linear(report.title(vertical)).between(vertical.from, vertical.to),
        series: vec![Series::new("stable", Color::Blue, Marks::Cells(cells))],
        guides: Vec::new(),
    }
}
