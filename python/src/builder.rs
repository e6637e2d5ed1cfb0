//! Builds whose runs somebody else makes.

use crate::background::in_background;
use crate::errors::{exception, raised};
use crate::model::read;
use crate::pool::new_pool;
use crate::study::Study;
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pcc::{Contents, Error, Format, Journal, ModelAnswer, TellError, ask_runs, build_from_answers, encode, tell_runs};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// A build that is stepped on answers.
#[pyclass(frozen, module = "pcc._pcc")]
pub struct Builder {
    study: Py<Study>,
    journal: Option<Journal>,
    contents: Mutex<Contents>,
    /// Held while answers are taken, by threads without the interpreter's lock: answers that came in between would be
    /// lost. What is known can be read meanwhile.
    taking: Mutex<()>,
}

#[pymethods]
impl Builder {
    #[new]
    fn new(py: Python<'_>, study: Py<Study>, journal: Option<PathBuf>) -> PyResult<Self> {
        let opened = journal.map(|path| Journal::open(&path)).transpose().map_err(|error| raised(py, error))?;
        let (journal, contents) = opened.map_or((None, Contents::default()), |(journal, known)| (Some(journal), known));
        Ok(Self { study, journal, contents: Mutex::new(contents), taking: Mutex::default() })
    }

    /// The points that wait for an answer, a row each; none if the build is complete.
    fn ask<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (study, contents) = (self.study.get(), self.contents());
        let served = study.served(py, 1);
        let step =
            in_background(py, new_pool()?, None, move |service| ask_runs(&served(service).0, &contents, service))?;
        let step = step.map_err(|error| raised(py, error))?;
        let points: Vec<f64> = step.open().flat_map(|(_, point)| point.iter().copied()).collect();
        let dimension = study.study.inputs.dimension();
        numpy::PyArray1::from_vec(py, points).reshape([step.open().count(), dimension])
    }

    /// Takes answers to points that were asked for, a row each: what `pcc._model` makes of an answer, or why there is
    /// none. Returns how many answers and failures are new, and how many points wait now.
    fn tell(
        &self,
        py: Python<'_>,
        points: PyReadonlyArray2<'_, f64>,
        answers: Vec<Bound<'_, PyAny>>,
    ) -> PyResult<(usize, usize, usize)> {
        let dimension = points.shape()[1].max(1);
        let rows = points.as_slice()?.chunks_exact(dimension).map(<[f64]>::to_vec);
        let read = |(row, answer): (usize, &Bound<'_, PyAny>)| -> PyResult<Result<ModelAnswer, String>> {
            if let Ok(cause) = answer.extract::<String>() {
                return Ok(Err(cause));
            }
            let found = read(answer, dimension);
            let found =
                found.map_err(|error| exception(py, "TellError", &format!("answer {row}: {}", error.value(py))));
            Ok(found?.map_err(|error| error.to_string()))
        };
        let answers = answers.iter().enumerate().map(read).collect::<PyResult<Vec<_>>>()?;
        let answers: Vec<_> = rows.zip(answers).collect();
        let served = self.study.get().served(py, 1);
        let told = in_background(py, new_pool()?, None, move |service| {
            let _taking = self.taking.lock().unwrap_or_else(PoisonError::into_inner);
            let mut contents = self.contents();
            let told = tell_runs(&served(service).0, self.journal.as_ref(), &mut contents, &answers, service)?;
            // Here, since Ctrl-C from now on must not part memory from what the journal has.
            *self.contents.lock().unwrap_or_else(PoisonError::into_inner) = contents;
            Ok::<_, TellError>(told)
        })?;
        let told = told.map_err(|error| raised(py, error))?;
        Ok((told.answered, told.failed, told.missing))
    }

    /// The bytes of the surrogate's file.
    fn result<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let (served, contents) = (self.study.get().served(py, 1), self.contents());
        let built = in_background(py, new_pool()?, None, move |service| -> Result<Vec<u8>, Error> {
            let surrogate = build_from_answers(&served(service).0, &contents, service)?;
            Ok(encode(&surrogate, Format::Binary)?)
        })?;
        Ok(PyBytes::new(py, &built.map_err(|error| raised(py, error))?))
    }
}

impl Builder {
    /// What is known, as it is now.
    fn contents(&self) -> Contents {
        self.contents.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
