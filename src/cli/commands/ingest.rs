//! `pcc ingest`: answers that others computed.

use super::super::recording::{journal_here, plural, remark};
use super::super::run_arguments::Ingest;
use super::super::{Context, Ending};
use super::design::{Stage, refuse_derivatives, step};
use super::read_study;
use crate::report::IngestReport;
use anyhow::{Context as _, anyhow, bail};
use pcc_compile::campaign::journal::{Journal, RunOutcome};
use pcc_compile::campaign::{Ledger, RowProblem, match_answers};
use pcc_compile::mechanics::model::command::results_table::read_results;
use std::fs::File;
use std::path::Path;

/// Rows that are named when they cannot be taken.
const SHOWN_PROBLEMS: usize = 10;

pub(in super::super) fn ingest(context: &Context, options: &Ingest) -> anyhow::Result<Ending> {
    let study = read_study(&options.study)?;
    let source = options.study.display().to_string();
    refuse_derivatives(&study, &source)?;
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
    let (journal, mut contents) = Journal::open(&path)?;
    remark(context, &path, &contents);
    let known = Ledger::blank(&study).knowing(&contents);
    let before = step(context, &study, &contents, &source)?;
    let outcome = |point: &[f64]| known.find(point).cloned();
    let found = match_answers(&study, &before.asked, outcome, &rows, options.replace)
        .map_err(|problems| refusal(&options.results, &problems))?;
    // What would end the build must not get into the journal, where it could not be taken back.
    contents.records.extend(found.records.iter().cloned());
    let after = match &before.stage {
        Stage::Complete if found.records.is_empty() => before,
        _ => step(context, &study, &contents, &source)?,
    };
    if let Stage::Failed(error) = after.stage {
        return Err(error.context(format!("{shown}: with these answers the build cannot go on, so none was taken")));
    }
    journal.append(&found.records.iter().collect::<Vec<_>>())?;
    let failed = found.records.iter().filter(|record| matches!(record.outcome, RunOutcome::Failed { .. })).count();
    let answered = found.records.len() - failed;
    let missing = after.asked.iter().filter(|asked| !asked.is_known).count() as u64;
    context.print(&IngestReport {
        study: study.name.clone(),
        source,
        journal: path.display().to_string(),
        rows: rows.len() as u64,
        answered: answered as u64,
        failed: failed as u64,
        repeated: found.repeated as u64,
        missing,
        complete: matches!(after.stage, Stage::Complete),
    })?;
    Ok(Ending::Done)
}

fn refusal(path: &Path, problems: &[RowProblem]) -> anyhow::Error {
    let lines: Vec<String> = problems.iter().take(SHOWN_PROBLEMS).map(|problem| format!("  {problem}")).collect();
    let more = match problems.len().saturating_sub(SHOWN_PROBLEMS) {
        0 => String::new(),
        more => format!("\n  and {}", plural(more, "other row")),
    };
    anyhow!(
        "{}: {} cannot be taken, so none was:\n{}{more}",
        path.display(),
        plural(problems.len(), "row"),
        lines.join("\n")
    )
}
