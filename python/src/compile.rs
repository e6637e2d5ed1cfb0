//! Builds, comparisons and certificates.

use crate::background::{Service, in_background};
use crate::errors::{exception, raised, run_error, sentence};
use crate::model::{PythonModel, Raised};
use crate::pool::new_pool;
use crate::questions::json;
use crate::study::Study;
use crate::surrogate::Surrogate;
use pcc::report::{CertifyReport, CompareReport};
use pcc::{
    Books, BuildError, Campaign, Error, Format, Note, Recording, ReferenceError, RunError, build as build_surrogate,
    certify_with_model, check_problem, compare_with_model, encode,
};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Probability with which each end of a certificate holds.
const SIDE_LEVEL: f64 = 0.95;

/// Who runs the model, and where it is recorded.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Runs {
    jobs: usize,
    journal: Option<PathBuf>,
    retry_failed: bool,
    counts_failures: bool,
}

impl Runs {
    fn recording(&self) -> Recording {
        Recording {
            journal: self.journal.clone(),
            resumes: self.journal.is_some(),
            retries_failures: self.retry_failed,
            is_off: self.journal.is_none(),
        }
    }
}

/// What went wrong, and the exception of the run that did.
type Failure = Box<(Error, Option<Raised>)>;

/// Builds the surrogate of a study: the bytes of its file, and the runs that failed and were skipped, in words.
#[pyfunction]
pub fn build<'py>(
    py: Python<'py>,
    study: &Study,
    runs: Runs,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyBytes>, Vec<String>)> {
    let served = study.served(py, runs.jobs);
    let built = in_background(py, new_pool()?, progress, move |service| {
        let (study, model) = served(service);
        built(&study, &runs, service).map_err(|error| with_exception(&study, model, error))
    })?;
    let (bytes, failed) = built.map_err(|failure| raised_with(py, &study.study, *failure))?;
    Ok((PyBytes::new(py, &bytes), failed))
}

fn built(study: &pcc::Study, runs: &Runs, service: &Service) -> Result<(Vec<u8>, Vec<String>), Error> {
    // Nothing is recorded unless a journal is named, so that the name of the file does not matter.
    let books = Books::of_build(study, &runs.recording(), Path::new(""))?;
    books.notes.iter().for_each(|note| service.note(note.to_string()));
    let surrogate = match build_surrogate(books.campaign(study), service) {
        Ok(surrogate) => surrogate,
        Err(error) => {
            if matches!(error, BuildError::TooManyFailures { .. }) && books.ledger.reused() > 0 {
                service.note(Note::FailuresReused.to_string());
            }
            books.give_up().iter().for_each(|note| service.note(note.to_string()));
            return Err(error.into());
        }
    };
    let failed = |failure: &_| describe_failure(study, failure);
    let failed = books.ledger.failures().iter().map(failed).collect();
    let bytes = encode(&surrogate, Format::Binary)?;
    books.close();
    Ok((bytes, failed))
}

fn describe_failure(study: &pcc::Study, failure: &pcc::Failure) -> String {
    format!("{}: {}", study.inputs.describe(&failure.point), failure.cause)
}

/// Compares a surrogate with the model at `samples` points: JSON, and text.
#[pyfunction]
pub fn compare(
    py: Python<'_>,
    surrogate: &Surrogate,
    study: &Study,
    samples: u64,
    seed: u64,
    runs: Runs,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, String)> {
    let (served, surrogate) = (study.served(py, runs.jobs), &surrogate.artifact.surrogate);
    let found = in_background(py, new_pool()?, progress, move |service| {
        let (study, model) = served(service);
        let start = Instant::now();
        let comparison = check_problem(surrogate, &study)
            .map_err(Error::from)
            .and_then(|()| {
                sampled(&study, &runs, service, |campaign| {
                    compare_with_model(surrogate, campaign, samples, seed, service)
                })
            })
            .map_err(|error| with_exception(&study, model, error))?;
        let report = CompareReport::new(&study.name, surrogate, &comparison, seed, start.elapsed().as_secs_f64());
        Ok((json(&report), format!("{report:100}")))
    })?;
    found.map_err(|failure: Failure| raised_with(py, &study.study, *failure))
}

/// Certifies a surrogate by fresh runs of the model: the surrogate with its certificate, JSON, and text.
#[pyfunction]
pub fn certify(
    py: Python<'_>,
    surrogate: &Surrogate,
    study: &Study,
    number: u64,
    seed: u64,
    runs: Runs,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Surrogate, String, String)> {
    surrogate.artifact.check_lossless().map_err(|error| raised(py, error))?;
    let (served, artifact) = (study.served(py, runs.jobs), &surrogate.artifact);
    let problem = study.study.problem_hash();
    let known = &artifact.surrogate.certificates;
    if known.iter().any(|known| known.seed == seed && known.problem_hash == problem) {
        let text = format!("the surrogate has a certificate of seed {seed} already; choose another seed");
        return Err(exception(py, "QuestionError", &text));
    }
    let found = in_background(py, new_pool()?, progress, move |service| {
        let (study, model) = served(service);
        let start = Instant::now();
        let certificate = check_problem(&artifact.surrogate, &study)
            .map_err(Error::from)
            .and_then(|()| {
                sampled(&study, &runs, service, |campaign| {
                    certify_with_model(&artifact.surrogate, campaign, number, seed, SIDE_LEVEL, service)
                })
            })
            .map_err(|error| with_exception(&study, model, error))?;
        let mut certified = artifact.clone();
        certified.surrogate.certificates.push(certificate);
        let report = CertifyReport::new(&certified.surrogate, String::new(), start.elapsed().as_secs_f64());
        Ok((Surrogate { artifact: certified }, json(&report), format!("{report:100}")))
    })?;
    found.map_err(|failure: Failure| raised_with(py, &study.study, *failure))
}

/// What model runs at random points say, with their books.
fn sampled<T>(
    study: &pcc::Study,
    runs: &Runs,
    service: &Service,
    work: impl FnOnce(Campaign<'_>) -> Result<T, ReferenceError>,
) -> Result<T, Error> {
    let books = Books::of_sampling(study, &runs.recording())?;
    books.notes.iter().for_each(|note| service.note(note.to_string()));
    let found = work(Campaign { counts_failures: runs.counts_failures, ..books.campaign(study) });
    if found.is_err() {
        books.recorded().iter().for_each(|note| service.note(note.to_string()));
    }
    Ok(found?)
}

/// The exception of the run that an error is about, if a function raised it.
fn with_exception(study: &pcc::Study, model: Option<Arc<PythonModel>>, error: Error) -> Failure {
    let run = match &error {
        Error::Build(BuildError::Run(run)) | Error::Reference(ReferenceError::Run(run)) => Some(run),
        _ => None,
    };
    let raised = match (run, model) {
        (Some(RunError::Model { point, .. }), Some(model)) => {
            model.exception_at(|other| study.inputs.describe(other) == *point)
        }
        _ => None,
    };
    Box::new((error, raised))
}

/// The exception for it: of a run with the inputs, and the exception of the function as its cause.
fn raised_with(py: Python<'_>, study: &pcc::Study, (error, run): (Error, Option<Raised>)) -> PyErr {
    let Some((point, cause)) = run else {
        let is_of_run = matches!(
            &error,
            Error::Build(BuildError::Run(_)) | Error::Reference(ReferenceError::Run(_) | ReferenceError::Model(_))
        );
        return match is_of_run {
            true => exception(py, "RunError", &sentence(&error)),
            false => raised(py, error),
        };
    };
    run_error(py, &sentence(&error), study.inputs.names().zip(point).collect(), cause)
}
