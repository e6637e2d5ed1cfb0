//! Files that commands write: what may be replaced by what.

use anyhow::bail;
use pcc_evaluate::artifact::{self, looks_like_a_surrogate};
use pcc_evaluate::foundation::{check_writable, plural};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Bytes of a file that tell what it is: the header of a table with some thousand columns.
const START: u64 = 1 << 16;

/// What an output is, which says which files it may take the place of.
#[derive(Debug, Clone, Copy)]
pub(super) enum Output<'a> {
    /// A surrogate, in the place of a surrogate.
    Surrogate,
    /// A file that has this mark near its start, in the place of its like.
    Marked(&'a str),
    /// A table whose header has these neighbouring columns, in the place of its like.
    Table(&'a str),
    /// A table of results at points, in the place of its like.
    Results,
    /// A table with this header, in the place of its like: with more columns it holds somebody's work.
    TableWithHeader(&'a str),
}

/// What pages of a surrogate, and of the reproduced paper, have near their start.
pub(super) const SURROGATE_PAGE: &str = "<meta name=\"generator\" content=\"pcc report ";
pub(super) const REPRODUCTION_PAGE: &str = "<meta name=\"generator\" content=\"pcc reproduce ";

/// What pictures have near their start.
pub(super) const PICTURE: &str = "sheet-title";

/// Columns of tables of sweeps and of recorded runs.
pub(super) const SWEEP_COLUMNS: &str = "stable_samples,stable_proportion,lower,upper";
pub(super) const RECORD_COLUMNS: &str = "record,model,status,attempts,seconds";

/// Neighbouring columns of tables of points, one of each: without intervals, and with.
const RESULT_COLUMNS: [&str; 2] = ["max_re,stable", "max_re_upper,stable"];

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
        _ if is_empty => Ok(()),
        Output::Surrogate if !(is_read && looks_like_a_surrogate(&start)) => {
            bail!("{shown}: exists and is not a surrogate; name another output, or remove it first")
        }
        Output::Marked(mark) if !(is_read && holds(&start, mark)) => {
            bail!("{shown}: exists and was not made by pcc; name another output, or remove it first")
        }
        Output::Table(columns) if !(is_read && holds(header(&start), columns)) => {
            bail!("{shown}: exists and is no such table ({columns}, …); name another output, or remove it first")
        }
        Output::Results if !(is_read && RESULT_COLUMNS.iter().any(|columns| holds(header(&start), columns))) => {
            let columns = RESULT_COLUMNS[0];
            bail!("{shown}: exists and is no such table ({columns}, …); name another output, or remove it first")
        }
        Output::TableWithHeader(expected) if !(is_read && header(&start) == expected.as_bytes()) => {
            bail!("{shown}: exists and is no table of {expected}; name another output, or remove it first")
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
fn keep_inputs(path: &Path, inputs: &[&Path]) -> anyhow::Result<()> {
    let Ok(file) = path.canonicalize() else { return Ok(()) };
    for input in inputs {
        if input.canonicalize().is_ok_and(|input| input == file) {
            bail!("{}: would replace the file it is made from; name another output", path.display());
        }
    }
    Ok(())
}

/// The number of certificates of the surrogate that a build is going to replace. Refuses to if there are any, unless
/// the user has said that they may be lost: whether they hold for what is built is known after the build only, and each
/// has cost model runs.
pub(super) fn certificates_to_keep(path: &Path, may_be_lost: bool) -> anyhow::Result<usize> {
    let known = path.is_file().then(|| artifact::read(path).ok()).flatten();
    match known.map_or(0, |artifact| artifact.surrogate.certificates.len()) {
        count if count == 0 || may_be_lost => Ok(count),
        count => bail!(
            "{}: has {}, which will be lost if the build gives another surrogate; name another output, or pass --replace",
            path.display(),
            plural(count, "certificate")
        ),
    }
}

fn holds(bytes: &[u8], text: &str) -> bool {
    bytes.windows(text.len()).any(|window| window == text.as_bytes())
}

/// The first line of a table.
fn header(start: &[u8]) -> &[u8] {
    start.split(|byte| *byte == b'\n').next().unwrap_or_default().trim_ascii_end()
}
