//! Answers of sessions on the terminal and in files of pictures: what `eval` and `merge` have in common.

use super::overwrite::{Output, PICTURE, SWEEP_COLUMNS, claim};
use super::shared_options::Pictures;
use super::{Context, Ending};
use crate::report::{EvalReport, SweepReport, sweep_chart};
use anyhow::bail;
use pcc_evaluate::evaluation::Question;
use pcc_evaluate::foundation::{Interrupted, save};
use pcc_evaluate::session::Evaluation;
use std::path::Path;

/// Prints an answer, and writes its pictures if it is complete.
pub(super) fn present(context: &Context, found: &Evaluation<'_>, pictures: &Pictures) -> anyhow::Result<Ending> {
    if found.question.sweeps.is_empty() {
        context.print(&EvalReport::of_surrogate(found).ok_or(Interrupted)?)?;
    } else {
        let mut report = SweepReport::new(found);
        if report.complete {
            report.files = save_pictures(&report, pictures)?;
        }
        context.print(&report)?;
    }
    Ok(if found.is_complete { Ending::Done } else { Ending::Interrupted })
}

/// Refuses pictures that nothing would be drawn in, and files that must not be replaced. `hint` says how to get a
/// sweep.
pub(super) fn check_pictures(
    pictures: &Pictures,
    question: &Question,
    inputs: &[&Path],
    hint: &str,
) -> anyhow::Result<()> {
    let outputs = [
        ("--table", &pictures.table, Output::Table(SWEEP_COLUMNS)),
        ("--chart", &pictures.chart, Output::Marked(PICTURE)),
    ];
    for (option, file, output) in outputs {
        let Some(file) = file else { continue };
        if question.sweeps.is_empty() {
            bail!("{option}: there is no sweep to write; {hint}");
        }
        claim(file, output, inputs)?;
    }
    let Some(chart) = &pictures.chart else { return Ok(()) };
    if question.sweeps.len() > 2 {
        bail!("--chart: {} sweeps cannot be drawn; use one or two, or --table", question.sweeps.len());
    }
    if chart.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("svg")) {
        bail!(
            "--chart {0}: charts are drawn as SVG; name it {1}",
            chart.display(),
            chart.with_extension("svg").display()
        );
    }
    Ok(())
}

/// The files that were written.
fn save_pictures(report: &SweepReport, pictures: &Pictures) -> anyhow::Result<Vec<String>> {
    let mut files = Vec::new();
    if let Some(file) = &pictures.table {
        save(file, &report.to_csv()?)?;
        files.push(file.display().to_string());
    }
    if let Some(file) = &pictures.chart {
        save(file, sweep_chart(report).as_bytes())?;
        files.push(file.display().to_string());
    }
    Ok(files)
}
