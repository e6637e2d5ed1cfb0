//! The function of a study as a model: runs call back into Python.

use crate::background::Service;
use crate::errors::{ends_the_work, exception};
use nalgebra::DMatrix;
use num_complex::Complex;
use numpy::{Complex64, PyReadonlyArray1, PyReadonlyArray3, PyReadonlyArray4, PyUntypedArrayMethods};
use pcc::{Concurrency, Linearization, Model, ModelAnswer, ModelError, SecondOrder};
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};

/// A run that raised: the inputs in physical units, and the exception.
pub type Raised = (Vec<f64>, PyErr);

/// A function of the user's, in the form that `pcc._model` gives it: it is called with the values of the inputs and
/// whether derivatives are wanted.
pub struct PythonModel {
    /// What threads share.
    shared: Arc<Shared>,
    service: Service,
    /// Whether it answers matrices.
    answers_matrices: bool,
    /// Calls that go on at once; one is made by the thread that serves the work.
    jobs: usize,
}

struct Shared {
    function: Py<PyAny>,
    raised: Mutex<Vec<Raised>>,
    service: Service,
}

impl PythonModel {
    pub fn new(function: Py<PyAny>, service: &Service, answers_matrices: bool, jobs: usize) -> Self {
        let shared = Shared { function, raised: Mutex::default(), service: service.clone() };
        Self { shared: Arc::new(shared), service: service.clone(), answers_matrices, jobs }
    }

    /// The exception of the run at this point.
    pub fn exception_at(&self, is_point: impl Fn(&[f64]) -> bool) -> Option<Raised> {
        let mut raised = self.shared.raised.lock().unwrap_or_else(PoisonError::into_inner);
        let found = raised.iter().position(|(point, _)| is_point(point))?;
        Some(raised.swap_remove(found))
    }
}

impl Shared {
    fn answer(&self, py: Python<'_>, point: Vec<f64>, with_derivatives: bool) -> Result<ModelAnswer, ModelError> {
        let called = self.function.bind(py).call1((point.clone(), with_derivatives));
        called.and_then(|answer| read(&answer, point.len())).map_err(|error| {
            let cause = describe(py, &error);
            if ends_the_work(py, &error) {
                self.service.stop(error);
            } else {
                self.raised.lock().unwrap_or_else(PoisonError::into_inner).push((point, error));
            }
            ModelError::Function(cause)
        })?
    }
}

/// An exception in a line: its kind, what it says, and where it was raised.
pub fn describe(py: Python<'_>, error: &PyErr) -> String {
    let value = error.value(py);
    // Until Python 3.12 an exception that is on its way does not hold its own traceback.
    let _ = value.setattr("__traceback__", error.traceback(py));
    let described = py.import("pcc._model").and_then(|model| model.call_method1("describe", (value,)));
    described.and_then(|text| text.extract()).unwrap_or_else(|_| error.to_string())
}

impl Model for PythonModel {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        self.run(point, false)?.eigenvalues()
    }

    fn has_derivatives(&self) -> bool {
        self.answers_matrices
    }

    fn linearization(&self, point: &[f64]) -> Result<Option<Linearization>, ModelError> {
        if !self.answers_matrices {
            return Ok(None);
        }
        match self.run(point, true)? {
            ModelAnswer::System(system) => Ok(Some(*system)),
            ModelAnswer::Eigenvalues(_) => Ok(None),
        }
    }

    fn system(&self, point: &[f64]) -> Result<Option<Linearization>, ModelError> {
        if !self.answers_matrices {
            return Ok(None);
        }
        match self.run(point, false)? {
            ModelAnswer::System(system) => Ok(Some(*system)),
            ModelAnswer::Eigenvalues(_) => Ok(None),
        }
    }

    fn run(&self, point: &[f64], with_derivatives: bool) -> Result<ModelAnswer, ModelError> {
        let (shared, point) = (self.shared.clone(), point.to_vec());
        let answer = match self.jobs {
            1 => self.service.call(move |py| shared.answer(py, point, with_derivatives)),
            _ => Some(Python::attach(|py| shared.answer(py, point, with_derivatives))),
        };
        answer.unwrap_or_else(|| Err(ModelError::Function("interrupted".to_owned())))
    }

    fn concurrency(&self) -> Concurrency {
        // Eigenvalues are computed beside the one call that goes on.
        Concurrency::Jobs(if self.jobs == 1 { rayon::current_num_threads() } else { self.jobs })
    }
}

/// What `pcc._model` makes of an answer: its form, its numbers, and their derivatives by each of so many inputs.
///
/// # Errors
///
/// `AnswerError` if it is not that, such as a tuple that somebody has made by hand; what is wrong with the system that
/// it holds is the model's error.
pub fn read(answer: &Bound<'_, PyAny>, inputs: usize) -> PyResult<Result<ModelAnswer, ModelError>> {
    let py = answer.py();
    let refused = |sentence: String| exception(py, "AnswerError", &sentence);
    let (form, numbers, derivatives): (String, Bound<'_, PyAny>, Option<Bound<'_, PyAny>>) = answer
        .extract()
        .map_err(|_| refused("an answer is a tuple of its form, its numbers, and derivatives or None".to_owned()))?;
    let count = match form.as_str() {
        "eigenvalues" => {
            let found: Option<PyReadonlyArray1<'_, Complex64>> = numbers.extract().ok();
            let found = found.filter(|found| !found.is_empty());
            let found = found.ok_or_else(|| refused("eigenvalues are a vector of complex128, not empty".to_owned()))?;
            return Ok(Ok(ModelAnswer::Eigenvalues(found.as_array().iter().copied().collect())));
        }
        "first order" => 1,
        "second order" => 3,
        _ => {
            let known = "\"first order\", \"second order\" and \"eigenvalues\"";
            return Err(refused(format!("an answer has the form {form:?}; there are {known}")));
        }
    };
    let values: Option<PyReadonlyArray3<'_, f64>> = numbers.extract().ok();
    let is_square = |values: &PyReadonlyArray3<'_, f64>| {
        let shape = values.shape();
        shape[0] == count && shape[1] == shape[2] && shape[1] > 0
    };
    let values = values.filter(is_square).ok_or_else(|| {
        refused(format!("the numbers of a {form} answer are float64 of the shape ({count}, n, n) with n of at least 1"))
    })?;
    let size = values.shape()[1];
    let own = matrices(values.as_array().iter().copied(), size);
    let mut by_input = Vec::new();
    if let Some(derivatives) = &derivatives {
        let expected = [inputs, count, size, size];
        let found: Option<PyReadonlyArray4<'_, f64>> = derivatives.extract().ok();
        let found = found.filter(|found| found.shape() == expected).ok_or_else(|| {
            refused(format!(
                "derivatives of this answer are float64 of the shape ({inputs}, {count}, {size}, {size}), an input each"
            ))
        })?;
        by_input = matrices(found.as_array().iter().copied(), size);
    }
    let system = match <[DMatrix<f64>; 3]>::try_from(own) {
        Ok(own) => {
            let parts = by_input.chunks_exact(count).filter_map(|parts| <[_; 3]>::try_from(parts.to_vec()).ok());
            second_order(own).linearization(parts.map(second_order).collect())
        }
        Err(own) => Ok(Linearization::first_order(own.into_iter().next().unwrap_or_default(), by_input)),
    };
    Ok(system.map(|system| ModelAnswer::System(Box::new(system))))
}

fn second_order([mass, damping, stiffness]: [DMatrix<f64>; 3]) -> SecondOrder {
    SecondOrder { mass, damping, stiffness }
}

/// Matrices that follow each other, row by row.
fn matrices(numbers: impl Iterator<Item = f64>, size: usize) -> Vec<DMatrix<f64>> {
    let numbers: Vec<f64> = numbers.collect();
    numbers.chunks_exact(size * size).map(|rows| DMatrix::from_row_slice(size, size, rows)).collect()
}
