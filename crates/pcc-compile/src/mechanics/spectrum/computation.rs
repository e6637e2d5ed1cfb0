//! What one run of a model gave, before it is known which eigenvalues a study groups.

use super::derivatives::ReducedSystem;
use super::labels::Vectors;
use super::modes::Spectrum;
use super::solution::{Solution, sizes, without_smallest};
use crate::mechanics::model::SecondOrder;
use crate::numerics::accuracy::Accuracy;
use nalgebra::{Complex, DMatrix, DVector};
use pcc_evaluate::components::OutputKind;

/// Of larger systems a list of modes is reduced alone: what reordering a Schur form costs grows as the third power.
const MOST_FOLLOWED: usize = 100;

/// The answer of one direct computation.
#[derive(Debug, Clone, PartialEq)]
pub struct Computation {
    /// Eigenvalues λ, in 1/s, as the model gave them: all of them, or those it was asked for.
    pub eigenvalues: Vec<Complex<f64>>,
    /// The accuracy of each; empty if the model knows nothing of it.
    pub accuracies: Vec<Accuracy>,
    /// The system with its derivatives, if they were asked for.
    pub reductions: Option<Reductions>,
}

impl Computation {
    /// The answer of a model that knows nothing but its eigenvalues.
    pub fn of_eigenvalues(eigenvalues: Vec<Complex<f64>>) -> Self {
        Self { eigenvalues, accuracies: Vec::new(), reductions: None }
    }
}

/// The derivatives of a system by each input, in physical units.
#[derive(Debug, Clone, Copy, Default)]
pub struct Slopes<'d> {
    /// Of the state matrix.
    pub state_matrix: &'d [DMatrix<f64>],
    /// Of the matrices of a second-order system; none of another.
    pub second_order: &'d [SecondOrder],
}

/// The state matrix and its derivatives on invariant subspaces: of the modes of interest, and of all eigenvalues where
/// those are not all or cannot be separated. Empty if nothing can be separated from rigid-body motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Reductions {
    /// Frequency ranks of the modes of interest, from 1.
    pub modes: Vec<usize>,
    /// The systems, that of the modes of interest first.
    pub systems: Vec<ReducedSystem>,
}

impl Reductions {
    /// Reduces a system that was solved and has this spectrum. The modes of interest have the frequency ranks `modes`.
    pub fn new(solution: &Solution, slopes: Slopes<'_>, spectrum: &Spectrum, modes: Vec<usize>) -> Self {
        let found = solution.eigenvalues();
        let of_interest: Vec<Complex<f64>> = modes.iter().filter_map(|&mode| spectrum.mode(mode).ok()).collect();
        let reduce = |lambdas: &[Complex<f64>]| match lambdas.is_empty() {
            true => None,
            false => ReducedSystem::new(solution, slopes, lambdas),
        };
        let mut systems: Vec<ReducedSystem> = reduce(&of_interest).into_iter().collect();
        let is_all = 2 * of_interest.len() == spectrum.eigenvalues().len();
        if systems.is_empty() || (!is_all && spectrum.eigenvalues().len() <= MOST_FOLLOWED) {
            // The numbers of the solver, where the spectrum has made real what is nearly so; in the order of the Schur
            // form, so that little of it has to change places.
            let kept = without_smallest(&sizes(found), spectrum.rigid_body_modes());
            systems.extend(reduce(&kept.into_iter().map(|at| found[at]).collect::<Vec<_>>()));
        }
        Self { modes, systems }
    }

    /// What follows from the derivatives of `eigenvalues` by each input, in physical units: one list per eigenvalue. Of
    /// a pair of which one half is given, the other has the conjugate derivatives. There are no vectors, so that
    /// nothing is followed by them. `None` if lists differ in length.
    ///
    /// # Examples
    ///
    /// ```
    /// use nalgebra::Complex;
    /// use pcc_compile::mechanics::spectrum::Reductions;
    /// use pcc_evaluate::components::OutputKind;
    /// let (lambda, slope) = (Complex::new(-1.0, 10.0), Complex::new(0.5, 2.0));
    /// let known = Reductions::of_slopes(&[lambda], &[vec![slope]]).expect("one input");
    /// assert_eq!(known.differentiate(OutputKind::Eigenvalue, &[lambda]), Some(vec![vec![0.5, 2.0]]));
    /// // λ + λ̄ and |λ|²
    /// let both = known.differentiate(OutputKind::Closed, &[lambda, lambda.conj()]).expect("with its conjugate");
    /// assert!((both[0][0] - 1.0).abs() < 1e-12 && (both[0][1] - 39.0).abs() < 1e-12);
    /// ```
    pub fn of_slopes(eigenvalues: &[Complex<f64>], slopes: &[Vec<Complex<f64>>]) -> Option<Self> {
        let conjugates = |list: &[Complex<f64>]| list.iter().map(Complex::conj).collect::<Vec<_>>();
        let is_alone = |lambda: &Complex<f64>| lambda.im != 0.0 && !eigenvalues.contains(&lambda.conj());
        let missing: Vec<usize> = (0..eigenvalues.len()).filter(|&k| is_alone(&eigenvalues[k])).collect();
        let all: Vec<Complex<f64>> =
            eigenvalues.iter().copied().chain(missing.iter().map(|&k| eigenvalues[k].conj())).collect();
        let slopes: Vec<Vec<Complex<f64>>> = slopes
            .iter()
            .cloned()
            .chain(missing.iter().map(|&k| conjugates(slopes.get(k).map_or(&[], Vec::as_slice))))
            .collect();
        let inputs = slopes.first()?.len();
        if slopes.len() != all.len() || slopes.iter().any(|list| list.len() != inputs) {
            return None;
        }
        let diagonal = |entries: Vec<Complex<f64>>| DMatrix::from_diagonal(&DVector::from_vec(entries));
        let derivatives = (0..inputs).map(|j| diagonal(slopes.iter().map(|list| list[j]).collect())).collect();
        let (right, left) = (DMatrix::zeros(0, all.len()), DMatrix::zeros(all.len(), 0));
        let system = ReducedSystem::from_parts(all.clone(), diagonal(all), derivatives, right, left)?;
        Some(Self { modes: Vec::new(), systems: vec![system] })
    }

    /// The derivatives of the components of a group ([`ReducedSystem::differentiate`]), from the first system that has
    /// them.
    pub fn differentiate(&self, kind: OutputKind, eigenvalues: &[Complex<f64>]) -> Option<Vec<Vec<f64>>> {
        self.systems.iter().find_map(|system| system.differentiate(kind, eigenvalues))
    }

    /// Right and left eigenvectors of all eigenvalues of a spectrum; `None` if some are not known.
    pub fn vectors(&self, spectrum: &Spectrum) -> Option<Vectors> {
        self.systems.iter().find_map(|system| Vectors::new(system, spectrum))
    }
}
