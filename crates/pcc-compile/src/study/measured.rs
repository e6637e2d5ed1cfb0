//! Measured values of an input: a column of a table beside the study.

use super::column::values;
use super::error::StudyError;
use super::inputs::of_data;
use super::raw;
use super::validate::Lines;
use pcc_evaluate::probability::inputs::{Marginal, MarginalError, Parameters, Smoothing, Source};
use std::path::Path;

impl Lines<'_> {
    /// The law of measured values; the inner error says why they have none.
    pub(super) fn measured(
        &self,
        key: &str,
        input: &raw::Input,
        given: &[(&'static str, f64)],
        folder: &Path,
    ) -> Result<Result<Marginal, MarginalError>, StudyError> {
        let file = input.file.as_ref();
        let is_bound = |(name, _): &(&str, f64)| ["lower", "upper"].contains(name);
        let levels = [("value", input.values.is_some()), ("weight", input.weights.is_some())];
        let levels = levels.into_iter().filter(|(_, is_given)| *is_given).map(|(name, _)| (name, 0.0));
        let given: Vec<(&str, f64)> = given.iter().copied().chain(levels).collect();
        let Some(file) = file.filter(|_| given.iter().all(is_bound)) else {
            let known = of_data(input).map(|name| (name, 0.0));
            return Ok(Marginal::named("data", &Parameters::of(given.into_iter().chain(known))));
        };
        if input.polynomials.is_some() {
            return Ok(Err(MarginalError::NoChoice { law: "data" }));
        }
        let smoothing = input.smoothing.as_ref();
        let smoothing = smoothing
            .map(|word| self.word(&format!("{key}.smoothing"), word, &Smoothing::ALL))
            .transpose()?
            .unwrap_or(Smoothing::Kernel);
        let values = values(file.get_ref(), input.column.as_deref(), folder).map_err(|cause| StudyError::Table {
            place: self.place(format!("{key}.file"), file),
            cause: Box::new(cause),
        })?;
        let bound = |wanted: &str| given.iter().find(|(name, _)| *name == wanted).map(|(_, value)| *value);
        let source = Source { file: file.get_ref().clone(), column: input.column.clone() };
        Ok(Marginal::measured(&values, [bound("lower"), bound("upper")], smoothing, Some(source)))
    }
}
