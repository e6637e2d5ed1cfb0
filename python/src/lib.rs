//! The Python module of pcc, below its Python half in `python/pcc`: what needs the library, and no more.
//!
//! | file | holds |
//! |---|---|
//! | `surrogate.rs` | a surrogate: its file, its values at points, its answers |
//! | `questions.rs` | questions as Python asks them, answers as JSON, text and pictures |
//! | `study.rs` | a study, with the function that is its model |
//! | `model.rs` | the function as a model: runs call back into Python |
//! | `compile.rs` | builds, comparisons and certificates |
//! | `builder.rs` | builds whose runs somebody else makes |
//! | `background.rs` | long work beside the interpreter: progress, Ctrl-C, calls back |
//! | `pool.rs` | threads that survive a fork of the process |
//! | `errors.rs` | errors of the library as exceptions |

#![forbid(unsafe_code)]

mod background;
mod builder;
mod compile;
mod errors;
mod model;
mod pool;
mod questions;
mod study;
mod surrogate;

use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;

/// What `pcc` needs of the library.
#[pymodule]
mod _pcc {
    #[pymodule_export]
    use super::builder::Builder;
    #[pymodule_export]
    use super::compile::{build, certify, compare};
    #[pymodule_export]
    use super::questions::interval;
    #[pymodule_export]
    use super::study::Study;
    #[pymodule_export]
    use super::surrogate::{Surrogate, looks_like_a_surrogate};
    #[pymodule_export]
    use super::{main, save};

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

/// The command line, with these arguments after the program's name; its exit code.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| pcc::cli::exit_code_of(std::iter::once("pcc".into()).chain(arguments)))
}

/// Writes a file whole or not at all.
#[pyfunction]
fn save(py: Python<'_>, path: PathBuf, data: &[u8]) -> PyResult<()> {
    py.detach(|| pcc::save_file(&path, data)).map_err(|error| errors::raised(py, error))
}
