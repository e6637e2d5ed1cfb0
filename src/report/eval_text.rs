//! The answer of `eval` and `reference` as people read it.

use super::eval::{EvalReport, RealReport, SobolReport, Statistics};
use super::survey::{conditions_text, events_text, histogram_text, quantiles_table};
use super::table::{Align, Table, significant};
use pcc_evaluate::evaluation::Sampler;
use pcc_evaluate::foundation::count;
use pcc_evaluate::probability::statistics::Interval;
use std::fmt::{self, Write};

/// Components side by side in a table of Sobol' indices: what fits a terminal.
const SOBOL_COLUMNS: usize = 4;

/// How long samples took, or how many parts they come from.
pub(super) fn pace(samples: f64, seconds: f64, merged_parts: Option<usize>) -> String {
    match merged_parts {
        Some(parts) => format!("from {parts} parts"),
        None => format!("in {seconds:.2} s ({} per second)", rounded(samples / seconds.max(1e-9))),
    }
}

/// A rate as a count with two significant digits: 6 600 000.
fn rounded(rate: f64) -> String {
    let unit = 10f64.powf(rate.max(10.0).log10().floor() - 1.0);
    count(((rate / unit).round() * unit) as u64)
}

impl Statistics {
    fn cells(&self) -> [String; 4] {
        [self.mean, self.variance.sqrt(), self.minimum, self.maximum].map(|value| significant(value, 5))
    }
}

impl EvalReport {
    /// Whether the system can diverge, not only flutter.
    fn can_diverge(&self) -> bool {
        self.divergence_proportion > 0.0 || !self.real_eigenvalues.is_empty()
    }

    /// The answer in a sentence or two.
    pub(super) fn headline(&self) -> String {
        let percent = |share: f64| format!("{:.3} %", 100.0 * share);
        let unanswered = match (self.unanswered_proportion, self.bounds) {
            (Some(share), Some(bounds)) => format!(
                " The model did not answer in {}: between {} and {} are stable.",
                percent(share),
                percent(bounds.stable.lower),
                percent(bounds.stable.upper)
            ),
            _ => String::new(),
        };
        self.verdict() + &unanswered
    }

    fn verdict(&self) -> String {
        let percent = |share: f64| format!("{:.3} %", 100.0 * share);
        let marginal = match self.marginal_proportion > 0.0 {
            true => format!(" Marginal in {}: neither growing nor decaying.", percent(self.marginal_proportion)),
            false => String::new(),
        };
        if self.undamped {
            return format!(
                "Undamped.{marginal} Flutter in {}, divergence in {}.",
                percent(self.flutter_proportion),
                percent(self.divergence_proportion)
            );
        }
        let beyond = if self.margin.is_some() { " with the margin asked for" } else { "" };
        let stable = format!("Stable{beyond} in {} of cases.{marginal}", percent(self.stable_proportion));
        match self.can_diverge() || !marginal.is_empty() {
            true => format!(
                "{stable} Flutter in {}, divergence in {}.",
                percent(self.flutter_proportion),
                percent(self.divergence_proportion)
            ),
            false => stable,
        }
    }
}

impl fmt::Display for EvalReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let how = pace(self.samples as f64, self.elapsed_seconds, self.only_in_text.merged_parts);
        let (study, samples) = (&self.study, count(self.samples));
        let of = if self.undamped { " of an undamped system" } else { "" };
        writeln!(f, "{study}: {samples} samples of the {}{of} {how}, seed {}\n", self.source, self.seed)?;
        let first = usize::from(self.only_in_text.is_contradicted);
        self.warnings[..first].iter().try_for_each(|warning| writeln!(f, "warning: {warning}\n"))?;
        self.write_circumstances(f)?;
        let percent = |share: f64| format!("{:.3} %", 100.0 * share);
        writeln!(f, "  stable                 {}   judged by {}", percent(self.stable_proportion), self.judged_by)?;
        if self.marginal_proportion > 0.0 || self.undamped {
            let marginal = percent(self.marginal_proportion);
            writeln!(f, "  marginal               {marginal}   neither grows nor decays, as far as can be told")?;
        }
        if self.can_diverge() || self.marginal_proportion > 0.0 || self.undamped {
            let [unstable, flutter, divergence] =
                [self.unstable_proportion, self.flutter_proportion, self.divergence_proportion].map(percent);
            writeln!(f, "  unstable               {unstable}   flutter {flutter}, divergence {divergence}")?;
            if self.marginal_proportion > 0.0 {
                let Interval { lower, upper, level } = self.intervals.unstable;
                let range = format!("{} to {}", percent(lower), percent(upper));
                writeln!(f, "                         {range}   {:.0} %, from {samples} samples", 100.0 * level)?;
            }
        }
        if let (Some(unanswered), Some(bounds)) = (self.unanswered_proportion, self.bounds) {
            let [lower, upper] = [bounds.stable.lower, bounds.stable.upper].map(percent);
            writeln!(
                f,
                "  unanswered             {}   the model failed there: {lower} to {upper} are stable",
                percent(unanswered)
            )?;
        }
        if let Some(count) = self.rigid_body_modes.filter(|&count| count > 0) {
            writeln!(f, "  rigid body             {count} of the eigenvalues, zero and left out")?;
        }
        if let Some(band) = &self.band {
            writeln!(f, "  frequencies            {band}")?;
        }
        match self.source {
            "model" => {
                let Interval { lower, upper, level } = self.confidence.interval;
                let range = format!("{} to {}", percent(lower), percent(upper));
                writeln!(f, "  sampling interval      {range}   {:.0} %", 100.0 * level)?;
            }
            _ => write!(f, "{}", self.confidence)?,
        }
        write!(f, "{}", events_text(&self.events))?;
        writeln!(f, "  largest max Re λ       {} 1/s", significant(self.max_re.maximum, 5))?;
        if let Some((low, high)) = self.central_residuals() {
            let [low, high] = [low, high].map(|value| significant(value, 3));
            let place = if self.confidence.basis.is_confined { " in all of the domain" } else { "" };
            writeln!(
                f,
                "  error of max Re λ      {low} to {high} 1/s, model minus surrogate, at 95 % of points left out{place}"
            )?;
        }
        if self.source == "model" && self.modes.is_empty() {
            writeln!(
                f,
                "\nmodes have no ranks in frequency here; pcc compare shows them by the numbers of a surrogate"
            )?;
        } else {
            writeln!(f, "\n{}", self.mode_table())?;
            if let Some(table) = self.kind_table() {
                writeln!(f, "{table}")?;
            }
            write!(f, "{}", self.component_table())?;
            let order = if self.source == "model" { "; modes by rank in frequency at each point" } else { "" };
            writeln!(f, "re in 1/s, im in rad/s{order}")?;
        }
        if let Some(table) = quantiles_table(&self.quantiles) {
            let note =
                "found by counting in bins of the width in the last column; frequency in Hz, im in rad/s, re in 1/s";
            writeln!(f, "\n{table}{note}")?;
        }
        self.histograms.iter().try_for_each(|histogram| write!(f, "\n{}", histogram_text(histogram)))?;
        if let Some(sensitivity) = &self.sensitivity {
            write!(f, "{sensitivity}")?;
        }
        let sobol = self.sobol_table();
        if !sobol.is_empty() {
            write!(f, "\n{sobol}")?;
        }
        if let Some(critical) = &self.critical {
            write!(f, "{critical}")?;
        }
        self.warnings[first..].iter().try_for_each(|warning| writeln!(f, "\nwarning: {warning}"))
    }
}

impl EvalReport {
    /// What is not plain about these samples.
    fn write_circumstances(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.complete {
            let (done, asked) = (count(self.samples), count(self.requested_samples));
            let place = match self.only_in_text.has_all_samples {
                true => "all samples are counted; critical values or Sobol' indices are left out".to_owned(),
                false => format!("interrupted after {done} of {asked} samples; what takes all of them is left out"),
            };
            writeln!(f, "  incomplete             {place}")?;
        }
        if self.sampler != Sampler::MonteCarlo.name() {
            let asked = self.only_in_text.requested_replicates;
            let points = count(self.requested_samples / u64::from(asked.max(1)));
            let done = match self.replicates {
                done if done == asked => format!("{asked} replicates of {points} points"),
                1 => format!("not two of {asked} replicates of {points} points: judged as if points were random"),
                done => format!("{done} of {asked} replicates of {points} points"),
            };
            writeln!(f, "  sampler                {}, {done}", self.sampler)?;
        }
        if !self.conditions.is_empty() {
            writeln!(f, "  where                  {}", conditions_text(&self.conditions))?;
        }
        Ok(())
    }

    /// The residual quantiles at 2.5 and 97.5 %.
    fn central_residuals(&self) -> Option<(f64, f64)> {
        let at = |level: f64| self.max_re_residuals.iter().find(|quantile| quantile.level == level).map(|q| q.value);
        at(0.025).zip(at(0.975))
    }

    pub(super) fn mode_table(&self) -> Table {
        let right = Align::Right;
        let mut table = Table::new(&[
            ("mode", Align::Left),
            ("", Align::Left),
            ("mean", right),
            ("std. dev.", right),
            ("minimum", right),
            ("maximum", right),
            ("unstable", right),
        ]);
        for mode in &self.modes {
            let unstable = format!("{:.2} %", 100.0 * mode.unstable_share);
            let lines = [
                (mode.mode.to_string(), "frequency, Hz", &mode.frequency_hz, unstable),
                (String::new(), "growth rate, 1/s", &mode.growth_rate, String::new()),
                (String::new(), "damping ratio", &mode.damping_ratio, String::new()),
            ];
            for (rank, what, statistics, unstable) in lines {
                let [mean, deviation, minimum, maximum] = statistics.cells();
                table.row([rank, what.to_owned(), mean, deviation, minimum, maximum, unstable]);
            }
        }
        for RealReport { name, growth_rate, divergence_share } in &self.real_eigenvalues {
            let [mean, deviation, minimum, maximum] = growth_rate.cells();
            let unstable = format!("{:.2} %", 100.0 * divergence_share);
            table.row([name.clone(), "growth rate, 1/s".to_owned(), mean, deviation, minimum, maximum, unstable]);
        }
        table
    }

    /// In how many samples modes oscillate, are overdamped, flutter and diverge; empty if all of them always oscillate.
    pub(super) fn kind_table(&self) -> Option<Table> {
        let right = Align::Right;
        let mut table = Table::new(&[
            ("mode", Align::Left),
            ("oscillates", right),
            ("overdamped", right),
            ("flutters", right),
            ("diverges", right),
        ]);
        let varied: Vec<_> = self.modes.iter().filter(|mode| mode.oscillating_share < 1.0).collect();
        for mode in &varied {
            let shares = [mode.oscillating_share, mode.overdamped_share, mode.flutter_share, mode.divergence_share];
            let row = std::iter::once(mode.mode.to_string());
            table.row(row.chain(shares.map(|share| format!("{:.2} %", 100.0 * share))));
        }
        (!varied.is_empty()).then_some(table)
    }

    fn component_table(&self) -> Table {
        let right = Align::Right;
        let mut columns = vec![
            ("component", Align::Left),
            ("mean", right),
            ("std. dev.", right),
            ("minimum", right),
            ("maximum", right),
        ];
        let exact = self.components.iter().any(|component| component.analysis.is_some());
        if exact {
            columns.extend([("mean by coefficients", right), ("std. dev.", right)]);
        }
        let mut table = Table::new(&columns);
        for component in &self.components {
            let mut row = vec![component.name.clone()];
            row.extend(component.samples.cells());
            if let Some(analysis) = &component.analysis {
                row.push(significant(analysis.mean_from_coefficients, 5));
                row.push(significant(analysis.variance_from_coefficients.sqrt(), 5));
            }
            table.row(row);
        }
        table
    }

    /// First-order and total indices, one column per component; empty without coefficients.
    fn sobol_table(&self) -> String {
        let shown: Vec<(&str, &[SobolReport])> = self
            .components
            .iter()
            .filter_map(|component| Some((component.name.as_str(), component.analysis.as_ref()?.sobol.as_slice())))
            .filter(|(_, sobol)| !sobol.is_empty())
            .collect();
        if shown.is_empty() {
            return String::new();
        }
        let mut text = String::new();
        for part in shown.chunks(SOBOL_COLUMNS) {
            let mut columns = vec![("Sobol' index", Align::Left)];
            columns.extend(part.iter().map(|(name, _)| (*name, Align::Right)));
            let mut table = Table::new(&columns);
            for (j, input) in part[0].1.iter().enumerate() {
                let mut row = vec![input.input.clone()];
                row.extend(part.iter().map(|(_, sobol)| format!("{:.4} / {:.4}", sobol[j].first, sobol[j].total)));
                table.row(row);
            }
            let _ = writeln!(text, "{table}");
        }
        text.pop();
        let _ = writeln!(
            text,
            "first order / total: the share of a component's variance that an input causes alone / in all"
        );
        text
    }
}
