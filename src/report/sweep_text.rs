//! A sweep as people read it: a table for one input, a map of characters for two.

use super::eval_text::pace;
use super::layout::{Facts, width, wrapped, write_verdict, write_warnings};
use super::numbers::{interval, plain, share, significant};
use super::survey::conditions_text;
use super::sweep::{SweepPoint, SweepReport};
use super::table::{Align, Table};
use pcc_evaluate::evaluation::Sampler;
use pcc_evaluate::foundation::{count, plural};
use std::fmt;

/// Lengths of the longest bar, in characters: at most, and what is worth drawing.
const LONGEST_BAR: usize = 40;
const SHORTEST_BAR: usize = 10;

/// Lines and characters of a map on a terminal, at most.
const MOST_ROWS: u32 = 51;
const MOST_COLUMNS: usize = 101;

impl fmt::Display for SweepReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = width(f);
        write_warnings(f, &self.warnings)?;
        write_verdict(f, &self.verdict)?;
        writeln!(f, "{:columns$}", self.facts())?;
        match self.sweeps.len() {
            _ if self.points.is_empty() => {}
            2 => self.write_map(f, columns)?,
            _ => write!(f, "{:columns$}", self.table(columns))?,
        }
        let how = pace(self.samples as f64 * self.points.len() as f64, self.elapsed_seconds, self.merged_parts);
        let last = format!("{} each {how}, seed {}", plural(self.samples as usize, "sample"), self.seed);
        writeln!(f, "\n{}", wrapped(&last, columns, 0))?;
        match self.files.is_empty() {
            true => Ok(()),
            false => writeln!(f, "written to {}", self.files.join(", ")),
        }
    }
}

impl SweepReport {
    /// From where to where the share goes.
    pub(super) fn verdict_sentence(&self) -> String {
        let shares = || self.points.iter().map(|point| self.kept(point));
        let (least, most) = (shares().fold(f64::INFINITY, f64::min), shares().fold(0.0, f64::max));
        let inputs: Vec<&str> = self.sweeps.iter().map(|sweep| sweep.input.as_str()).collect();
        let points = plural(self.points.len(), "point");
        let over = format!("{}: over {points} of {}", self.study, inputs.join(" and "));
        match self.points.is_empty() {
            true => format!("{over} nothing is known yet."),
            false => format!("{over} between {} and {} of cases are {}.", share(least), share(most), self.kept_name()),
        }
    }

    /// The share of stable samples; of an undamped system, which has none, of those that are not unstable.
    fn kept(&self, point: &SweepPoint) -> f64 {
        let marginal = if self.has_marginal() { point.marginal_proportion } else { 0.0 };
        point.stable_proportion + marginal
    }

    fn kept_name(&self) -> &'static str {
        if self.has_marginal() { "stable or marginal" } else { "stable" }
    }

    fn facts(&self) -> Facts {
        let mut facts = Facts::default();
        if !self.complete {
            let all: u64 = self.sweeps.iter().map(|sweep| u64::from(sweep.points)).product();
            let done = count(self.points.len() as u64);
            let tables = "no table or chart is written";
            facts.add("incomplete", format!("interrupted after {done} of {} points; {tables}", count(all)), "");
        }
        if self.sampler != Sampler::MonteCarlo.name() {
            facts.add("sampler", format!("{}, {} replicates", self.sampler, self.replicates), "");
        }
        if let Some(dependence) = &self.dependence {
            facts.add("dependence", dependence.in_words(), "correlations of ranks");
        }
        if !self.conditions.is_empty() {
            facts.add("where", conditions_text(&self.conditions, &self.inputs), "");
        }
        facts.add("judged by", self.judged_by.clone(), "");
        facts.add("surrogate band", self.width_of_band(), "");
        facts
    }

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
    fn table(&self, width: usize) -> Table {
        let right = Align::Right;
        let swept: Vec<String> = self.sweeps.iter().map(|sweep| self.head(sweep)).collect();
        let mut columns: Vec<(&str, Align)> = swept.iter().map(|head| (head.as_str(), right)).collect();
        columns.extend([("stable", right), ("95 % interval", right)]);
        let has_marginal = self.has_marginal();
        let has_unanswered = self.points.iter().any(|point| point.bounds.is_some());
        columns.extend(has_unanswered.then_some(("whatever it would answer", right)));
        columns.extend(has_marginal.then_some(("marginal", right)));
        if self.can_diverge {
            columns.extend([("flutter", right), ("divergence", right)]);
        }
        let events = self.points.first().map_or(&[][..], |point| &point.events);
        columns.extend(events.iter().map(|event| (event.event.as_str(), right)));
        let mut table = Table::new(&columns);
        for point in &self.points {
            let mut row: Vec<String> = point.values.iter().map(|&value| plain(value)).collect();
            row.extend([share(point.stable_proportion), interval(&point.interval)]);
            let bounds = || point.bounds.map_or(String::new(), |bounds| interval(&bounds.stable));
            row.extend(has_unanswered.then(bounds));
            row.extend(has_marginal.then(|| share(point.marginal_proportion)));
            if self.can_diverge {
                row.extend([point.flutter_proportion, point.divergence_proportion].map(share));
            }
            row.extend(point.events.iter().map(|event| share(event.proportion)));
            table.row(row);
        }
        let longest = width.saturating_sub(table.width() + 2).min(LONGEST_BAR);
        if longest < SHORTEST_BAR {
            return table;
        }
        let bar = |share: f64| "█".repeat((longest as f64 * share.clamp(0.0, 1.0)).round() as usize);
        table.with_last_column("", self.points.iter().map(|point| bar(point.stable_proportion)))
    }

    /// One character per point: rows are the first sweep, from its last value down, columns the second.
    fn write_map(&self, f: &mut fmt::Formatter<'_>, available: usize) -> fmt::Result {
        let [vertical, horizontal] = &self.sweeps[..] else { return Ok(()) };
        let columns = horizontal.points as usize;
        let label = |row: usize| plain(vertical.value(row as u32));
        let width = (0..vertical.points as usize).map(|row| label(row).chars().count()).max().unwrap_or(0);
        let most_columns = available.saturating_sub(width + 3).clamp(1, MOST_COLUMNS) as u32;
        let (row_step, column_step) = (vertical.points.div_ceil(MOST_ROWS), horizontal.points.div_ceil(most_columns));
        writeln!(f, "{:>width$}   {}: 0 to 9 tenths, · none, # all", self.head(vertical), self.kept_name())?;
        let rows = self.points.chunks(columns).enumerate().filter(|(row, _)| row.is_multiple_of(row_step as usize));
        for (row, points) in rows.collect::<Vec<_>>().into_iter().rev() {
            let shown = points.iter().step_by(column_step as usize);
            let line: String = shown.map(|point| symbol(self.kept(point))).collect();
            writeln!(f, "{:>width$}  |{line}", label(row))?;
        }
        let (from, to) = (plain(horizontal.from), plain(horizontal.to));
        let gap =
            columns.div_ceil(column_step as usize).saturating_sub(from.chars().count() + to.chars().count()).max(1);
        let over = format!("{:width$}   {from}{}{to}", "", " ".repeat(gap));
        let head = self.head(horizontal);
        match over.chars().count() + 2 + head.chars().count() <= available {
            true => writeln!(f, "{over}  {head}")?,
            false => writeln!(f, "{over}\n{:width$}   {head}", "")?,
        }
        if row_step > 1 || column_step > 1 {
            writeln!(
                f,
                "shown: one of {row_step} rows and one of {column_step} columns; --table and --chart have all"
            )?;
        }
        Ok(())
    }
}

fn symbol(kept: f64) -> char {
    match kept {
        kept if kept <= 0.0 => '·',
        kept if kept >= 1.0 => '#',
        kept => char::from_digit((10.0 * kept) as u32, 10).unwrap_or('9'),
    }
}
