//! Programs as models: a user's program is run at every point, and answers the eigenvalues.
//!
//! A run has a folder of its own, in which the program is started. It finds its point there, and must leave its answer:
//!
//! * [`Mode::Each`]: pcc writes `params.json`, which is `{"input": 0.5, …, "constant": 2.0, …}`; the program writes
//!   `results.json`, which is `{"eigenvalues": [[re, im], …]}`.
//! * [`Mode::Batch`]: pcc writes `points.csv` with the columns `run,<inputs>,<constants>`; the program writes
//!   `results.csv` with the columns `run,re_1,im_1,…`, see [`results_table`].
//!
//! Numbers are written so that they read back with the same bits. The environment holds `PCC_STUDY_DIR` and
//! `PCC_WORK_DIR`, the folders of the study and of the run. Success is status 0 and a complete answer; anything else
//! is a [`CommandError`], never a guess.

mod as_model;
mod batch;
mod captured;
mod command_line;
mod error;
mod exchange;
mod folder;
mod process;
mod result_columns;
pub mod results_table;
mod row_reader;
mod settings;
mod table_error;
#[cfg(all(test, unix))]
mod tests;

use super::{not_numbers, printable};
pub use error::{CommandError, CommandFailure};
pub use settings::{CommandSettings, Keep, Mode};

use nalgebra::Complex;
use std::cell::LazyCell;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Eigenvalues at one point.
type PointAnswer = Result<Vec<Complex<f64>>, CommandError>;

/// A user's program. Runs may be asked for from several threads at once.
#[derive(Debug)]
pub struct CommandModel {
    settings: CommandSettings,
    is_interrupted: AtomicBool,
}

impl CommandModel {
    /// A program that has not run yet; settings that make no sense are reported by the first run.
    pub fn new(settings: CommandSettings) -> Self {
        Self { settings, is_interrupted: AtomicBool::new(false) }
    }

    /// How the program is run.
    pub fn settings(&self) -> &CommandSettings {
        &self.settings
    }

    /// The eigenvalues at `point`: one value per input.
    ///
    /// # Errors
    ///
    /// [`CommandError`] of the last attempt.
    pub fn run(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, CommandError> {
        let unanswered = || Err(CommandFailure::NoRow { run: 1 }.into());
        self.answers(&[point]).pop().unwrap_or_else(unanswered)
    }

    /// The eigenvalues at each of `points`: by one process if the mode is [`Mode::Batch`], else by one after the other.
    /// Points that failed are tried again together.
    ///
    /// # Errors
    ///
    /// For each point as [`CommandModel::run`].
    pub fn run_batch<P: AsRef<[f64]>>(&self, points: &[P]) -> Vec<Result<Vec<Complex<f64>>, CommandError>> {
        match self.settings.mode {
            Mode::Each => points.iter().map(|point| self.run(point.as_ref())).collect(),
            Mode::Batch if points.is_empty() => Vec::new(),
            Mode::Batch => self.answers(&points.iter().map(AsRef::as_ref).collect::<Vec<_>>()),
        }
    }

    /// Ends what is running, within a fraction of a second: its runs fail with [`CommandFailure::Interrupted`], and
    /// so do all later ones.
    pub fn interrupt(&self) {
        self.is_interrupted.store(true, Ordering::Relaxed);
    }

    /// Removes the folder that holds the folders of runs, if it is empty.
    pub fn clean_up(&self) {
        // A folder that is not empty stays, and one that does not exist is removed already.
        let _ = fs::remove_dir(&self.settings.work_folder);
    }

    /// Runs `points` together, and those that fail again as often as allowed.
    fn answers(&self, points: &[&[f64]]) -> Vec<PointAnswer> {
        let mut folders = Vec::new();
        let mut answers = self.attempt(points, &mut folders);
        for attempts in 2..=self.settings.retries.saturating_add(1) {
            let is_open = |answer: &PointAnswer| answer.as_ref().is_err_and(|error| !error.failure.is_final());
            let open: Vec<usize> = (0..points.len()).filter(|&i| is_open(&answers[i])).collect();
            if open.is_empty() {
                break;
            }
            let again = self.attempt(&open.iter().map(|&i| points[i]).collect::<Vec<_>>(), &mut folders);
            for (i, answer) in open.into_iter().zip(again) {
                answers[i] = answer.map_err(|error| CommandError { attempts, ..error });
            }
        }
        self.remove_folders(&folders, &mut answers);
        answers
    }

    /// One process for all of `points`.
    fn attempt(&self, points: &[&[f64]], folders: &mut Vec<PathBuf>) -> Vec<PointAnswer> {
        let every = |error: &CommandError| vec![Err(error.clone()); points.len()];
        let folder = match self.check(points).and_then(|()| self.create_folder(points)) {
            Ok(folder) => folder,
            Err(failure) => return every(&failure.into()),
        };
        folders.push(folder.clone());
        let output = LazyCell::new(|| captured::end(&folder));
        let in_folder = |failure| CommandError {
            // A program that reports an error has said what there is to say.
            output: if matches!(failure, CommandFailure::Reported { .. }) { String::new() } else { output.clone() },
            folder: Some(folder.clone()),
            ..CommandError::from(failure)
        };
        match self.start(points, &folder) {
            Ok(answers) => answers.into_iter().map(|answer| answer.map_err(in_folder)).collect(),
            Err(failure) => every(&in_folder(failure)),
        }
    }

    /// Whether there is a reason not to start at all.
    fn check(&self, points: &[&[f64]]) -> Result<(), CommandFailure> {
        if self.is_interrupted.load(Ordering::Relaxed) {
            return Err(CommandFailure::Interrupted);
        }
        let CommandSettings { inputs, constants, .. } = &self.settings;
        for point in points {
            if point.len() != inputs.len() {
                return Err(CommandFailure::PointLength { found: point.len(), expected: inputs.len() });
            }
            check_finite(inputs.iter().zip(point.iter().copied()))?;
        }
        check_finite(constants.iter().map(|(name, value)| (name, *value)))?;
        if self.settings.mode == Mode::Batch {
            results_table::check_names(inputs.iter().chain(constants.iter().map(|(name, _)| name)))?;
        }
        Ok(())
    }

    fn create_folder(&self, points: &[&[f64]]) -> Result<PathBuf, CommandFailure> {
        let kind = match self.settings.mode {
            Mode::Each => "run",
            Mode::Batch => "batch",
        };
        folder::create(&self.settings.work_folder, kind, points)
    }

    /// The answer to each point, or the failure of the process that should have given them.
    fn start(&self, points: &[&[f64]], folder: &Path) -> Result<Vec<batch::RowAnswer>, CommandFailure> {
        let (settings, is_interrupted) = (&self.settings, &self.is_interrupted);
        match settings.mode {
            // There is one point only.
            Mode::Each => {
                points.iter().map(|point| exchange::run(settings, point, folder, is_interrupted).map(Ok)).collect()
            }
            Mode::Batch => batch::run(settings, points, folder, is_interrupted),
        }
    }

    /// Removes what is not kept, and forgets its name.
    fn remove_folders(&self, folders: &[PathBuf], answers: &mut [PointAnswer]) {
        let are_kept = match self.settings.keep {
            Keep::Always => true,
            Keep::Failed => answers.iter().any(Result::is_err),
            Keep::Never => false,
        };
        if !are_kept {
            folders.iter().for_each(|folder| folder::remove(folder));
            answers.iter_mut().filter_map(|answer| answer.as_mut().err()).for_each(|error| error.folder = None);
        }
    }
}

fn check_finite<'a>(mut values: impl Iterator<Item = (&'a String, f64)>) -> Result<(), CommandFailure> {
    match values.find(|(_, value)| !value.is_finite()) {
        Some((name, value)) => Err(CommandFailure::ValueNotFinite {
            name: printable::line(name, printable::SHOWN_CELL),
            value: value.to_string(),
        }),
        None => Ok(()),
    }
}
