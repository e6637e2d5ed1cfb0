//! Models by matrices of the user's: entries are numbers and expressions of the inputs, or terms f(inputs) · K_i with
//! matrices from files.
//!
//! Second order: M ü + (C + G) u̇ + (K + N) u = 0; first order: ẋ = A x. Expressions are compiled once and
//! differentiated symbolically, so derivatives of the state matrix by every input come with each run.

mod assembly;
mod compile;
mod description;
mod error;
mod matrix_market;

pub use description::{Description, Entry, Form, Layout, Matrix, Role, Term};
pub use error::MatricesError;
pub use matrix_market::{CoordinateMatrix, LARGEST_DIMENSION, MatrixMarketError, read_matrix_market};

use super::second_order::{Linearization, SecondOrder};
use super::{Model, ModelError};
use crate::numerics::eigenvalues::eigenvalues;
use assembly::Assembly;
use nalgebra::Complex;
use pcc_expressions::{Derivative, Evaluated, Program, Workspace};
use std::sync::{Mutex, PoisonError};

/// Rows of a matrix at most: eigenvalues of larger systems take minutes.
pub const MOST_ROWS: usize = 500;

/// A model by matrices, ready to run.
///
/// # Examples
///
/// ```
/// use pcc_compile::mechanics::model::Model;
/// use pcc_compile::study::Study;
/// let study = Study::from_toml(
///     r#"
///     format = 1
///     name = "oscillator"
///     [model]
///     kind = "matrices"
///     M = [["m"]]
///     C = [["0.02 * sqrt(k*m)"]]
///     K = [["k"]]
///     [model.constants]
///     m = 2.0
///     [inputs]
///     k = { distribution = "uniform", lower = 1.0, upper = 9.0 }
///     "#,
/// )?;
/// let lambda = study.model()?.eigenvalues(&[8.0])?[0];
/// assert!((lambda.norm() - 2.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Matrices {
    program: Program,
    system: System,
    /// Names of the inputs.
    inputs: Vec<String>,
    /// For each output of the program, where it stands.
    sources: Vec<Source>,
    /// Workspaces that no thread is using.
    workspaces: Mutex<Vec<Workspace>>,
}

#[derive(Debug)]
enum System {
    SecondOrder { mass: Assembly, damping: Assembly, stiffness: Assembly },
    FirstOrder(Assembly),
}

/// Where an expression stands in the study.
#[derive(Debug)]
enum Source {
    Entry { matrix: &'static str, row: usize, column: usize, text: String },
    Factor { matrix: &'static str, term: usize, text: String },
}

impl Matrices {
    /// Compiles a description for inputs of these names.
    ///
    /// # Errors
    ///
    /// [`MatricesError`] names the matrix, row and column.
    pub fn new(description: &Description, inputs: &[&str]) -> Result<Self, MatricesError> {
        compile::compile(description, inputs)
    }

    /// Number of degrees of freedom, or of states of a first-order system.
    pub fn size(&self) -> usize {
        match &self.system {
            System::SecondOrder { mass, .. } => mass.size(),
            System::FirstOrder(state) => state.size(),
        }
    }

    /// Lends `work` a workspace, so that runs allocate none.
    fn with_workspace<T>(&self, work: impl FnOnce(&mut Workspace) -> T) -> T {
        let pool = || self.workspaces.lock().unwrap_or_else(PoisonError::into_inner);
        let free = pool().pop();
        let mut workspace = free.unwrap_or_else(|| self.program.workspace());
        let result = work(&mut workspace);
        pool().push(workspace);
        result
    }

    fn check(&self, values: &[f64]) -> Result<(), MatricesError> {
        let Some(at) = values.iter().position(|value| !value.is_finite()) else { return Ok(()) };
        let value = values[at];
        Err(match &self.sources[at] {
            Source::Entry { matrix, row, column, text } => {
                MatricesError::NotFinite { matrix, row: *row, column: *column, text: text.clone(), value }
            }
            Source::Factor { matrix, term, text } => {
                MatricesError::FactorNotFinite { matrix, term: *term, text: text.clone(), value }
            }
        })
    }

    fn check_slopes(&self, slopes: &[f64]) -> Result<(), MatricesError> {
        let Some(at) = slopes.iter().position(|value| !value.is_finite()) else { return Ok(()) };
        let Derivative { output, variable } = self.program.derivatives()[at];
        let (input, value) = (self.inputs[variable].clone(), slopes[at]);
        let (matrix, place, text) = match &self.sources[output] {
            Source::Entry { matrix, row, column, text } => (matrix, format!("row {row}, column {column}"), text),
            Source::Factor { matrix, term, text } => (matrix, format!("factor of term {term}"), text),
        };
        Err(MatricesError::Slope { matrix, place, text: text.clone(), input, value })
    }

    fn system_at(&self, values: &[f64]) -> Result<Linearization, ModelError> {
        match &self.system {
            System::SecondOrder { mass, damping, stiffness } => {
                let [mass, damping, stiffness] = [mass, damping, stiffness].map(|matrix| matrix.value(values));
                SecondOrder { mass, damping, stiffness }.linearization(Vec::new())
            }
            System::FirstOrder(state) => Ok(Linearization::first_order(state.value(values), Vec::new())),
        }
    }

    fn linearize(&self, evaluated: &Evaluated<'_>) -> Result<Linearization, ModelError> {
        let values = evaluated.values;
        // Of all outputs by one input; most are zero.
        let slopes = |input: usize| {
            let mut slopes = vec![0.0; values.len()];
            for at in self.program.derivatives_by(input) {
                slopes[self.program.derivatives()[at].output] = evaluated.derivatives[at];
            }
            slopes
        };
        let by_input = (0..self.program.variables()).map(slopes);
        match &self.system {
            System::SecondOrder { mass, damping, stiffness } => {
                let derivative = |slopes: Vec<f64>| {
                    let [mass, damping, stiffness] =
                        [mass, damping, stiffness].map(|matrix| matrix.derivative(values, &slopes));
                    SecondOrder { mass, damping, stiffness }
                };
                let derivatives: Vec<SecondOrder> = by_input.map(derivative).collect();
                let [mass, damping, stiffness] = [mass, damping, stiffness].map(|matrix| matrix.value(values));
                SecondOrder { mass, damping, stiffness }.linearization(derivatives)
            }
            System::FirstOrder(state) => {
                let derivatives = by_input.map(|slopes| state.derivative(values, &slopes)).collect();
                Ok(Linearization::first_order(state.value(values), derivatives))
            }
        }
    }
}

impl Model for Matrices {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        let system = self.with_workspace(|workspace| {
            let values = self.program.evaluate(point, workspace);
            self.check(values)?;
            self.system_at(values)
        })?;
        Ok(eigenvalues(system.state_matrix)?)
    }

    fn system(&self, point: &[f64]) -> Result<Option<Linearization>, ModelError> {
        self.with_workspace(|workspace| {
            let values = self.program.evaluate(point, workspace);
            self.check(values)?;
            self.system_at(values).map(Some)
        })
    }

    fn has_derivatives(&self) -> bool {
        true
    }

    fn linearization(&self, point: &[f64]) -> Result<Option<Linearization>, ModelError> {
        self.with_workspace(|workspace| {
            let evaluated = self.program.differentiate(point, workspace);
            self.check(evaluated.values)?;
            self.check_slopes(evaluated.derivatives)?;
            self.linearize(&evaluated).map(Some)
        })
    }
}
