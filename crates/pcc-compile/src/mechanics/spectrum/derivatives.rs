//! Derivatives of invariants by the inputs, from the Schur form of one eigenvalue solve.
//!
//! With the spectral projector P of a group of k eigenvalues (Kato 1995, chapter II,
//! <https://doi.org/10.1007/978-3-642-66282-9>), the mean s and the power sums p_m = Σ(λ_i − s)^m have
//!
//! ds = tr(P dA)/k,   dp_m = m tr(P (A − sI)^{m−1} dA) − m p_{m−1} ds,
//!
//! the last term because s moves, too. Newton's identities turn power sums into the coefficients of Π(z − (λ_i − s)).
//! All of this is regular where the eigenvalues of the group coalesce; only groups that come close to other eigenvalues
//! have no P.
//!
//! Groups that are closed under conjugation have the elementary symmetric functions e_m instead (`closed_slopes`).
//!
//! Which eigenvalues form groups is known after all runs. Until then a run keeps the state matrix and its derivatives
//! on the invariant subspace of all eigenvalues of interest: for m of them T = WAV and D_j = W ∂A/∂x_j V, m × m each,
//! with P = VPʹW and the projector Pʹ of the group within T. It keeps right and left eigenvectors, too, by which
//! eigenvalues are followed from run to run.

use super::closed_slopes::closed_slopes;
use super::computation::Slopes;
use super::modes::is_nearly_real;
use super::refinement::Refined;
use super::solution::Solution;
use crate::numerics::invariant_subspace::Subspace;
use nalgebra::{Complex, DMatrix};
use pcc_evaluate::components::OutputKind;

/// The state matrix and its derivatives on the invariant subspace of some eigenvalues.
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedSystem {
    /// The eigenvalues, as the solver gave them.
    eigenvalues: Vec<Complex<f64>>,
    /// T, upper triangular with the eigenvalues on its diagonal.
    state_matrix: DMatrix<Complex<f64>>,
    /// D_j, one per input.
    derivatives: Vec<DMatrix<Complex<f64>>>,
    /// Right eigenvectors, one per column.
    right: DMatrix<Complex<f64>>,
    /// Left eigenvectors, one per row, biorthonormal to the right ones.
    left: DMatrix<Complex<f64>>,
}

impl ReducedSystem {
    /// The system of these parts: m eigenvalues, T, one derivative per input, right eigenvectors in columns and left
    /// ones in rows. `None` if their sizes do not fit together.
    pub fn from_parts(
        eigenvalues: Vec<Complex<f64>>,
        state_matrix: DMatrix<Complex<f64>>,
        derivatives: Vec<DMatrix<Complex<f64>>>,
        right: DMatrix<Complex<f64>>,
        left: DMatrix<Complex<f64>>,
    ) -> Option<Self> {
        let count = eigenvalues.len();
        let are_square = std::iter::once(&state_matrix).chain(&derivatives).all(|m| m.shape() == (count, count));
        let fits = are_square && right.ncols() == count && left.shape() == (count, right.nrows());
        fits.then_some(Self { eigenvalues, state_matrix, derivatives, right, left })
    }

    /// Its eigenvalues.
    pub fn eigenvalues(&self) -> &[Complex<f64>] {
        &self.eigenvalues
    }

    /// T, upper triangular with the eigenvalues on its diagonal, in 1/s.
    pub fn state_matrix(&self) -> &DMatrix<Complex<f64>> {
        &self.state_matrix
    }

    /// D_j = W ∂A/∂x_j V, one per input.
    pub fn derivatives(&self) -> &[DMatrix<Complex<f64>>] {
        &self.derivatives
    }

    /// Right eigenvectors, one per column, in the order of the eigenvalues.
    pub fn right(&self) -> &DMatrix<Complex<f64>> {
        &self.right
    }

    /// Left eigenvectors, one per row.
    pub fn left(&self) -> &DMatrix<Complex<f64>> {
        &self.left
    }

    /// Reduces a system to some of its eigenvalues, which are numbers of the solution.
    ///
    /// Those that were refined have vectors of their own, the others share an invariant subspace. If that cannot be
    /// separated from the rest of the spectrum ([`Subspace::is_separated`]), as where that is wide, all are refined.
    /// `None` if that fails, too, or one of them does not exist.
    pub fn new(solution: &Solution, slopes: Slopes<'_>, eigenvalues: &[Complex<f64>]) -> Option<Self> {
        let positions = positions(solution.eigenvalues(), eigenvalues)?;
        let together: Vec<usize> = positions.iter().copied().filter(|&at| solution.refined(at).is_none()).collect();
        let subspace = Some(&together).filter(|together| !together.is_empty()).map(|at| solution.schur().subspace(at));
        let (subspace, single): (Option<Subspace>, Vec<Refined>) = match subspace {
            Some(subspace) if !subspace.is_separated() => (None, solution.with_vectors(&positions)?),
            subspace => (subspace, positions.iter().filter_map(|&at| solution.refined(at).cloned()).collect()),
        };
        if single.is_empty() {
            return subspace.map(|subspace| Self::of_subspace(subspace, slopes, eigenvalues.to_vec()));
        }
        let together = together.iter().filter(|_| subspace.is_some()).map(|&at| solution.eigenvalues()[at]).collect();
        Self::of_vectors(solution, (subspace, together), &single, slopes)
    }

    fn of_subspace(subspace: Subspace, slopes: Slopes<'_>, eigenvalues: Vec<Complex<f64>>) -> Self {
        let (vectors, inverse) = eigenvectors(&subspace.restricted);
        Self {
            eigenvalues,
            derivatives: reduced_derivatives(&subspace.left, &subspace.right, slopes.state_matrix),
            right: &subspace.right * vectors,
            left: inverse * &subspace.left,
            state_matrix: subspace.restricted,
        }
    }

    /// The system of a subspace with its eigenvalues, if there is one, and of those that have vectors of their own.
    fn of_vectors(
        solution: &Solution,
        (subspace, mut eigenvalues): (Option<Subspace>, Vec<Complex<f64>>),
        single: &[Refined],
        slopes: Slopes<'_>,
    ) -> Option<Self> {
        let (second_order, states) = (solution.second_order()?, solution.eigenvalues().len());
        let first = subspace.as_ref().map_or(0, |subspace| subspace.right.ncols());
        let count = first + single.len();
        let (mut right, mut left) = (DMatrix::zeros(states, count), DMatrix::zeros(count, states));
        let mut state_matrix = DMatrix::zeros(count, count);
        let mut own = DMatrix::identity(count, count);
        let mut own_inverse = DMatrix::identity(count, count);
        if let Some(subspace) = &subspace {
            right.columns_mut(0, first).copy_from(&subspace.right);
            left.rows_mut(0, first).copy_from(&subspace.left);
            state_matrix.view_mut((0, 0), (first, first)).copy_from(&subspace.restricted);
            let (vectors, inverse) = eigenvectors(&subspace.restricted);
            own.view_mut((0, 0), (first, first)).copy_from(&vectors);
            own_inverse.view_mut((0, 0), (first, first)).copy_from(&inverse);
        }
        for (k, refined) in (first..).zip(single) {
            right.set_column(k, &refined.right_state());
            left.set_row(k, &refined.left_state(second_order).transpose());
            state_matrix[(k, k)] = refined.eigenvalue;
        }
        let mut derivatives = reduced_derivatives(&left, &right, slopes.state_matrix);
        // Products with the state matrix lose the digits of slow modes; those with the matrices it is made of do not.
        for (reduced, by_input) in derivatives.iter_mut().zip(slopes.second_order) {
            for (i, one) in (first..).zip(single) {
                for (k, other) in (first..).zip(single) {
                    reduced[(i, k)] = one.moved_by(other, by_input);
                }
            }
        }
        eigenvalues.extend(single.iter().map(|refined| refined.eigenvalue));
        Some(Self { eigenvalues, state_matrix, derivatives, right: right * own, left: own_inverse * left })
    }

    /// The derivatives of the components of a group of this kind, in their order, by each input in physical units: one
    /// list per input. The group has these `eigenvalues`, and those of closed groups with their conjugates; a system
    /// without conjugates takes them as known.
    ///
    /// `None` if the group is not among the eigenvalues, or cannot be separated from the others to eight digits.
    pub fn differentiate(&self, kind: OutputKind, eigenvalues: &[Complex<f64>]) -> Option<Vec<Vec<f64>>> {
        let is_half = kind == OutputKind::Closed && self.eigenvalues.iter().all(|lambda| lambda.im > 0.0);
        let group: Vec<Complex<f64>> = match is_half {
            true if eigenvalues.iter().any(|lambda| lambda.im == 0.0) => return None,
            true => eigenvalues.iter().filter(|lambda| lambda.im > 0.0).copied().collect(),
            false => eigenvalues.to_vec(),
        };
        let subspace = Subspace::of_triangular(self.state_matrix.clone(), &positions(&self.eigenvalues, &group)?);
        let slopes = |derivative| {
            let derivative = &subspace.left * derivative * &subspace.right;
            match kind {
                OutputKind::Closed => closed_slopes(&subspace.restricted, &derivative, is_half),
                OutputKind::Eigenvalue | OutputKind::Cluster => {
                    let parts = invariant_slopes(&subspace.restricted, &derivative);
                    parts.iter().flat_map(|slope| [slope.re, slope.im]).collect()
                }
            }
        };
        let found: Vec<Vec<f64>> = self.derivatives.iter().map(slopes).collect();
        let is_finite = found.iter().flatten().all(|slope| slope.is_finite());
        (subspace.is_separated() && is_finite).then_some(found)
    }
}

/// Where `wanted` are among `all`, each at a position of its own.
fn positions(all: &[Complex<f64>], wanted: &[Complex<f64>]) -> Option<Vec<usize>> {
    let mut positions: Vec<usize> = Vec::with_capacity(wanted.len());
    for lambda in wanted {
        let candidates = (0..all.len()).filter(|at| is_seen_as(all[*at], *lambda) && !positions.contains(at));
        let position = nearest(candidates, all, *lambda)?;
        positions.push(position);
    }
    Some(positions)
}

/// Whether a spectrum can have made this `seen` of the solver's number: real what is nearly so, imaginary what cannot
/// be told from it.
pub(super) fn is_seen_as(solved: Complex<f64>, seen: Complex<f64>) -> bool {
    (solved.re == seen.re || seen.re == 0.0) && (solved.im == seen.im || (seen.im == 0.0 && is_nearly_real(solved)))
}

/// The first of these positions whose eigenvalue is nearest to `lambda`.
pub(super) fn nearest(
    positions: impl Iterator<Item = usize>,
    all: &[Complex<f64>],
    lambda: Complex<f64>,
) -> Option<usize> {
    let distance = |at: usize| (all[at] - lambda).norm();
    positions.reduce(|a, b| if distance(b) < distance(a) { b } else { a })
}

/// The eigenvectors of an upper triangular matrix, one per column, and their inverse. Of eigenvalues that coalesce they
/// are nearly parallel, and their inverse is large.
fn eigenvectors(triangular: &DMatrix<Complex<f64>>) -> (DMatrix<Complex<f64>>, DMatrix<Complex<f64>>) {
    let size = triangular.nrows();
    let smallest = f64::EPSILON * triangular.norm().max(f64::MIN_POSITIVE);
    let divisor = |difference: Complex<f64>| match difference.norm() < smallest {
        true => Complex::new(smallest, 0.0),
        false => difference,
    };
    let mut vectors = DMatrix::<Complex<f64>>::identity(size, size);
    for k in 0..size {
        for i in (0..k).rev() {
            let known: Complex<f64> = (i + 1..=k).map(|l| triangular[(i, l)] * vectors[(l, k)]).sum();
            vectors[(i, k)] = known / divisor(triangular[(k, k)] - triangular[(i, i)]);
        }
    }
    let mut inverse = DMatrix::<Complex<f64>>::identity(size, size);
    for k in 0..size {
        for i in (0..k).rev() {
            inverse[(i, k)] = -(i + 1..=k).map(|l| vectors[(i, l)] * inverse[(l, k)]).sum::<Complex<f64>>();
        }
    }
    (vectors, inverse)
}

/// W D_j V for real D_j.
fn reduced_derivatives(
    left: &DMatrix<Complex<f64>>,
    right: &DMatrix<Complex<f64>>,
    derivatives: &[DMatrix<f64>],
) -> Vec<DMatrix<Complex<f64>>> {
    let (size, modes) = right.shape();
    // Real and imaginary parts side by side: real products are cheaper.
    let right = DMatrix::from_fn(size, 2 * modes, |i, k| {
        let entry = right[(i, k % modes)];
        if k < modes { entry.re } else { entry.im }
    });
    let reduced = |derivative: &DMatrix<f64>| {
        let product = derivative * &right;
        let parts = (product.columns(0, modes), product.columns(modes, modes));
        left * parts.0.zip_map(&parts.1, Complex::new)
    };
    derivatives.iter().map(reduced).collect()
}

/// ds, dc_{k−2}, …, dc_0 for T of a group and W dA V of one input.
pub(super) fn invariant_slopes(
    state_matrix: &DMatrix<Complex<f64>>,
    derivative: &DMatrix<Complex<f64>>,
) -> Vec<Complex<f64>> {
    let size = state_matrix.nrows();
    let mean = state_matrix.trace() / size as f64;
    let mean_slope = derivative.trace() / size as f64;
    let mut centered = state_matrix.clone();
    (0..size).for_each(|i| centered[(i, i)] -= mean);

    // p_m and dp_m by (A − sI)^{m−1}; p_0 = k, p_1 = 0.
    let zero = Complex::new(0.0, 0.0);
    let (mut sums, mut sum_slopes) = (vec![zero; size + 1], vec![zero; size + 1]);
    sums[0] = Complex::new(size as f64, 0.0);
    let mut power = DMatrix::identity(size, size);
    for m in 2..=size {
        power *= &centered;
        sums[m] = (&power * &centered).trace();
        sum_slopes[m] = ((&power * derivative).trace() - sums[m - 1] * mean_slope) * m as f64;
    }

    // m a_m = −Σ_{i=2}^{m} a_{m−i} p_i for the coefficients a_m = c_{k−m}, a_0 = 1, a_1 = 0.
    let (mut coefficients, mut slopes) = (vec![zero; size + 1], vec![zero; size + 1]);
    coefficients[0] = Complex::new(1.0, 0.0);
    for m in 2..=size {
        let terms = (2..=m).map(|i| coefficients[m - i] * sums[i]);
        let term_slopes = (2..=m).map(|i| slopes[m - i] * sums[i] + coefficients[m - i] * sum_slopes[i]);
        let (sum, sum_slope): (Complex<f64>, Complex<f64>) = (terms.sum(), term_slopes.sum());
        (coefficients[m], slopes[m]) = (-sum / m as f64, -sum_slope / m as f64);
    }
    std::iter::once(mean_slope).chain(slopes.into_iter().skip(2)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::spectrum::{Spectrum, components_of};
    use nalgebra::dmatrix;

    /// Central differences with a step of 1e-5 are good to some 1e-9.
    const DIFFERENCES: f64 = 1e-7;
    const STEP: f64 = 1e-5;

    /// Three oscillators, coupled without symmetry, all different.
    fn state_matrix(x: f64) -> DMatrix<f64> {
        let stiffness = dmatrix![100.0 + x, -3.0 - 2.0 * x, 0.5; 1.0 + x * x, 110.0, -4.0 * x; 0.3, 2.0, 121.0 - x];
        let mut state = DMatrix::zeros(6, 6);
        state.view_mut((0, 3), (3, 3)).fill_with_identity();
        state.view_mut((3, 0), (3, 3)).copy_from(&-stiffness);
        state.view_mut((3, 3), (3, 3)).fill_diagonal(-0.1 - 0.05 * x);
        state
    }

    fn derivative(x: f64) -> DMatrix<f64> {
        let mut state = DMatrix::zeros(6, 6);
        let stiffness = dmatrix![1.0, -2.0, 0.0; 2.0 * x, 0.0, -4.0; 0.0, 0.0, -1.0];
        state.view_mut((3, 0), (3, 3)).copy_from(&-stiffness);
        state.view_mut((3, 3), (3, 3)).fill_diagonal(-0.05);
        state
    }

    fn solution(x: f64) -> Solution {
        Solution::new(state_matrix(x), None).unwrap()
    }

    fn spectrum(x: f64) -> Spectrum {
        Spectrum::new(solution(x).eigenvalues()).unwrap()
    }

    #[test]
    fn slopes_are_those_of_differences_for_every_grouping() {
        let x = 0.7;
        let by_x = [derivative(x)];
        let slopes = Slopes { state_matrix: &by_x, second_order: &[] };
        let half = ReducedSystem::new(&solution(x), slopes, spectrum(x).oscillating()).unwrap();
        let full = ReducedSystem::new(&solution(x), slopes, spectrum(x).eigenvalues()).unwrap();
        // By the distances between modes each grouping is what invariants of these lists would be.
        for group in [vec![0], vec![1], vec![2], vec![0, 1], vec![1, 2], vec![0, 1, 2]] {
            for kind in [OutputKind::Eigenvalue, OutputKind::Cluster, OutputKind::Closed] {
                if (kind == OutputKind::Eigenvalue) != (group.len() == 1) && kind != OutputKind::Closed {
                    continue;
                }
                let lambdas = |x: f64| {
                    let spectrum = spectrum(x);
                    let of_mode = |&mode: &usize| spectrum.oscillating()[mode];
                    let conjugate = |lambda: Complex<f64>| match kind {
                        OutputKind::Closed => vec![lambda, lambda.conj()],
                        _ => vec![lambda],
                    };
                    group.iter().map(of_mode).flat_map(conjugate).collect::<Vec<_>>()
                };
                let values = |x: f64| components_of(kind, &lambdas(x));
                for system in [&half, &full] {
                    let found = system.differentiate(kind, &lambdas(x)).unwrap().remove(0);
                    for ((slope, above), below) in found.iter().zip(values(x + STEP)).zip(values(x - STEP)) {
                        let difference = (above - below) / (2.0 * STEP);
                        // Differences of large numbers lose digits.
                        let rounding = f64::EPSILON * above.abs() / STEP;
                        assert!(
                            (slope - difference).abs() < DIFFERENCES * (1.0 + slope.abs()) + 10.0 * rounding,
                            "{kind:?} {group:?}: {slope} {difference}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn eigenvectors_are_biorthonormal_and_those_of_the_matrix() {
        let system = ReducedSystem::new(&solution(0.3), Slopes::default(), spectrum(0.3).eigenvalues()).unwrap();
        let matrix = state_matrix(0.3).map(|entry| Complex::new(entry, 0.0));
        let product = system.left() * system.right();
        assert!((product - DMatrix::identity(6, 6)).norm() < 1e-11);
        for (k, lambda) in system.eigenvalues().iter().enumerate() {
            let right = system.right().column(k);
            assert!((&matrix * right - right * *lambda).norm() < 1e-10 * right.norm());
        }
    }

    #[test]
    fn groups_that_touch_other_modes_have_no_slopes() {
        // Two equal oscillators, coupled in one direction only: a defective pair.
        let mut state = DMatrix::zeros(4, 4);
        state.view_mut((0, 2), (2, 2)).fill_with_identity();
        state.view_mut((2, 0), (2, 2)).copy_from(&dmatrix![-100.0, 1.0; 0.0, -100.0]);
        let solution = Solution::new(state.clone(), None).unwrap();
        let spectrum = Spectrum::new(solution.eigenvalues()).unwrap();
        let (modes, by_x) = (spectrum.oscillating(), [state]);
        let slopes = Slopes { state_matrix: &by_x, second_order: &[] };
        assert_eq!(ReducedSystem::new(&solution, slopes, &modes[..1]), None);
        let both = ReducedSystem::new(&solution, slopes, modes).unwrap();
        assert_eq!(both.differentiate(OutputKind::Eigenvalue, &modes[..1]), None);
        assert!(both.differentiate(OutputKind::Cluster, modes).is_some());
        let unknown = [modes[0], Complex::new(1.0, 2.0)];
        assert!(both.differentiate(OutputKind::Cluster, &unknown).is_none(), "a mode that was not kept");
    }
}
