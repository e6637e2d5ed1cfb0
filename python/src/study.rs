//! A study, with the function that is its model.

use crate::background::Service;
use crate::errors::raised;
use crate::model::PythonModel;
use pcc::{FunctionAnswers, ModelSettings};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A validated study.
#[pyclass(frozen, module = "pcc._pcc")]
pub struct Study {
    pub study: pcc::Study,
    function: Option<Py<PyAny>>,
}

#[pymethods]
impl Study {
    /// Reads the text of a study; files that it names lie in `folder`.
    #[staticmethod]
    fn from_toml(py: Python<'_>, text: &str, folder: PathBuf) -> PyResult<Self> {
        let study = pcc::Study::from_toml_in(text, &folder).map_err(|error| raised(py, error))?;
        Ok(Self { study, function: None })
    }

    /// Reads a study from its file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let study = pcc::Study::read(Path::new(&path)).map_err(|error| raised(py, error))?;
        Ok(Self { study, function: None })
    }

    /// The same study with its function, in the form that `pcc._model` gives it.
    fn with_function(&self, py: Python<'_>, function: Py<PyAny>) -> PyResult<Self> {
        match &self.study.model {
            ModelSettings::Function(_) => Ok(Self { study: self.study.clone(), function: Some(function) }),
            other => Err(raised(py, pcc::ModelError::NotFunction { kind: other.kind() })),
        }
    }

    /// The study as a file with every default filled in.
    fn to_toml(&self) -> String {
        self.study.to_toml()
    }

    #[getter]
    fn name(&self) -> &str {
        &self.study.name
    }

    /// The kind of its model.
    #[getter]
    fn kind(&self) -> &'static str {
        self.study.model.kind()
    }

    /// What its function answers, if its model is one.
    #[getter]
    fn answers(&self) -> Option<&'static str> {
        match &self.study.model {
            ModelSettings::Function(function) => Some(function.answers.name()),
            _ => None,
        }
    }

    /// What its function is given beside the inputs.
    #[getter]
    fn constants(&self) -> Vec<(String, f64)> {
        match &self.study.model {
            ModelSettings::Function(function) => function.constants.clone(),
            _ => Vec::new(),
        }
    }

    /// Whether fits use derivatives.
    #[getter]
    fn uses_derivatives(&self) -> bool {
        self.study.uses_derivatives()
    }

    #[getter]
    fn problem_hash(&self) -> String {
        self.study.problem_hash()
    }

    /// Names of the inputs, in order.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.study.inputs.names().map(str::to_owned).collect()
    }

    /// The point where every input has its median.
    #[getter]
    fn medians(&self) -> Vec<f64> {
        self.study.inputs.physical(&self.study.inputs.middle())
    }

    /// Per input, the standardized interval that holds its middle half.
    #[getter]
    fn spreads(&self) -> Vec<f64> {
        let spread = |input: &pcc::Input| input.marginal.germ().at(0.5) - input.marginal.germ().at(-0.5);
        self.study.inputs.inputs().iter().map(spread).collect()
    }

    /// The value of input number `input` that lies `step` in its standardized variable from `value`, if its law has it.
    fn neighbour(&self, input: usize, value: f64, step: f64) -> Option<f64> {
        /// An end of a law may lie infinitely far away in the standardized variable: then from where few values are.
        const NEAR_THE_END: f64 = 1.0 - 1e-6;
        let marginal = &self.study.inputs.inputs().get(input)?.marginal;
        let xi = marginal.standardized(value);
        let xi = if xi.is_finite() { xi } else { marginal.germ().at(NEAR_THE_END.copysign(xi)) };
        let found = marginal.physical(xi + step);
        // Values do not leave the support: at its end there is none beyond.
        Some(found).filter(|found| *found != value && found.is_finite() && marginal.contains(*found))
    }

    /// A point as sentences have it.
    fn describe(&self, point: Vec<f64>) -> String {
        self.study.inputs.describe(&point)
    }
}

impl Study {
    /// The study with its function as a model that this work serves, and that model.
    pub fn served(
        &self,
        py: Python<'_>,
        jobs: usize,
    ) -> impl FnOnce(&Service) -> (pcc::Study, Option<Arc<PythonModel>>) + Send + use<> {
        let (study, function) = (self.study.clone(), self.function.as_ref().map(|function| function.clone_ref(py)));
        move |service| {
            let answers_matrices = matches!(
                &study.model,
                ModelSettings::Function(function) if function.answers == FunctionAnswers::Matrices
            );
            let Some(function) = function else { return (study, None) };
            let model = Arc::new(PythonModel::new(function, service, answers_matrices, jobs.max(1)));
            // It was checked that the study has room for a function.
            let served = study.clone().with_function(model.clone()).unwrap_or(study);
            (served, Some(model))
        }
    }
}
