//! Rigid-body motion of a second-order system, told from slow modes.
//!
//! A body on soft springs has a stiffness that is nearly singular: what its own elements add and take away again is
//! 10¹² times as large as the springs, and singular values of K are lost in rounding. So the null space is looked for
//! where it can be seen. A vector φ is one of free motion if K φ vanishes row by row as far as rounding of the entries
//! of K explains, |Kφ|_i ≤ c ε (|K||φ|)_i, with K φ computed in twofold precision. Block inverse iteration finds the
//! candidates, with (K + σM)⁻¹ as an approximate inverse.
//!
//! Each such φ is an eigenvector for λ = 0. It counts twice where no damper holds the motion, ψᵀCφ = 0 for all ψ with
//! ψᵀK = 0: a body that is pushed moves on.

use crate::mechanics::model::SecondOrder;
use crate::numerics::twofold::Twofold;
use nalgebra::{DMatrix, DVector};

/// c: products of exact entries with a vector that is known to its last digits.
const ROUNDINGS: f64 = 64.0;

/// Steps of the block iteration. Each leaves a share σ/(σ + ω²) of a mode ω.
const STEPS: usize = 10;

/// σM beside K, relative.
const SHIFT: f64 = 1e-14;

/// The number of eigenvalues zero of a system that has `most` at most; `None` if it cannot be told.
pub fn free_motion(system: &SecondOrder, most: usize) -> Option<usize> {
    let size = system.stiffness.nrows();
    let right = null_space(&system.stiffness, &system.mass, most.min(size))?;
    if right.ncols() == 0 {
        return Some(0);
    }
    let left = null_space(&system.stiffness.transpose(), &system.mass.transpose(), most.min(size))?;
    let held = rank(&system.damping, &left, &right);
    Some((2 * right.ncols() - held).min(most))
}

/// Vectors whose motion no entry of `stiffness` resists, orthonormal, at most so many.
fn null_space(stiffness: &DMatrix<f64>, mass: &DMatrix<f64>, most: usize) -> Option<DMatrix<f64>> {
    let size = stiffness.nrows();
    let shift = SHIFT * stiffness.amax() / mass.amax();
    let approximate = (stiffness + mass * shift).lu();
    // Columns that favour no coordinate.
    let mut block = DMatrix::from_fn(size, most, |i, j| ((i + 1) as f64 * (j as f64 + 2.0).sqrt()).sin());
    for _ in 0..STEPS {
        let correction = approximate.solve(&product(stiffness, &block))?;
        block = (block - correction).qr().q();
        if !block.iter().all(|entry| entry.is_finite()) {
            return None;
        }
    }
    // What K does to every row, relative to what its entries do there.
    let reach = DVector::from_fn(size, |j, _| block.row(j).amax());
    let resisted = stiffness.abs() * reach;
    let mut image = product(stiffness, &block);
    for (mut row, &resisted) in image.row_iter_mut().zip(&resisted) {
        if resisted > 0.0 {
            row /= resisted;
        }
    }
    let decomposition = image.try_svd(false, true, f64::EPSILON, 0)?;
    let free = decomposition.singular_values.iter().filter(|value| **value <= ROUNDINGS * f64::EPSILON).count();
    // Rows of Vᵀ belong to singular values that fall.
    let turned = block * decomposition.v_t?.transpose();
    Some(turned.columns(most - free, free).into_owned())
}

/// The rank of ΨᵀCΦ, as far as entries of C tell.
fn rank(damping: &DMatrix<f64>, left: &DMatrix<f64>, right: &DMatrix<f64>) -> usize {
    let held = left.transpose() * product(damping, right);
    let reach = (left.abs().transpose() * damping.abs() * right.abs()).amax();
    let zero = ROUNDINGS * f64::EPSILON * reach;
    held.singular_values().iter().filter(|value| **value > zero).count()
}

/// matrix × block, each entry rounded once.
fn product(matrix: &DMatrix<f64>, block: &DMatrix<f64>) -> DMatrix<f64> {
    let mut sums = vec![Twofold::default(); matrix.nrows() * block.ncols()];
    for (column, entries) in matrix.column_iter().enumerate() {
        for (row, &entry) in entries.iter().enumerate().filter(|(_, entry)| **entry != 0.0) {
            for k in 0..block.ncols() {
                sums[k * matrix.nrows() + row].add_product(entry, block[(column, k)].into());
            }
        }
    }
    DMatrix::from_iterator(matrix.nrows(), block.ncols(), sums.into_iter().map(Twofold::rounded))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of `count` masses of 1 kg and springs of 10¹² N/m, with a soft spring and a damper to the ground at the
    /// first.
    fn chain(count: usize, soft: f64, damper: f64) -> SecondOrder {
        let mut stiffness = DMatrix::zeros(count, count);
        for i in 1..count {
            for (row, column, sign) in [(i, i, 1.0), (i - 1, i - 1, 1.0), (i, i - 1, -1.0), (i - 1, i, -1.0)] {
                stiffness[(row, column)] += sign * 1e12;
            }
        }
        stiffness[(0, 0)] += soft;
        let mut damping = DMatrix::zeros(count, count);
        damping[(0, 0)] = damper;
        SecondOrder { mass: DMatrix::identity(count, count), damping, stiffness }
    }

    #[test]
    fn free_chains_move_and_those_on_soft_springs_do_not() {
        for count in [2, 20, 60] {
            assert_eq!(free_motion(&chain(count, 0.0, 0.0), 2), Some(2), "{count}");
            assert_eq!(free_motion(&chain(count, 0.0, 0.5), 2), Some(1), "{count}, held by a damper");
            assert_eq!(free_motion(&chain(count, 1.0, 0.0), 2), Some(0), "{count}, on a spring");
        }
    }

    #[test]
    fn two_bodies_can_be_free_at_once() {
        let mut system = chain(6, 0.0, 0.0);
        for (row, column) in [(2, 3), (3, 2)] {
            system.stiffness[(row, column)] = 0.0;
        }
        (system.stiffness[(2, 2)], system.stiffness[(3, 3)]) = (1e12, 1e12);
        assert_eq!(free_motion(&system, 4), Some(4));
        system.damping[(0, 0)] = 2.0;
        assert_eq!(free_motion(&system, 4), Some(3));
    }
}
