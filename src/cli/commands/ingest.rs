//! `pcc ingest`: answers that others computed.

use crate::cli::inputs::read_study_with;
use crate::cli::shared_options::DataArguments;
use crate::cli::{Context, Ending, about};
use crate::report::IngestReport;
use anyhow::{Context as _, anyhow, bail};
use clap::Args;
use pcc_compile::ask_and_tell::{AskError, TellError, check, tell};
use pcc_compile::campaign::journal::Journal;
use pcc_compile::campaign::{journal_here, notes_on};
use pcc_compile::mechanics::model::command::results_table::read_results;
use std::fs::File;
use std::path::PathBuf;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc ingest rig.toml answers.csv               all rows, or none if one is wrong
  pcc ingest rig.toml corrected.csv --replace   answers that contradict earlier ones";

/// Take answers to the points of a design from a table
///
/// RESULTS.csv has the inputs of the table that pcc design wrote, and its column run if they have lost digits, and the
/// eigenvalues as re_1, im_1, re_2, im_2 and so on in 1/s; a text in a column error marks a run that failed. Rows may
/// come in any order, in part, and more than once; a row that contradicts an earlier answer is refused, and then none
/// is taken.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
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

    #[command(flatten)]
    pub data: DataArguments,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let study = read_study_with(&options.study, &options.data)?;
    let source = options.study.display().to_string();
    check(&study).with_context(|| source.clone())?;
    let path = options.journal.clone().unwrap_or_else(|| journal_here(&study));
    let Some(answers) = study.model.answers() else {
        bail!(
            "{source}: pcc runs this model itself, so it takes no results; they belong to models of kind \"command\" and \"table\""
        );
    };
    let inputs: Vec<String> = study.inputs.names().map(str::to_owned).collect();
    let shown = options.results.display();
    if options.results.exists() && !options.results.is_file() {
        bail!("{shown}: is no file; write the table to one first");
    }
    let file = File::open(&options.results).with_context(|| format!("{shown} cannot be read"))?;
    let rows = read_results(file, &inputs, answers.eigenvalues).with_context(|| shown.to_string())?;

    // Held from the first look to the last record, so that no other process records in between.
    let (journal, contents) = Journal::open(&path)?;
    notes_on(&path, &contents).iter().for_each(|note| context.note(note));
    let told = tell(&study, &journal, contents, &rows, options.replace, &context.terminal);
    let told = told.map_err(|error| match error {
        TellError::Ask(AskError::Build(error)) => about(&source, error),
        TellError::CannotGoOn(cause) => {
            anyhow!("{shown}: with these answers the build cannot go on, so none was taken: {source}: {cause}")
        }
        TellError::Journal(error) => error.into(),
        other => anyhow::Error::from(other).context(shown.to_string()),
    })?;
    context.print(&IngestReport {
        study: study.name.clone(),
        source,
        journal: path.display().to_string(),
        rows: rows.len() as u64,
        answered: told.answered as u64,
        failed: told.failed as u64,
        repeated: told.repeated as u64,
        missing: told.missing as u64,
        complete: told.is_complete,
    })?;
    Ok(Ending::Done)
}
