//! Eigenvalues of a second-order system, refined on the quadratic problem itself.
//!
//! A solver that rounds to ε‖K‖ leaves a slow mode ω beside a fast one ω₀ with an error of ε ω₀²/2ω. The residual of
//! the quadratic problem P(λ) = λ²M + λC + K, in twofold precision, has no such error, and Newton's method on
//!
//! P(λ) u = 0,   u₀ᴴ u = 1
//!
//! with one factorised matrix \[P(σ), P′(σ)u₀; u₀ᴴ, 0\] takes it away: eigenvalue and right vector are those of the
//! matrices as they are stored, to their last digits (Tisseur and Meerbergen 2001,
//! <https://doi.org/10.1137/S0036144500381988>, section 5; Rump 2001, <https://doi.org/10.1016/S0024-3795(00)00279-2>).
//! The transposed matrix gives the left vector.
//!
//! How far matrices with rounded entries can move a growth rate is bounded entry by entry. With g = w uᵀ/(wᵀP′(λ)u),
//!
//! |Re δλ| ≤ c ε Σ_ij (|K_ij||Re g_ij| + |C_ij||Re λg_ij| + |M_ij||Re λ²g_ij|) + c ε|λ|.

use crate::mechanics::model::SecondOrder;
use crate::numerics::accuracy::{Accuracy, SAFETY};
use crate::numerics::twofold::TwofoldComplex;
use nalgebra::{Complex, DMatrix, DVector, Dyn, LU};

/// Newton steps at most: each takes two digits where the width of the spectrum leaves them.
const STEPS: usize = 25;

/// Corrections of vectors this small, relative to their length, are rounding.
const SETTLED: f64 = 1e-13;

/// Corrections of the last step up to this are good enough for vectors of close modes.
const ACCEPTED: f64 = 1e-9;

/// An eigenvalue with its vectors, of the quadratic problem.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Refined {
    /// λ, in 1/s.
    pub eigenvalue: Complex<f64>,
    /// u, of length one.
    pub right: DVector<Complex<f64>>,
    /// w, with wᵀP′(λ)u = 1.
    pub left: DVector<Complex<f64>>,
    /// How well it is known, given matrices with rounded entries.
    pub accuracy: Accuracy,
}

/// The entries of a matrix that are not zero.
#[derive(Debug, Clone, PartialEq)]
struct Entries(Vec<(usize, usize, f64)>);

impl Entries {
    fn of(matrix: &DMatrix<f64>) -> Self {
        let rows = matrix.nrows();
        let entry = |(at, &value): (usize, &f64)| (at % rows, at / rows, value);
        Self(matrix.iter().enumerate().filter(|(_, value)| **value != 0.0).map(entry).collect())
    }

    fn add_product(&self, vector: &[TwofoldComplex], transposed: bool, sum: &mut [TwofoldComplex]) {
        for &(row, column, value) in &self.0 {
            let (to, from) = if transposed { (column, row) } else { (row, column) };
            sum[to].add_product(value, vector[from]);
        }
    }
}

/// P(λ) = λ²M + λC + K.
#[derive(Debug)]
pub(super) struct QuadraticProblem<'s> {
    system: &'s SecondOrder,
    mass: Entries,
    damping: Entries,
    stiffness: Entries,
}

impl<'s> QuadraticProblem<'s> {
    pub fn new(system: &'s SecondOrder) -> Self {
        let SecondOrder { mass, damping, stiffness } = system;
        Self { system, mass: Entries::of(mass), damping: Entries::of(damping), stiffness: Entries::of(stiffness) }
    }

    /// The eigenvalue nearest to an approximate one with its right vector u; `None` where Newton's method does not
    /// settle, as for eigenvalues that coalesce.
    pub fn refine(&self, eigenvalue: Complex<f64>, right: &DVector<Complex<f64>>) -> Option<Refined> {
        let length = right.norm();
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let start = right.unscale(length);
        let bordered = Bordered::new(self, eigenvalue, &start)?;
        let (mut lambda, mut u) = (eigenvalue, start.clone());
        settle(|| {
            let residual = self.times(lambda, &u, false);
            let (step, change) = bordered.solve(&-residual, Complex::default())?;
            u += &step;
            lambda += change;
            Some(step.norm().max(change.norm() / lambda.norm().max(f64::MIN_POSITIVE)))
        })?;
        if eigenvalue.im == 0.0 {
            lambda.im = 0.0;
        }
        let left = self.left_vector(&bordered, lambda, &u)?;
        let accuracy = self.accuracy(lambda, &u, &left);
        Some(Refined { eigenvalue: lambda, right: u, left, accuracy })
    }

    /// w with P(λ)ᵀw = 0 and wᵀP′(λ)u = 1.
    fn left_vector(
        &self,
        bordered: &Bordered,
        lambda: Complex<f64>,
        u: &DVector<Complex<f64>>,
    ) -> Option<DVector<Complex<f64>>> {
        let (size, one) = (u.len(), Complex::new(1.0, 0.0));
        let mut w = bordered.solve_transposed(&DVector::zeros(size), one)?.0;
        settle(|| {
            let residual = self.times(lambda, &w, true);
            // The border keeps wᵀP′(σ)u₀ as it is.
            let (step, _) = bordered.solve_transposed(&-residual, Complex::default())?;
            let change = step.norm() / w.norm();
            w += step;
            Some(change)
        })?;
        let scale = w.dot(&self.derivative_times(lambda, u));
        (scale.norm() > 0.0).then(|| w / scale)
    }

    /// P(λ)x or P(λ)ᵀx, rounded once.
    fn times(&self, lambda: Complex<f64>, x: &DVector<Complex<f64>>, transposed: bool) -> DVector<Complex<f64>> {
        let plain: Vec<TwofoldComplex> = x.iter().map(|&entry| entry.into()).collect();
        let once: Vec<TwofoldComplex> = plain.iter().map(|entry| entry.times(lambda)).collect();
        let twice: Vec<TwofoldComplex> = once.iter().map(|entry| entry.times(lambda)).collect();
        let mut sum = vec![TwofoldComplex::default(); x.len()];
        self.stiffness.add_product(&plain, transposed, &mut sum);
        self.damping.add_product(&once, transposed, &mut sum);
        self.mass.add_product(&twice, transposed, &mut sum);
        DVector::from_iterator(x.len(), sum.into_iter().map(TwofoldComplex::rounded))
    }

    /// P′(λ)x = (2λM + C)x.
    fn derivative_times(&self, lambda: Complex<f64>, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        let mut sum = DVector::zeros(x.len());
        self.mass.0.iter().for_each(|&(row, column, value)| sum[row] += x[column] * (lambda * (2.0 * value)));
        self.damping.0.iter().for_each(|&(row, column, value)| sum[row] += x[column] * value);
        sum
    }

    fn accuracy(&self, lambda: Complex<f64>, u: &DVector<Complex<f64>>, w: &DVector<Complex<f64>>) -> Accuracy {
        let mut sums = (0.0, 0.0);
        let mut add = |entries: &Entries, factor: Complex<f64>| {
            for &(row, column, value) in &entries.0 {
                let moved = factor * w[row] * u[column] * value;
                sums = (sums.0 + moved.re.abs(), sums.1 + moved.norm());
            }
        };
        add(&self.stiffness, Complex::new(1.0, 0.0));
        add(&self.damping, lambda);
        add(&self.mass, lambda * lambda);
        let rounding = SAFETY * f64::EPSILON;
        Accuracy { re: rounding * (sums.0 + lambda.norm()), whole: rounding * (sums.1 + lambda.norm()) }
    }
}

impl Refined {
    /// The conjugate eigenvalue.
    pub fn conjugate(&self) -> Self {
        Self {
            eigenvalue: self.eigenvalue.conj(),
            right: self.right.conjugate(),
            left: self.left.conjugate(),
            accuracy: self.accuracy,
        }
    }

    /// (u, λu): the right vector of the state matrix.
    pub fn right_state(&self) -> DVector<Complex<f64>> {
        let size = self.right.len();
        DVector::from_fn(2 * size, |i, _| if i < size { self.right[i] } else { self.right[i - size] * self.eigenvalue })
    }

    /// Its left one, y with yᵀA = λyᵀ and yᵀ(u, λu) = 1: (λMᵀw + Cᵀw, Mᵀw).
    pub fn left_state(&self, system: &SecondOrder) -> DVector<Complex<f64>> {
        let size = self.left.len();
        let transposed = |matrix: &DMatrix<f64>, i: usize| -> Complex<f64> {
            matrix.column(i).iter().zip(&self.left).map(|(&entry, w)| w * entry).sum()
        };
        let inertia: Vec<Complex<f64>> = (0..size).map(|i| transposed(&system.mass, i)).collect();
        DVector::from_fn(2 * size, |i, _| match i < size {
            true => self.eigenvalue * inertia[i] + transposed(&system.damping, i),
            false => inertia[i - size],
        })
    }

    /// −wᵀ(λ′² dM + λ′ dC + dK) u′ for an eigenvalue λ′ with its vector u′: dλ/dx, if both are the same.
    pub fn moved_by(&self, other: &Self, derivative: &SecondOrder) -> Complex<f64> {
        let lambda = other.eigenvalue;
        let form = |matrix: &DMatrix<f64>| -> Complex<f64> {
            let of_column = |(column, u): (usize, &Complex<f64>)| -> Complex<f64> {
                let entries = matrix.column(column);
                u * entries
                    .iter()
                    .zip(&self.left)
                    .filter(|(k, _)| **k != 0.0)
                    .map(|(&k, w)| w * k)
                    .sum::<Complex<f64>>()
            };
            other.right.iter().enumerate().map(of_column).sum()
        };
        let SecondOrder { mass, damping, stiffness } = derivative;
        -(form(mass) * lambda * lambda + form(damping) * lambda + form(stiffness))
    }
}

/// Takes steps until they no longer shrink, which is rounding, or the lack of convergence: `None` then. A step says how
/// large it was, relative to what it changes.
fn settle(mut step: impl FnMut() -> Option<f64>) -> Option<()> {
    let mut before = f64::INFINITY;
    for _ in 0..STEPS {
        let size = step().filter(|size| size.is_finite())?;
        if size <= SETTLED || size >= 0.5 * before {
            before = before.min(size);
            break;
        }
        before = size;
    }
    (before <= ACCEPTED).then_some(())
}

/// \[P(σ), s P′(σ)u₀; s′ u₀ᴴ, 0\], factorised; border and matrix are brought to the same size.
struct Bordered {
    factors: LU<Complex<f64>, Dyn, Dyn>,
    lower: DMatrix<Complex<f64>>,
    upper: DMatrix<Complex<f64>>,
    /// s and s′.
    scales: (f64, f64),
}

impl Bordered {
    fn new(problem: &QuadraticProblem<'_>, shift: Complex<f64>, start: &DVector<Complex<f64>>) -> Option<Self> {
        let size = start.len();
        let SecondOrder { mass, damping, stiffness } = problem.system;
        let square = shift * shift;
        let mut matrix = DMatrix::zeros(size + 1, size + 1);
        for j in 0..size {
            for i in 0..size {
                matrix[(i, j)] = square * mass[(i, j)] + shift * damping[(i, j)] + stiffness[(i, j)];
            }
        }
        let border = problem.derivative_times(shift, start);
        let largest = matrix.iter().map(|entry: &Complex<f64>| entry.norm()).fold(0.0, f64::max);
        let scales = (largest / border.norm(), largest);
        for i in 0..size {
            matrix[(i, size)] = border[i] * scales.0;
            matrix[(size, i)] = start[i].conj() * scales.1;
        }
        let is_finite = matrix.iter().all(|entry| entry.re.is_finite() && entry.im.is_finite());
        is_finite.then(|| {
            let factors = matrix.lu();
            Self { lower: factors.l(), upper: factors.u(), factors, scales }
        })
    }

    /// The vector and the number that the border and the matrix make `vector` and `number` of.
    fn solve(
        &self,
        vector: &DVector<Complex<f64>>,
        number: Complex<f64>,
    ) -> Option<(DVector<Complex<f64>>, Complex<f64>)> {
        let size = vector.len();
        let mut right = vector.clone().insert_row(size, number * self.scales.1);
        self.factors.solve_mut(&mut right).then_some(())?;
        let last = right[size] * self.scales.0;
        Some((right.remove_row(size), last))
    }

    /// The same of the transposed matrix.
    fn solve_transposed(
        &self,
        vector: &DVector<Complex<f64>>,
        number: Complex<f64>,
    ) -> Option<(DVector<Complex<f64>>, Complex<f64>)> {
        let size = vector.len();
        let right = vector.clone().insert_row(size, number * self.scales.0);
        let right = self.upper.tr_solve_upper_triangular(&right)?;
        let mut right = self.lower.tr_solve_lower_triangular(&right)?;
        self.factors.p().inv_permute_rows(&mut right);
        let last = right[size] * self.scales.1;
        Some((right.remove_row(size), last))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    /// A body on a soft spring with a negative damper, coupled to a light one by a spring 10¹⁴ times as stiff.
    fn soft() -> SecondOrder {
        SecondOrder {
            mass: dmatrix![3.0, 0.0; 0.0, 1.0],
            damping: dmatrix![-0.5, 0.0; 0.0, 0.25],
            stiffness: dmatrix![1e14 + 8.0, -1e14; -1e14, 1e14],
        }
    }

    #[test]
    fn slow_modes_beside_fast_ones_are_known_to_their_last_digits() {
        // Together they are a body of 4 kg on 8 N/m with a damper of −0.25 N s/m, but for 1e-14.
        let expected = Complex::new(0.25 / 8.0, (2.0f64 - (0.25f64 / 8.0).powi(2)).sqrt());
        let (system, one) = (soft(), Complex::new(1.0, 0.0));
        let start = DVector::from_vec(vec![one, one * 0.9]);
        let found = QuadraticProblem::new(&system).refine(Complex::new(0.02, 1.3), &start).unwrap();
        assert!((found.eigenvalue - expected).norm() < 1e-12, "{}", found.eigenvalue);
        // Entries are rounded: 1e14 + 8 could be 1e14 + 8 + 1/64.
        assert!(found.accuracy.re < 1e-2 * expected.re && found.accuracy.whole > 1e-3);
    }

    #[test]
    fn vectors_of_the_state_matrix_are_biorthonormal_and_give_derivatives() {
        let system = SecondOrder {
            mass: dmatrix![2.0, 0.3; 0.1, 1.0],
            damping: dmatrix![0.1, 1.0; -1.0, 0.2],
            stiffness: dmatrix![40.0, -3.0; 5.0, 60.0],
        };
        let state = system.state_matrix().unwrap().map(|entry| Complex::new(entry, 0.0));
        let lambdas = crate::numerics::eigenvalues::eigenvalues(system.state_matrix().unwrap()).unwrap();
        let start = DVector::from_vec(vec![Complex::new(1.0, 0.1), Complex::new(0.4, -0.6)]);
        let problem = QuadraticProblem::new(&system);
        let upper = lambdas.iter().filter(|lambda| lambda.im > 0.0);
        let found: Vec<Refined> = upper.map(|&lambda| problem.refine(lambda, &start).unwrap()).collect();
        for (i, one) in found.iter().enumerate() {
            let (right, left) = (one.right_state(), one.left_state(&system));
            assert!((&state * &right - &right * one.eigenvalue).norm() < 1e-12 * state.norm());
            for (k, other) in found.iter().enumerate() {
                let expected = if i == k { 1.0 } else { 0.0 };
                assert!((left.dot(&other.right_state()) - expected).norm() < 1e-12, "{i} {k}");
            }
            let by = SecondOrder {
                mass: dmatrix![0.0, 1.0; 0.0, 0.0],
                damping: dmatrix![1.0, 0.0; 0.0, 0.0],
                stiffness: dmatrix![0.0, 3.0; 1.0, 0.0],
            };
            let moved = |step: f64| {
                let moved = SecondOrder {
                    mass: &system.mass + &by.mass * step,
                    damping: &system.damping + &by.damping * step,
                    stiffness: &system.stiffness + &by.stiffness * step,
                };
                QuadraticProblem::new(&moved).refine(one.eigenvalue, &one.right).unwrap().eigenvalue
            };
            let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!((one.moved_by(one, &by) - difference).norm() < 1e-8);
        }
    }
}
