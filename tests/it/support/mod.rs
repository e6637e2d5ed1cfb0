//! What several tests share.
#![allow(dead_code, reason = "every test file compiles its own copy and uses a part of it")]

pub mod command;

use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::surrogate::Surrogate;
use std::path::PathBuf;

/// A file of the repository.
pub fn repository(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The text of a file of the repository.
pub fn text(path: &str) -> String {
    std::fs::read_to_string(repository(path)).unwrap()
}

/// The shipped study by the paper's method with so many inputs.
pub fn shipped_study(inputs: usize) -> Study {
    Study::from_toml(&text(&format!("surrogates/clutch-r{inputs}-eigenvalues.toml"))).unwrap()
}

/// The shipped study by invariants with so many inputs.
pub fn invariants_study(inputs: usize) -> Study {
    Study::from_toml(&text(&format!("surrogates/clutch-r{inputs}.toml"))).unwrap()
}

/// Builds a study.
pub fn build(study: &Study) -> Surrogate {
    pcc_compile::compilation::build(study, &Silent).unwrap()
}

/// Rows of a CSV file of numbers, below its header.
pub fn csv_rows(path: &str) -> Vec<Vec<f64>> {
    let rows = text(path);
    rows.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
}
