//! Defaults of a study: at most one formula in the number of inputs r each.

use super::DesignKind;
use crate::fitting::fit::FitMethod;
use crate::fitting::fit::gpc::PAPERS_LIMIT;
use crate::fitting::fit::method::Design;
use crate::mechanics::spectrum::{Modes, Target};

pub(super) const SEED: u64 = 1;
pub(super) const MODES: Modes = Modes::All;

/// Processes of a program that go on at once.
pub(super) const JOBS: i64 = 1;

/// Folder for the folders of runs, in the current one.
pub(super) const WORK_FOLDER: &str = "runs";

/// Of a program that has not begun to answer otherwise.
pub(super) const VERSION: &str = "1";

/// Given runs that a fit takes which solves for as many unknowns as there are equations: with eight inputs and four
/// modes they take some seconds, and the time grows with the cube of their number.
pub(super) const MOST_GIVEN: usize = 500;

/// Where the paper's table stops, ten times as many for multi-element expansions, which spend runs on split parents,
/// too; for invariants, where the matrices of the minimum-norm fit begin to cost minutes: 2000 values, or 3000 values
/// and derivatives.
pub(super) fn maximum(target: Target, inputs: usize, derivatives: bool, method: &FitMethod) -> usize {
    match (method.profile().design, target) {
        (Design::QuadraturePerElement, _) => 10 * PAPERS_LIMIT as usize,
        (Design::Quadrature | Design::Oversampled(_), _) | (_, Target::Eigenvalues) => PAPERS_LIMIT as usize,
        _ if derivatives => {
            (3_000 / (1 + inputs)).max(initial(target, inputs, derivatives) + step(target, inputs, derivatives))
        }
        _ => 2_000,
    }
}

/// For invariants, of √(p (1 − p)): an error of 0.05 % of a half, half of what the sampling of a million points leaves
/// open; with derivatives a quarter of that costs few runs more. Stepwise regression does not get that far.
pub(super) fn proportion_tolerance(derivatives: bool, method: &str) -> f64 {
    if derivatives && method != "stepwise" { 1.2e-4 } else { 5e-4 }
}

/// The paper's designs for its own method, spread ones for invariants.
pub(super) fn design(target: Target) -> DesignKind {
    match target {
        Target::Eigenvalues => DesignKind::NestedLhs,
        _ => DesignKind::NestedMaximinLhs,
    }
}

/// Runs of the first level. Eigenvalues need some terms for every pair of inputs at high degree; invariants few; with
/// derivatives each run tells r + 1 times as much. Of many inputs few matter: at most half of what a design may have.
pub(super) fn initial(target: Target, inputs: usize, derivatives: bool) -> usize {
    match target {
        Target::Eigenvalues => (15 * inputs * inputs).min(5_000),
        _ if derivatives => (2 * inputs).clamp(5, 50),
        _ => (inputs * inputs + 7 * inputs).clamp(10, 1_000),
    }
}

/// Runs of each enrichment: as many again, but with derivatives half as many more. A first level has nothing to be
/// judged by.
pub(super) fn step(target: Target, inputs: usize, derivatives: bool) -> usize {
    if target != Target::Eigenvalues && derivatives {
        (3 * inputs).clamp(5, 75)
    } else {
        initial(target, inputs, derivatives)
    }
}
