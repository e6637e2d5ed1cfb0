//! A surrogate: its file, its values at points, its answers.

use crate::background::in_background;
use crate::errors::raised;
use crate::pool::pool;
use crate::questions::{Asked, ModeAlong, answer, campbell, json, page};
use numpy::{Complex64, PyArray1, PyReadonlyArray2, PyReadwriteArray1, PyReadwriteArray2, PyUntypedArrayMethods};
use pcc::report::InspectReport;
use pcc::{Artifact, Format, GivenPoints, PointError, Silent, Verdict, decode, encode};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// Fewer points are evaluated on the spot: to start threads would take longer.
const FEW: usize = 256;

/// Whether a file that starts with these bytes looks like a surrogate.
#[pyfunction]
pub fn looks_like_a_surrogate(start: &[u8]) -> bool {
    pcc::looks_like_a_surrogate(start)
}

/// A surrogate as its file has it.
#[pyclass(frozen, module = "pcc._pcc")]
pub struct Surrogate {
    pub artifact: Artifact,
}

#[pymethods]
impl Surrogate {
    /// Reads a surrogate from the bytes of its file.
    #[new]
    fn new(py: Python<'_>, data: &[u8]) -> PyResult<Self> {
        decode(data).map(|artifact| Self { artifact }).map_err(|error| raised(py, error))
    }

    /// The bytes of its file, binary or JSON.
    fn to_bytes<'py>(&self, py: Python<'py>, json: bool) -> PyResult<Bound<'py, PyBytes>> {
        let format = if json { Format::Json } else { Format::Binary };
        self.artifact.check_lossless().map_err(|error| raised(py, error))?;
        let bytes = encode(&self.artifact.surrogate, format).map_err(|error| raised(py, error))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Whether it was read from JSON.
    #[getter]
    fn is_json(&self) -> bool {
        self.artifact.format == Format::Json
    }

    /// Name of the study.
    #[getter]
    fn study_name(&self) -> &str {
        &self.artifact.surrogate.provenance.study_name
    }

    /// Names of the inputs, in order.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.artifact.surrogate.inputs.names().map(str::to_owned).collect()
    }

    /// Names of the eigenvalues, in the order of their columns.
    #[getter]
    fn labels(&self) -> Vec<String> {
        let name = |label: &pcc::Label| label.growth_rate().trim_start_matches("re_").to_owned();
        self.artifact.surrogate.labels().iter().map(name).collect()
    }

    /// What `pcc inspect` prints: JSON, and text.
    fn inspect(&self, file: String, bytes: u64) -> (String, String) {
        let report = InspectReport::new(&self.artifact, file, bytes);
        (json(&report), format!("{report:100}"))
    }

    /// Writes every eigenvalue at every point, in 1/s, into an array that NumPy has made: it knows how to get much
    /// memory quickly.
    fn eigenvalues(
        &self,
        py: Python<'_>,
        points: PyReadonlyArray2<'_, f64>,
        mut found: PyReadwriteArray2<'_, Complex64>,
        extrapolate: bool,
    ) -> PyResult<()> {
        let found = found.as_slice_mut()?;
        self.at(py, &points, extrapolate, |given, rows, observer| given.eigenvalues(rows, found, observer))
    }

    /// Writes max Re λ at every point, in 1/s.
    fn max_re(
        &self,
        py: Python<'_>,
        points: PyReadonlyArray2<'_, f64>,
        mut found: PyReadwriteArray1<'_, f64>,
        extrapolate: bool,
    ) -> PyResult<()> {
        let found = found.as_slice_mut()?;
        self.at(py, &points, extrapolate, |given, rows, observer| given.max_re(rows, found, observer))
    }

    /// What is said of stability at every point: 0 stable, 1 marginal, 2 flutter, 3 divergence.
    fn verdict<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        extrapolate: bool,
    ) -> PyResult<Bound<'py, PyArray1<u8>>> {
        let mut found = vec![Verdict::Stable; points.shape()[0]];
        self.at(py, &points, extrapolate, |given, rows, observer| given.verdicts(rows, &mut found, observer))?;
        Ok(PyArray1::from_vec(py, found.into_iter().map(|verdict| verdict as u8).collect()))
    }

    /// The answer to a question: JSON, text, and pictures as SVG.
    fn ask(
        &self,
        py: Python<'_>,
        asked: Asked,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<(String, String, Vec<String>)> {
        in_background(py, pool()?, progress, |service| answer(&self.artifact.surrogate, &asked, service))?
            .map_err(|error| raised(py, error))
    }

    /// Frequencies of modes along an input, as SVG.
    fn campbell(&self, input: &str, values: Vec<f64>, modes: Vec<ModeAlong>) -> String {
        campbell(&self.artifact.surrogate, input, &values, modes)
    }

    /// What `pcc report` writes, as HTML.
    fn page(
        &self,
        py: Python<'_>,
        file: (String, u64),
        samples: u64,
        seed: u64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        in_background(py, pool()?, progress, |service| page(&self.artifact, file, samples, seed, service))?
            .map_err(|error| raised(py, error))
    }
}

impl Surrogate {
    fn at(
        &self,
        py: Python<'_>,
        points: &PyReadonlyArray2<'_, f64>,
        extrapolates: bool,
        evaluate: impl FnOnce(GivenPoints<'_>, &[f64], &dyn pcc::Observer) -> Result<(), PointError> + Send,
    ) -> PyResult<()> {
        let rows = points.as_slice()?;
        let given = GivenPoints { surrogate: &self.artifact.surrogate, extrapolates };
        let found = match points.shape()[0] <= FEW {
            true => {
                let pool = pool()?;
                // A thread of the pool may be busy for long; nobody is to wait for the interpreter meanwhile.
                py.detach(|| pool.install(|| evaluate(given, rows, &Silent)))
            }
            false => in_background(py, pool()?, None, |service| evaluate(given, rows, service))?,
        };
        found.map_err(|error| raised(py, error))
    }
}
