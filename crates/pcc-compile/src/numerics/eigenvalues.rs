//! Eigenvalues of a real general matrix: scaled, balanced, with a bounded number of iterations.
//!
//! Balancing comes first because the entries of a state matrix span eight orders of magnitude (ones beside stiffness
//! over mass). For a 6-degree-of-freedom system it takes the error of Re λ from 7e-8 to 2e-11 1/s.
//!
//! The QR iteration can stall. Rigid-body motion makes zero a multiple, defective eigenvalue, whose computed copies
//! scatter, and in rare cases (one clutch in some millions) the iteration circles around them. In another orthogonal
//! basis the same matrix has other roundings and converges. Two conjugate pairs that are the same but for a shift make
//! it circle in every basis, because double shifts halfway between them treat both alike. Single complex shifts do not,
//! so inverse iteration gives an eigenvalue, an orthogonal basis splits off its invariant subspace, and the rest goes
//! on alone.
//!
//! The Schur form A = D S Q T Qᵀ D⁻¹ is kept for those who need invariant subspaces: D balances, the power of two S
//! scales.

use nalgebra::linalg::Schur;
use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{Complex, DMatrix, DVector};
use thiserror::Error;

/// QR sweeps allowed per row of the matrix in each basis. Two or three are usual.
const SWEEPS_PER_ROW: usize = 8;

/// Starts of the inverse iteration, and steps from each.
const STARTS: usize = 8;
const INVERSE_ITERATIONS: usize = 30;

/// Residual of an eigenvector relative to the norm of the matrix that rounding allows, per row.
const EXACT: f64 = 1e-15;

/// What is left below a block that was split off, relative to the matrix, at most: it is set to zero.
const SPLIT: f64 = 1e-13;

/// Why the eigenvalues of a matrix could not be computed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EigenvalueError {
    /// The matrix is not square or has no rows.
    #[error("the matrix is {rows} × {columns}; eigenvalues need a square matrix with at least one row")]
    NotSquare {
        /// Number of rows found.
        rows: usize,
        /// Number of columns found.
        columns: usize,
    },
    /// An entry is NaN or infinite.
    #[error("entry ({row}, {column}) of the matrix is {value}")]
    NotFinite {
        /// Row of the entry, from 1.
        row: usize,
        /// Column of the entry, from 1.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// The QR iteration reached its limit.
    #[error("the QR iteration did not converge within {iterations} sweeps, and no part could be split off")]
    NotConverged {
        /// Number of sweeps allowed.
        iterations: usize,
    },
}

/// All eigenvalues λ of `matrix`, in no particular order.
///
/// The matrix is divided by a power of two so that no intermediate overflows, balanced (Parlett and Reinsch with
/// 2-norms, James, Langou and Lowery 2014, <https://arxiv.org/abs/1401.5766>) and reduced to real Schur form. Conjugate
/// pairs come out as pairs.
///
/// # Errors
///
/// [`EigenvalueError::NotSquare`] and [`EigenvalueError::NotFinite`] for unusable matrices,
/// [`EigenvalueError::NotConverged`] if the iteration stalls whatever is tried.
///
/// # Examples
///
/// ```
/// use nalgebra::dmatrix;
/// let oscillator = dmatrix![0.0, 1.0; -4.0, 0.0];
/// let mut frequencies: Vec<f64> = pcc_compile::numerics::eigenvalues::eigenvalues(oscillator)?
///     .iter()
///     .map(|lambda| lambda.im)
///     .collect();
/// frequencies.sort_by(f64::total_cmp);
/// assert_eq!(frequencies, [-2.0, 2.0]);
/// # Ok::<(), pcc_compile::numerics::eigenvalues::EigenvalueError>(())
/// ```
pub fn eigenvalues(matrix: DMatrix<f64>) -> Result<Vec<Complex<f64>>, EigenvalueError> {
    SchurForm::new(matrix).map(|schur| schur.eigenvalues())
}

/// A = D (s Q T Qᵀ) D⁻¹ with a diagonal D and a scalar s of powers of two, an orthogonal Q and T upper triangular but
/// for 2 × 2 blocks on its diagonal.
#[derive(Debug, Clone, PartialEq)]
pub struct SchurForm {
    balance: DVector<f64>,
    scale: f64,
    basis: DMatrix<f64>,
    triangular: DMatrix<f64>,
}

impl SchurForm {
    /// The Schur form of `matrix`.
    ///
    /// # Errors
    ///
    /// As [`eigenvalues`].
    pub fn new(mut matrix: DMatrix<f64>) -> Result<Self, EigenvalueError> {
        let (rows, columns) = matrix.shape();
        if rows != columns || rows == 0 {
            return Err(EigenvalueError::NotSquare { rows, columns });
        }
        if let Some(at) = matrix.iter().position(|entry| !entry.is_finite()) {
            let (row, column) = (at % rows + 1, at / rows + 1);
            return Err(EigenvalueError::NotFinite { row, column, value: matrix[(row - 1, column - 1)] });
        }
        let scale = power_of_two_above(matrix.amax());
        matrix /= scale;
        let balance = balance_parlett_reinsch(&mut matrix);

        let (basis, triangular) = real_schur(matrix)?;
        Ok(Self { balance, scale, basis, triangular })
    }

    /// All eigenvalues, in the order of the diagonal of T. The first of a conjugate pair has the positive imaginary
    /// part.
    pub fn eigenvalues(&self) -> Vec<Complex<f64>> {
        of_quasi_triangular(&self.triangular).iter().map(|lambda| lambda * self.scale).collect()
    }

    /// D, the diagonal matrix that balances.
    pub fn balance(&self) -> &DVector<f64> {
        &self.balance
    }

    /// s, the power of two that multiplies T.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Q.
    pub fn basis(&self) -> &DMatrix<f64> {
        &self.basis
    }

    /// T.
    pub fn triangular(&self) -> &DMatrix<f64> {
        &self.triangular
    }
}

/// Q and T of a real matrix Q T Qᵀ.
fn real_schur(matrix: DMatrix<f64>) -> Result<(DMatrix<f64>, DMatrix<f64>), EigenvalueError> {
    let size = matrix.nrows();
    let iterations = SWEEPS_PER_ROW * size;
    if let Some(schur) = Schur::try_new(matrix.clone(), f64::EPSILON, iterations) {
        return Ok(schur.unpack());
    }
    let start = reflection(size);
    if let Some(schur) = Schur::try_new(&start * &matrix * &start, f64::EPSILON, iterations) {
        let (basis, triangular) = schur.unpack();
        return Ok((start * basis, triangular));
    }
    by_splitting(&matrix).ok_or(EigenvalueError::NotConverged { iterations })
}

/// Some eigenvalue, by inverse iteration whose shift is its own Rayleigh quotient.
fn an_eigenvalue(matrix: &DMatrix<f64>) -> Option<Complex<f64>> {
    let size = matrix.nrows();
    let matrix = matrix.map(|entry| Complex::new(entry, 0.0));
    let largest = matrix.norm();
    let from = |start: usize| {
        // Different places in the upper half plane, and vectors that favour no coordinate.
        let angle = start as f64 + 0.5;
        let mut shift = Complex::from_polar(largest / (start + 2) as f64, angle.rem_euclid(std::f64::consts::PI));
        let mut vector =
            DVector::from_fn(size, |i, _| Complex::from_polar(1.0, angle * (i * i + 1) as f64)).normalize();
        for _ in 0..INVERSE_ITERATIONS {
            let shifted = &matrix - DMatrix::identity(size, size) * shift;
            let solved = shifted.lu().solve(&vector).filter(|found| found.iter().all(|entry| entry.is_finite()));
            // A shift that is an eigenvalue to the last bit cannot be solved with.
            let Some(solved) = solved else { return Some(shift) };
            vector = solved.normalize();
            let image = &matrix * &vector;
            shift = vector.dotc(&image);
            if (image - &vector * shift).norm() <= EXACT * size as f64 * largest {
                return Some(shift);
            }
        }
        None
    };
    (0..STARTS).find_map(from)
}

/// The same by splitting off the invariant subspace of one pair, or of one real eigenvalue.
fn by_splitting(matrix: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let size = matrix.nrows();
    let lambda = an_eigenvalue(matrix)?;
    // A − λ for a real one, (A − λ)(A − λ̄) for a pair: its null space is the subspace, and an orthogonal basis whose
    // first vectors are the null space splits it off.
    let is_real = lambda.im.abs() <= f64::EPSILON.sqrt() * lambda.norm();
    let identity = DMatrix::<f64>::identity(size, size);
    let (polynomial, split) = match is_real {
        true => (matrix - identity * lambda.re, 1),
        false => (matrix * matrix - matrix * (2.0 * lambda.re) + identity * lambda.norm_sqr(), 2),
    };
    if split >= size {
        return None;
    }
    // Rows of Vᵀ belong to singular values that fall.
    let right = polynomial.try_svd(false, true, f64::EPSILON, SWEEPS_PER_ROW * size)?.v_t?;
    let start = DMatrix::from_fn(size, size, |i, j| right[(size - 1 - j, i)]);
    let in_basis = start.transpose() * matrix * &start;
    let rest = size - split;
    if in_basis.view((split, 0), (rest, split)).amax() > SPLIT * size as f64 * in_basis.amax() {
        return None;
    }
    let (first_basis, first) = real_schur(in_basis.view((0, 0), (split, split)).into_owned()).ok()?;
    let (second_basis, second) = real_schur(in_basis.view((split, split), (rest, rest)).into_owned()).ok()?;
    let (mut basis, mut triangular) = (DMatrix::zeros(size, size), DMatrix::zeros(size, size));
    let corner = first_basis.transpose() * in_basis.view((0, split), (split, rest)) * &second_basis;
    triangular.view_mut((0, 0), (split, split)).copy_from(&first);
    triangular.view_mut((split, split), (rest, rest)).copy_from(&second);
    triangular.view_mut((0, split), (split, rest)).copy_from(&corner);
    basis.view_mut((0, 0), (split, split)).copy_from(&first_basis);
    basis.view_mut((split, split), (rest, rest)).copy_from(&second_basis);
    Some((start * basis, triangular))
}

/// The smallest power of two not below `magnitude`, within the range where it and its inverse are normal numbers.
fn power_of_two_above(magnitude: f64) -> f64 {
    if magnitude == 0.0 { 1.0 } else { magnitude.log2().ceil().clamp(-1000.0, 1000.0).exp2() }
}

/// The Householder reflection H = I − 2vvᵀ/vᵀv, v_i = 1 + 1/(i + 1): a basis that shares no symmetry with the
/// coordinate axes.
fn reflection(size: usize) -> DMatrix<f64> {
    let v = DVector::from_fn(size, |i, _| 1.0 + 1.0 / (i as f64 + 1.0));
    DMatrix::identity(size, size) - &v * v.transpose() * (2.0 / v.norm_squared())
}

/// Eigenvalues of the 1 × 1 and 2 × 2 diagonal blocks of a real Schur form. A block's eigenvalues are
/// (a + d)/2 ± √(bc + ((a − d)/2)²): a conjugate pair, or two real ones where rounding left a block with real
/// eigenvalues.
fn of_quasi_triangular(triangular: &DMatrix<f64>) -> Vec<Complex<f64>> {
    let size = triangular.nrows();
    let mut found = Vec::with_capacity(size);
    while found.len() < size {
        let i = found.len();
        if i + 1 == size || triangular[(i + 1, i)] == 0.0 {
            found.push(Complex::new(triangular[(i, i)], 0.0));
            continue;
        }
        let (a, b, c, d) =
            (triangular[(i, i)], triangular[(i, i + 1)], triangular[(i + 1, i)], triangular[(i + 1, i + 1)]);
        let (mean, half_difference) = (0.5 * (a + d), 0.5 * (a - d));
        let discriminant = b * c + half_difference * half_difference;
        let root = discriminant.abs().sqrt();
        let offset = if discriminant < 0.0 { Complex::new(0.0, root) } else { Complex::new(root, 0.0) };
        found.extend([Complex::new(mean, 0.0) + offset, Complex::new(mean, 0.0) - offset]);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    fn sorted_real_parts(matrix: DMatrix<f64>) -> Vec<f64> {
        let mut parts: Vec<f64> = eigenvalues(matrix).unwrap().iter().map(|lambda| lambda.re).collect();
        parts.sort_by(f64::total_cmp);
        parts
    }

    #[test]
    fn triangular_matrix_has_its_diagonal() {
        let parts = sorted_real_parts(dmatrix![3.0, 5.0, 7.0; 0.0, -1.0, 9.0; 0.0, 0.0, 2.0]);
        for (found, expected) in parts.iter().zip([-1.0, 2.0, 3.0]) {
            assert!((found - expected).abs() < 1e-14, "{found} is not {expected}");
        }
    }

    #[test]
    fn cyclic_permutations_converge_to_roots_of_unity() {
        for n in 3..12 {
            let cyclic = DMatrix::from_fn(n, n, |i, j| f64::from((i + 1) % n == j));
            for lambda in eigenvalues(cyclic).unwrap() {
                assert!((lambda.powi(n as i32) - Complex::new(1.0, 0.0)).norm() < 1e-12);
            }
        }
    }

    #[test]
    fn the_other_basis_has_the_same_eigenvalues() {
        let matrix = dmatrix![0.0, 1.0, 2.0; -4.0, 0.1, 3.0; 0.5, -7.0, -1.0];
        let sorted = |matrix: &DMatrix<f64>| {
            let mut all = eigenvalues(matrix.clone()).unwrap();
            all.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
            all
        };
        let start = reflection(3);
        for (a, b) in sorted(&matrix).iter().zip(sorted(&(&start * &matrix * &start))) {
            assert!((a - b).norm() < 1e-13);
        }
    }

    /// Splitting must be as exact as the iteration where that converges, too.
    #[test]
    fn splitting_gives_a_schur_form() {
        for matrix in [
            dmatrix![0.0, 1.0, 2.0, 0.3; -4.0, 0.1, 3.0, 1.0; 0.5, -7.0, -1.0, 0.2; 1.0, 2.0, 3.0, 4.0],
            dmatrix![3.0, 5.0, 7.0; 0.0, -1.0, 9.0; 0.0, 0.0, 2.0],
        ] {
            let (basis, triangular) = by_splitting(&matrix).unwrap();
            assert!((&basis * &triangular * basis.transpose() - &matrix).amax() < 1e-14 * matrix.amax());
            let size = matrix.nrows();
            assert!((basis.transpose() * &basis - DMatrix::identity(size, size)).amax() < 1e-14);
            let below = (2..size).flat_map(|i| (0..i - 1).map(move |j| (i, j)));
            assert!(below.into_iter().all(|at| triangular[at] == 0.0));
        }
    }

    #[test]
    fn the_schur_form_gives_the_matrix_back() {
        let matrix = dmatrix![0.0, 1.0, 2e6; -4e8, 0.1, 3.0; 0.5, -7.0, -1e3];
        let schur = SchurForm::new(matrix.clone()).unwrap();
        let mut product = schur.basis() * schur.triangular() * schur.basis().transpose() * schur.scale();
        for i in 0..3 {
            for j in 0..3 {
                product[(i, j)] *= schur.balance()[i] / schur.balance()[j];
                let tolerance = 1e-12 * schur.scale() * schur.balance()[i] / schur.balance()[j];
                assert!((product[(i, j)] - matrix[(i, j)]).abs() < tolerance, "({i}, {j})");
            }
        }
    }

    #[test]
    fn a_block_with_real_eigenvalues_is_split() {
        let block = dmatrix![1.0, 4.0; 1.0, 1.0];
        assert_eq!(of_quasi_triangular(&block), [Complex::new(3.0, 0.0), Complex::new(-1.0, 0.0)]);
    }

    #[test]
    fn extreme_magnitudes_scale_exactly() {
        let matrix = dmatrix![1.0, 2.0; 3.0, 4.0];
        let plain = sorted_real_parts(matrix.clone());
        for exponent in [-900, 900] {
            let scale = 2f64.powi(exponent);
            let scaled = sorted_real_parts(&matrix * scale);
            assert_eq!(scaled, [plain[0] * scale, plain[1] * scale]);
        }
    }

    /// Of a heavily damped rotor: two conjugate pairs, the same but for a shift.
    #[test]
    fn pairs_that_are_the_same_but_for_a_shift_do_not_stall() {
        let points = [
            (9.333946943854638, 3834.3434429094823, 48278.43697642798, 88106.47937275021),
            (11.03566532814278, 4869.380175792359, 21202.131705589694, 110827.76021373065),
            (8.54236824402345, 4139.802842004131, 23348.969004002094, 134536.26234940178),
        ];
        for (m, c, k, k_c) in points as [(f64, f64, f64, f64); 3] {
            let state = dmatrix![
                0.0, 0.0, 1.0, 0.0;
                0.0, 0.0, 0.0, 1.0;
                -k / m, -k_c / m, -c / m, 0.0;
                k_c / m, -1.4 * k / m, 0.0, -c / m
            ];
            // λ² + (c/m) λ + κ/m = 0 for the eigenvalues κ of K.
            let kappa = Complex::new(1.2 * k, (k_c * k_c - 0.04 * k * k).sqrt());
            let root = (Complex::new((0.5 * c / m).powi(2), 0.0) - kappa / m).sqrt();
            let found = eigenvalues(state).unwrap();
            for expected in [root, -root].map(|root| root - 0.5 * c / m) {
                for expected in [expected, expected.conj()] {
                    let nearest = found.iter().map(|lambda| (lambda - expected).norm()).fold(f64::INFINITY, f64::min);
                    assert!(nearest < 1e-11 * c / m, "{expected} is not among {found:?}");
                }
            }
        }
    }

    #[test]
    fn zero_matrix_has_zero_eigenvalues() {
        assert_eq!(sorted_real_parts(DMatrix::zeros(5, 5)), [0.0; 5]);
    }

    #[test]
    fn unusable_matrices_are_refused() {
        assert!(matches!(eigenvalues(DMatrix::zeros(2, 3)), Err(EigenvalueError::NotSquare { rows: 2, columns: 3 })));
        assert!(matches!(eigenvalues(DMatrix::zeros(0, 0)), Err(EigenvalueError::NotSquare { .. })));
        let poisoned = dmatrix![0.0, 1.0; f64::INFINITY, 0.0];
        assert_eq!(eigenvalues(poisoned), Err(EigenvalueError::NotFinite { row: 2, column: 1, value: f64::INFINITY }));
    }
}
