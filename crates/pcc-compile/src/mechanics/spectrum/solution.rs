//! The eigenvalues of a system with their accuracy, refined where the solver's digits do not reach.
//!
//! Most eigenvalues are far from deciding anything: their accuracy is looked at only where the growth rate is small
//! beside the whole spectrum, where eigenvalues come as λ and −λ̄, as those of undamped systems do, and where they are
//! slow. Of those that turn out to be known too badly, second-order systems have the quadratic problem to refine them
//! on (`refinement.rs`).

use super::refinement::{QuadraticProblem, Refined};
use crate::mechanics::model::SecondOrder;
use crate::numerics::accuracy::Accuracy;
use crate::numerics::eigenvalues::{EigenvalueError, SchurForm};
use nalgebra::{Complex, DMatrix};

/// Growth rates up to this share of the largest |λ| are looked at: errors of simple eigenvalues are far below.
const NEAR_AXIS: f64 = 1e-6;

/// So are eigenvalues up to this share of it: their errors are larger by its reciprocal.
const SLOW: f64 = 1e-3;

/// Relative errors of eigenvalues up to this are good enough.
const ACCURATE: f64 = 1e-9;

/// A growth rate that cannot be told from zero is refined if its error is so many times what no solver avoids.
const WORTH_REFINING: f64 = 100.0;

/// The eigenvalues of one system.
#[derive(Debug)]
pub struct Solution {
    schur: SchurForm,
    second_order: Option<SecondOrder>,
    eigenvalues: Vec<Complex<f64>>,
    accuracies: Vec<Accuracy>,
    refined: Vec<Option<Refined>>,
}

impl Solution {
    /// The eigenvalues of a state matrix, which is that of a second-order system or not.
    ///
    /// # Errors
    ///
    /// As [`SchurForm::new`].
    pub fn new(state_matrix: DMatrix<f64>, second_order: Option<SecondOrder>) -> Result<Self, EigenvalueError> {
        let schur = SchurForm::new(state_matrix)?;
        let eigenvalues = schur.eigenvalues();
        let least = Accuracy::least(sizes(&eigenvalues).into_iter().fold(0.0, f64::max));
        let count = eigenvalues.len();
        let (accuracies, refined) = (vec![least; count], vec![None; count]);
        Ok(Self { schur, second_order, eigenvalues, accuracies, refined })
    }

    /// Looks at the accuracy of all eigenvalues but `rigid_body_modes`, those with the smallest |λ|, and refines what
    /// needs it.
    pub fn look_closer(&mut self, rigid_body_modes: usize) {
        let sizes = sizes(&self.eigenvalues);
        let kept = without_smallest(&sizes, rigid_body_modes);
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        let is_suspect = |at: usize| {
            let (lambda, near) = (self.eigenvalues[at], NEAR_AXIS * largest);
            let mirrors = |other: &usize| {
                let other = self.eigenvalues[*other];
                (lambda.re + other.re).abs() <= near && (lambda.im - other.im).abs() <= near
            };
            lambda.im >= 0.0 && (sizes[at] <= SLOW * largest || kept.iter().any(mirrors))
        };
        let suspects: Vec<usize> = kept.iter().copied().filter(|&at| is_suspect(at)).collect();
        for (&at, accuracy) in suspects.iter().zip(self.schur.accuracies(&suspects)) {
            self.set(at, self.eigenvalues[at], accuracy, None);
        }
        let Some(second_order) = self.second_order.take() else { return };
        let problem = QuadraticProblem::new(&second_order);
        let worth = WORTH_REFINING * Accuracy::least(1.0).re;
        let is_worth_it = |at: &usize| {
            let (lambda, accuracy) = (self.eigenvalues[*at], self.accuracies[*at]);
            let is_undecided = lambda.re.abs() <= accuracy.re && accuracy.re > worth * lambda.norm();
            is_undecided || accuracy.whole > ACCURATE * lambda.norm()
        };
        let tried: Vec<usize> = suspects.into_iter().filter(is_worth_it).collect();
        let accuracies = tried.iter().map(|&at| self.accuracies[at]).collect();
        let refined = self.refine(&problem, &tried, accuracies);
        let found: Vec<(usize, Refined)> =
            tried.iter().zip(refined).filter_map(|(&at, refined)| Some((at, refined?))).collect();
        // Two that end at the same place are one that was found twice, and one that was not found.
        let is_distinct = |(at, one): &(usize, Refined)| {
            found.iter().all(|(other, two)| {
                other == at || (one.eigenvalue - two.eigenvalue).norm() > ACCURATE * one.eigenvalue.norm()
            })
        };
        let distinct: Vec<bool> = found.iter().map(is_distinct).collect();
        for ((at, refined), _) in found.into_iter().zip(distinct).filter(|(_, is_distinct)| *is_distinct) {
            self.set(at, refined.eigenvalue, refined.accuracy, Some(refined));
        }
        self.second_order = Some(second_order);
    }

    /// Eigenvalues of the solver at these positions with their accuracies, refined; none that has gone farther than its
    /// error.
    fn refine<'p>(
        &'p self,
        problem: &'p QuadraticProblem<'_>,
        positions: &'p [usize],
        accuracies: Vec<Accuracy>,
    ) -> impl Iterator<Item = Option<Refined>> + 'p {
        let states = self.schur.right_vectors(positions);
        let solved = self.schur.eigenvalues();
        positions.iter().zip(states).zip(accuracies).map(move |((&at, state), accuracy)| {
            let refined = problem.refine(solved[at], &state.rows(0, state.len() / 2).into_owned())?;
            let moved = (refined.eigenvalue - solved[at]).norm();
            (moved <= accuracy.whole.max(ACCURATE * solved[at].norm())).then_some(refined)
        })
    }

    fn set(&mut self, at: usize, lambda: Complex<f64>, accuracy: Accuracy, refined: Option<Refined>) {
        self.eigenvalues[at] = lambda;
        self.accuracies[at] = accuracy;
        if lambda.im > 0.0 && at + 1 < self.eigenvalues.len() {
            // The conjugate comes next.
            self.eigenvalues[at + 1] = lambda.conj();
            self.accuracies[at + 1] = accuracy;
            self.refined[at + 1] = refined.as_ref().map(Refined::conjugate);
        }
        self.refined[at] = refined;
    }

    /// All eigenvalues. The first of a conjugate pair has the positive imaginary part.
    pub fn eigenvalues(&self) -> &[Complex<f64>] {
        &self.eigenvalues
    }

    /// Their accuracy.
    pub fn accuracies(&self) -> &[Accuracy] {
        &self.accuracies
    }

    /// The Schur form they come from.
    pub fn schur(&self) -> &SchurForm {
        &self.schur
    }

    /// The matrices of a second-order system.
    pub(super) fn second_order(&self) -> Option<&SecondOrder> {
        self.second_order.as_ref()
    }

    /// The eigenvalue at a position with its vectors, if it was refined.
    pub(super) fn refined(&self, at: usize) -> Option<&Refined> {
        self.refined[at].as_ref()
    }

    /// The eigenvalues at these positions of a second-order system with vectors of their own, refined or not; `None` if
    /// one of them cannot be separated from others.
    pub(super) fn with_vectors(&self, positions: &[usize]) -> Option<Vec<Refined>> {
        let problem = QuadraticProblem::new(self.second_order.as_ref()?);
        // The upper half of each pair, once.
        let upper = |at: usize| if self.eigenvalues[at].im < 0.0 { at.saturating_sub(1) } else { at };
        let mut missing: Vec<usize> =
            positions.iter().map(|&at| upper(at)).filter(|&at| self.refined[at].is_none()).collect();
        missing.sort_unstable();
        missing.dedup();
        let accuracies = self.schur.accuracies(&missing);
        let found: Vec<Refined> = self.refine(&problem, &missing, accuracies).collect::<Option<_>>()?;
        let of = |&at: &usize| {
            if let Some(refined) = &self.refined[at] {
                return Some(refined.clone());
            }
            let half = &found[missing.binary_search(&upper(at)).ok()?];
            let own = if upper(at) == at { half.clone() } else { half.conjugate() };
            // Known to the digits of the solver before, it keeps its number.
            Some(Refined { eigenvalue: self.eigenvalues[at], ..own })
        };
        positions.iter().map(of).collect()
    }
}

/// Positions of all eigenvalues with these |λ| but so many of the smallest, in their order.
pub(super) fn without_smallest(sizes: &[f64], count: usize) -> Vec<usize> {
    if count == 0 {
        return (0..sizes.len()).collect();
    }
    let mut by_size: Vec<usize> = (0..sizes.len()).collect();
    by_size.sort_by(|&a, &b| sizes[a].total_cmp(&sizes[b]).then(a.cmp(&b)));
    let mut kept = by_size.split_off(count.min(sizes.len()));
    kept.sort_unstable();
    kept
}

pub(super) fn sizes(eigenvalues: &[Complex<f64>]) -> Vec<f64> {
    eigenvalues.iter().map(|lambda| lambda.norm()).collect()
}
