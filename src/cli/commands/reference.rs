//! `pcc reference`

use super::super::arguments::Reference;
use super::super::points::{Evaluated, PointsFile};
use super::super::{Context, Ending};
use super::{PointsReport, interruptible, read_study};
use crate::reference::{ReferenceError, Runner, monte_carlo};
use crate::report::EvalReport;
use crate::study::Study;
use anyhow::Context as _;
use std::path::Path;
use std::time::Instant;

pub(in super::super) fn reference(context: &Context, options: &Reference) -> anyhow::Result<Ending> {
    let study = read_study(&options.study)?;
    let sampling = &options.sampling;
    if let (Some(points), Some(out)) = (&sampling.points, &sampling.out) {
        context.print(&at_points(&study, options.study.display().to_string(), points, out, sampling.extrapolate)?)?;
        return Ok(Ending::Done);
    }
    let start = Instant::now();
    let found =
        monte_carlo(&study, sampling.samples.unwrap_or(0), sampling.seed, &context.terminal).map_err(|error| {
            interruptible(error.clone(), error == ReferenceError::Interrupted, &options.study.display().to_string())
        })?;
    let elapsed = start.elapsed().as_secs_f64();
    context.print(&EvalReport::of_model(&study.name, &found.outputs, &found.summary, sampling.seed, elapsed))?;
    Ok(Ending::Done)
}

fn at_points(
    study: &Study,
    source: String,
    points: &Path,
    out: &Path,
    extrapolate: bool,
) -> anyhow::Result<PointsReport> {
    let mut runner = Runner::new(study)?;
    let file = PointsFile::open(points, &study.inputs, extrapolate)?;
    let (count, stable) = file.evaluate(out, |group| {
        let standardized: Vec<Vec<f64>> = group.iter().map(|point| study.inputs.standardized(point)).collect();
        let runs = runner.run(&standardized).with_context(|| source.clone())?;
        let results = runs.into_iter().map(|run| (run.eigenvalues, run.spectrum.max_re())).collect();
        Ok(Evaluated { modes: runner.modes().to_vec(), results })
    })?;
    Ok(PointsReport { points: count, stable_points: stable, file: out.display().to_string() })
}
