//! The surrogate: an immutable set of expansions with everything needed to use it and to judge it.

mod agreement;
mod analysis;
mod certificate;
mod coverage;
mod evaluate;
mod left_out;
mod records;
mod sobol;
mod trained_domain;

pub use agreement::{Disagreement, PORTABLE_TOLERANCE};
pub use analysis::FitQuality;
pub use certificate::{
    AssumedBound, Certificate, ErrorTail, FallingErrors, MarginalBounds, RareSide, SampledStrata, Strata, StratumRuns,
    Withheld,
};
pub use coverage::Coverage;
pub use left_out::LeftOut;
pub use records::{
    Band, Counts, Decision, Expansion, LeaveOut, Provenance, Quantile, SelfTest, Setting, SettingValue, StopReason,
    Training, VerdictBasis,
};
pub use sobol::SobolIndices;
pub use trained_domain::TrainedDomain;

use crate::components::{Component, Label, Output, OutputKind};
use crate::polynomials::Mesh;
use crate::probability::inputs::InputSpace;

/// A surrogate model of the eigenvalues of a system with uncertain parameters.
///
/// Component k is center + scale · Σ_α c_α ψ_α with its expansion in the element that holds the point, at the local
/// variables there; outputs say how components become eigenvalues. A global expansion has one element, whose local
/// variables are ξ.
#[derive(Debug, Clone, PartialEq)]
pub struct Surrogate {
    /// Where it comes from.
    pub provenance: Provenance,
    /// The uncertain inputs, in the order of the standardized variables.
    pub inputs: InputSpace,
    /// What the components form.
    pub outputs: Vec<Output>,
    /// The elements, each with expansions of its own.
    pub mesh: Mesh,
    /// For each element in order, one expansion per component, by component id.
    pub expansions: Vec<Expansion>,
    /// How it was trained.
    pub training: Training,
    /// What is known of its error where stability is decided.
    pub decision: Decision,
    /// Points with expected values, to check an evaluator.
    pub self_test: SelfTest,
    /// Verified bounds, added after the build.
    pub certificates: Vec<Certificate>,
    /// What the verdict on stability rests on beside the sign of Re λ.
    pub verdict: VerdictBasis,
    /// Where the model did not answer, if it did not everywhere.
    pub coverage: Option<Coverage>,
    /// The box that the model runs spanned; `None` if they fill the laws of all inputs, and if it is not known.
    pub trained_domain: Option<TrainedDomain>,
    /// What components miss at runs left out; `None` if none were left out, and if the file does not say.
    pub left_out: Option<LeftOut>,
}

impl Surrogate {
    /// All components in the order of their ids.
    pub fn components(&self) -> Vec<&Component> {
        let mut components: Vec<_> = self.outputs.iter().flat_map(|output| &output.components).collect();
        components.sort_by_key(|component| component.id);
        components
    }

    /// Number of components.
    pub fn component_count(&self) -> usize {
        self.outputs.iter().map(|output| output.components.len()).sum()
    }

    /// The expansion of the component with this id in an element.
    pub fn expansion(&self, element: usize, component: usize) -> &Expansion {
        &self.expansions[element * self.component_count() + component]
    }

    /// The expansions of the component with this id, element by element.
    pub fn expansions_of(&self, component: usize) -> impl Iterator<Item = &Expansion> {
        self.expansions.iter().skip(component).step_by(self.component_count())
    }

    /// Numbers of all modes it carries, output by output.
    pub fn modes(&self) -> Vec<usize> {
        self.outputs.iter().flat_map(|output| output.modes.iter().copied()).collect()
    }

    /// The names of all eigenvalues it yields, in the order in which recombination yields them.
    pub fn labels(&self) -> Vec<Label> {
        self.outputs.iter().flat_map(Output::labels).collect()
    }

    /// Whether its eigenvalues lie on the imaginary axis or symmetric to it at every point: nothing decays but what
    /// grows elsewhere.
    pub fn is_undamped(&self) -> bool {
        let vanishes = |component: &Component| {
            let is_zero = |expansion: &Expansion| expansion.coefficients.iter().all(|&coefficient| coefficient == 0.0);
            component.center == 0.0 && self.expansions_of(component.id).all(is_zero)
        };
        let is_undamped = |output: &Output| match output.kind {
            // Odd functions of λ.
            OutputKind::Closed => output.components.iter().step_by(2).all(vanishes),
            // Re s, then Im c_{k−2}, Re c_{k−3}, and so on.
            OutputKind::Eigenvalue | OutputKind::Cluster => {
                vanishes(&output.components[0])
                    && (2..output.components.len() / 2 + 1)
                        .all(|degree| vanishes(&output.components[2 * (degree - 1) + usize::from(degree % 2 == 0)]))
            }
        };
        self.outputs.iter().all(is_undamped)
    }

    /// Whether some of its eigenvalues can be real.
    pub fn has_real_eigenvalues(&self) -> bool {
        self.outputs.iter().any(|output| output.kind == OutputKind::Closed)
    }
}
