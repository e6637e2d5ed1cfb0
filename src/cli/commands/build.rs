//! `pcc build`

use crate::cli::inputs::read_study_with;
use crate::cli::overwrite::{Output, refuse_to_replace};
use crate::cli::shared_options::{DataArguments, RecordingOptions, seed};
use crate::cli::{Context, Ending};
use crate::report::BuildReport;
use clap::{Args, ValueEnum};
use pcc_evaluate::artifact::Format;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc build belt.toml                          writes belt.pcc
  pcc build belt.toml --resume                 goes on after whatever has stopped a build
  pcc build belt.toml -o other.json --seed 2   another design, as JSON
  pcc build belt.toml --data runs.csv --holdout 0.2
                                               of runs that have been made, a fifth of which validate it";

/// Build a surrogate from a study
///
/// Runs the model on a nested Latin hypercube design that grows until every component is fitted and the stability
/// proportion is accurate enough, as far as the study asks for it, and writes index sets and coefficients. Full
/// expansions (methods gpc and me-gpc) run it on a grid, or on a design whose size their degree fixes. Runs that have
/// been made already come first (--data); a model of kind "table" has no others. The same study gives the same bytes on
/// any number of threads.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Study file
    pub study: PathBuf,

    /// Surrogate file [default: <name of the study>.pcc in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Form of the file [default: by the ending of FILE, .json or other]
    #[arg(long, value_enum)]
    pub format: Option<FileFormat>,

    /// Seed of the design instead of the study's
    #[arg(long, value_name = "S", value_parser = seed())]
    pub seed: Option<u64>,

    /// When Ctrl-C stops the build, write the best level that it has instead of nothing
    #[arg(long)]
    pub best: bool,

    /// Build over a surrogate with certificates; they stay only if the build gives the same surrogate again
    #[arg(long)]
    pub replace: bool,

    /// Print the study with every default filled in, and build nothing
    #[arg(long)]
    pub show_study: bool,

    #[command(flatten)]
    pub data: DataArguments,

    #[command(flatten)]
    pub recording: RecordingOptions,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum FileFormat {
    /// Compact and checksummed
    Binary,
    /// Readable
    Json,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let mut study = read_study_with(&options.study, &options.data)?;
    study.seed = options.seed.unwrap_or(study.seed);
    if options.show_study {
        context.print(&ShownStudy { study: study.to_toml() })?;
        return Ok(Ending::Done);
    }
    let asked = options.format.map(|format| match format {
        FileFormat::Binary => Format::Binary,
        FileFormat::Json => Format::Json,
    });
    let path = options
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}.{}", study.name, asked.unwrap_or(Format::Binary).extension())));
    let format = asked.unwrap_or_else(|| Format::of_path(&path));
    refuse_to_replace(&path, Output::Surrogate, &[])?;
    context.terminal.take_what_there_is(options.best);
    let source = options.study.display().to_string();
    let built = context.build_to_file(&study, &source, &path, format, &options.recording.to_recording(), options.replace)?;
    context.print(&BuildReport::of_file(&study, &built, path.display().to_string()))?;
    context.hint_at("eval", &path, "to sample it");
    Ok(Ending::Done)
}

/// A study with its defaults.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(in crate::cli) struct ShownStudy {
    study: String,
}

impl fmt::Display for ShownStudy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.study)
    }
}
