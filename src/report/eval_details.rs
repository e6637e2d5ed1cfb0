//! Every detail of an answer of `eval` and `reference`: all modes, all components, all indices.

use super::eval::{EvalReport, RealReport, SobolReport, Statistics};
use super::extrapolation;
use super::layout::{Facts, width, wrapped};
use super::numbers::{share, significant};
use super::table::{Align, Table};
use std::fmt::{self, Write};

/// Significant digits in tables: what fits, and more than samples know.
const DIGITS: usize = 4;

impl Statistics {
    fn cells(&self) -> [String; 4] {
        [self.mean, self.variance.sqrt(), self.minimum, self.maximum].map(|value| significant(value, DIGITS))
    }
}

impl EvalReport {
    pub(super) fn write_details(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = width(f);
        let mut facts = Facts::default();
        facts.add("largest max Re λ", format!("{} 1/s", significant(self.max_re.maximum, 5)), "");
        if let Some((low, high)) = self.central_residuals() {
            let [low, high] = [low, high].map(|value| significant(value, 3));
            let place = if self.confidence.basis.is_confined { ", in all of the domain" } else { "" };
            let words = format!("model minus surrogate, at 95 % of points left out{place}");
            facts.add("error of max Re λ", format!("{low} to {high} 1/s"), words);
        }
        if let Some((name, value, words)) = self.extrapolation() {
            facts.add(name, value, words);
        }
        writeln!(f, "{facts:columns$}")?;
        if self.has_ranks() {
            writeln!(f, "{:columns$}", self.mode_table())?;
            if let Some(table) = self.kind_table() {
                writeln!(f, "{table:columns$}")?;
            }
            write!(f, "{:columns$}", self.component_table())?;
            let order = if self.source == "model" { "; modes by rank in frequency at each point" } else { "" };
            writeln!(f, "re in 1/s, im in rad/s{order}")?;
        }
        if let Some(sensitivity) = &self.sensitivity {
            write!(f, "{sensitivity:columns$}")?;
        }
        if let Some(shapley) = &self.shapley {
            write!(f, "{shapley:columns$}")?;
        }
        let sobol = self.sobol_table(columns);
        if sobol.is_empty() { Ok(()) } else { write!(f, "\n{sobol}") }
    }

    /// Which share of the samples lies beyond all model runs, and what that leaves open.
    pub(super) fn extrapolation(&self) -> Option<(&'static str, String, String)> {
        let (proportion, bounds) = (self.extrapolated_proportion?, self.extrapolated_bounds.as_ref()?);
        let words = format!("beyond all model runs in some input; {}", extrapolation::consequence(bounds));
        Some(("extrapolated", share(proportion), words))
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
            let unstable = share(mode.unstable_share);
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
            let unstable = share(*divergence_share);
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
            table.row(row.chain(shares.map(share)));
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
            columns.extend([("exact mean", right), ("std. dev.", right)]);
        }
        let mut table = Table::new(&columns);
        for component in &self.components {
            let mut row = vec![component.name.clone()];
            row.extend(component.samples.cells());
            if let Some(analysis) = &component.analysis {
                row.push(significant(analysis.mean_from_coefficients, DIGITS));
                row.push(significant(analysis.variance_from_coefficients.sqrt(), DIGITS));
            }
            table.row(row);
        }
        table
    }

    /// First-order and total indices, one column per component; empty without coefficients.
    fn sobol_table(&self, width: usize) -> String {
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
        let mut columns = vec![("Sobol' index", Align::Left)];
        columns.extend(shown.iter().map(|(name, _)| (*name, Align::Right)));
        let mut table = Table::new(&columns);
        for (j, input) in shown[0].1.iter().enumerate() {
            let mut row = vec![input.input.clone()];
            row.extend(shown.iter().map(|(_, sobol)| format!("{:.4} / {:.4}", sobol[j].first, sobol[j].total)));
            table.row(row);
        }
        let _ = writeln!(text, "{table:width$}");
        let note = "first order / total: the share of a component's variance that an input causes alone / in all";
        text.pop();
        let _ = writeln!(text, "{}", wrapped(note, width, 0));
        text
    }
}
