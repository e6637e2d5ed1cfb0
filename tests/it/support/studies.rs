//! Studies in folders of their own, built, and what commands print of them as JSON.

use super::command::output;
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A folder with the study as `study.toml`.
pub fn folder_with(study: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("study.toml"), study).unwrap();
    folder
}

/// The same with its surrogate as `built.pcc`.
pub fn built_from(study: &str) -> TempDir {
    let folder = folder_with(study);
    output(folder.path(), &["build", "study.toml", "-o", "built.pcc", "--quiet"]);
    folder
}

/// The JSON document that a command prints.
pub fn json(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&output(folder, &[arguments, &["--json"]].concat())).unwrap()
}

/// A number of such a document.
#[track_caller]
pub fn number(report: &Value, pointer: &str) -> f64 {
    report.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} of {report}"))
}
