//! What can be typed about model runs: where they are recorded, and who makes them.

use clap::Args;
use std::path::PathBuf;

/// Where model runs are recorded.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct Recording {
    /// Record model runs in this journal [default: those of programs in <name of the study>.journal, of a build beside the surrogate;
    /// others only while a build lasts]
    #[arg(long, value_name = "FILE")]
    pub journal: Option<PathBuf>,

    /// Use the runs of this model that the journal has instead of running them again
    #[arg(long)]
    pub resume: bool,

    /// Try recorded failures again that the study would skip
    #[arg(long, requires = "resume")]
    pub retry_failed: bool,

    /// Record nothing
    #[arg(long, conflicts_with_all = ["journal", "resume"])]
    pub no_journal: bool,
}

#[derive(Debug, Args)]
pub(super) struct Design {
    /// Study file
    pub study: PathBuf,

    /// Table of the points to run: run, one column per input, constants
    #[arg(long, value_name = "ROWS.csv")]
    pub emit: PathBuf,

    /// Journal of the answers [default: <name of the study>.journal in the current folder]
    #[arg(long, value_name = "FILE")]
    pub journal: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct Ingest {
    /// Study file
    pub study: PathBuf,

    /// Table of answers
    #[arg(value_name = "RESULTS.csv")]
    pub results: PathBuf,

    /// Take answers that contradict earlier ones in their place
    #[arg(long)]
    pub replace: bool,

    /// Journal of the answers [default: <name of the study>.journal in the current folder]
    #[arg(long, value_name = "FILE")]
    pub journal: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct ShowJournal {
    /// Journal file
    pub journal: PathBuf,

    /// Only the runs of this study's model, columns named like its inputs
    #[arg(long, value_name = "STUDY")]
    pub study: Option<PathBuf>,

    /// Write every run with its inputs, eigenvalues and errors to a table
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}
