//! Errors of the library as exceptions, with the sentences of the command line.

use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use std::error::Error;

/// The exception of this name in `pcc._errors`.
pub fn exception(py: Python<'_>, name: &str, sentence: &str) -> PyErr {
    let made = py.import("pcc._errors").and_then(|errors| errors.getattr(name)?.call1((sentence,)));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// The exception for a run whose function raised `cause` at these inputs.
pub fn run_error(py: Python<'_>, sentence: &str, inputs: Vec<(&str, f64)>, cause: PyErr) -> PyErr {
    let made = py.import("pcc._errors").and_then(|errors| errors.getattr("RunError")?.call1((sentence, inputs)));
    let exception = made.map_or_else(|error| error, PyErr::from_value);
    exception.set_cause(py, Some(cause));
    exception
}

/// What the library says of an error, with its causes where it does not say them itself.
pub fn sentence(error: &dyn Error) -> String {
    let mut said = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let text = error.to_string();
        if !said.contains(&text) {
            said = format!("{said}: {text}");
        }
        cause = error.source();
    }
    said
}

/// The exception for an error of the library.
pub fn raised(py: Python<'_>, error: impl Into<pcc::Error>) -> PyErr {
    let error = error.into();
    let name = match &error {
        pcc::Error::Study(_) => "StudyError",
        pcc::Error::StudyFile(pcc::StudyFileError::Study { .. }) => "StudyError",
        pcc::Error::StudyFile(_) | pcc::Error::Read(_) | pcc::Error::Save(_) | pcc::Error::File(_) => "FileError",
        pcc::Error::Journal(_) | pcc::Error::Recording(_) => "JournalError",
        pcc::Error::Model(_) | pcc::Error::Run(_) => "RunError",
        pcc::Error::Build(_) | pcc::Error::BuildFile(_) => "BuildError",
        pcc::Error::Ask(_) | pcc::Error::Tell(_) => "TellError",
        pcc::Error::Point(_) => "PointsError",
        pcc::Error::Survey(_) | pcc::Error::Eval(_) | pcc::Error::Session(_) => "QuestionError",
        _ => "Error",
    };
    exception(py, name, &sentence(&error))
}

/// Whether what was raised is to end the work, and not a run alone: Ctrl-C, `SystemExit`.
pub fn ends_the_work(py: Python<'_>, error: &PyErr) -> bool {
    !error.is_instance_of::<PyException>(py)
}
