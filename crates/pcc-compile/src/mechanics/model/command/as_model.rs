//! A program as a model.

use super::{CommandModel, Mode};
use crate::mechanics::model::{Concurrency, Model, ModelError};
use nalgebra::Complex;

impl Model for CommandModel {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        Ok(self.run(point)?)
    }

    fn concurrency(&self) -> Concurrency {
        match self.settings().mode {
            Mode::Each => Concurrency::Jobs(self.settings().jobs),
            Mode::Batch => Concurrency::Together,
        }
    }

    fn eigenvalues_together(&self, points: &[&[f64]]) -> Vec<Result<Vec<Complex<f64>>, ModelError>> {
        self.run_batch(points).into_iter().map(|answer| answer.map_err(ModelError::from)).collect()
    }

    fn interrupt(&self) {
        CommandModel::interrupt(self);
    }
}

impl Drop for CommandModel {
    fn drop(&mut self) {
        self.clean_up();
    }
}
