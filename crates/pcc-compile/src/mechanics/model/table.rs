//! Models whose answers come in tables.

use super::{Model, ModelError};
use nalgebra::Complex;

/// A model that pcc cannot run.
#[derive(Debug, Clone, Copy)]
pub struct TableModel;

impl Model for TableModel {
    fn eigenvalues(&self, _: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        Err(ModelError::NotRun)
    }
}
