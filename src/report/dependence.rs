//! How inputs depend on each other, in reports.

use super::numbers::significant;
use pcc_evaluate::probability::inputs::InputSpace;
use serde::Serialize;

/// Correlations that are named in a line, at most.
const MOST_NAMED: usize = 6;

/// A Gaussian copula.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DependenceReport {
    /// `gaussian-copula`.
    pub kind: &'static str,
    /// Correlations that are not zero.
    pub correlations: Vec<CorrelationReport>,
}

/// The correlation of two inputs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CorrelationReport {
    /// Name of an input.
    pub first: String,
    /// Name of the other.
    pub second: String,
    /// Correlation of their normal scores.
    pub normal_scores: f64,
    /// Correlation of their ranks (Spearman).
    pub spearman: f64,
}

impl DependenceReport {
    /// The report of inputs that depend on each other; `None` if none do.
    pub(super) fn of(inputs: &InputSpace) -> Option<Self> {
        let names: Vec<&str> = inputs.names().collect();
        let correlations = inputs.dependence()?.correlations().iter();
        let report = |pair: &pcc_evaluate::probability::dependence::Correlation| CorrelationReport {
            first: names[pair.first].to_owned(),
            second: names[pair.second].to_owned(),
            normal_scores: pair.value,
            spearman: 6.0 / std::f64::consts::PI * (0.5 * pair.value).asin(),
        };
        Some(Self { kind: "gaussian-copula", correlations: correlations.map(report).collect() })
    }

    /// In a line: "k with c 0.6, a with b -0.3".
    pub(super) fn in_words(&self) -> String {
        let pair =
            |pair: &CorrelationReport| format!("{} with {} {}", pair.first, pair.second, significant(pair.spearman, 3));
        let named: Vec<String> = self.correlations.iter().take(MOST_NAMED).map(pair).collect();
        match self.correlations.len().saturating_sub(MOST_NAMED) {
            0 => named.join(", "),
            more => format!("{} and {more} more pairs", named.join(", ")),
        }
    }
}
