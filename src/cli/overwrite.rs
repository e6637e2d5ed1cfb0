//! Files that commands write: what may be replaced by what.

use anyhow::bail;
use pcc_compile::campaign::journal;
use pcc_evaluate::artifact::looks_like_a_surrogate;
use pcc_evaluate::foundation::check_writable;
use pcc_evaluate::shard_file::MARK;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Bytes of a file that tell what it is.
const START: u64 = 1024;

/// What an output is, which says which files it may take the place of.
#[derive(Debug, Clone, Copy)]
pub(super) enum Output {
    /// A surrogate, in the place of a surrogate.
    Surrogate,
    /// A file that has this mark near its start, in the place of its like.
    Marked(&'static str),
    /// A table or a picture, in the place of anything but a surrogate, a part of an evaluation, or a journal.
    Table,
}

/// What pages of a surrogate, and of the reproduced paper, have near their start.
pub(super) const SURROGATE_PAGE: &str = "<meta name=\"generator\" content=\"pcc report ";
pub(super) const REPRODUCTION_PAGE: &str = "<meta name=\"generator\" content=\"pcc reproduce ";

/// Refuses an output that would replace one of the command's own `inputs`, or a file of another kind: a study or data
/// named by mistake.
pub(super) fn refuse_to_replace(path: &Path, output: Output, inputs: &[&Path]) -> anyhow::Result<()> {
    keep_inputs(path, inputs)?;
    if !path.is_file() {
        return Ok(()); // nothing there, or nothing that may be opened: a pipe would block
    }
    let mut start = Vec::new();
    let is_read = File::open(path).and_then(|file| file.take(START).read_to_end(&mut start)).is_ok();
    let (is_empty, shown) = (is_read && start.is_empty(), path.display());
    match output {
        Output::Surrogate if !(is_empty || is_read && looks_like_a_surrogate(&start)) => {
            bail!("{shown}: exists and is not a surrogate; name another output, or remove it first")
        }
        Output::Marked(mark)
            if !(is_empty || is_read && start.windows(mark.len()).any(|window| window == mark.as_bytes())) =>
        {
            bail!("{shown}: exists and was not made by pcc; name another output, or remove it first")
        }
        Output::Table if !is_read || is_result(&start) => {
            bail!("{shown}: is a surrogate, a part of an evaluation or a journal of model runs; name another output")
        }
        _ => Ok(()),
    }
}

/// The same, and asks whether the file can be written.
pub(super) fn claim(path: &Path, output: Output, inputs: &[&Path]) -> anyhow::Result<()> {
    refuse_to_replace(path, output, inputs)?;
    Ok(check_writable(path)?)
}

/// Refuses an output that is one of the command's own inputs, which the result would destroy.
pub(super) fn keep_inputs(path: &Path, inputs: &[&Path]) -> anyhow::Result<()> {
    let Ok(file) = path.canonicalize() else { return Ok(()) };
    for input in inputs {
        if input.canonicalize().is_ok_and(|input| input == file) {
            bail!("{}: would replace the file it is made from; name another output", path.display());
        }
    }
    Ok(())
}

fn is_result(start: &[u8]) -> bool {
    looks_like_a_surrogate(start) || start.starts_with(MARK.as_bytes()) || start.starts_with(&journal::MAGIC)
}
