//! `pcc design`: the model runs that a build is waiting for.

use super::super::recording::{journal_here, remark};
use super::super::run_arguments::Design;
use super::super::{Context, Ending};
use super::{interruptible, keep_inputs, keep_results, read_study};
use crate::artifact::{check_writable, save_with};
use crate::build::{BuildError, build};
use crate::design::{Asked, Campaign, Ledger, RunError};
use crate::journal::{Contents, Journal};
use crate::model::program::results_table::write_points;
use crate::report::DesignReport;
use crate::study::Study;
use anyhow::bail;
use std::io;

pub(in super::super) fn design(context: &Context, options: &Design) -> anyhow::Result<Ending> {
    let study = read_study(&options.study)?;
    let source = options.study.display().to_string();
    let journal = options.journal.clone().unwrap_or_else(|| journal_here(&study));
    refuse_derivatives(&study, &source)?;
    keep_inputs(&options.emit, &[&options.study, &journal])?;
    keep_results(&options.emit)?;
    check_writable(&options.emit)?;
    let contents = if journal.exists() { Journal::read(&journal)? } else { Contents::default() };
    remark(context, &journal, &contents);
    let (asked, is_complete) = step(context, &study, &contents, &source)?;
    let (runs, open): (Vec<u64>, Vec<&Vec<f64>>) =
        (1..).zip(&asked).filter(|(_, asked)| !asked.is_known).map(|(run, asked)| (run, &asked.point)).unzip();
    let inputs: Vec<String> = study.inputs.names().map(str::to_owned).collect();
    let constants = study.model.answers().map_or(&[][..], |answers| &answers.constants);
    save_with(&options.emit, |writer| write_points(writer, runs, &inputs, constants, &open).map_err(io::Error::other))?;
    context.print(&DesignReport {
        study: study.name.clone(),
        source,
        file: options.emit.display().to_string(),
        points: open.len() as u64,
        answered: (asked.len() - open.len()) as u64,
        complete: is_complete,
    })?;
    Ok(Ending::Done)
}

/// Steps the build as far as it goes on what is known: every point it asked for, and whether it is complete.
pub(super) fn step(
    context: &Context,
    study: &Study,
    contents: &Contents,
    source: &str,
) -> anyhow::Result<(Vec<Asked>, bool)> {
    let ledger = Ledger::blank(study).knowing(contents).asking();
    match build(Campaign { study, ledger: Some(&ledger) }, &context.terminal) {
        Ok(_) => Ok((ledger.asked(), true)),
        Err(BuildError::Run(RunError::Unanswered { .. })) => Ok((ledger.asked(), false)),
        Err(error) => Err(interruptible(error.clone(), error.is_interruption(), source)),
    }
}

/// Tables of results hold eigenvalues alone.
pub(super) fn refuse_derivatives(study: &Study, source: &str) -> anyhow::Result<()> {
    if study.uses_derivatives() {
        bail!(
            "{source}: fits derivatives, which tables of results do not hold; set fit.derivatives = false, or let pcc run the \
             model"
        );
    }
    Ok(())
}
