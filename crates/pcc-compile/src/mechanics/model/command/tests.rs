//! Real processes: shell scripts that answer well, badly, late or not at all.

mod batch;
mod each;
mod endings;
mod hostile;
mod messages;
mod results_table;

use crate::mechanics::model::command::{CommandModel, CommandSettings, Keep, Mode};
use nalgebra::Complex;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Answers [[a, b], [c, a]] for the inputs a and b and the constant c.
const ECHO: &str = r#"set -- $(sed -n 's/.*: \([^,]*\),*$/\1/p' params.json)
printf '{"eigenvalues": [[%s, %s], [%s, %s]]}' "$1" "$2" "$3" "$1" > results.json"#;

/// A folder with a study's folder in it; a work folder appears beside that.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("study")).unwrap();
    folder
}

fn settings(folder: &Path, script: &str) -> CommandSettings {
    CommandSettings {
        command: vec!["sh".to_owned(), "-c".to_owned(), script.to_owned()],
        shell: false,
        mode: Mode::Each,
        jobs: 1,
        timeout: None,
        retries: 0,
        eigenvalues: 2,
        work_folder: folder.join("work"),
        keep: Keep::Failed,
        study_folder: folder.join("study"),
        inputs: vec!["a".to_owned(), "b".to_owned()],
        constants: vec![("c".to_owned(), 0.25)],
    }
}

fn program(folder: &TempDir, script: &str) -> CommandModel {
    CommandModel::new(settings(folder.path(), script))
}

/// What [`ECHO`] must answer.
fn echoed(point: &[f64]) -> Vec<Complex<f64>> {
    vec![Complex::new(point[0], point[1]), Complex::new(0.25, point[0])]
}

fn assert_same_bits(left: &[Complex<f64>], right: &[Complex<f64>]) {
    let bits = |values: &[Complex<f64>]| values.iter().map(|z| (z.re.to_bits(), z.im.to_bits())).collect::<Vec<_>>();
    assert_eq!(bits(left), bits(right), "{left:?} {right:?}");
}

/// Names of the folders of runs that are there.
fn runs(folder: &TempDir) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder.path().join("work")) else { return Vec::new() };
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}
