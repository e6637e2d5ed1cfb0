//! Whether the runs have seen the rarer of stable and unstable, and what is known of it if they have not.
//!
//! Where fewer than three runs lie on the rarer side, nothing tells how far the share is off: residuals are those
//! of the other side. Such a level is *blind*, and no error is small enough. If none of the runs lies there, the
//! share can still be known to be zero, by the distance from the boundary. Every group of eigenvalues g has an
//! excess at a point, the largest of its eigenvalues, e_g, and a largest left-out error of that at the runs, ε_g.
//! Nothing is unstable if at every point at which shares are judged
//!
//! e_g < −10 ε_g for every group that may come out on top, e_g + 3 ε_g ≥ max_h (e_h − 3 ε_h),
//!
//! or the group is marginal there and at every run; and everything is unstable if e_g > 10 ε_g for some group.

use super::trials::is_not_unstable;
use pcc_evaluate::components::{Block, Output, beyond_rounding};
use pcc_evaluate::surrogate::{Surrogate, VerdictBasis};

/// Runs on the rarer side below which a level is blind.
pub(super) const LEAST_RARE: usize = 3;

/// Left-out errors within which zero may be reached: well above the three of [`ON_TOP`], since one point is enough.
const FAR: f64 = 10.0;

/// Left-out errors within which another group may be on top: errors are seldom three times those left out.
const ON_TOP: f64 = 3.0;

/// What the runs of a level have seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sight {
    /// Number of unstable runs.
    pub unstable: usize,
    /// Number of runs.
    pub runs: usize,
    /// Whether every eigenvalue is marginal at every run.
    pub is_marginal: bool,
    /// How far everything stays from the boundary, if it is far enough.
    pub clearance: Option<Clearance>,
    /// The number of points at which it does.
    pub points: usize,
}

/// How far everything stays from the boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Clearance {
    /// The excess that is nearest to zero, in 1/s.
    pub nearest: f64,
    /// The largest left-out error of what may decide, in 1/s.
    pub error: f64,
}

impl Sight {
    /// Whether too few runs lie on the rarer side for an estimate. Where nothing but rounding is seen, that is the
    /// result.
    pub fn is_blind(&self) -> bool {
        !self.is_marginal && self.rare() < LEAST_RARE
    }

    /// Number of runs on the rarer side.
    pub fn rare(&self) -> usize {
        self.unstable.min(self.runs - self.unstable)
    }
}

/// The groups of a surrogate at its runs.
pub(super) struct Groups {
    /// Left-out errors ε_g, in 1/s.
    errors: Vec<f64>,
    /// Whether the group is marginal at every run.
    are_marginal: Vec<bool>,
    /// Whether all its eigenvalues are.
    are_wholly_marginal: bool,
}

/// The largest excess of eigenvalues.
fn excess(verdict: &VerdictBasis, eigenvalues: impl Iterator<Item = nalgebra::Complex<f64>>) -> f64 {
    let each = eigenvalues.map(|lambda| verdict.margin.excess(verdict.settled(lambda)));
    beyond_rounding(each.fold(f64::NEG_INFINITY, f64::max), verdict.tolerance)
}

impl Groups {
    /// Of components with these `values`, one list each, and left-out `residuals`, one list per run.
    pub fn new(surrogate: &Surrogate, values: &[Vec<f64>], residuals: &[Vec<f64>]) -> Self {
        let verdict = &surrogate.verdict;
        let (mut errors, mut are_marginal) = (Vec::new(), Vec::new());
        let mut are_wholly_marginal = true;
        for output in &surrogate.outputs {
            let (mut error, mut is_marginal) = (0.0, true);
            for (i, rest) in residuals.iter().enumerate() {
                let exact: Vec<f64> = values.iter().map(|value| value[i]).collect();
                let predicted: Vec<f64> = exact.iter().zip(rest).map(|(value, rest)| value - rest).collect();
                let [exact, predicted] = [exact, predicted].map(|components| recombined(output, &components));
                let is_zero = |lambda: &nalgebra::Complex<f64>| excess(verdict, std::iter::once(*lambda)) == 0.0;
                are_wholly_marginal &= exact.iter().all(is_zero);
                let [exact, predicted] = [exact, predicted].map(|lambdas| excess(verdict, lambdas.into_iter()));
                is_marginal &= exact == 0.0;
                let off = (exact - predicted).abs();
                // An error that is no number is not known.
                error = if off <= error {
                    error
                } else if off.is_nan() {
                    f64::INFINITY
                } else {
                    off
                };
            }
            errors.push(error);
            are_marginal.push(is_marginal);
        }
        Self { errors, are_marginal, are_wholly_marginal }
    }

    /// What `unstable` of so many `runs` say, without the distance from the boundary.
    pub fn sight(&self, unstable: usize, runs: usize) -> Sight {
        Sight { unstable, runs, is_marginal: self.are_wholly_marginal, clearance: None, points: 0 }
    }

    /// How far everything stays from the boundary at the points of `block`, on the side of all runs.
    pub fn clearance(&self, surrogate: &Surrogate, block: &Block, is_stable: bool) -> Option<Clearance> {
        let mut worst: Option<Clearance> = None;
        let mut excesses = vec![0.0; self.errors.len()];
        for i in 0..block.excess.len() {
            let mut at = 0;
            for (output, own) in surrogate.outputs.iter().zip(&mut excesses) {
                let labels = at..at + output.eigenvalue_count();
                at = labels.end;
                *own = excess(&surrogate.verdict, block.eigenvalues[labels].iter().map(|list| list[i]));
            }
            let found = match is_stable {
                true => self.below(&excesses)?,
                false => self.above(&excesses)?,
            };
            let error = worst.map_or(found.error, |worst| worst.error.max(found.error));
            let nearest = match worst {
                Some(worst) if worst.nearest.abs() <= found.nearest.abs() => worst.nearest,
                _ => found.nearest,
            };
            worst = Some(Clearance { nearest, error });
        }
        worst
    }

    /// The largest excess of a point, if all that may be on top is far below zero.
    fn below(&self, excesses: &[f64]) -> Option<Clearance> {
        let groups = || excesses.iter().zip(&self.errors).zip(&self.are_marginal);
        let surely = groups().map(|((own, error), _)| own - ON_TOP * error).fold(f64::NEG_INFINITY, f64::max);
        let mut top = Clearance { nearest: f64::NEG_INFINITY, error: 0.0 };
        for ((&own, &error), &is_marginal) in groups() {
            if own + ON_TOP * error < surely {
                continue;
            }
            let is_far = own < -FAR * error || (is_marginal && own == 0.0);
            if !is_far {
                return None;
            }
            top = Clearance { nearest: top.nearest.max(own), error: top.error.max(error) };
        }
        Some(top)
    }

    /// The largest excess of a point, if it is far above zero.
    fn above(&self, excesses: &[f64]) -> Option<Clearance> {
        let far = excesses.iter().zip(&self.errors).filter(|&(&own, &error)| own > FAR * error && own > 0.0);
        let top = far.reduce(|a, b| if b.0 > a.0 { b } else { a })?;
        Some(Clearance { nearest: *top.0, error: *top.1 })
    }
}

fn recombined(output: &Output, components: &[f64]) -> Vec<nalgebra::Complex<f64>> {
    let mut found = Vec::with_capacity(output.eigenvalue_count());
    output.recombine(components, &mut found);
    found
}

/// Number of unstable runs, by the eigenvalues that the surrogate carries.
pub(super) fn unstable_runs(surrogate: &Surrogate, values: &[Vec<f64>], runs: usize) -> usize {
    let excess = |i: usize| surrogate.top(&values.iter().map(|value| value[i]).collect::<Vec<_>>()).excess;
    (0..runs).filter(|&i| !is_not_unstable(excess(i))).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn groups(errors: &[f64], are_marginal: &[bool]) -> Groups {
        Groups { errors: errors.to_vec(), are_marginal: are_marginal.to_vec(), are_wholly_marginal: false }
    }

    #[test]
    fn below_three_runs_on_either_side_a_level_is_blind() {
        let sight = |unstable| Sight { unstable, runs: 20, is_marginal: false, clearance: None, points: 0 };
        let blind: Vec<usize> = (0..=20).filter(|&unstable| sight(unstable).is_blind()).collect();
        assert_eq!(blind, [0, 1, 2, 18, 19, 20]);
        assert!(!Sight { is_marginal: true, ..sight(0) }.is_blind(), "marginal everywhere is a result");
    }

    #[test]
    fn ten_errors_below_zero_are_far_and_nine_are_not() {
        let two = groups(&[0.1, 0.5], &[false; 2]);
        assert_eq!(two.below(&[-1.1, -9.0]), Some(Clearance { nearest: -1.1, error: 0.1 }));
        assert_eq!(two.below(&[-0.9, -9.0]), None);
        assert_eq!(two.below(&[-1.1, -4.0]), Some(Clearance { nearest: -1.1, error: 0.1 }), "it cannot be on top");
        assert_eq!(two.below(&[-1.1, -2.5]), None, "it may be on top, and is not known well enough");
        assert_eq!(two.below(&[-1.1, 0.1]), None);
    }

    #[test]
    fn a_group_that_is_always_marginal_is_known() {
        let two = groups(&[0.0, 0.1], &[true, false]);
        assert_eq!(two.below(&[0.0, -2.0]), Some(Clearance { nearest: 0.0, error: 0.0 }));
        assert_eq!(groups(&[0.0, 0.1], &[false; 2]).below(&[0.0, -2.0]), None);
    }

    #[test]
    fn one_group_far_above_zero_is_enough_to_be_unstable() {
        let two = groups(&[0.1, 9.0], &[false; 2]);
        assert_eq!(two.above(&[1.1, -3.0]), Some(Clearance { nearest: 1.1, error: 0.1 }));
        assert_eq!(two.above(&[0.9, 3.0]), None);
        assert_eq!(groups(&[0.0], &[true]).above(&[0.0]), None, "marginal is not unstable");
    }
}
