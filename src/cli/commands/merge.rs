//! `pcc merge`

use crate::cli::answers::{check_pictures, present};
use crate::cli::overwrite::{Output, claim};
use crate::cli::shared_options::Pictures;
use crate::cli::{Context, Ending, about};
use crate::report::MergeReport;
use anyhow::Context as _;
use clap::Args;
use pcc_evaluate::foundation::save;
use pcc_evaluate::session::{Evaluation, SessionError};
use pcc_evaluate::shard_file::{MARK, Part, merge as merge_parts};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc merge *.part                            what one evaluation would have printed
  pcc merge 0.part 1.part --part first.part   two neighbouring parts as one";

/// Put the parts of an evaluation together
///
/// Takes the files that eval has written with --shard and --part, in any order, and prints what one evaluation of all
/// samples would have printed. Parts of different evaluations, missing and repeated shards are refused.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Files that eval --part has written
    #[arg(required = true)]
    pub parts: Vec<PathBuf>,

    /// Write the parts as one part to FILE; then the first and the last shards may be missing
    #[arg(long, value_name = "FILE")]
    pub part: Option<PathBuf>,

    #[command(flatten)]
    pub pictures: Pictures,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let start = Instant::now();
    let files: Vec<&Path> = options.parts.iter().map(AsRef::as_ref).collect();
    let mut parts = Vec::with_capacity(files.len());
    for file in &files {
        let name = file.display().to_string();
        let part = Part::read(file).with_context(|| name.clone())?;
        parts.push((name, part));
    }
    let whole = merge_parts(parts)?;
    if let Some(file) = &options.part {
        claim(file, Output::Marked(MARK), &files)?;
    }
    check_pictures(&options.pictures, &whole.question, &files, "these parts are of plain samples")?;
    let wants_all = options.part.is_none() || options.pictures.table.is_some() || options.pictures.chart.is_some();
    if wants_all {
        whole.check_complete()?;
    }
    if let Some(file) = &options.part {
        save(file, &whole.to_bytes()?)?;
        if !whole.is_complete() {
            let survey = whole.survey()?;
            context.print(&MergeReport {
                file: file.display().to_string(),
                parts: files.len(),
                samples: survey.division().samples_in(&whole.findings.chunks()),
                of: survey.division().samples(),
                stable_samples: whole.findings.stable(),
            })?;
            return Ok(Ending::Done);
        }
        context.say(&format!("written to {}", file.display()));
    }
    let before = start.elapsed().as_secs_f64();
    let found = Evaluation::of_parts(&whole, files.len(), &context.terminal);
    let mut found = found.map_err(|error| match error {
        SessionError::Eval(error) => about(&whole.surrogate.provenance.study_name, error),
        other => other.into(),
    })?;
    found.elapsed_seconds += before;
    present(context, &found, &options.pictures)
}
