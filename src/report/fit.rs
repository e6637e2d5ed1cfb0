//! How well each component is fitted.

use super::numbers::significant;
use super::table::{Align, Table};
use pcc_evaluate::surrogate::{StopReason, Surrogate};
use serde::Serialize;

/// Shares of the variance above this are shown by what they leave.
const ALMOST_ONE: f64 = 1.0 - 5e-6;

/// Fit of one component.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FitReport {
    /// Name.
    pub name: String,
    /// Degree p at which the search ended.
    pub degree: u16,
    /// Number of terms.
    pub terms: usize,
    /// R² on the design.
    pub r2: Option<f64>,
    /// Leave-one-out S².
    pub s2: Option<f64>,
    /// S² with the correction for small designs.
    pub corrected_s2: Option<f64>,
    /// Why the search ended.
    pub stop: &'static str,
}

impl FitReport {
    /// The fits of all components.
    pub fn of(surrogate: &Surrogate) -> Vec<Self> {
        let report = |component: &pcc_evaluate::components::Component| {
            let fit = surrogate.fit_of(component.id);
            Self {
                name: component.name.clone(),
                degree: fit.degree,
                terms: fit.terms,
                r2: fit.r2,
                s2: fit.s2,
                corrected_s2: fit.corrected_s2,
                stop: fit.stop.describe(),
            }
        };
        surrogate.components().into_iter().map(report).collect()
    }

    /// Whether more runs would not make it better.
    pub(super) fn has_stalled(&self) -> bool {
        self.stop == StopReason::Stalled.describe()
    }

    /// A table of fits.
    pub fn table(fits: &[Self]) -> Table {
        let right = Align::Right;
        let mut table = Table::new(&[
            ("component", Align::Left),
            ("degree", right),
            ("terms", right),
            ("R²", right),
            ("S²", right),
            ("S² corrected", right),
            ("search ended at", Align::Left),
        ]);
        for fit in fits {
            table.row([
                fit.name.clone(),
                fit.degree.to_string(),
                fit.terms.to_string(),
                share_of_variance(fit.r2),
                share_of_variance(fit.s2),
                share_of_variance(fit.corrected_s2),
                fit.stop.to_owned(),
            ]);
        }
        table
    }
}

/// R² or S²: close to 1 by what it leaves.
pub(super) fn share_of_variance(share: Option<f64>) -> String {
    match share {
        None => "–".to_owned(),
        Some(share) if share > ALMOST_ONE => format!("1 − {}", significant((1.0 - share).max(f64::EPSILON), 1)),
        Some(share) => format!("{share:.5}"),
    }
}
