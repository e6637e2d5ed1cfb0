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
//! Which modes form groups is known after all runs. Until then a run keeps the state matrix and its derivatives on the
//! invariant subspace of all modes of interest: for m modes T = WAV and D_j = W ∂A/∂x_j V, m × m each, with P = VPʹW
//! and the projector Pʹ of the group within T.

use super::modes::Spectrum;
use crate::numerics::eigenvalues::SchurForm;
use crate::numerics::invariant_subspace::Subspace;
use nalgebra::{Complex, DMatrix};
use pcc_evaluate::components::Output;

/// The state matrix and its derivatives on the invariant subspace of some modes.
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedSystem {
    /// Frequency ranks, from 1.
    modes: Vec<usize>,
    /// T, upper triangular with the eigenvalues of the modes on its diagonal.
    state_matrix: DMatrix<Complex<f64>>,
    /// D_j, one per input.
    derivatives: Vec<DMatrix<Complex<f64>>>,
}

impl ReducedSystem {
    /// The system of these parts: frequency ranks from 1, T, and one derivative per input. `None` if their sizes do not
    /// fit together.
    pub fn from_parts(
        modes: Vec<usize>,
        state_matrix: DMatrix<Complex<f64>>,
        derivatives: Vec<DMatrix<Complex<f64>>>,
    ) -> Option<Self> {
        let shape = (modes.len(), modes.len());
        let fits = std::iter::once(&state_matrix).chain(&derivatives).all(|matrix| matrix.shape() == shape);
        fits.then_some(Self { modes, state_matrix, derivatives })
    }

    /// Frequency ranks of its modes, from 1.
    pub fn modes(&self) -> &[usize] {
        &self.modes
    }

    /// T, upper triangular with the eigenvalues of the modes on its diagonal, in 1/s.
    pub fn state_matrix(&self) -> &DMatrix<Complex<f64>> {
        &self.state_matrix
    }

    /// D_j = W ∂A/∂x_j V, one per input.
    pub fn derivatives(&self) -> &[DMatrix<Complex<f64>>] {
        &self.derivatives
    }

    /// Reduces a system to the modes with the given ranks. `derivatives` are those of the state matrix by each input,
    /// in physical units; `spectrum` are the modes of `schur`.
    ///
    /// `None` if the modes cannot be separated from the rest of the spectrum ([`Subspace::is_separated`]), or one of
    /// them does not exist.
    pub fn new(schur: &SchurForm, derivatives: &[DMatrix<f64>], spectrum: &Spectrum, modes: &[usize]) -> Option<Self> {
        let lambdas = schur.eigenvalues();
        let mut positions: Vec<usize> = Vec::with_capacity(modes.len());
        for &mode in modes {
            // The spectrum holds the very numbers of the Schur form.
            let wanted = spectrum.mode(mode).ok()?;
            let position = (0..lambdas.len()).find(|at| lambdas[*at] == wanted && !positions.contains(at))?;
            positions.push(position);
        }
        let subspace = schur.subspace(&positions);
        subspace.is_separated().then(|| Self {
            modes: modes.to_vec(),
            derivatives: reduced_derivatives(&subspace, derivatives),
            state_matrix: subspace.restricted,
        })
    }

    /// The derivatives of the mean s and the coefficients c_{k−2}, …, c_0 of a group of modes, one list per input;
    /// `None` if the group cannot be separated from the other modes.
    fn slopes(&self, group: &[usize]) -> Option<Vec<Vec<Complex<f64>>>> {
        let position = |mode: &usize| self.modes.iter().position(|known| known == mode);
        let positions: Vec<usize> = group.iter().map(position).collect::<Option<_>>()?;
        let subspace = Subspace::of_triangular(self.state_matrix.clone(), &positions);
        let slopes =
            |derivative| invariant_slopes(&subspace.restricted, &(&subspace.left * derivative * &subspace.right));
        let found: Vec<Vec<Complex<f64>>> = self.derivatives.iter().map(slopes).collect();
        let is_finite = found.iter().flatten().all(|slope| slope.re.is_finite() && slope.im.is_finite());
        (subspace.is_separated() && is_finite).then_some(found)
    }

    /// The derivatives of the components of `output`, in their order, by each input in physical units: one list per
    /// input. `None` if its modes cannot be separated from the rest of the spectrum to eight digits.
    pub fn differentiate(&self, output: &Output) -> Option<Vec<Vec<f64>>> {
        let parts = self.slopes(&output.modes)?;
        Some(parts.iter().map(|by_input| by_input.iter().flat_map(|slope| [slope.re, slope.im]).collect()).collect())
    }
}

/// W D_j V for real D_j.
fn reduced_derivatives(subspace: &Subspace, derivatives: &[DMatrix<f64>]) -> Vec<DMatrix<Complex<f64>>> {
    let (size, modes) = subspace.right.shape();
    // Real and imaginary parts side by side: real products are cheaper.
    let right = DMatrix::from_fn(size, 2 * modes, |i, k| {
        let entry = subspace.right[(i, k % modes)];
        if k < modes { entry.re } else { entry.im }
    });
    let reduced = |derivative: &DMatrix<f64>| {
        let product = derivative * &right;
        let parts = (product.columns(0, modes), product.columns(modes, modes));
        &subspace.left * parts.0.zip_map(&parts.1, Complex::new)
    };
    derivatives.iter().map(reduced).collect()
}

/// ds, dc_{k−2}, …, dc_0 for T of a group and W dA V of one input.
fn invariant_slopes(state_matrix: &DMatrix<Complex<f64>>, derivative: &DMatrix<Complex<f64>>) -> Vec<Complex<f64>> {
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
    use crate::mechanics::spectrum::{Target, decompose};
    use nalgebra::dmatrix;
    use pcc_evaluate::components::{Component, OutputKind};

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

    #[test]
    fn slopes_are_those_of_differences_for_every_grouping() {
        let x = 0.7;
        let (schur, spectrum) = (SchurForm::new(state_matrix(x)).unwrap(), |x: f64| {
            Spectrum::new(&SchurForm::new(state_matrix(x)).unwrap().eigenvalues()).unwrap()
        });
        let system = ReducedSystem::new(&schur, &[derivative(x)], &spectrum(x), &[1, 2, 3]).unwrap();
        // By the distances between modes each grouping is what invariants of these lists would be.
        for group in [vec![1], vec![2], vec![3], vec![1, 2], vec![2, 3], vec![1, 2, 3]] {
            let kind = if group.len() == 1 { OutputKind::Eigenvalue } else { OutputKind::Cluster };
            let mut output = Target::Eigenvalues.outputs(&[1], &[spectrum(x)]).unwrap().remove(0);
            output.components =
                (0..2 * group.len()).map(|id| Component { id, name: String::new(), center: 0.0, scale: 1.0 }).collect();
            (output.kind, output.modes) = (kind, group.clone());
            let values = |x: f64| {
                let mut values = vec![0.0; output.components.len()];
                decompose(&output, &spectrum(x), &mut values).unwrap();
                values
            };
            let found = system.differentiate(&output).unwrap().remove(0);
            for ((slope, above), below) in found.iter().zip(values(x + STEP)).zip(values(x - STEP)) {
                let difference = (above - below) / (2.0 * STEP);
                assert!(
                    (slope - difference).abs() < DIFFERENCES * (1.0 + slope.abs()),
                    "{group:?}: {slope} {difference}"
                );
            }
        }
    }

    #[test]
    fn groups_that_touch_other_modes_have_no_slopes() {
        // Two equal oscillators, coupled in one direction only: a defective pair.
        let mut state = DMatrix::zeros(4, 4);
        state.view_mut((0, 2), (2, 2)).fill_with_identity();
        state.view_mut((2, 0), (2, 2)).copy_from(&dmatrix![-100.0, 1.0; 0.0, -100.0]);
        let schur = SchurForm::new(state.clone()).unwrap();
        let spectrum = Spectrum::new(&schur.eigenvalues()).unwrap();
        assert_eq!(ReducedSystem::new(&schur, &[state.clone()], &spectrum, &[1]), None);
        let both = ReducedSystem::new(&schur, &[state], &spectrum, &[1, 2]).unwrap();
        assert_eq!(both.slopes(&[1]), None);
        assert!(both.slopes(&[1, 2]).is_some());
        assert!(both.slopes(&[1, 3]).is_none(), "a mode that was not kept");
    }
}
