//! The 6-degree-of-freedom clutch of Wickramarachi, Singh and Bailey (2005) with internal damping, section 4 of the
//! paper.
//!
//! A pressure plate, modelled as four masses M_p/4 on bending springs k_f, rotates by θ_x and θ_y and is pressed on the
//! flywheel by four cushion springs k_A … k_D; friction μ at their contacts couples the two rotations.
//!
//! Two things differ from the printed paper. Entry (1, 2) of K and C is +μ l r (k_C + k_D): with the printed minus the
//! rigid rotation (0, 1, 0, 0, −r, r) is not in the null space of K, a real eigenvalue appears and no modes coalesce.
//! And M_p, I_x, I_y, which are not printed, are those that reproduce its table 2: 40 kg and 0.030 kg·m².

use super::second_order::{Linearization, SecondOrder};
use super::{Model, ModelError, Parameter, Range};
use crate::numerics::eigenvalues::eigenvalues;
use nalgebra::{Complex, DMatrix, Matrix6, dvector};

const fn parameter(
    name: &'static str,
    unit: &'static str,
    nominal: f64,
    range: Range,
    meaning: &'static str,
) -> Parameter {
    Parameter { name, unit, nominal, range, meaning }
}

/// Every parameter of the clutch with its nominal value. The first eight are those the paper treats as uncertain, in
/// its order.
pub const CLUTCH_PARAMETERS: [Parameter; 16] = [
    parameter("mu", "", 0.25, Range::NonNegative, "friction coefficient"),
    parameter("k_p", "N/m", 16e6, Range::NonNegative, "cushion stiffness"),
    parameter("k_f", "N/m", 7e6, Range::NonNegative, "bending stiffness of the pressure plate"),
    parameter("gamma_1", "", 0.9, Range::Positive, "stiffness ratio of the first nodal diameter"),
    parameter("gamma_2", "", 0.8, Range::Positive, "stiffness ratio of the second nodal diameter"),
    parameter("r_1", "m", 0.075, Range::NonNegative, "inner sliding radius"),
    parameter("r_2", "m", 0.12, Range::NonNegative, "outer sliding radius"),
    parameter("l", "m", 0.0125, Range::NonNegative, "thickness of the pressure plate"),
    parameter("plate_mass", "kg", 40.0, Range::Positive, "mass of the pressure plate, M_p"),
    parameter("plate_inertia_x", "kg·m²", 0.030, Range::Positive, "moment of inertia about x"),
    parameter("plate_inertia_y", "kg·m²", 0.030, Range::Positive, "moment of inertia about y"),
    parameter("c_A", "N·s/m", 4.0, Range::NonNegative, "damping at A"),
    parameter("c_B", "N·s/m", 4.0, Range::NonNegative, "damping at B"),
    parameter("c_C", "N·s/m", 4.0, Range::NonNegative, "damping at C"),
    parameter("c_D", "N·s/m", 4.0, Range::NonNegative, "damping at D"),
    parameter("c_f", "N·s/m", 0.1, Range::NonNegative, "bending damping of the pressure plate"),
];

/// The clutch with some of its parameters uncertain.
///
/// # Examples
///
/// ```
/// use pcc_compile::mechanics::model::{Clutch, Model};
/// let clutch = Clutch::new(&[], &["mu"])?;
/// let largest = |mu| clutch.eigenvalues(&[mu]).map(|all| all.iter().map(|l| l.re).fold(f64::MIN, f64::max));
/// assert!(largest(0.4)? > 1.0); // squeals
/// # Ok::<(), pcc_compile::mechanics::model::ModelError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Clutch {
    /// Values of [`CLUTCH_PARAMETERS`], in its order.
    values: [f64; 16],
    /// For each uncertain input, its position in `values`.
    uncertain: Vec<usize>,
}

impl Clutch {
    /// The clutch with `constants` in place of nominal values and the parameters named `uncertain` left open, in the
    /// order in which [`Model::eigenvalues`] takes them.
    ///
    /// # Errors
    ///
    /// [`ModelError::UnknownParameter`] and [`ModelError::OutOfRange`].
    pub fn new(constants: &[(&str, f64)], uncertain: &[&str]) -> Result<Self, ModelError> {
        let mut values = CLUTCH_PARAMETERS.map(|parameter| parameter.nominal);
        for &(name, value) in constants {
            let at = position(name)?;
            check_range(at, value)?;
            values[at] = value;
        }
        let uncertain = uncertain.iter().map(|name| position(name)).collect::<Result<_, _>>()?;
        Ok(Self { values, uncertain })
    }

    /// The values of [`CLUTCH_PARAMETERS`] at `point`.
    fn values(&self, point: &[f64]) -> [f64; 16] {
        let mut values = self.values;
        for (&parameter, &value) in self.uncertain.iter().zip(point) {
            values[parameter] = value;
        }
        values
    }

    /// M, C and K at `point`. Parameters beyond the end of a short `point` are nominal.
    pub fn matrices(&self, point: &[f64]) -> SecondOrder {
        matrices(&self.values(point))
    }

    fn check(&self, point: &[f64]) -> Result<(), ModelError> {
        self.uncertain.iter().zip(point).try_for_each(|(&at, &value)| check_range(at, value))
    }
}

impl Model for Clutch {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        self.check(point)?;
        Ok(eigenvalues(self.matrices(point).state_matrix()?)?)
    }

    fn has_derivatives(&self) -> bool {
        true
    }

    fn system(&self, point: &[f64]) -> Result<Option<Linearization>, ModelError> {
        self.check(point)?;
        self.matrices(point).linearization(Vec::new()).map(Some)
    }

    fn linearization(&self, point: &[f64]) -> Result<Option<Linearization>, ModelError> {
        self.check(point)?;
        let values = self.values(point);
        let derivatives: Vec<SecondOrder> = self.uncertain.iter().map(|&by| derivative(&values, by)).collect();
        matrices(&values).linearization(derivatives).map(Some)
    }
}

fn check_range(at: usize, value: f64) -> Result<(), ModelError> {
    let Parameter { name, range, .. } = CLUTCH_PARAMETERS[at];
    if range.contains(value) { Ok(()) } else { Err(ModelError::OutOfRange { name, value, range: range.describe() }) }
}

fn position(name: &str) -> Result<usize, ModelError> {
    CLUTCH_PARAMETERS.iter().position(|parameter| parameter.name == name).ok_or_else(|| ModelError::UnknownParameter {
        name: name.to_owned(),
        known: CLUTCH_PARAMETERS.map(|parameter| parameter.name).join(", "),
    })
}

/// M, C and K for U = (θ_x, θ_y, Z_A, Z_B, Z_C, Z_D) from the values of [`CLUTCH_PARAMETERS`].
fn matrices(values: &[f64; 16]) -> SecondOrder {
    let [mu, k_p, k_f, gamma_1, gamma_2, r_1, r_2, l, plate_mass, inertia_x, inertia_y, c_a, c_b, c_c, c_d, c_f] =
        *values;
    let levers = Levers::new(mu, (r_1 + r_2) / 2.0, l);
    SecondOrder {
        mass: mass(inertia_x, inertia_y, plate_mass),
        damping: levers.assemble([c_a, c_b, c_c, c_d], c_f),
        stiffness: levers.assemble(springs(k_p, gamma_1, gamma_2), k_f),
    }
}

/// k_A, k_B, k_C, k_D.
fn springs(k_p: f64, gamma_1: f64, gamma_2: f64) -> [f64; 4] {
    [gamma_1 * k_p / 4.0, k_p / (4.0 * gamma_1), gamma_2 * k_p / 4.0, k_p / (4.0 * gamma_2)]
}

/// The derivatives of M, C and K by the parameter number `by`.
///
/// C and K are linear in the springs or dampers and in the five lever products, so each derivative is one more
/// assembly.
fn derivative(values: &[f64; 16], by: usize) -> SecondOrder {
    let [mu, k_p, k_f, gamma_1, gamma_2, r_1, r_2, l, _, _, _, c_a, c_b, c_c, c_d, c_f] = *values;
    let r = (r_1 + r_2) / 2.0;
    let levers = Levers::new(mu, r, l);
    let zero = || DMatrix::zeros(6, 6);
    let none = SecondOrder { mass: zero(), damping: zero(), stiffness: zero() };
    let by_levers = |slopes: Levers| SecondOrder {
        mass: zero(),
        damping: slopes.assemble([c_a, c_b, c_c, c_d], c_f),
        stiffness: slopes.assemble(springs(k_p, gamma_1, gamma_2), k_f),
    };
    let by_springs = |springs, bending| SecondOrder { stiffness: levers.assemble(springs, bending), ..none.clone() };
    let by_dampers = |dampers, bending| SecondOrder { damping: levers.assemble(dampers, bending), ..none.clone() };
    let by_mass = |mass| SecondOrder { mass, ..none.clone() };
    // r = (r_1 + r_2)/2.
    let by_radius = Levers { one: 0.0, r: 0.5, r_squared: r, mu_l: 0.0, mu_l_r: 0.5 * mu * l };
    match CLUTCH_PARAMETERS[by].name {
        "mu" => by_levers(Levers { one: 0.0, r: 0.0, r_squared: 0.0, mu_l: l, mu_l_r: l * r }),
        "l" => by_levers(Levers { one: 0.0, r: 0.0, r_squared: 0.0, mu_l: mu, mu_l_r: mu * r }),
        "r_1" | "r_2" => by_levers(by_radius),
        "k_p" => by_springs([gamma_1 / 4.0, 1.0 / (4.0 * gamma_1), gamma_2 / 4.0, 1.0 / (4.0 * gamma_2)], 0.0),
        "gamma_1" => by_springs([k_p / 4.0, -k_p / (4.0 * gamma_1 * gamma_1), 0.0, 0.0], 0.0),
        "gamma_2" => by_springs([0.0, 0.0, k_p / 4.0, -k_p / (4.0 * gamma_2 * gamma_2)], 0.0),
        "k_f" => by_springs([0.0; 4], 1.0),
        "c_A" => by_dampers([1.0, 0.0, 0.0, 0.0], 0.0),
        "c_B" => by_dampers([0.0, 1.0, 0.0, 0.0], 0.0),
        "c_C" => by_dampers([0.0, 0.0, 1.0, 0.0], 0.0),
        "c_D" => by_dampers([0.0, 0.0, 0.0, 1.0], 0.0),
        "c_f" => by_dampers([0.0; 4], 1.0),
        "plate_mass" => by_mass(mass(0.0, 0.0, 1.0)),
        "plate_inertia_x" => by_mass(mass(1.0, 0.0, 0.0)),
        "plate_inertia_y" => by_mass(mass(0.0, 1.0, 0.0)),
        name => unreachable!("{name} is no parameter of the clutch"),
    }
}

/// diag(I_x, I_y, M_p/4, M_p/4, M_p/4, M_p/4).
fn mass(inertia_x: f64, inertia_y: f64, plate_mass: f64) -> DMatrix<f64> {
    let quarter = plate_mass / 4.0;
    DMatrix::from_diagonal(&dvector![inertia_x, inertia_y, quarter, quarter, quarter, quarter])
}

/// The products of friction coefficient μ, mean radius r = (r_1 + r_2)/2 in m and thickness l in m that multiply
/// springs and dampers; or their derivatives.
struct Levers {
    one: f64,
    r: f64,
    r_squared: f64,
    mu_l: f64,
    mu_l_r: f64,
}

impl Levers {
    fn new(mu: f64, r: f64, l: f64) -> Self {
        Self { one: 1.0, r, r_squared: r * r, mu_l: mu * l, mu_l_r: mu * l * r }
    }

    /// K of equation 28 from the springs at A … D and f, or C of equation 29 from the dampers.
    #[rustfmt::skip]
    fn assemble(&self, [a, b, c, d]: [f64; 4], f: f64) -> DMatrix<f64> {
        let Self { one, r, r_squared, mu_l, mu_l_r } = *self;
        let matrix = Matrix6::new(
            r_squared*(a + b + 4.0*f), mu_l_r*(c + d),            r*(a + 2.0*f),   -r*(b + 2.0*f),  mu_l*c,          -mu_l*d,
            -mu_l_r*(a + b),           r_squared*(c + d + 4.0*f), -mu_l*a,         mu_l*b,          r*(c + 2.0*f),   -r*(d + 2.0*f),
            r*(a + 2.0*f),             0.0,                       one*(a + 2.0*f), 0.0,             -one*f,          -one*f,
            -r*(b + 2.0*f),            0.0,                       0.0,             one*(b + 2.0*f), -one*f,          -one*f,
            0.0,                       r*(c + 2.0*f),             -one*f,          -one*f,          one*(c + 2.0*f), 0.0,
            0.0,                       -r*(d + 2.0*f),            -one*f,          -one*f,          0.0,             one*(d + 2.0*f),
        );
        DMatrix::from_column_slice(6, 6, matrix.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MU_ONLY: [&str; 1] = ["mu"];

    /// Rank by singular values: those of the null space are rounding, the others are stiffnesses.
    fn rank(matrix: &DMatrix<f64>) -> usize {
        let singular = matrix.singular_values();
        singular.iter().filter(|&&value| value > 1e-10 * singular.max()).count()
    }

    #[test]
    fn stiffness_has_rank_four_for_every_friction_coefficient() {
        let clutch = Clutch::new(&[], &MU_ONLY).unwrap();
        for mu in [0.0, 0.1, 0.25, 0.5] {
            assert_eq!(rank(&clutch.matrices(&[mu]).stiffness), 4);
        }
    }

    #[test]
    fn the_printed_sign_breaks_the_rigid_rotation_and_diverges() {
        let clutch = Clutch::new(&[], &MU_ONLY).unwrap();
        let mut matrices = clutch.matrices(&[0.25]);
        let r = 0.0975;
        let rotation = dvector![0.0, 1.0, 0.0, 0.0, -r, r];
        assert!((&matrices.stiffness * rotation).norm() < 1e-9 * matrices.stiffness.norm());

        matrices.stiffness[(0, 1)] *= -1.0;
        matrices.damping[(0, 1)] *= -1.0;
        assert_eq!(rank(&matrices.stiffness), 5);
        let all = eigenvalues(matrices.state_matrix().unwrap()).unwrap();
        let divergent = all.iter().filter(|l| l.im == 0.0).map(|l| l.re).fold(f64::MIN, f64::max);
        assert!((divergent - 11.8).abs() < 0.1, "real eigenvalue {divergent}");
    }

    #[test]
    fn stability_depends_on_ratios_of_mass_inertia_and_damping_only() {
        let scale = 3.0_f64;
        let heavy = ["plate_mass", "plate_inertia_x", "plate_inertia_y"].map(|name| (name, scale));
        let damped = ["c_A", "c_B", "c_C", "c_D", "c_f"].map(|name| (name, scale.sqrt()));
        let constants: Vec<(&str, f64)> = heavy
            .into_iter()
            .chain(damped)
            .map(|(name, factor)| (name, CLUTCH_PARAMETERS[position(name).unwrap()].nominal * factor))
            .collect();
        let (plain, scaled) = (Clutch::new(&[], &MU_ONLY).unwrap(), Clutch::new(&constants, &MU_ONLY).unwrap());
        let largest =
            |clutch: &Clutch| clutch.eigenvalues(&[0.3]).unwrap().iter().map(|l| l.re).fold(f64::MIN, f64::max);
        assert!((largest(&scaled) * scale.sqrt() - largest(&plain)).abs() < 1e-9);
    }

    /// Points at which the iteration circles around the fourfold zero in the given basis.
    #[test]
    fn stalled_iterations_converge_in_another_basis() {
        let friction = Clutch::new(&[], &MU_ONLY).unwrap();
        assert_eq!(friction.eigenvalues(&[0.395_519_087_835_095_54]).unwrap().len(), 12);
        let two = Clutch::new(&[], &["mu", "k_p"]).unwrap();
        assert_eq!(two.eigenvalues(&[0.458_215_768_123_292_4, 16_065_468.631_272_795]).unwrap().len(), 12);
    }

    #[test]
    fn unknown_parameters_are_named() {
        let error = Clutch::new(&[("k_q", 1.0)], &[]).unwrap_err();
        assert!(error.to_string().starts_with("the model has no parameter k_q; it has mu, k_p"));
    }
}
