//! The answer of `eval` and `reference`: stability and what engineers read of each mode.

use super::build::FitReport;
use super::sensitivity::{CriticalReport, SensitivityReport};
use super::sureness::Sureness;
use super::survey::{
    EventReport, HistogramReport, LEVEL, QuantilesReport, conditions_text, events, events_text, histogram_text,
    histograms, quantiles_table,
};
use super::table::{Align, Table, count, significant};
use crate::eval::{Answer, Condition, CriticalValues, Question, Sampler, Sensitivities};
use crate::spectrum::{ModeSummary, Output, Summary};
use crate::statistics::{Interval, Moments, Share};
use crate::surrogate::{Quantile, Surrogate};
use serde::Serialize;
use std::f64::consts::TAU;
use std::fmt::{self, Write};

/// Statistics over samples, from a surrogate or from the model itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EvalReport {
    /// Name of the study.
    pub study: String,
    /// Whether model or surrogate was sampled.
    pub source: &'static str,
    /// Number of samples.
    pub samples: u64,
    /// Whether these are all samples that were asked for; false after an interruption.
    pub complete: bool,
    /// Seed of the samples.
    pub seed: u64,
    /// How samples are drawn.
    pub sampler: &'static str,
    /// Independent randomisations that the samples are divided among.
    pub replicates: u32,
    /// Inputs that are confined or fixed.
    pub conditions: Vec<Condition>,
    /// Number of stable samples, max Re λ < 0.
    pub stable_samples: u64,
    /// Their share.
    pub stable_proportion: f64,
    /// Standard error of the share: from the spread of replicates, or of independent samples.
    pub standard_error: f64,
    /// How sure that is.
    #[serde(flatten)]
    pub sureness: Sureness,
    /// Spectral abscissa max Re λ, in 1/s.
    pub max_re: Statistics,
    /// What engineers read, per mode.
    pub modes: Vec<ModeReport>,
    /// Every component.
    pub components: Vec<ComponentReport>,
    /// Sobol' indices of what decides stability; absent for a model.
    pub sensitivity: Option<SensitivityReport>,
    /// The critical value of an input, if asked for.
    pub critical: Option<CriticalReport>,
    /// Other events that were counted.
    pub events: Vec<EventReport>,
    /// Histograms that were asked for.
    pub histograms: Vec<HistogramReport>,
    /// Quantiles, if asked for.
    pub quantiles: Vec<QuantilesReport>,
    /// What to know before trusting a surrogate.
    pub warnings: Vec<String>,
    /// Quantiles of max Re λ of the model minus its leave-one-out prediction, in 1/s, from the file; empty for a model.
    pub max_re_residuals: Vec<QuantileReport>,
    /// Wall-clock time.
    pub elapsed_seconds: f64,
}

/// Moments and range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Statistics {
    /// Mean.
    pub mean: f64,
    /// Unbiased variance.
    pub variance: f64,
    /// Smallest sample.
    pub minimum: f64,
    /// Largest sample.
    pub maximum: f64,
}

/// One mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModeReport {
    /// Frequency rank, from 1.
    pub mode: usize,
    /// Im λ/2π, in Hz.
    pub frequency_hz: Statistics,
    /// Re λ, in 1/s.
    pub growth_rate: Statistics,
    /// −Re λ/|λ|.
    pub damping_ratio: Statistics,
    /// Share of samples in which this mode is unstable, Re λ ≥ 0.
    pub unstable_share: f64,
}

/// One component.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComponentReport {
    /// Name.
    pub name: String,
    /// Statistics of the samples.
    #[serde(flatten)]
    pub samples: Statistics,
    /// The same moments exactly, and Sobol' indices; absent for a model.
    #[serde(flatten)]
    pub analysis: Option<Analysis>,
}

/// What follows from the coefficients without sampling.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Analysis {
    /// Mean from the coefficients.
    pub mean_from_coefficients: f64,
    /// Variance from the coefficients.
    pub variance_from_coefficients: f64,
    /// Sobol' indices per input; empty if the component does not vary.
    pub sobol: Vec<SobolReport>,
}

/// Sobol' indices of one input.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SobolReport {
    /// Name of the input.
    pub input: String,
    /// First order.
    pub first: f64,
    /// Total.
    pub total: f64,
}

/// A quantile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct QuantileReport {
    /// Probability to be undercut.
    pub level: f64,
    /// Its value.
    pub value: f64,
}

/// Components side by side in a table of Sobol' indices: what fits a terminal.
const SOBOL_COLUMNS: usize = 4;

/// A surrogate, what was asked of it, and what it answers.
#[derive(Debug, Clone, Copy)]
pub struct Asked<'a> {
    /// The surrogate.
    pub surrogate: &'a Surrogate,
    /// The question.
    pub question: &'a Question,
    /// The answer.
    pub answer: &'a Answer,
    /// Wall-clock time of the samples.
    pub elapsed_seconds: f64,
}

impl EvalReport {
    /// The report of a surrogate's samples; `None` if there are none.
    pub fn of_surrogate(asked: Asked<'_>, indices: Option<&Sensitivities>) -> Option<Self> {
        let Asked { surrogate, question, answer, elapsed_seconds } = asked;
        let cell = answer.cells.first()?;
        let (name, summary) = (&surrogate.provenance.study_name, &cell.total.summary);
        let mut report = Self::new(name, "surrogate", &surrogate.outputs, summary, question.seed, elapsed_seconds);
        let is_whole = question.conditions.is_empty();
        if is_whole {
            for (component, analysis) in report.components.iter_mut().zip(analyses(surrogate)) {
                component.analysis = Some(analysis);
            }
        }
        let (stable, share) = (summary.stable_proportion(), cell.share(LEVEL, |tally| tally.summary.stable));
        report.complete = answer.is_complete;
        report.sampler = question.sampler.name();
        report.replicates = question.replicates;
        report.conditions = question.conditions.clone();
        report.standard_error = share.standard_error;
        report.sureness = Sureness::new(surrogate, stable, summary.stable_if_shifted, share.interval);
        report.sureness.replicates = cell.replicates.len() as u64;
        if !is_whole {
            report.sureness.confine();
        }
        let free = |name: &&str| !question.conditions.iter().any(|c| c.input == *name && c.lower == c.upper);
        report.sensitivity = indices.map(|indices| {
            let mut sensitivity = SensitivityReport::new(surrogate.inputs.names(), indices);
            sensitivity.inputs.retain(|input| free(&input.input.as_str()));
            sensitivity
        });
        report.events = events(question, cell);
        (report.histograms, report.quantiles) = histograms(question, &answer.histograms);
        report.warnings = FitReport::warnings_of(surrogate);
        report.warnings.extend(unbalanced(question));
        let quantile = |quantile: &Quantile| QuantileReport { level: quantile.level, value: quantile.value };
        report.max_re_residuals = surrogate.decision.max_re_residuals.iter().map(quantile).collect();
        Some(report)
    }

    /// Adds the distribution of the critical value of an input.
    pub fn add_critical_values(&mut self, surrogate: &Surrogate, input: usize, found: &CriticalValues) {
        let name = surrogate.inputs.names().nth(input).unwrap_or_default();
        self.critical = Some(CriticalReport::new(name, found));
    }

    /// The report of direct computations.
    pub fn of_model(study: &str, outputs: &[Output], summary: &Summary, seed: u64, elapsed_seconds: f64) -> Self {
        Self::new(study, "model", outputs, summary, seed, elapsed_seconds)
    }

    fn new(
        study: &str,
        source: &'static str,
        outputs: &[Output],
        summary: &Summary,
        seed: u64,
        elapsed_seconds: f64,
    ) -> Self {
        let stable = summary.stable_proportion();
        let ranks = outputs.iter().flat_map(|output| output.modes.iter().copied());
        let mut names: Vec<_> = outputs.iter().flat_map(|output| &output.components).collect();
        names.sort_by_key(|component| component.id);
        Self {
            study: study.to_owned(),
            source,
            samples: stable.samples,
            complete: true,
            seed,
            sampler: Sampler::MonteCarlo.name(),
            replicates: 1,
            conditions: Vec::new(),
            stable_samples: stable.hits,
            stable_proportion: stable.value(),
            standard_error: Share::of_replicates(&[stable], LEVEL).standard_error,
            sureness: Sureness {
                interval: stable.wilson(LEVEL),
                samples: stable.samples,
                replicates: 1,
                is_confined: false,
                surrogate_band: None,
                estimated_error_percent: None,
                of_modes_left_out: false,
                verified_bound: None,
            },
            max_re: Statistics::of(&summary.max_re, 1.0),
            modes: ranks.zip(&summary.modes).map(|(mode, part)| mode_report(mode, part, stable.samples)).collect(),
            components: names
                .into_iter()
                .zip(&summary.components)
                .map(|(component, moments)| ComponentReport {
                    name: component.name.clone(),
                    samples: Statistics::of(moments, 1.0),
                    analysis: None,
                })
                .collect(),
            sensitivity: None,
            critical: None,
            events: Vec::new(),
            histograms: Vec::new(),
            quantiles: Vec::new(),
            warnings: Vec::new(),
            max_re_residuals: Vec::new(),
            elapsed_seconds,
        }
    }
}

impl Statistics {
    fn of(moments: &Moments, unit: f64) -> Self {
        Self {
            mean: moments.mean() * unit,
            variance: moments.variance() * unit * unit,
            minimum: moments.minimum() * unit,
            maximum: moments.maximum() * unit,
        }
    }

    fn cells(&self) -> [String; 4] {
        [self.mean, self.variance.sqrt(), self.minimum, self.maximum].map(|value| significant(value, 5))
    }
}

/// A rate as a count with two significant digits: 6 600 000.
pub(super) fn rounded(rate: f64) -> String {
    let unit = 10f64.powf(rate.max(10.0).log10().floor() - 1.0);
    count(((rate / unit).round() * unit) as u64)
}

fn mode_report(mode: usize, summary: &ModeSummary, samples: u64) -> ModeReport {
    ModeReport {
        mode,
        frequency_hz: Statistics::of(&summary.angular_frequency, 1.0 / TAU),
        growth_rate: Statistics::of(&summary.growth_rate, 1.0),
        damping_ratio: Statistics::of(&summary.damping_ratio, 1.0),
        unstable_share: summary.unstable as f64 / samples as f64,
    }
}

fn analyses(surrogate: &Surrogate) -> Vec<Analysis> {
    let all_indices = surrogate.sobol_indices();
    let sobol = |id: usize| {
        let Some(indices) = all_indices[id].clone() else { return Vec::new() };
        let shares = indices.first.into_iter().zip(indices.total);
        let report =
            |(input, (first, total)): (&str, (f64, f64))| SobolReport { input: input.to_owned(), first, total };
        surrogate.inputs.names().zip(shares).map(report).collect()
    };
    let moments = surrogate.moments().into_iter().enumerate();
    moments
        .map(|(id, (mean, variance))| Analysis {
            mean_from_coefficients: mean,
            variance_from_coefficients: variance,
            sobol: sobol(id),
        })
        .collect()
}

impl fmt::Display for EvalReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rate = self.samples as f64 / self.elapsed_seconds.max(1e-9);
        writeln!(
            f,
            "{}: {} samples of the {} in {:.2} s ({} per second), seed {}\n",
            self.study,
            count(self.samples),
            self.source,
            self.elapsed_seconds,
            rounded(rate),
            self.seed
        )?;
        self.write_circumstances(f)?;
        let percent = |share: f64| format!("{:.3} %", 100.0 * share);
        let modes: Vec<String> = self.modes.iter().map(|mode| mode.mode.to_string()).collect();
        let judged_by = match self.source {
            "model" => "all modes".to_owned(),
            _ => format!("modes {}", modes.join(", ")),
        };
        writeln!(f, "  stable                 {}   judged by {judged_by}", percent(self.stable_proportion))?;
        match self.source {
            "model" => {
                let Interval { lower, upper, level } = self.sureness.interval;
                let range = format!("{} to {}", percent(lower), percent(upper));
                writeln!(f, "  sampling interval      {range}   {:.0} %", 100.0 * level)?;
            }
            _ => write!(f, "{}", self.sureness)?,
        }
        write!(f, "{}", events_text(&self.events))?;
        writeln!(f, "  largest max Re λ       {} 1/s", significant(self.max_re.maximum, 5))?;
        if let Some((low, high)) = self.central_residuals() {
            let [low, high] = [low, high].map(|value| significant(value, 3));
            writeln!(
                f,
                "  error of max Re λ      {low} to {high} 1/s, model minus surrogate, at 95 % of points left out"
            )?;
        }
        writeln!(f, "\n{}", self.mode_table())?;
        write!(f, "{}", self.component_table())?;
        writeln!(f, "re in 1/s, im in rad/s")?;
        if let Some(table) = quantiles_table(&self.quantiles) {
            write!(f, "\n{table}")?;
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
        self.warnings.iter().try_for_each(|warning| writeln!(f, "\nwarning: {warning}"))
    }
}

/// Sobol' points are balanced in numbers that are powers of two.
fn unbalanced(question: &Question) -> Option<String> {
    let per_replicate = question.samples / u64::from(question.replicates.max(1));
    if question.sampler != Sampler::Sobol || per_replicate.is_power_of_two() {
        return None;
    }
    let nearest = per_replicate.checked_next_power_of_two()?.checked_mul(u64::from(question.replicates))?;
    Some(format!(
        "replicates of {} Sobol' points are less balanced than those of a power of two; use -n {nearest}",
        count(per_replicate)
    ))
}

impl EvalReport {
    /// What is not plain about these samples.
    fn write_circumstances(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.complete {
            writeln!(f, "  incomplete             interrupted before the last samples")?;
        }
        if self.replicates > 1 {
            let points = count(self.samples / u64::from(self.replicates));
            writeln!(
                f,
                "  sampler                {}, {} replicates of {points} points",
                self.sampler, self.replicates
            )?;
        } else if self.sampler != Sampler::MonteCarlo.name() {
            writeln!(f, "  sampler                {}", self.sampler)?;
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
        table
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
