//! One file per command.

mod build;
mod compare;
mod convert;
mod eval;
mod inspect;
mod reference;
mod run;

pub(super) use build::build;
pub(super) use compare::compare;
pub(super) use convert::convert;
pub(super) use eval::eval;
pub(super) use inspect::inspect;
pub(super) use reference::reference;
pub(super) use run::run;

use super::arguments::Arguments;
use super::{Ending, Interrupted};
use crate::artifact::{self, Artifact};
use crate::study::Study;
use anyhow::Context as _;
use clap::CommandFactory;
use clap_complete::Shell;
use serde::Serialize;
use std::fmt;
use std::path::Path;

/// Prints the completion script of a shell.
pub(super) fn completions(shell: Shell) -> anyhow::Result<Ending> {
    clap_complete::generate(shell, &mut Arguments::command(), "pcc", &mut std::io::stdout());
    Ok(Ending::Done)
}

fn read_study(path: &Path) -> anyhow::Result<Study> {
    let text = std::fs::read_to_string(path).with_context(|| format!("{} cannot be read", path.display()))?;
    Study::from_toml(&text).with_context(|| path.display().to_string())
}

fn read_surrogate(path: &Path) -> anyhow::Result<Artifact> {
    artifact::read(path).with_context(|| path.display().to_string())
}

/// What `eval` and `reference` say after writing points.
#[derive(Debug, Serialize)]
struct PointsReport {
    points: u64,
    stable_points: u64,
    file: String,
}

impl fmt::Display for PointsReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} points, {} of them stable, written to {}", self.points, self.stable_points, self.file)
    }
}

/// An error of long work on `what`; an interruption becomes the one that decides the exit code.
fn interruptible<E>(error: E, was_interrupted: bool, what: &str) -> anyhow::Error
where
    E: std::error::Error + Send + Sync + 'static,
{
    if was_interrupted { Interrupted.into() } else { anyhow::Error::from(error).context(what.to_owned()) }
}
