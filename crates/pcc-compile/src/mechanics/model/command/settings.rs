//! What is known about a program before it runs.

use std::path::PathBuf;
use std::time::Duration;

/// How a program is run and what it must answer.
#[derive(Debug, Clone, PartialEq)]
pub struct CommandSettings {
    /// The program and its arguments. In the arguments, and in the program, `{study}` stands for the study's folder and
    /// `{work}` for the folder of the run; nothing else is replaced.
    pub command: Vec<String>,
    /// Whether the command is one text for a shell: `sh -c`, on Windows `cmd /C`. There `{study}` and `{work}` stand
    /// for the variables `PCC_STUDY_DIR` and `PCC_WORK_DIR`, so that no path becomes a part of the text: write them
    /// in double quotes if a path may hold spaces.
    pub shell: bool,
    /// How many points a process answers.
    pub mode: Mode,
    /// How many processes run at once; the caller's business.
    pub jobs: usize,
    /// How long a process may take; `None` for as long as it likes.
    pub timeout: Option<Duration>,
    /// Further attempts after one that failed.
    pub retries: u32,
    /// Eigenvalues that every run must answer.
    pub eigenvalues: usize,
    /// Holds the folders of runs; created if missing.
    pub work_folder: PathBuf,
    /// Which of these folders stay.
    pub keep: Keep,
    /// The study's folder, absolute.
    pub study_folder: PathBuf,
    /// Names of the inputs, in the order of a point's values.
    pub inputs: Vec<String>,
    /// Names and values that go to the program with every point.
    pub constants: Vec<(String, f64)>,
}

/// How many points a process answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// One: it reads `params.json` and writes `results.json`.
    #[default]
    Each,
    /// All points of a call: it reads `points.csv` and writes `results.csv`.
    Batch,
}

/// Which folders of runs stay on the disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Keep {
    /// All.
    Always,
    /// Those of runs that failed, with all their attempts. A run that succeeded in the end leaves nothing, a batch only
    /// if all of its points succeeded.
    #[default]
    Failed,
    /// None.
    Never,
}
