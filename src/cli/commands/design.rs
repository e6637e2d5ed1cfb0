//! `pcc design`: the model runs that a build is waiting for.

use crate::cli::inputs::read_study_with;
use crate::cli::shared_options::DataArguments;
use crate::cli::overwrite::{Output, claim};
use crate::cli::{Context, Ending, about};
use crate::report::DesignReport;
use anyhow::Context as _;
use clap::Args;
use pcc_compile::ask_and_tell::{ask, check};
use pcc_compile::campaign::journal::{Contents, Journal};
use pcc_compile::campaign::{journal_here, notes_on};
use pcc_compile::mechanics::model::command::results_table::write_points;
use pcc_evaluate::foundation::save_with;
use std::io;
use std::path::PathBuf;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc design rig.toml --emit rows.csv                         the points that are needed next
  pcc design rig.toml --emit rows.csv --journal old.journal   with answers from elsewhere
  pcc design rig.toml --emit rows.csv --data runs.csv         beside runs that have been made already";

/// Write the model runs that a build is waiting for as a table
///
/// For models that something else than pcc runs: a scheduler, a cluster, a laboratory. Steps the build of STUDY as far
/// as the recorded answers carry it, and writes the points whose answers it needs next. Run them, hand the answers over
/// with pcc ingest, and repeat until there are no more: pcc build STUDY --resume then writes the surrogate.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Study file
    pub study: PathBuf,

    /// Table of the points to run: run, one column per input, constants
    #[arg(long, value_name = "ROWS.csv")]
    pub emit: PathBuf,

    /// Journal of the answers [default: <name of the study>.journal in the current folder]
    #[arg(long, value_name = "FILE")]
    pub journal: Option<PathBuf>,

    #[command(flatten)]
    pub data: DataArguments,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let study = read_study_with(&options.study, &options.data)?;
    let source = options.study.display().to_string();
    let journal = options.journal.clone().unwrap_or_else(|| journal_here(&study));
    check(&study).with_context(|| source.clone())?;
    let inputs: Vec<String> = study.inputs.names().map(str::to_owned).collect();
    let constants = study.model.answers().map_or(&[][..], |answers| &answers.constants);
    let mut header = Vec::new();
    write_points::<&[f64]>(&mut header, [], &inputs, constants, &[])?;
    let header = String::from_utf8_lossy(&header);
    claim(&options.emit, Output::TableWithHeader(header.trim_end()), &[&options.study, &journal])?;
    let contents = if journal.exists() { Journal::read(&journal)? } else { Contents::default() };
    notes_on(&journal, &contents).iter().for_each(|note| context.note(note));
    let step = ask(&study, &contents, &context.terminal).map_err(|error| about(&source, error))?;
    let (runs, open): (Vec<u64>, Vec<&[f64]>) = step.open().unzip();
    save_with(&options.emit, |writer| write_points(writer, runs, &inputs, constants, &open).map_err(io::Error::other))?;
    context.print(&DesignReport {
        study: study.name.clone(),
        source,
        file: options.emit.display().to_string(),
        points: open.len() as u64,
        answered: (step.asked.len() - open.len()) as u64,
        complete: step.is_complete,
    })?;
    Ok(Ending::Done)
}
