//! How many runs a certificate of some width takes, before any is made.

use super::layout::{width, write_verdict};
use super::numbers::share;
use super::table::{Align, Table};
use pcc_compile::reference::{RunsForWidth, RunsNeeded};
use pcc_evaluate::foundation::count;
use pcc_evaluate::surrogate::{RareSide, Surrogate};
use serde::Serialize;
use std::fmt;

/// Runs that a certificate takes.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CertifyPlanReport {
    /// The answer in a sentence.
    pub verdict: String,
    /// Name of the study.
    pub study: String,
    /// How far the upper end of the bound on the rarer side may lie above the surrogate's share of it.
    pub target_width: f64,
    /// Probability with which that end holds.
    pub side_level: f64,
    /// The rarer of stable and not stable, by the surrogate.
    pub rare_side: RareSide,
    /// Its share of samples of the surrogate.
    pub surrogate_share: f64,
    /// Number of these samples.
    pub surrogate_samples: u64,
    /// Runs by the number of them that disagree outside.
    pub needed: Vec<PlannedRuns>,
}

/// Runs of one certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlannedRuns {
    /// Runs outside that may be on the rare side all the same.
    pub disagreements: u64,
    /// Runs outside what is predicted to be rare: what `--runs` asks for.
    pub outside: u64,
    /// Runs in the layer nearest to it.
    pub layer: u64,
    /// Runs inside.
    pub inside: u64,
    /// All of these.
    pub runs: u64,
}

impl CertifyPlanReport {
    /// The report of what `surrogate` needs.
    pub fn new(surrogate: &Surrogate, target_width: f64, side_level: f64, found: &RunsForWidth) -> Self {
        let planned = |&RunsNeeded { rare, outside, layer, inside }: &RunsNeeded| PlannedRuns {
            disagreements: rare,
            outside,
            layer,
            inside,
            runs: outside.saturating_add(layer).saturating_add(inside),
        };
        let mut report = Self {
            verdict: String::new(),
            study: surrogate.provenance.study_name.clone(),
            target_width,
            side_level,
            rare_side: found.rare_side,
            surrogate_share: found.share.value(),
            surrogate_samples: found.share.samples,
            needed: found.runs.iter().map(planned).collect(),
        };
        report.verdict = report.verdict();
        report
    }

    fn verdict(&self) -> String {
        let Some(first) = self.needed.first() else { return String::new() };
        let side = match self.rare_side {
            RareSide::Stable => "stable",
            RareSide::NotStable => "not stable",
        };
        format!(
            "{}: a verified bound that ends at most {} of all cases above the surrogate's share, {} {side}, takes {} \
             fresh model runs if none disagrees: pcc certify -n {}.",
            self.study,
            share(self.target_width),
            share(self.surrogate_share),
            count(first.runs),
            first.outside,
        )
    }
}

impl fmt::Display for CertifyPlanReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = width(f);
        write_verdict(f, &self.verdict)?;
        let names = ["disagree", "outside, -n", "in the layer", "inside", "all"];
        let mut table = Table::new(&names.map(|name| (name, Align::Right)));
        for PlannedRuns { disagreements, outside, layer, inside, runs } in &self.needed {
            table.row([*disagreements, *outside, *layer, *inside, *runs].map(count));
        }
        write!(f, "{table:columns$}")
    }
}
