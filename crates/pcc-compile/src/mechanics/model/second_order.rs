//! Second-order systems as first-order ones, with derivatives.

use super::ModelError;
use nalgebra::{DMatrix, Dyn, LU};

/// Entries that should be equal may differ by so many roundings: each is a sum of terms.
const ROUNDINGS: f64 = 8.0;

/// Mass, damping and stiffness matrices of M Ü + C U̇ + K U = 0, n × n each, in units that fit together (kg, N·s/m and
/// N/m for displacements in m); or their derivatives by a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct SecondOrder {
    /// M. Need not be symmetric.
    pub mass: DMatrix<f64>,
    /// C, gyroscopic parts included.
    pub damping: DMatrix<f64>,
    /// K, circulatory parts included.
    pub stiffness: DMatrix<f64>,
}

/// The state matrix A of ẋ = A x, its derivatives, and what they were made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearization {
    /// A.
    pub state_matrix: DMatrix<f64>,
    /// ∂A/∂x_j, one per uncertain input x_j in physical units, in the order of the inputs.
    pub derivatives: Vec<DMatrix<f64>>,
    /// M, C and K of a second-order system, on which eigenvalues can be refined.
    pub second_order: Option<SecondOrder>,
    /// Their derivatives by each input, as many as those of A.
    pub second_order_derivatives: Vec<SecondOrder>,
}

impl Linearization {
    /// A system that is of first order by itself, with the derivatives of its state matrix by each input.
    pub fn first_order(state_matrix: DMatrix<f64>, derivatives: Vec<DMatrix<f64>>) -> Self {
        Self { state_matrix, derivatives, second_order: None, second_order_derivatives: Vec::new() }
    }
}

impl SecondOrder {
    /// The state matrix for x = (U, U̇),
    ///
    /// A = \[0, I; −M⁻¹K, −M⁻¹C\], 2n × 2n.
    ///
    /// # Errors
    ///
    /// [`ModelError::SingularMass`].
    ///
    /// # Examples
    ///
    /// ```
    /// use nalgebra::dmatrix;
    /// use pcc_compile::mechanics::model::SecondOrder;
    /// let oscillator = SecondOrder { mass: dmatrix![2.0], damping: dmatrix![1.0], stiffness: dmatrix![8.0] };
    /// assert_eq!(oscillator.state_matrix()?, dmatrix![0.0, 1.0; -4.0, -0.5]);
    /// # Ok::<(), pcc_compile::mechanics::model::ModelError>(())
    /// ```
    pub fn state_matrix(&self) -> Result<DMatrix<f64>, ModelError> {
        self.divided_by(&self.factored()?).map(|(stiffness, damping)| assemble(&stiffness, &damping, 1.0))
    }

    /// A with its derivatives, given those of M, C and K by each uncertain input, or by none of them:
    ///
    /// dA = \[0, 0; −M⁻¹(dK − dM M⁻¹K), −M⁻¹(dC − dM M⁻¹C)\].
    ///
    /// # Errors
    ///
    /// [`ModelError::SingularMass`].
    ///
    /// # Panics
    ///
    /// If matrices differ in size.
    pub fn linearization(self, derivatives: Vec<Self>) -> Result<Linearization, ModelError> {
        let mass = self.factored()?;
        let (stiffness, damping) = self.divided_by(&mass)?;
        let derivative = |by: &Self| {
            if is_zero(&by.mass) {
                return by.divided_by(&mass).map(|(stiffness, damping)| assemble(&stiffness, &damping, 0.0));
            }
            let moved = Self {
                mass: by.mass.clone(),
                damping: &by.damping - &by.mass * &damping,
                stiffness: &by.stiffness - &by.mass * &stiffness,
            };
            moved.divided_by(&mass).map(|(stiffness, damping)| assemble(&stiffness, &damping, 0.0))
        };
        Ok(Linearization {
            state_matrix: assemble(&stiffness, &damping, 1.0),
            derivatives: derivatives.iter().map(derivative).collect::<Result<_, _>>()?,
            second_order: Some(self),
            second_order_derivatives: derivatives,
        })
    }

    /// Whether M and K are symmetric but for rounding, M is positive definite, and C is zero: λ² is real.
    pub fn is_self_adjoint(&self) -> bool {
        let is_symmetric = |matrix: &DMatrix<f64>| {
            (0..matrix.nrows()).all(|i| {
                (0..i).all(|j| {
                    let (below, above) = (matrix[(i, j)], matrix[(j, i)]);
                    (below - above).abs() <= ROUNDINGS * f64::EPSILON * below.abs().max(above.abs())
                })
            })
        };
        is_zero(&self.damping)
            && is_symmetric(&self.mass)
            && is_symmetric(&self.stiffness)
            && self.mass.clone().cholesky().is_some()
    }

    fn factored(&self) -> Result<LU<f64, Dyn, Dyn>, ModelError> {
        let mass = self.mass.clone().lu();
        if mass.is_invertible() { Ok(mass) } else { Err(ModelError::SingularMass) }
    }

    /// M⁻¹K and M⁻¹C for the mass matrix of a system and the other matrices of this one; many derivatives are zero.
    fn divided_by(&self, mass: &LU<f64, Dyn, Dyn>) -> Result<(DMatrix<f64>, DMatrix<f64>), ModelError> {
        let solve = |matrix: &DMatrix<f64>| match is_zero(matrix) {
            true => Ok(matrix.clone()),
            false => mass.solve(matrix).ok_or(ModelError::SingularMass),
        };
        Ok((solve(&self.stiffness)?, solve(&self.damping)?))
    }
}

fn is_zero(matrix: &DMatrix<f64>) -> bool {
    matrix.iter().all(|&entry| entry == 0.0)
}

/// \[0, identity · I; −stiffness, −damping\].
fn assemble(stiffness: &DMatrix<f64>, damping: &DMatrix<f64>, identity: f64) -> DMatrix<f64> {
    let size = stiffness.nrows();
    let mut state = DMatrix::zeros(2 * size, 2 * size);
    state.view_mut((0, size), (size, size)).fill_diagonal(identity);
    state.view_mut((size, 0), (size, size)).zip_apply(stiffness, |entry, value| *entry = -value);
    state.view_mut((size, size), (size, size)).zip_apply(damping, |entry, value| *entry = -value);
    state
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    fn system(x: f64) -> SecondOrder {
        SecondOrder {
            mass: dmatrix![2.0 + x, 0.3 * x; 0.1, 1.0 + x * x],
            damping: dmatrix![0.1 * x, 1.0; -1.0, 0.2],
            stiffness: dmatrix![40.0, -3.0 * x; 5.0 * x, 60.0 + x],
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let x = 0.4;
        let by_x = SecondOrder {
            mass: dmatrix![1.0, 0.3; 0.0, 2.0 * x],
            damping: dmatrix![0.1, 0.0; 0.0, 0.0],
            stiffness: dmatrix![0.0, -3.0; 5.0, 1.0],
        };
        let found = system(x).linearization(vec![by_x]).unwrap();
        let at = |x| system(x).state_matrix().unwrap();
        assert_eq!(found.state_matrix, at(x));
        let step = 1e-5;
        let difference = (at(x + step) - at(x - step)) / (2.0 * step);
        assert!((&found.derivatives[0] - difference).amax() < 1e-8);
    }

    #[test]
    fn singular_masses_are_refused() {
        let massless = SecondOrder { mass: DMatrix::zeros(2, 2), ..system(0.0) };
        assert_eq!(massless.state_matrix(), Err(ModelError::SingularMass));
    }
}
