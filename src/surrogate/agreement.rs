//! Whether two builds of one study agree across machines.

use super::Surrogate;
use thiserror::Error;

/// Largest difference of coefficients between machines, relative to the largest coefficient of the expansion besides the
/// mean. Matrix products choose their kernels by processor; a build amplifies such last-bit differences by the condition
/// of its regression, below 10⁴ for N ≥ 2 card(A).
pub const PORTABLE_TOLERANCE: f64 = 1e-9;

/// How two surrogates differ.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Disagreement {
    /// Model, constants, inputs, spectrum, study or components are not the same.
    #[error("they come from different studies")]
    Study,
    /// A component has other terms.
    #[error("component {component} has other multi-indices")]
    IndexSet {
        /// Id of the component.
        component: usize,
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
    /// Compares studies, index sets (exactly) and coefficients (within [`PORTABLE_TOLERANCE`]).
    ///
    /// # Errors
    ///
    /// The first [`Disagreement`].
    pub fn agrees_with(&self, other: &Self) -> Result<(), Disagreement> {
        let same_study = self.provenance.study_hash == other.provenance.study_hash
            && (&self.inputs, &self.outputs) == (&other.inputs, &other.outputs);
        if !same_study || self.expansions.len() != other.expansions.len() {
            return Err(Disagreement::Study);
        }
        for (component, (own, others)) in self.expansions.iter().zip(&other.expansions).enumerate() {
            if own.indices != others.indices {
                return Err(Disagreement::IndexSet { component });
            }
            let largest = own.coefficients.iter().skip(1).fold(f64::MIN_POSITIVE, |largest, c| c.abs().max(largest));
            let pairs = own.coefficients.iter().zip(&others.coefficients);
            let difference = pairs.fold(0f64, |difference, (a, b)| difference.max((a - b).abs())) / largest;
            if difference > PORTABLE_TOLERANCE {
                return Err(Disagreement::Coefficients { component, difference });
            }
        }
        Ok(())
    }
}
