//! What several tests share.

pub mod command;
pub mod reproduction;
pub mod studies;

use pcc_compile::reference::ModelSample;
use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::surrogate::Surrogate;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Mutex, OnceLock};

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

/// The surrogate of the shipped study of this name, built once for all tests.
pub fn built(name: &str) -> &'static Surrogate {
    static BUILT: Mutex<BTreeMap<String, &'static OnceLock<Surrogate>>> = Mutex::new(BTreeMap::new());
    // The list is free again while the surrogate is built, for tests that want others.
    let place = *BUILT.lock().unwrap().entry(name.to_owned()).or_insert_with(|| Box::leak(Box::default()));
    place.get_or_init(|| {
        let study = Study::from_toml_in(&text(&format!("surrogates/{name}.toml")), &repository("surrogates"));
        build(&study.unwrap())
    })
}

/// Points of a shared sample.
const SAMPLE_POINTS: u64 = 50_000;

/// The model with so many inputs at the first points under seed 1: run once for all tests that judge surrogates on
/// them, because that costs more than the builds and evaluations of most surrogates.
pub fn model_sample(inputs: usize) -> &'static ModelSample<'static> {
    static SAMPLES: [OnceLock<ModelSample<'static>>; 8] = [const { OnceLock::new() }; 8];
    SAMPLES[inputs - 1].get_or_init(|| {
        let study: &'static Study = Box::leak(Box::new(shipped_study(inputs)));
        ModelSample::new(study, SAMPLE_POINTS, 1, &Silent).unwrap()
    })
}

/// Rows of a CSV file of numbers, below its header.
pub fn csv_rows(path: &str) -> Vec<Vec<f64>> {
    let rows = text(path);
    // The verdict at the end of a row is a word.
    rows.lines().skip(1).map(|line| line.split(',').map_while(|cell| cell.parse().ok()).collect()).collect()
}

/// Text as if a terminal had no end.
pub fn in_one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
