//! Many points, one process: `points.csv` goes in, `results.csv` comes out.
//!
//! If the process fails, all of its points do, whatever it has written: the last row may be cut in the middle of a
//! number.

use super::error::CommandFailure;
use super::results_table::{TableError, read_results, write_points};
use super::settings::CommandSettings;
use super::{folder, process};
use nalgebra::Complex;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::sync::atomic::AtomicBool;

const POINTS: &str = "points.csv";
const RESULTS: &str = "results.csv";

/// Eigenvalues of one point.
pub(super) type RowAnswer = Result<Vec<Complex<f64>>, CommandFailure>;

/// The eigenvalues at each of `points`, by a process in `folder`.
pub(super) fn run(
    settings: &CommandSettings,
    points: &[&[f64]],
    folder: &Path,
    interrupted: &AtomicBool,
) -> Result<Vec<RowAnswer>, CommandFailure> {
    let path = folder.join(POINTS);
    File::create_new(&path)
        .and_then(|file| write_points(BufWriter::new(file), 1.., &settings.inputs, &settings.constants, points))
        .map_err(|error| folder::failure(&path, &error))?;
    process::run(settings, folder, interrupted)?;
    answers(folder::open_results(folder, RESULTS)?, settings.eigenvalues, points.len())
}

fn answers(results: File, eigenvalues: usize, count: usize) -> Result<Vec<RowAnswer>, CommandFailure> {
    let mut answers: Vec<Option<RowAnswer>> = vec![None; count];
    let mut lines: Vec<Option<u64>> = vec![None; count];
    // Without names of inputs, rows are identified by their run.
    for row in read_results(results, &[], eigenvalues)? {
        let run = row.run.unwrap_or(0);
        let place = run.checked_sub(1).and_then(|index| usize::try_from(index).ok());
        let answer = place.and_then(|index| answers.get_mut(index));
        let answer = answer.ok_or(CommandFailure::UnknownRun { line: row.line, run, count })?;
        if let Some(first) = lines[run as usize - 1].replace(row.line) {
            return Err(TableError::RepeatedRun { line: row.line, first, run }.into());
        }
        *answer = Some(row.answer.map_err(|text| CommandFailure::Reported { text }));
    }
    let answers = answers.into_iter().enumerate();
    Ok(answers.map(|(index, answer)| answer.unwrap_or(Err(CommandFailure::NoRow { run: index + 1 }))).collect())
}
