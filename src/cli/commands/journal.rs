//! `pcc journal`: what is recorded of model runs.

use crate::cli::inputs::read_study;
use crate::cli::overwrite::{Output, RECORD_COLUMNS, refuse_to_replace};
use crate::cli::{Context, Ending};
use crate::report::{JournalModel, JournalReport};
use anyhow::bail;
use clap::Args;
use pcc_compile::campaign::journal::{Contents, Journal, Record, RunOutcome};
use pcc_compile::campaign::notes_on;
use pcc_evaluate::foundation::{hexadecimal, save_with};
use std::io::{self, Write};
use std::path::PathBuf;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc journal belt.journal                                    how many runs of which models
  pcc journal belt.journal --study belt.toml --csv runs.csv   every run of one model, as a table";

/// Show the model runs that are recorded in a journal
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Journal file
    pub journal: PathBuf,

    /// Only the runs of this study's model, columns named like its inputs
    #[arg(long, value_name = "STUDY")]
    pub study: Option<PathBuf>,

    /// Write every run with its inputs, eigenvalues and errors to a table
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let study = options.study.as_ref().map(|path| read_study(path)).transpose()?;
    let mut contents = Journal::read(&options.journal)?;
    let (torn_bytes, damaged_bytes) = (contents.torn_bytes, contents.damaged_bytes);
    // Reading cuts nothing.
    let damage = Contents { torn_bytes: 0, damaged_bytes, records: Vec::new() };
    notes_on(&options.journal, &damage).iter().for_each(|note| context.note(note));
    if let Some(study) = &study {
        let model = study.model_hash();
        contents.records.retain(|record| record.model == model);
    }
    if let Some(csv) = &options.csv {
        refuse_to_replace(csv, Output::Table(RECORD_COLUMNS), &[&options.journal])?;
        let names: Option<Vec<&str>> = study.as_ref().map(|study| study.inputs.names().collect());
        let inputs = contents.records.iter().map(|record| record.point.len()).max().unwrap_or(0);
        if names.is_none() && contents.records.iter().any(|record| record.point.len() != inputs) {
            bail!(
                "{}: has runs of models with different numbers of inputs, which are no table; choose a model with --study",
                options.journal.display()
            );
        }
        let header = names.map_or_else(
            || (1..=inputs).map(|j| format!("x_{j}")).collect(),
            |names| names.into_iter().map(str::to_owned).collect::<Vec<_>>(),
        );
        save_with(csv, |writer| export(writer, &header, &contents.records))?;
    }
    context.print(&JournalReport {
        journal: options.journal.display().to_string(),
        models: models(&contents.records),
        torn_bytes,
        damaged_bytes,
        csv: options.csv.as_ref().map(|csv| csv.display().to_string()),
    })?;
    Ok(Ending::Done)
}

/// Runs by model, in the order in which models first appear.
fn models(records: &[Record]) -> Vec<JournalModel> {
    let mut models: Vec<JournalModel> = Vec::new();
    for record in records {
        let hash = hexadecimal(&record.model);
        let at = models.iter().position(|model| model.hash == hash).unwrap_or_else(|| {
            models.push(JournalModel { hash, inputs: record.point.len() as u64, ..JournalModel::default() });
            models.len() - 1
        });
        let model = &mut models[at];
        match record.outcome {
            RunOutcome::Answered(_) => model.answered += 1,
            RunOutcome::Failed { .. } => model.failed += 1,
        }
        model.seconds += record.seconds;
    }
    models
}

/// One row per record: its number, the model, how it ended, its inputs and its eigenvalues, numbers to the last bit.
fn export(writer: &mut dyn Write, inputs: &[String], records: &[Record]) -> io::Result<()> {
    let count = |record: &Record| match &record.outcome {
        RunOutcome::Answered(computation) => computation.eigenvalues.len(),
        RunOutcome::Failed { .. } => 0,
    };
    let eigenvalues = records.iter().map(count).max().unwrap_or(0);
    let mut table = csv::Writer::from_writer(writer);
    let mut header: Vec<String> = ["record", "model", "status", "attempts", "seconds"].map(str::to_owned).to_vec();
    header.extend(inputs.iter().cloned());
    header.extend((1..=eigenvalues).flat_map(|k| [format!("re_{k}"), format!("im_{k}")]));
    header.push("error".to_owned());
    table.write_record(&header)?;
    for (number, record) in (1..).zip(records) {
        let (status, attempts, lambdas, error) = match &record.outcome {
            RunOutcome::Answered(computation) => ("answered", 1, &computation.eigenvalues[..], ""),
            RunOutcome::Failed { attempts, cause, .. } => ("failed", *attempts, &[][..], cause.as_str()),
        };
        let (model, seconds) = (hexadecimal(&record.model), record.seconds);
        let mut row: Vec<String> =
            vec![number.to_string(), model, status.to_owned(), attempts.to_string(), seconds.to_string()];
        row.extend(record.point.iter().map(|value| format!("{value:?}")));
        row.extend(lambdas.iter().flat_map(|lambda| [format!("{:?}", lambda.re), format!("{:?}", lambda.im)]));
        row.extend(std::iter::repeat_n(String::new(), 2 * (eigenvalues - lambdas.len())));
        row.push(error.to_owned());
        table.write_record(&row)?;
    }
    table.flush()
}
