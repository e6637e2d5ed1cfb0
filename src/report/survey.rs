//! What else was counted: events, histograms, quantiles; and what the samples were confined to.

use super::layout::Facts;
use super::numbers::{self, level, plain, share, significant};
use super::table::{Align, Table};
use pcc_evaluate::evaluation::{Bins, Cell, Condition, Histogram, Question};
use pcc_evaluate::foundation::count;
use pcc_evaluate::probability::inputs::Input;
use pcc_evaluate::probability::statistics::Interval;
use serde::Serialize;

/// Confidence level of the printed intervals.
pub(super) const LEVEL: f64 = 0.95;

/// Relative width of histograms whose edges would all look the same.
const NARROW: f64 = 1e-5;

/// Width of the longest bar of a histogram, in characters, and of what stands before it.
const LONGEST_BAR: usize = 50;
const BEFORE_BAR: usize = 40;

/// Samples in which a quantity is below or above a value.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EventReport {
    /// As asked: `max_re<-1.0`.
    pub event: String,
    /// How many.
    pub samples: u64,
    /// Their share.
    pub proportion: f64,
    /// Interval of the share.
    pub interval: Interval,
}

/// Samples in equal bins.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistogramReport {
    /// Name of the quantity.
    pub quantity: String,
    /// Lower edge of the first bin.
    pub lower: f64,
    /// Upper edge of the last bin.
    pub upper: f64,
    /// Samples below the lower edge.
    pub below: u64,
    /// Samples in each bin.
    pub counts: Vec<u64>,
    /// Samples above the upper edge.
    pub above: u64,
}

/// Quantiles of one quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct QuantilesReport {
    /// Name of the quantity.
    pub quantity: String,
    /// How far a value can be off because samples were counted in bins.
    pub resolution: f64,
    /// The values; null where one lies outside of the bins.
    pub quantiles: Vec<LevelReport>,
}

/// One quantile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LevelReport {
    /// Probability not to be exceeded.
    pub level: f64,
    /// The value.
    pub value: Option<f64>,
}

/// The events of a question.
pub(super) fn events(question: &Question, cell: &Cell) -> Vec<EventReport> {
    let report = |(number, event): (usize, &pcc_evaluate::evaluation::Event)| {
        let share = cell.share(LEVEL, |tally| tally.events[number]);
        let samples = cell.total.events[number];
        EventReport { event: event.text(), samples, proportion: share.value, interval: share.interval }
    };
    question.events.iter().enumerate().map(report).collect()
}

/// The histograms of a question, and the quantiles from the fine ones.
pub(super) fn histograms(question: &Question, found: &[Histogram]) -> (Vec<HistogramReport>, Vec<QuantilesReport>) {
    let (shown, fine) = found.split_at(question.histograms.len().min(found.len()));
    let histogram = |(bins, found): (&Bins, &Histogram)| HistogramReport {
        quantity: bins.quantity.clone(),
        lower: bins.lower,
        upper: bins.upper,
        below: found.below,
        counts: found.counts.clone(),
        above: found.above,
    };
    let quantiles = |(bins, found): (&Bins, &Histogram)| QuantilesReport {
        quantity: bins.quantity.clone(),
        resolution: (bins.upper - bins.lower) / f64::from(bins.bins),
        quantiles: question
            .quantile_levels
            .iter()
            .map(|&level| LevelReport { level, value: found.quantile(bins, level) })
            .collect(),
    };
    (
        question.histograms.iter().zip(shown).map(histogram).collect(),
        question.quantile_bins.iter().zip(fine).map(quantiles).collect(),
    )
}

/// "mu from 0.1 to 0.2, k_p = 15800000 N/m"
pub(super) fn conditions_text(conditions: &[Condition], inputs: &[Input]) -> String {
    let text = |condition: &Condition| {
        let Condition { input, lower, upper } = condition;
        let unit = inputs.iter().find(|one| one.name == *input).and_then(|input| input.description.unit());
        let unit = unit.map_or(String::new(), |unit| format!(" {unit}"));
        match lower == upper {
            true => format!("{input} = {}{unit}", plain(*lower)),
            false => format!("{input} from {} to {}{unit}", plain(*lower), plain(*upper)),
        }
    };
    conditions.iter().map(text).collect::<Vec<_>>().join(", ")
}

/// One line per event.
pub(super) fn add_events(facts: &mut Facts, events: &[EventReport]) {
    for EventReport { event, samples, proportion, interval } in events {
        let words = format!("{}, {}, {} samples", numbers::interval(interval), level(interval.level), count(*samples));
        facts.add(event, share(*proportion), words);
    }
}

/// One row per quantity, one column per level.
pub(super) fn quantiles_table(quantiles: &[QuantilesReport]) -> Option<Table> {
    let levels: Vec<String> = quantiles.first()?.quantiles.iter().map(|quantile| level(quantile.level)).collect();
    let mut columns = vec![("quantile", Align::Left)];
    columns.extend(levels.iter().map(|level| (level.as_str(), Align::Right)));
    columns.push(("to within", Align::Right));
    let mut table = Table::new(&columns);
    for report in quantiles {
        let values = report.quantiles.iter().map(|quantile| match quantile.value {
            Some(value) => significant(value, 5),
            None => "beyond".to_owned(),
        });
        let row = std::iter::once(report.quantity.clone()).chain(values);
        table.row(row.chain([significant(report.resolution, 2)]));
    }
    Some(table)
}

/// One line per bin, with a bar.
pub(super) fn histogram_text(histogram: &HistogramReport, columns: usize) -> String {
    let HistogramReport { quantity, lower, upper, below, counts, above } = histogram;
    if upper - lower < NARROW * lower.abs().max(upper.abs()) {
        let samples = count(below + counts.iter().sum::<u64>() + above);
        return format!("histogram of {quantity}\nall {samples} samples are near {}\n", plain(*lower));
    }
    let longest = LONGEST_BAR.min(columns.saturating_sub(BEFORE_BAR));
    let most = counts.iter().copied().max().unwrap_or(0).max(1);
    let width = (upper - lower) / counts.len().max(1) as f64;
    let mut table =
        Table::new(&[("from", Align::Right), ("to", Align::Right), ("samples", Align::Right), ("", Align::Left)]);
    if *below > 0 {
        table.row(["below".to_owned(), plain(*lower), count(*below), String::new()]);
    }
    for (number, &samples) in counts.iter().enumerate() {
        let edge = |number: usize| plain(rounded_to(lower + width * number as f64, width));
        let bar = (longest as f64 * samples as f64 / most as f64).round() as usize;
        table.row([edge(number), edge(number + 1), count(samples), "█".repeat(bar)]);
    }
    if *above > 0 {
        table.row(["above".to_owned(), plain(*upper), count(*above), String::new()]);
    }
    format!("histogram of {quantity}\n{table:columns$}")
}

/// Zero if an edge is zero but for rounding.
fn rounded_to(edge: f64, width: f64) -> f64 {
    if edge.abs() < 1e-9 * width { 0.0 } else { edge }
}
