//! The surrogate: an immutable set of expansions with everything needed to use it and to judge it.

mod agreement;
mod analysis;
mod evaluate;
mod records;

pub use agreement::{Disagreement, PORTABLE_TOLERANCE};
pub use analysis::SobolIndices;
pub use records::{
    Certificate, Counts, Decision, Expansion, LeaveOut, Provenance, Quantile, SelfTest, Setting, SettingValue,
    StopReason, Training,
};

use crate::input::InputSpace;
use crate::spectrum::{Component, Output};

/// A surrogate model of the eigenvalues of a system with uncertain parameters.
///
/// Component k is center + scale · Σ_α c_α ψ_α(ξ) with the expansion of the same id; outputs say how components become
/// eigenvalues.
#[derive(Debug, Clone, PartialEq)]
pub struct Surrogate {
    /// Where it comes from.
    pub provenance: Provenance,
    /// The uncertain inputs, in the order of the standardized variables.
    pub inputs: InputSpace,
    /// What the components form.
    pub outputs: Vec<Output>,
    /// One expansion per component, by component id.
    pub expansions: Vec<Expansion>,
    /// How it was trained.
    pub training: Training,
    /// What is known of its error where stability is decided.
    pub decision: Decision,
    /// Points with expected values, to check an evaluator.
    pub self_test: SelfTest,
    /// Verified bounds, added after the build.
    pub certificates: Vec<Certificate>,
}

impl Surrogate {
    /// All components in the order of their ids.
    pub fn components(&self) -> Vec<&Component> {
        let mut components: Vec<_> = self.outputs.iter().flat_map(|output| &output.components).collect();
        components.sort_by_key(|component| component.id);
        components
    }

    /// Frequency ranks of all modes it carries, in the order in which recombination yields them.
    pub fn modes(&self) -> Vec<usize> {
        self.outputs.iter().flat_map(|output| output.modes.iter().copied()).collect()
    }
}
