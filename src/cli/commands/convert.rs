//! `pcc convert`

use crate::cli::inputs::read_surrogate;
use crate::cli::overwrite::{Output, refuse_to_replace};
use crate::cli::{Context, Ending};
use anyhow::Context as _;
use clap::Args;
use pcc_evaluate::artifact::{Format, encode};
use pcc_evaluate::foundation::{count, save};
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc convert belt.pcc belt.json   readable
  pcc convert belt.json belt.pcc   and back, to the same bytes";

/// Convert a surrogate between binary (.pcc) and JSON (.json), without loss
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Surrogate file to read, binary or JSON
    pub input: PathBuf,

    /// Surrogate file to write: JSON if it ends in .json, else binary
    pub output: PathBuf,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let artifact = read_surrogate(&options.input)?;
    artifact.check_lossless().with_context(|| options.input.display().to_string())?;
    refuse_to_replace(&options.output, Output::Surrogate, &[&options.input])?;
    let bytes = encode(&artifact.surrogate, Format::of_path(&options.output))?;
    save(&options.output, &bytes)?;
    context.print(&Converted { file: options.output.display().to_string(), bytes: bytes.len() as u64 })?;
    Ok(Ending::Done)
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(in crate::cli) struct Converted {
    file: String,
    bytes: u64,
}

impl fmt::Display for Converted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "written to {} ({} bytes)", self.file, count(self.bytes))
    }
}
