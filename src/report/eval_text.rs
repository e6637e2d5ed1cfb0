//! The answer of `eval` and `reference` as people read it: a sentence, how sure it is, modes that can be unstable, and
//! causes. What stands behind it is in `eval_details.rs`.

use super::confidence::Named;
use super::eval::{EvalReport, ModeReport, RealReport, Statistics};
use super::judgement::modes_text;
use super::layout::{Facts, width, wrapped, write_verdict, write_warnings};
use super::numbers::{interval, share, significant};
use super::survey::{add_events, conditions_text, histogram_text, quantiles_table};
use super::table::{Align, Table};
use pcc_evaluate::evaluation::Sampler;
use pcc_evaluate::foundation::{count, plural};
use std::fmt;

/// Modes without details, those that are unstable most often.
const MODES: usize = 6;

/// Causes without details.
const CAUSES: usize = 3;

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

impl EvalReport {
    /// Whether the system can diverge, not only flutter.
    fn can_diverge(&self) -> bool {
        self.divergence_proportion > 0.0 || !self.real_eigenvalues.is_empty()
    }

    /// Whether modes have numbers.
    pub(super) fn has_ranks(&self) -> bool {
        self.source != "model" || !self.modes.is_empty()
    }

    /// What is known of the shares, and how sure.
    pub(super) fn facts(&self) -> Facts {
        let mut facts = Facts::default();
        self.add_circumstances(&mut facts);
        let judged_by = || format!("judged by {}", self.judged_by);
        let has_marginal = self.marginal_proportion > 0.0 || self.undamped;
        let named = match has_marginal {
            true => Named::BesideMarginal(self.intervals.unstable),
            false if self.names_unstable() => Named::Unstable,
            false => Named::Stable,
        };
        let kinds =
            || format!("flutter {}, divergence {}", share(self.flutter_proportion), share(self.divergence_proportion));
        let mut stated = vec![("stable", self.stable_proportion, judged_by())];
        if has_marginal {
            stated.push(("marginal", self.marginal_proportion, "neither grows nor decays".to_owned()));
            stated.push(("unstable", self.unstable_proportion, kinds()));
        } else if named == Named::Unstable {
            let kinds = if self.can_diverge() { kinds() + "; " } else { String::new() };
            stated = vec![("unstable", self.unstable_proportion, kinds + &judged_by())];
        } else if self.can_diverge() {
            stated.push(("unstable", self.unstable_proportion, kinds()));
        }
        // That none of so many was unstable says more than 0 %.
        let value = |name: &str, value: f64| match name == "unstable" && value == 0.0 && named == Named::Unstable {
            true => format!("none of {}", count(self.samples)),
            false => share(value),
        };
        stated.into_iter().for_each(|(name, stated, words)| facts.add(name, value(name, stated), words));
        if let (Some(unanswered), Some(bounds)) = (self.unanswered_proportion, self.bounds) {
            let words = format!("{} are stable, whatever the model would say there", interval(&bounds.stable));
            facts.add("unanswered", share(unanswered), words);
        }
        if let Some(count) = self.rigid_body_modes.filter(|&count| count > 0) {
            facts.add("rigid-body motion", format!("{count} of the eigenvalues, zero and left out"), "");
        }
        if let Some(band) = &self.band {
            facts.add("frequencies", band.clone(), "");
        }
        let sure = match self.source {
            "model" => vec![self.confidence.sampling(named)],
            _ => self.confidence.facts(named),
        };
        sure.into_iter().for_each(|(name, value, words)| facts.add(name, value, words));
        add_events(&mut facts, &self.events);
        facts
    }
}

impl fmt::Display for EvalReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = width(f);
        write_warnings(f, &self.warnings)?;
        write_verdict(f, &self.verdict)?;
        writeln!(f, "{:columns$}", self.facts())?;
        if f.alternate() {
            self.write_details(f)?;
        } else {
            self.write_modes_and_causes(f)?;
        }
        if let Some(table) = quantiles_table(&self.quantiles) {
            let note =
                "found by counting in bins of the width in the last column; frequency in Hz, im in rad/s, re in 1/s";
            writeln!(f, "\n{table:columns$}{}", wrapped(note, columns, 0))?;
        }
        self.histograms.iter().try_for_each(|histogram| write!(f, "\n{}", histogram_text(histogram, columns)))?;
        if let Some(critical) = &self.critical {
            write!(f, "{critical:columns$}")?;
        }
        let how = pace(self.samples as f64, self.elapsed_seconds, self.only_in_text.merged_parts);
        let samples = plural(self.samples as usize, "sample");
        let last = format!("{samples} of the {} {how}, seed {}", self.source, self.seed);
        writeln!(f, "\n{}", wrapped(&last, columns, 0))?;
        if f.alternate() { Ok(()) } else { writeln!(f, "more: --details") }
    }
}

impl EvalReport {
    fn write_modes_and_causes(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = width(f);
        if !self.has_ranks() {
            let note = "modes have no ranks in frequency here; pcc compare shows them by the numbers of a surrogate";
            return writeln!(f, "{}", wrapped(note, columns, 0));
        }
        write!(f, "{:columns$}", self.decisive_modes())?;
        let never: Vec<usize> = self.stable_modes();
        if !never.is_empty() && self.unstable_proportion > 0.0 {
            let verb = if never.len() == 1 { "is" } else { "are" };
            writeln!(f, "{} {verb} never unstable", modes_text(&never))?;
        }
        let causes = || {
            let of_indices = self.sensitivity.as_ref().and_then(|found| found.causes(CAUSES));
            of_indices.or_else(|| self.shapley.as_ref().and_then(|found| found.causes(CAUSES)))
        };
        match (self.unstable_proportion > 0.0).then(causes).flatten() {
            Some(causes) => write!(f, "\n{causes:columns$}"),
            None => Ok(()),
        }
    }

    /// Numbers of the modes that no sample is unstable by.
    fn stable_modes(&self) -> Vec<usize> {
        let mut found: Vec<usize> =
            self.modes.iter().filter(|mode| mode.unstable_share == 0.0).map(|mode| mode.mode).collect();
        found.sort_unstable();
        found
    }

    /// The modes that are unstable most often; if none ever is, the one that comes closest.
    fn decisive_modes(&self) -> Table {
        let right = Align::Right;
        let mut table = Table::new(&[
            ("mode", Align::Left),
            ("unstable", right),
            (if self.unstable_proportion > 0.0 { "flutters at, Hz" } else { "frequency, Hz" }, right),
            ("growth rate, 1/s", right),
            ("least damping", right),
        ]);
        let mode = |mode: &ModeReport| {
            let cells = [
                mode.mode.to_string(),
                share(mode.unstable_share),
                match mode.flutter_frequency_hz {
                    Some(frequency) => frequency.range(),
                    None if self.unstable_proportion > 0.0 => "–".to_owned(),
                    None => mode.frequency_hz.range(),
                },
                mode.growth_rate.range(),
                significant(mode.damping_ratio.minimum, 3),
            ];
            (mode.unstable_share, mode.growth_rate.maximum, cells)
        };
        let real = |real: &RealReport| {
            let cells = [
                real.name.clone(),
                share(real.divergence_share),
                "–".to_owned(),
                real.growth_rate.range(),
                String::new(),
            ];
            (real.divergence_share, real.growth_rate.maximum, cells)
        };
        let mut all: Vec<_> = self.modes.iter().map(mode).chain(self.real_eigenvalues.iter().map(real)).collect();
        all.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
        let unstable = all.iter().filter(|(unstable, ..)| *unstable > 0.0).count();
        all.into_iter().take(unstable.clamp(1, MODES)).for_each(|(.., cells)| table.row(cells));
        table
    }

    /// What is not plain about these samples.
    fn add_circumstances(&self, facts: &mut Facts) {
        if !self.complete {
            let (done, asked) = (count(self.samples), count(self.requested_samples));
            let place = match self.only_in_text.has_all_samples {
                true => "all samples are counted; critical values or Sobol' indices are left out".to_owned(),
                false => format!("interrupted after {done} of {asked} samples; what takes all of them is left out"),
            };
            facts.add("incomplete", place, "");
        }
        if self.sampler != Sampler::MonteCarlo.name() {
            let asked = self.only_in_text.requested_replicates;
            let points = count(self.requested_samples / u64::from(asked.max(1)));
            let done = match self.replicates {
                done if done == asked => format!("{asked} replicates of {points} points"),
                1 => format!("not two of {asked} replicates of {points} points: judged as if points were random"),
                done => format!("{done} of {asked} replicates of {points} points"),
            };
            facts.add("sampler", format!("{}, {done}", self.sampler), "");
        }
        if !self.conditions.is_empty() {
            facts.add("where", conditions_text(&self.conditions, &self.only_in_text.inputs), "");
        }
        if let Some(dependence) = &self.dependence {
            let words = match self.source != "model" && self.complete && self.shapley.is_none() {
                true => "correlations of ranks; no Shapley effects where one of them is confined to an interval",
                false => "correlations of ranks",
            };
            facts.add("dependence", dependence.in_words(), words);
        }
    }
}

impl Statistics {
    /// Mean and range.
    fn range(&self) -> String {
        let [mean, minimum, maximum] = [self.mean, self.minimum, self.maximum].map(|value| significant(value, 3));
        if minimum == maximum { mean } else { format!("{mean} ({minimum} to {maximum})") }
    }
}
