//! Files that commands read.

use super::shared_options::DataArguments;
use anyhow::{Context as _, bail};
use pcc_compile::study::Study;
use pcc_evaluate::artifact::{self, Artifact};
use pcc_evaluate::shard_file::MARK;
use std::fs::File;
use std::io::Read;
use std::path::Path;

pub(super) fn read_study(path: &Path) -> anyhow::Result<Study> {
    Ok(Study::read(path)?)
}

/// The same with runs that the command line gives.
pub(super) fn read_study_with(path: &Path, data: &DataArguments) -> anyhow::Result<Study> {
    Ok(Study::read_with(path, &data.to_options())?)
}

pub(super) fn read_surrogate(path: &Path) -> anyhow::Result<Artifact> {
    artifact::read(path).or_else(|error| {
        let mut start = Vec::new();
        let read = File::open(path).and_then(|file| file.take(MARK.len() as u64).read_to_end(&mut start));
        if read.is_ok() && start == MARK.as_bytes() {
            bail!("{}: is a part of an evaluation; put all its parts together with pcc merge", path.display());
        }
        Err(error).with_context(|| path.display().to_string())
    })
}
