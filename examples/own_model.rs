//! A model of your own with its derivatives: `cargo run --release --example own_model`.
//!
//! Two masses on a belt, the smallest system that squeals: friction couples its two modes. The study says which inputs
//! are uncertain and what is asked; the model is the code below.

use nalgebra::{Complex, dmatrix};
use pcc::{Linearization, Model, ModelError, SecondOrder, Silent, Study, build_with, monte_carlo};

/// What the study asks. A model of kind "table" is one that pcc does not know.
const STUDY: &str = r#"
format = 1
name = "belt"

[model]
kind = "table"
eigenvalues = 4

[inputs]
mu = { distribution = "uniform", lower = 0.0, upper = 0.5 }
k  = { distribution = "uniform", nominal = 100.0, spread = 0.1 }
"#;

/// M Ü + C U̇ + K U = 0 with K = [k + 20, −40 μ; 40 μ, k].
struct Belt;

impl Belt {
    fn matrices(&self, mu: f64, k: f64) -> SecondOrder {
        SecondOrder {
            mass: dmatrix![1.0, 0.0; 0.0, 1.0],
            damping: dmatrix![0.1, 0.0; 0.0, 0.1],
            stiffness: dmatrix![k + 20.0, -40.0 * mu; 40.0 * mu, k],
        }
    }
}

impl Model for Belt {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        let state_matrix = self.matrices(point[0], point[1]).state_matrix()?;
        Ok(state_matrix.complex_eigenvalues().iter().copied().collect())
    }

    fn has_derivatives(&self) -> bool {
        true
    }

    fn linearization(&self, point: &[f64]) -> Result<Option<Linearization>, ModelError> {
        let zero = || dmatrix![0.0, 0.0; 0.0, 0.0];
        let by = |stiffness| SecondOrder { mass: zero(), damping: zero(), stiffness };
        // By μ and by k, in the order of the study's inputs.
        let derivatives = vec![by(dmatrix![0.0, -40.0; 40.0, 0.0]), by(dmatrix![1.0, 0.0; 0.0, 1.0])];
        self.matrices(point[0], point[1]).linearization(derivatives).map(Some)
    }
}

fn main() -> Result<(), pcc::Error> {
    let study = Study::from_toml(STUDY)?;
    let surrogate = build_with(&study, Box::new(Belt), &Silent)?;
    let stable = monte_carlo(&surrogate, 1_000_000, 1, &Silent)?.stable_proportion();
    println!("{} model runs", surrogate.training.counts.direct_computations);
    let interval = stable.interval(0.95);
    println!(
        "stable in {:.2} % of cases, from {:.2} to {:.2} %",
        100.0 * stable.value(),
        100.0 * interval.lower,
        100.0 * interval.upper
    );
    Ok(())
}
