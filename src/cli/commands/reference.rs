//! `pcc reference`

use super::super::arguments::Reference;
use super::super::points::{Evaluated, PointsFile};
use super::super::recording::open_here;
use super::super::{Context, Ending};
use super::{PointsReport, interruptible, keep_inputs, read_study};
use crate::report::EvalReport;
use pcc_compile::campaign::{Campaign, RunError, Runner};
use pcc_compile::reference::monte_carlo;
use std::path::Path;
use std::time::Instant;

pub(in super::super) fn reference(context: &Context, options: &Reference) -> anyhow::Result<Ending> {
    let study = read_study(&options.study)?;
    let sampling = &options.sampling;
    if let (Some(points), Some(out)) = (&sampling.points, &sampling.out) {
        keep_inputs(out, &[points, &options.study])?;
        let books = open_here(context, &study, &options.recording)?;
        let campaign = Campaign { study: &study, ledger: Some(&books.ledger) };
        let source = options.study.display().to_string();
        context.print(&at_points(context, campaign, source, points, out, sampling.extrapolate)?)?;
        return Ok(Ending::Done);
    }
    let books = open_here(context, &study, &options.recording)?;
    let campaign = Campaign { study: &study, ledger: Some(&books.ledger) };
    let start = Instant::now();
    let found = monte_carlo(campaign, sampling.samples.unwrap_or(0), sampling.seed, &context.terminal);
    let found = found.map_err(|error| {
        books.say_recorded(context);
        interruptible(error.clone(), error.is_interruption(), &options.study.display().to_string())
    })?;
    let elapsed = start.elapsed().as_secs_f64();
    context.print(&EvalReport::of_model(&study.name, &found.outputs, &found.summary, sampling.seed, elapsed))?;
    Ok(Ending::Done)
}

fn at_points(
    context: &Context,
    campaign: Campaign<'_>,
    source: String,
    points: &Path,
    out: &Path,
    extrapolate: bool,
) -> anyhow::Result<PointsReport> {
    let mut runner = Runner::new(campaign)?;
    let file = PointsFile::open(points, &campaign.study.inputs, extrapolate)?;
    let (count, stable) = file.evaluate(out, &context.terminal, |group| {
        let runs = runner
            .run(group, &context.terminal)
            .map_err(|error| interruptible(error.clone(), matches!(error, RunError::Interrupted(_)), &source))?;
        let results = runs.into_iter().map(|run| (run.eigenvalues, run.spectrum.max_re())).collect();
        Ok(Evaluated { modes: runner.modes().to_vec(), results })
    })?;
    Ok(PointsReport { points: count, stable_points: stable, file: out.display().to_string() })
}
