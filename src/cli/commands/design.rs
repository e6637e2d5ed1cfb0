//! `pcc design`: the model runs that a build is waiting for.

use super::super::recording::{journal_here, remark};
use super::super::run_arguments::Design;
use super::super::{Context, Ending};
use super::{interruptible, keep_inputs, keep_results, read_study};
use crate::report::DesignReport;
use anyhow::bail;
use pcc_compile::campaign::journal::{Contents, Journal};
use pcc_compile::campaign::{Campaign, DesignPoint, Ledger, RunError};
use pcc_compile::compilation::{BuildError, build};
use pcc_compile::mechanics::model::command::results_table::write_points;
use pcc_compile::study::Study;
use pcc_evaluate::foundation::{check_writable, save_with};
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
    let Step { asked, stage } = step(context, &study, &contents, &source)?;
    let is_complete = match stage {
        Stage::Complete => true,
        Stage::Waiting => false,
        Stage::Failed(error) => return Err(error),
    };
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

/// How far a build has come.
pub(super) struct Step {
    /// Every point it asked for.
    pub asked: Vec<DesignPoint>,
    /// What stopped it.
    pub stage: Stage,
}

/// What stops a build that does not run its model.
pub(super) enum Stage {
    /// It is done.
    Complete,
    /// It waits for answers.
    Waiting,
    /// The answers it has cannot be right, or are not enough.
    Failed(anyhow::Error),
}

/// Steps the build as far as it goes on what is known.
pub(super) fn step(context: &Context, study: &Study, contents: &Contents, source: &str) -> anyhow::Result<Step> {
    let ledger = Ledger::blank(study).knowing(contents).asking();
    match build(Campaign { study, ledger: Some(&ledger) }, &context.terminal) {
        Ok(_) => Ok(Step { asked: ledger.asked(), stage: Stage::Complete }),
        Err(BuildError::Run(RunError::Unanswered { .. })) => Ok(Step { asked: ledger.asked(), stage: Stage::Waiting }),
        Err(error) if error.is_interruption() => Err(interruptible(error, true, source)),
        Err(error) => Ok(Step { asked: ledger.asked(), stage: Stage::Failed(interruptible(error, false, source)) }),
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
