//! Rigid-body motion of a second-order system, told from slow modes.
//!
//! A body on soft springs has a stiffness that is nearly singular: what its own elements add and take away again is
//! 10¹² times as large as the springs, and singular values of K are lost in rounding. So the null space is looked for
//! where it can be seen. A vector φ is one of free motion if K φ vanishes row by row as far as rounding of the entries
//! of K explains, |Kφ|_i ≤ c ε (|K|m)_i with m_j = max(|φ_j|, max |φ|/64) and K φ computed in twofold precision: where
//! a motion has no part, φ_j is rounding. Block inverse iteration on the rows of K, each brought to size one, finds the
//! candidates.
//!
//! Each such φ is an eigenvector for λ = 0. It counts twice where no damper holds the motion, ψᵀCφ = 0 for all ψ with
//! ψᵀK = 0: a body that is pushed moves on.

use crate::mechanics::model::SecondOrder;
use crate::numerics::twofold::Twofold;
use nalgebra::{DMatrix, DVector};

/// c: products of exact entries with a vector that is known to its last digits.
const ROUNDINGS: f64 = 64.0;

/// Sweeps of a singular value decomposition per column: two or three are usual.
const SWEEPS: usize = 50;

/// Parts of a motion below this share of its largest are not known to all digits.
const LEAST_PART: f64 = 1.0 / 64.0;

/// Steps that take away what orthogonal bases have added.
const POLISHING: usize = 3;

/// Pivots of the approximate inverse for that, at least: a free motion is left as it is.
const LEAST_PIVOT: f64 = 1e-6;

/// Part of the candidate in what is left of a free motion after that, at least.
const STILL_THERE: f64 = 0.5;

/// Steps of the block iteration: each leaves (ε/σ)² of a motion with the singular value σ.
const STEPS: usize = 4;

/// The number of eigenvalues zero of a system that has `most` at most; `None` if it cannot be told.
pub fn free_motion(system: &SecondOrder, most: usize) -> Option<usize> {
    let size = system.stiffness.nrows();
    let right = null_space(&system.stiffness, most.min(size))?;
    if right.ncols() == 0 {
        return Some(0);
    }
    let left = null_space(&system.stiffness.transpose(), most.min(size))?;
    // They have the same dimension, unless something nearly free is in the way of one.
    if left.ncols() != right.ncols() {
        return None;
    }
    let held = rank(&system.damping, &left, &right);
    Some((2 * right.ncols() - held).min(most))
}

/// Vectors whose motion no entry of `stiffness` resists, orthonormal, at most so many.
fn null_space(stiffness: &DMatrix<f64>, most: usize) -> Option<DMatrix<f64>> {
    let size = stiffness.nrows();
    let inverse = Inverse::new(stiffness);
    // Columns that favour no coordinate.
    let mut block = DMatrix::from_fn(size, most, |i, j| ((i + 1) as f64 * (j as f64 + 2.0).sqrt()).sin());
    for _ in 0..STEPS {
        block = inverse.of_normal_equations(&block)?.qr().q();
        if !block.iter().all(|entry| entry.is_finite()) {
            return None;
        }
    }
    let (_, turned) = resistances(stiffness, &block)?;
    // The freest first; each is polished by itself.
    let mut free: Vec<DVector<f64>> = Vec::with_capacity(most);
    for candidate in turned.column_iter().rev() {
        let mut polished = DMatrix::from_column_slice(size, 1, candidate.as_slice());
        for _ in 0..POLISHING {
            polished -= inverse.solve(&product(stiffness, &polished))?;
        }
        let (resistance, _) = resistances(stiffness, &polished.normalize())?;
        // What is no free motion has vanished, or become another.
        let is_left = polished.column(0).dot(&candidate).abs() >= STILL_THERE * polished.norm();
        if !is_left || resistance[0] > ROUNDINGS * f64::EPSILON {
            break;
        }
        free.push(candidate.into_owned());
    }
    Some(DMatrix::from_fn(size, free.len(), |i, j| free[j][i]))
}

/// D⁻¹K = QR with the sums of the moduli of K's rows in D, and no pivot of R below ε, or below [`LEAST_PIVOT`].
struct Inverse {
    scales: DVector<f64>,
    q: DMatrix<f64>,
    r: DMatrix<f64>,
    polishing_r: DMatrix<f64>,
}

impl Inverse {
    fn new(stiffness: &DMatrix<f64>) -> Self {
        let scale = |row: usize| match stiffness.row(row).iter().map(|entry| entry.abs()).sum::<f64>() {
            sum if sum > 0.0 => sum,
            _ => 1.0,
        };
        let scales = DVector::from_fn(stiffness.nrows(), |row, _| scale(row));
        let scaled = DMatrix::from_fn(stiffness.nrows(), stiffness.ncols(), |i, j| stiffness[(i, j)] / scales[i]);
        let (q, r) = scaled.qr().unpack();
        let with_pivots = |least: f64| {
            let mut r = r.clone();
            for i in 0..r.nrows() {
                if r[(i, i)].abs() < least {
                    r[(i, i)] = least;
                }
            }
            r
        };
        Self { scales, q, r: with_pivots(f64::EPSILON), polishing_r: with_pivots(LEAST_PIVOT) }
    }

    /// (RᵀR)⁻¹ of a block: what is free grows.
    fn of_normal_equations(&self, block: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        self.r.solve_upper_triangular(&self.r.tr_solve_upper_triangular(block)?)
    }

    /// K⁻¹ of a block, about.
    fn solve(&self, block: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let scaled = DMatrix::from_fn(block.nrows(), block.ncols(), |i, j| block[(i, j)] / self.scales[i]);
        self.polishing_r.solve_upper_triangular(&(self.q.transpose() * scaled))
    }
}

/// What K does to the rows of a block of orthonormal vectors, relative to what its entries do there: singular values,
/// falling, and the block turned to their vectors.
fn resistances(stiffness: &DMatrix<f64>, block: &DMatrix<f64>) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let least = LEAST_PART * block.amax();
    let reach = DVector::from_fn(block.nrows(), |j, _| block.row(j).amax().max(least));
    let resisted = stiffness.abs() * reach;
    let mut image = product(stiffness, block);
    for (mut row, &resisted) in image.row_iter_mut().zip(&resisted) {
        if resisted > 0.0 {
            row /= resisted;
        }
    }
    if image.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    let sweeps = SWEEPS * image.ncols();
    let decomposition = image.try_svd(false, true, f64::EPSILON, sweeps)?;
    // Rows of Vᵀ belong to singular values that fall.
    Some((decomposition.singular_values, block * decomposition.v_t?.transpose()))
}

/// The rank of ΨᵀCΦ, as far as entries of C tell.
fn rank(damping: &DMatrix<f64>, left: &DMatrix<f64>, right: &DMatrix<f64>) -> usize {
    let held = left.transpose() * product(damping, right);
    let parts = |block: &DMatrix<f64>| block.map(|part| part.abs().max(LEAST_PART * block.amax()));
    let reach = (parts(left).transpose() * damping.abs() * parts(right)).amax();
    let zero = ROUNDINGS * f64::EPSILON * reach;
    let sweeps = SWEEPS * (held.ncols() + held.nrows());
    let Some(decomposition) = held.try_svd(false, false, f64::EPSILON, sweeps) else { return 0 };
    decomposition.singular_values.iter().filter(|value| **value > zero).count()
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

    /// A carriage on viscous rails beside a sprung mass, and a chain whose springs span eight decades.
    #[test]
    fn what_takes_no_part_and_what_is_softer_by_decades_hides_no_free_motion() {
        let carriage = SecondOrder {
            mass: DMatrix::identity(2, 2),
            damping: DMatrix::from_diagonal(&nalgebra::dvector![0.5, 0.1]),
            stiffness: DMatrix::from_diagonal(&nalgebra::dvector![0.0, 100.0]),
        };
        assert_eq!(free_motion(&carriage, 1), Some(1));
        // The damper of what stands beside holds nothing.
        let mut beside = chain(3, 0.0, 0.0);
        (beside.stiffness[(1, 2)], beside.stiffness[(2, 1)]) = (0.0, 0.0);
        (beside.stiffness[(1, 1)], beside.damping[(2, 2)]) = (1e12, 1.0);
        assert_eq!(free_motion(&beside, 2), Some(2));
        let mut uneven = chain(12, 0.0, 0.0);
        uneven.stiffness.fill(0.0);
        for i in 1..12 {
            let spring = 3.7 * 10f64.powf(8.0 * i as f64 / 11.0);
            for (row, column, sign) in [(i, i, 1.0), (i - 1, i - 1, 1.0), (i, i - 1, -1.0), (i - 1, i, -1.0)] {
                uneven.stiffness[(row, column)] += sign * spring;
            }
        }
        assert_eq!(free_motion(&uneven, 2), Some(2));
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
