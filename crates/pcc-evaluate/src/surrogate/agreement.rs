//! Whether two builds of one study agree across machines.
//!
//! Last-bit differences between processors change the coefficients of a stepwise fit by next to nothing. A fit whose
//! settings come out of a search can take another of several settings that are equally good; it agrees if it predicts
//! the same within its own leave-one-out error.

use super::{Expansion, Surrogate};
use thiserror::Error;

/// Largest difference of coefficients between machines, relative to the largest coefficient of the expansion besides
/// the mean. Matrix products choose their kernels by processor; a build amplifies such last-bit differences by the
/// condition of its regression, below 10⁴ for N ≥ 2 card(A).
pub const PORTABLE_TOLERANCE: f64 = 1e-9;

/// Share of a mean of which [`PORTABLE_TOLERANCE`] is some hundred roundings.
const MEAN_ROUNDING: f64 = 1e-5;

/// The methods without a search for settings.
const WITHOUT_SEARCH: [&str; 3] = ["stepwise", "gpc", "me-gpc"];

/// Leave-one-out errors by which predictions may differ: the largest of some ten points, of two builds.
const ERRORS_APART: f64 = 5.0;

/// How two surrogates differ.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Disagreement {
    /// Model, constants, inputs, spectrum, study or components are not the same.
    #[error("they come from different studies")]
    Study,
    /// The box is divided otherwise.
    #[error("they have other elements")]
    Elements,
    /// A component has other terms.
    #[error("component {component} has other multi-indices")]
    IndexSet {
        /// Id of the component.
        component: usize,
    },
    /// Predictions differ.
    #[error(
        "component {component}: predictions differ by {difference:e}, more than their leave-one-out error {error:e}"
    )]
    Predictions {
        /// Id of the component.
        component: usize,
        /// Largest difference at the points of the self-test, in the component's unit.
        difference: f64,
        /// What is allowed.
        error: f64,
    },
    /// A coefficient differs.
    #[error(
        "component {component}: coefficients differ by {difference:e} of the largest, more than {PORTABLE_TOLERANCE:e}"
    )]
    Coefficients {
        /// Id of the component.
        component: usize,
        /// Largest relative difference.
        difference: f64,
    },
}

impl Surrogate {
    /// Compares studies, and index sets (exactly) and coefficients (within [`PORTABLE_TOLERANCE`]) or, for methods that
    /// search for their settings, predictions at the points of the self-test.
    ///
    /// # Errors
    ///
    /// The first [`Disagreement`].
    pub fn agrees_with(&self, other: &Self) -> Result<(), Disagreement> {
        let same_study = self.provenance.study_hash == other.provenance.study_hash
            && (&self.inputs, &self.outputs) == (&other.inputs, &other.outputs);
        if !same_study {
            return Err(Disagreement::Study);
        }
        if self.mesh != other.mesh || self.expansions.len() != other.expansions.len() {
            return Err(Disagreement::Elements);
        }
        // The weight of derivatives is searched for by every method that uses them.
        let has_weights = self.training.settings.iter().any(|setting| setting.key == "derivative_weights");
        if has_weights || !WITHOUT_SEARCH.contains(&self.training.method.as_str()) {
            return self.predicts_like(other);
        }
        let scales: Vec<f64> = (0..self.component_count()).map(|component| self.coefficient_scale(component)).collect();
        for (number, (own, others)) in self.expansions.iter().zip(&other.expansions).enumerate() {
            let component = number % self.component_count();
            if own.indices != others.indices {
                return Err(Disagreement::IndexSet { component });
            }
            let largest = scales[component];
            let pairs = own.coefficients.iter().zip(&others.coefficients);
            let difference = pairs.fold(0f64, |difference, (a, b)| difference.max((a - b).abs())) / largest;
            if difference > PORTABLE_TOLERANCE {
                return Err(Disagreement::Coefficients { component, difference });
            }
        }
        Ok(())
    }

    /// What differences of coefficients are relative to: the largest besides the mean in any element, but not less than
    /// what rounding of the mean makes of it.
    fn coefficient_scale(&self, component: usize) -> f64 {
        let largest = |part: &Expansion| part.coefficients.iter().skip(1).fold(0f64, |largest, c| c.abs().max(largest));
        let means = self.expansions_of(component).map(|part| MEAN_ROUNDING * part.mean().abs());
        self.expansions_of(component).map(largest).chain(means).fold(f64::MIN_POSITIVE, f64::max)
    }

    fn predicts_like(&self, other: &Self) -> Result<(), Disagreement> {
        for (component, (_, variance)) in self.components().into_iter().zip(self.moments()) {
            let unexplained = 1.0 - self.fit_of(component.id).s2.unwrap_or(1.0);
            let deviation = (variance * unexplained).sqrt();
            let scale = self.self_test.components.iter().fold(0f64, |scale, row| scale.max(row[component.id].abs()));
            let error = ERRORS_APART * deviation + PORTABLE_TOLERANCE * scale;
            let rows = self.self_test.components.iter().zip(&other.self_test.components);
            let difference = rows.fold(0f64, |most, (a, b)| most.max((a[component.id] - b[component.id]).abs()));
            if difference > error {
                return Err(Disagreement::Predictions { component: component.id, difference, error });
            }
        }
        Ok(())
    }
}
