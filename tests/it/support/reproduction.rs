//! The paper's table 2 by `pcc reproduce`, made once for all tests that judge its rows: its builds and its model runs
//! are most of what these tests cost.

use super::command::{files, output};
use serde::Deserialize;
use std::ffi::OsString;
use std::fs;
use std::sync::LazyLock;

/// Points of the model that every surrogate is compared with; a single point weighs 0.002 % of them and up to 0.01 % of
/// the proportion. Fewer than the documented table is made of, and all bars hold with them as well.
pub const POINTS: &str = "50000";

/// What `pcc reproduce --only table2` has said and written.
pub struct Reproduction {
    pub printed: String,
    /// Names of the files it has written.
    pub files: Vec<OsString>,
    /// The text of `table2.csv`.
    pub csv: String,
    /// The rows of `table2.csv`.
    pub rows: Vec<Row>,
}

/// Points and first design have the seed 1, as by default.
pub static TABLE_2: LazyLock<Reproduction> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let printed = output(folder.path(), &["reproduce", "--only", "table2", "-o", "table2", "--runs", POINTS]);
    let csv = fs::read_to_string(folder.path().join("table2/table2.csv")).unwrap();
    let rows = csv::Reader::from_reader(csv.as_bytes()).into_deserialize().map(Result::unwrap).collect();
    Reproduction { printed, files: files(&folder.path().join("table2")), csv, rows }
});

/// One build and its comparison with the model.
#[derive(Debug, Deserialize)]
pub struct Row {
    pub r: usize,
    pub method: String,
    pub direct_computations: u64,
    pub stability_error_percent: Option<f64>,
    pub target: String,
    pub derivatives: bool,
    pub seed: u64,
    pub final_mesh_computations: u64,
    pub misclassified_percent: f64,
}

impl Row {
    /// Error of the proportion in percent.
    pub fn error(&self) -> f64 {
        self.stability_error_percent.unwrap()
    }
}

impl Reproduction {
    /// The rows of the sparse method, one per design, whose seeds are 1 to 5.
    pub fn sparse(&self, inputs: usize, target: &str, derivatives: bool) -> Vec<&Row> {
        let is_wanted = |row: &&Row| row.method == "sparse" && row.derivatives == derivatives;
        let rows: Vec<&Row> = self.of(inputs, target).filter(is_wanted).collect();
        assert_eq!(rows.iter().map(|row| row.seed).collect::<Vec<_>>(), [1, 2, 3, 4, 5], "r = {inputs}, {target}");
        rows
    }

    /// The row of a full expansion of eigenvalues, `gpc` or `me-gpc`, whose final mesh has so many runs.
    pub fn full(&self, inputs: usize, method: &str, final_mesh: u64) -> &Row {
        let is_wanted = |row: &&Row| row.method == method && row.final_mesh_computations == final_mesh;
        let rows: Vec<&Row> = self.of(inputs, "eigenvalues").filter(is_wanted).collect();
        assert_eq!(rows.len(), 1, "{method} with r = {inputs} and {final_mesh} runs");
        rows[0]
    }

    fn of(&self, inputs: usize, target: &str) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |row| row.r == inputs && row.target == target)
    }
}
