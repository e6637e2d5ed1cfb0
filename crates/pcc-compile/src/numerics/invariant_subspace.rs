//! Invariant subspaces of groups of eigenvalues, and how well they are separated from the rest.
//!
//! The Schur form A = Q T Qᴴ is reordered until the eigenvalues of the group lead its diagonal,
//!
//! T = \[T₁₁, T₁₂; 0, T₂₂\],   T₁₁ R − R T₂₂ = T₁₂,   P = \[I, R; 0, 0\],
//!
//! with the spectral projector P of the group (Bai and Demmel 1993, <https://doi.org/10.1016/0024-3795(93)90286-W>;
//! LAPACK's `trsen`). Rotations that reorder are orthogonal, so nothing is lost where eigenvalues of the group
//! coalesce, which no basis of eigenvectors survives. What counts is the distance of the group from the other
//! eigenvalues.

use super::eigenvalues::SchurForm;
use nalgebra::linalg::givens::GivensRotation;
use nalgebra::{Complex, DMatrix, DVector, Vector2};

/// Relative errors of P beyond this share of one, estimated as ε times [`Subspace::amplification`], mean that the group
/// cannot be separated.
const LARGEST_ERROR: f64 = 1e-8;

/// Right-hand sides by which the separation is estimated.
const TRIALS: usize = 3;

/// Bases of a right and a left invariant subspace, biorthonormal: P = `right` · `left`.
#[derive(Debug, Clone, PartialEq)]
pub struct Subspace {
    /// V, n × k, with A V = V T₁₁.
    pub right: DMatrix<Complex<f64>>,
    /// W, k × n, with W A = T₁₁ W and W V = I.
    pub left: DMatrix<Complex<f64>>,
    /// T₁₁, upper triangular with the eigenvalues on its diagonal, in the order asked for.
    pub restricted: DMatrix<Complex<f64>>,
    /// (1 + ‖R‖²) ‖T‖/sep(T₁₁, T₂₂) in Frobenius norms and for the balanced matrix: an estimate of how much rounding
    /// errors of A are amplified in P, where ‖P‖₂² ≤ 1 + ‖R‖². The separation is the smallest ‖T₁₁X − XT₂₂‖/‖X‖: the
    /// distance of the eigenvalues, or much less where those of the group coalesce.
    pub amplification: f64,
}

impl Subspace {
    /// Whether the group is far enough from all other eigenvalues for P to be known to eight digits.
    pub fn is_separated(&self) -> bool {
        self.amplification * f64::EPSILON <= LARGEST_ERROR
    }

    /// The subspace of the eigenvalues at `positions`, all distinct, on the diagonal of an upper triangular matrix.
    ///
    /// # Panics
    ///
    /// If a position is beyond the matrix.
    pub fn of_triangular(mut triangular: DMatrix<Complex<f64>>, positions: &[usize]) -> Self {
        let size = triangular.nrows();
        let mut basis = DMatrix::identity(size, size);
        reorder(&mut triangular, &mut basis, positions);
        let group = positions.len();
        let rest = size - group;
        let restricted = triangular.view((0, 0), (group, group)).into_owned();
        let others = triangular.view((group, group), (rest, rest)).into_owned();
        let coupling = sylvester(&restricted, &others, triangular.view((0, group), (group, rest)).into_owned());
        let mut left = DMatrix::zeros(group, size);
        left.view_mut((0, 0), (group, group)).fill_with_identity();
        left.view_mut((0, group), (group, rest)).copy_from(&coupling);
        let amplification =
            (1.0 + coupling.norm_squared()) * triangular.norm() * inverse_separation(&restricted, &others);
        Self {
            right: basis.columns(0, group).into_owned(),
            left: left * basis.adjoint(),
            restricted,
            amplification: if amplification.is_nan() { f64::INFINITY } else { amplification },
        }
    }
}

impl SchurForm {
    /// The invariant subspace of the eigenvalues at `positions`, all distinct, in the order of
    /// [`SchurForm::eigenvalues`].
    ///
    /// # Panics
    ///
    /// If a position is beyond the matrix.
    ///
    /// # Examples
    ///
    /// ```
    /// use nalgebra::dmatrix;
    /// use pcc_compile::numerics::eigenvalues::SchurForm;
    /// // A defective pair at 2, and 5: no basis of eigenvectors, but an invariant subspace.
    /// let schur = SchurForm::new(dmatrix![2.0, 1.0, 3.0; 0.0, 2.0, 4.0; 0.0, 0.0, 5.0])?;
    /// let subspace = schur.subspace(&[0, 1]);
    /// let projector = &subspace.right * &subspace.left;
    /// assert!((&projector * &projector - &projector).norm() < 1e-14 && subspace.is_separated());
    /// # Ok::<(), pcc_compile::numerics::eigenvalues::EigenvalueError>(())
    /// ```
    pub fn subspace(&self, positions: &[usize]) -> Subspace {
        let (triangular, basis) = triangular_form(self, self.basis().clone());
        let Subspace { right, left, restricted, amplification } = Subspace::of_triangular(triangular, positions);
        let (mut right, mut left) = (&basis * right, left * basis.adjoint());
        for (i, &factor) in self.balance().iter().enumerate() {
            right.row_mut(i).scale_mut(factor);
            left.column_mut(i).unscale_mut(factor);
        }
        Subspace { right, left, restricted: restricted.scale(self.scale()), amplification }
    }
}

/// T with its 2 × 2 blocks made triangular, and `basis` turned with it; the eigenvalue with positive imaginary part
/// comes first.
pub(super) fn triangular_form(
    schur: &SchurForm,
    basis: DMatrix<f64>,
) -> (DMatrix<Complex<f64>>, DMatrix<Complex<f64>>) {
    let to_complex = |matrix: &DMatrix<f64>| matrix.map(|entry| Complex::new(entry, 0.0));
    let (mut triangular, mut basis) = (to_complex(schur.triangular()), to_complex(&basis));
    let lambdas = schur.eigenvalues();
    for i in 1..triangular.nrows() {
        if schur.triangular()[(i, i - 1)] != 0.0 {
            // An eigenvector of \[a, b; c, d\] is (b, λ − a) or (λ − d, c), whichever is longer.
            let lambda = lambdas[i - 1] / schur.scale();
            let first = Vector2::new(triangular[(i - 1, i)], lambda - triangular[(i - 1, i - 1)]);
            let second = Vector2::new(lambda - triangular[(i, i)], triangular[(i, i - 1)]);
            let eigenvector = if first.norm_squared() > second.norm_squared() { first } else { second };
            lead(&mut triangular, &mut basis, i - 1, &eigenvector);
        }
    }
    (triangular, basis)
}

/// Moves the diagonal entries at `positions` to the front, in this order, by exchanges of neighbours.
fn reorder(triangular: &mut DMatrix<Complex<f64>>, basis: &mut DMatrix<Complex<f64>>, positions: &[usize]) {
    // order[k] is the former position of the entry that is now at k.
    let mut order: Vec<usize> = (0..triangular.nrows()).collect();
    for (target, &position) in positions.iter().enumerate() {
        let from = order.iter().position(|&former| former == position).expect("a position of the matrix");
        for k in (target..from).rev() {
            let (upper, lower) = (triangular[(k, k)], triangular[(k + 1, k + 1)]);
            lead(triangular, basis, k, &Vector2::new(triangular[(k, k + 1)], lower - upper));
            (triangular[(k, k)], triangular[(k + 1, k + 1)]) = (lower, upper);
            order.swap(k, k + 1);
        }
    }
}

/// Rotates coordinates k and k + 1 so that an eigenvector of the 2 × 2 block there becomes the first of the two.
fn lead(
    triangular: &mut DMatrix<Complex<f64>>,
    basis: &mut DMatrix<Complex<f64>>,
    k: usize,
    eigenvector: &Vector2<Complex<f64>>,
) {
    // No rotation is needed where the eigenvector is the first coordinate already.
    let Some((rotation, _)) = GivensRotation::cancel_y(eigenvector) else { return };
    rotation.rotate(&mut triangular.fixed_rows_mut::<2>(k));
    let inverse = rotation.inverse();
    inverse.rotate_rows(&mut triangular.fixed_columns_mut::<2>(k));
    inverse.rotate_rows(&mut basis.fixed_columns_mut::<2>(k));
    triangular[(k + 1, k)] = Complex::new(0.0, 0.0);
}

/// An estimate of 1/sep(A, B), the norm of the solution operator of A X − X B = C, by solving for right-hand sides that
/// have no structure: each has about 1/√dimension of its length in the worst direction.
fn inverse_separation(a: &DMatrix<Complex<f64>>, b: &DMatrix<Complex<f64>>) -> f64 {
    let (rows, columns) = (a.nrows(), b.nrows());
    let trial = |number: usize| {
        let phase = |i: usize, j: usize| (1 + i * columns + j) as f64 * (number as f64 + 2.0).sqrt();
        let unstructured = DMatrix::from_fn(rows, columns, |i, j| Complex::new(phase(i, j).sin(), phase(i, j).cos()));
        let length = unstructured.norm();
        sylvester(a, b, unstructured).norm() / length
    };
    let largest = (0..TRIALS)
        .map(trial)
        .fold(0.0, |largest: f64, ratio| if ratio >= largest { ratio } else { largest.max(ratio) });
    if rows * columns == 0 { 0.0 } else { largest * ((rows * columns) as f64).sqrt() }
}

/// R of A R − R B = C for upper triangular A and B, column by column; not finite if they share an eigenvalue.
fn sylvester(
    a: &DMatrix<Complex<f64>>,
    b: &DMatrix<Complex<f64>>,
    mut c: DMatrix<Complex<f64>>,
) -> DMatrix<Complex<f64>> {
    for j in 0..c.ncols() {
        let mut column: DVector<Complex<f64>> = c.column(j).into_owned();
        for l in 0..j {
            column.axpy(b[(l, j)], &c.column(l), Complex::new(1.0, 0.0));
        }
        for i in (0..column.len()).rev() {
            let known: Complex<f64> = (i + 1..column.len()).map(|l| a[(i, l)] * column[l]).sum();
            column[i] = (column[i] - known) / (a[(i, i)] - b[(j, j)]);
        }
        c.set_column(j, &column);
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::probability::random::{Purpose, Stream};
    use proptest::prelude::*;

    fn random(size: usize, seed: u64) -> DMatrix<f64> {
        let mut stream = Stream::new(seed, Purpose::Design, 0);
        DMatrix::from_fn(size, size, |_, _| stream.next_unit() - 0.5)
    }

    fn complex(matrix: &DMatrix<f64>) -> DMatrix<Complex<f64>> {
        matrix.map(|entry| Complex::new(entry, 0.0))
    }

    fn largest(matrix: DMatrix<Complex<f64>>) -> f64 {
        matrix.iter().map(|entry| entry.norm()).fold(0.0, f64::max)
    }

    proptest! {
        #[test]
        fn subspaces_are_invariant_and_biorthonormal(size in 2..14usize, seed in 0..500u64, group in 1..5usize) {
            let mut matrix = random(size, seed);
            // Rows and columns of different units, as in a state matrix.
            for i in 0..size {
                matrix.row_mut(i).scale_mut(10f64.powi(i as i32 % 3 * 2));
            }
            let schur = SchurForm::new(matrix.clone()).unwrap();
            let lambdas = schur.eigenvalues();
            let positions: Vec<usize> = (0..group.min(size)).map(|k| (k * 7 + seed as usize) % size).fold(Vec::new(), |mut all, k| {
                if !all.contains(&k) { all.push(k); }
                all
            });
            let subspace = schur.subspace(&positions);
            prop_assume!(subspace.amplification < 1e4);
            let Subspace { right, left, restricted, .. } = subspace;
            let tolerance = 1e-9;
            let group = positions.len();
            prop_assert!(largest(&left * &right - DMatrix::identity(group, group)) < tolerance);
            let scale = matrix.amax() * largest(right.clone());
            prop_assert!(largest(complex(&matrix) * &right - &right * &restricted) < tolerance * scale);
            prop_assert!(largest(&left * complex(&matrix) - &restricted * &left) < tolerance * matrix.amax() * largest(left.clone()));
            for (k, &position) in positions.iter().enumerate() {
                prop_assert!((restricted[(k, k)] - lambdas[position]).norm() < tolerance * matrix.amax());
            }
        }
    }

    #[test]
    fn groups_that_touch_the_rest_are_not_separated() {
        let distance = |gap: f64| {
            let triangular = complex(&nalgebra::dmatrix![1.0, 1.0, 0.0; 0.0, 1.0 + gap, 1.0; 0.0, 0.0, 3.0]);
            Subspace::of_triangular(triangular, &[0])
        };
        assert!(distance(0.1).is_separated());
        assert!(!distance(1e-6).is_separated());
        assert!(!distance(0.0).is_separated());
    }

    /// A coalesced pair is closer to a third eigenvalue than the distance says: by its square.
    #[test]
    fn groups_of_coalescing_eigenvalues_need_more_distance() {
        let at = |gap: f64| {
            let triangular = complex(&nalgebra::dmatrix![1.0, 1.0, 0.3; 0.0, 1.0, 0.5; 0.0, 0.0, 1.0 + gap]);
            Subspace::of_triangular(triangular, &[0, 1])
        };
        assert!(at(0.1).is_separated());
        assert!(!at(1e-4).is_separated());
        // sep ≈ gap², and ‖P‖² grows, too.
        assert!(at(1e-2).amplification > 1e4);
    }

    #[test]
    fn a_whole_space_is_separated_from_nothing() {
        let subspace = SchurForm::new(random(4, 1)).unwrap().subspace(&[3, 1, 0, 2]);
        assert!(
            subspace.amplification == 0.0
                && largest(&subspace.right * &subspace.left - DMatrix::identity(4, 4)) < 1e-13
        );
    }
}
