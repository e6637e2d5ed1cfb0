//! Models that are functions of the program that reads the study.

use super::{Concurrency, Linearization, Model, ModelAnswer, ModelError};
use nalgebra::Complex;
use std::sync::Arc;

/// The place of a function: what it answers is known before it is given.
pub struct FunctionModel {
    function: Option<Arc<dyn Model + Send>>,
    has_derivatives: bool,
}

impl FunctionModel {
    /// The place of a function that answers matrices, or eigenvalues alone.
    pub fn new(function: Option<Arc<dyn Model + Send>>, has_derivatives: bool) -> Self {
        Self { function, has_derivatives }
    }

    fn function(&self) -> Result<&dyn Model, ModelError> {
        match &self.function {
            Some(function) => Ok(&**function),
            None => Err(ModelError::NoFunction),
        }
    }
}

impl Model for FunctionModel {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        self.function()?.eigenvalues(point)
    }

    fn has_derivatives(&self) -> bool {
        self.has_derivatives
    }

    fn linearization(&self, point: &[f64]) -> Result<Option<Linearization>, ModelError> {
        self.function()?.linearization(point)
    }

    fn system(&self, point: &[f64]) -> Result<Option<Linearization>, ModelError> {
        self.function()?.system(point)
    }

    fn run(&self, point: &[f64], with_derivatives: bool) -> Result<ModelAnswer, ModelError> {
        self.function()?.run(point, with_derivatives)
    }

    fn concurrency(&self) -> Concurrency {
        self.function.as_ref().map_or(Concurrency::Threads, |function| function.concurrency())
    }

    fn eigenvalues_together(&self, points: &[&[f64]]) -> Vec<Result<Vec<Complex<f64>>, ModelError>> {
        match self.function() {
            Ok(function) => function.eigenvalues_together(points),
            Err(error) => vec![Err(error); points.len()],
        }
    }

    fn interrupt(&self) {
        if let Some(function) = &self.function {
            function.interrupt();
        }
    }
}
