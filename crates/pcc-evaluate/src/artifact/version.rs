//! Versions of the surrogate file and what this code can do with them.

use crate::components::OutputKind;
use crate::probability::inputs::{Input, Marginal};
use crate::surrogate::{Expansion, StopReason, Surrogate, VerdictBasis};
use std::cmp::Ordering;

/// Major version written and read. It changes when older readers could misunderstand a file.
pub const MAJOR: u16 = 1;

/// Highest minor version read and written. It changes when sections, section versions or kinds are added, which older
/// readers either skip or refuse by name.
///
/// * 0: eigenvalue outputs, uniform inputs, one element.
/// * 1: clusters, with modes in the order of their frequencies; the mode of a cluster with the lowest Im λ comes first,
///   equal frequencies within 10⁻¹² by Re λ.
/// * 2: several elements, where errors of an expansion are relative to the variance over all of them; three reasons why
///   the search for an expansion ended that full expansions have.
/// * 3: section 3 in version 2, with groups of eigenvalues that are closed under conjugation; section 10; section 9 in
///   version 2, with bounds of all shares and strata; a search that ended because errors no longer fell; sections 11
///   to 14; laws other than the uniform one in section 2, and dependence.
pub const MINOR: u16 = 3;

/// The lowest minor version that knows everything `surrogate` uses: the one it is written with, so that older readers
/// read what they can.
pub(super) fn minor(surrogate: &Surrogate) -> u16 {
    let is_full = |expansion: &Expansion| {
        matches!(expansion.stop, StopReason::GivenDegree | StopReason::Settled | StopReason::Limited)
    };
    let needs_2 = surrogate.mesh.elements().len() > 1 || surrogate.expansions.iter().any(is_full);
    let has_clusters = surrogate.outputs.iter().any(|output| output.kind == OutputKind::Cluster);
    let bounds_all =
        surrogate.certificates.iter().any(|one| one.marginal.is_some() || one.failed > 0 || one.strata.is_some());
    let has_stalled = surrogate.expansions.iter().any(|expansion| expansion.stop == StopReason::Stalled);
    let has_verdict = surrogate.has_real_eigenvalues() || surrogate.verdict != VerdictBasis::default();
    let has_more_sections =
        surrogate.coverage.is_some() || surrogate.inputs.has_descriptions() || surrogate.left_out.is_some();
    let is_uniform = |input: &Input| matches!(input.marginal, Marginal::Uniform(_));
    let has_laws = !surrogate.inputs.inputs().iter().all(is_uniform);
    let has_dependence = surrogate.inputs.dependence().is_some();
    match has_laws || has_dependence || has_verdict || bounds_all || has_stalled || has_more_sections {
        true => 3,
        false if needs_2 => 2,
        false => u16::from(has_clusters),
    }
}

/// What this code can do with a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compatibility {
    /// Everything in the file is known.
    Known,
    /// The file may hold sections and kinds that this code does not know.
    NewerMinor,
    /// The file cannot be read.
    OtherMajor,
}

/// Compares a file's version with this code's.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::artifact::version::{MAJOR, compatibility, Compatibility};
/// assert_eq!(compatibility(MAJOR, 0), Compatibility::Known);
/// assert_eq!(compatibility(MAJOR + 1, 0), Compatibility::OtherMajor);
/// ```
pub fn compatibility(major: u16, minor: u16) -> Compatibility {
    match (major == MAJOR, minor.cmp(&MINOR)) {
        (false, _) => Compatibility::OtherMajor,
        (true, Ordering::Less | Ordering::Equal) => Compatibility::Known,
        (true, Ordering::Greater) => Compatibility::NewerMinor,
    }
}
