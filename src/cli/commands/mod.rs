//! One file per command.

mod build;
mod certify;
mod compare;
mod convert;
mod design;
mod eval;
mod ingest;
mod inspect;
mod journal;
mod merge;
mod reference;
mod report;
mod reproduce;
mod run;

pub(super) use build::build;
pub(super) use certify::certify;
pub(super) use compare::compare;
pub(super) use convert::convert;
pub(super) use design::design;
pub(super) use eval::eval;
pub(super) use ingest::ingest;
pub(super) use inspect::inspect;
pub(super) use journal::journal;
pub(super) use merge::merge;
pub(super) use reference::reference;
pub(super) use report::report;
pub(super) use reproduce::reproduce;
pub(super) use run::run;

use super::arguments::Arguments;
use super::{Ending, print};
use anyhow::{Context as _, bail};
use clap::CommandFactory;
use clap_complete::Shell;
use pcc_compile::campaign::journal as model_journal;
use pcc_compile::study::Study;
use pcc_evaluate::artifact::{self, Artifact};
use pcc_evaluate::foundation::Interrupted;
use pcc_evaluate::shard_file::MARK;
use serde::Serialize;
use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Bytes of a study file that are read at most.
const LARGEST_STUDY: u64 = 1 << 24;

/// Prints the completion script of a shell.
pub(super) fn completions(shell: Shell) -> anyhow::Result<Ending> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "pcc", &mut script);
    print(&String::from_utf8_lossy(&script))?;
    Ok(Ending::Done)
}

/// Refuses an output that is one of the command's own inputs, which the result would destroy.
fn keep_inputs(output: &Path, inputs: &[&Path]) -> anyhow::Result<()> {
    let Ok(output_file) = output.canonicalize() else { return Ok(()) };
    for input in inputs {
        if input.canonicalize().is_ok_and(|input_file| input_file == output_file) {
            bail!("{}: would replace the file it is made from; name another output", output.display());
        }
    }
    Ok(())
}

/// Refuses to replace a file that is no surrogate by one: a study or data named by mistake.
fn keep_other_files(output: &Path) -> anyhow::Result<()> {
    if !output.is_file() {
        return Ok(()); // nothing there, or nothing that may be opened: a pipe would block
    }
    let mut start = Vec::new();
    let read = File::open(output).and_then(|file| file.take(64).read_to_end(&mut start));
    if read.is_err() || (!start.is_empty() && !artifact::looks_like_a_surrogate(&start)) {
        bail!("{}: exists and is not a surrogate; name another output, or remove it first", output.display());
    }
    Ok(())
}

/// What pages of a surrogate, and of the reproduced paper, have near their start.
const SURROGATE_PAGE: &str = "<meta name=\"generator\" content=\"pcc report ";
const REPRODUCTION_PAGE: &str = "<meta name=\"generator\" content=\"pcc reproduce ";

/// Refuses to replace a file by one of another kind, which has `mark` near its start.
fn keep_unmarked_files(output: &Path, mark: &str) -> anyhow::Result<()> {
    if !output.is_file() {
        return Ok(());
    }
    let mut start = Vec::new();
    let read = File::open(output).and_then(|file| file.take(1024).read_to_end(&mut start));
    let is_ours = start.windows(mark.len()).any(|window| window == mark.as_bytes());
    if read.is_err() || (!start.is_empty() && !is_ours) {
        bail!("{}: exists and was not made by pcc; name another output, or remove it first", output.display());
    }
    Ok(())
}

/// Refuses to replace a surrogate, a part of an evaluation or a journal by a table or a picture.
fn keep_results(output: &Path) -> anyhow::Result<()> {
    if !output.is_file() {
        return Ok(());
    }
    let mut start = Vec::new();
    let read = File::open(output).and_then(|file| file.take(64).read_to_end(&mut start));
    let is_result = artifact::looks_like_a_surrogate(&start) || start.starts_with(MARK.as_bytes());
    if read.is_err() || is_result || start.starts_with(&model_journal::MAGIC) {
        bail!(
            "{}: is a surrogate, a part of an evaluation or a journal of model runs; name another output",
            output.display()
        );
    }
    Ok(())
}

fn read_study(path: &Path) -> anyhow::Result<Study> {
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(LARGEST_STUDY + 1).read_to_end(&mut bytes));
    read.with_context(|| format!("{} cannot be read", path.display()))?;
    if artifact::looks_like_a_surrogate(&bytes) {
        bail!("{}: is a surrogate; give the study, a .toml file", path.display());
    }
    if bytes.len() as u64 > LARGEST_STUDY {
        bail!("{}: is larger than {LARGEST_STUDY} bytes, which no study is", path.display());
    }
    let Ok(text) = String::from_utf8(bytes) else {
        bail!("{}: is not text; give a study, a .toml file", path.display());
    };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    Study::from_toml_in(&text, folder).with_context(|| path.display().to_string())
}

fn read_surrogate(path: &Path) -> anyhow::Result<Artifact> {
    artifact::read(path).or_else(|error| {
        let mut start = Vec::new();
        let read = File::open(path).and_then(|file| file.take(MARK.len() as u64).read_to_end(&mut start));
        if read.is_ok() && start == MARK.as_bytes() {
            bail!("{}: is a part of an evaluation; put all its parts together with pcc merge", path.display());
        }
        Err(error).with_context(|| path.display().to_string())
    })
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
