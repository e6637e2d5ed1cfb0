//! `pcc eval`

use super::super::arguments::Eval;
use super::super::points::{Evaluated, PointsFile};
use super::super::{Context, Ending};
use super::{PointsReport, interruptible, keep_inputs, read_surrogate};
use crate::eval::{Plan, evaluate_points, monte_carlo};
use crate::report::EvalReport;
use crate::surrogate::Surrogate;
use std::path::Path;
use std::time::Instant;

pub(in super::super) fn eval(context: &Context, options: &Eval) -> anyhow::Result<Ending> {
    let surrogate = read_surrogate(&options.surrogate)?.surrogate;
    let sampling = &options.sampling;
    if let (Some(points), Some(out)) = (&sampling.points, &sampling.out) {
        keep_inputs(out, &[points, &options.surrogate])?;
        context.print(&at_points(context, &surrogate, points, out, sampling.extrapolate)?)?;
    } else {
        context.print(&sample(context, &surrogate, sampling.samples.unwrap_or(0), sampling.seed)?)?;
    }
    Ok(Ending::Done)
}

pub(super) fn sample(context: &Context, surrogate: &Surrogate, samples: u64, seed: u64) -> anyhow::Result<EvalReport> {
    let start = Instant::now();
    let summary = monte_carlo(surrogate, samples, seed, &context.terminal)
        .map_err(|error| interruptible(error.clone(), error.is_interruption(), &surrogate.provenance.study_name))?;
    Ok(EvalReport::of_surrogate(surrogate, &summary, seed, start.elapsed().as_secs_f64()))
}

fn at_points(
    context: &Context,
    surrogate: &Surrogate,
    points: &Path,
    out: &Path,
    extrapolate: bool,
) -> anyhow::Result<PointsReport> {
    let plan = Plan::new(surrogate);
    let file = PointsFile::open(points, &surrogate.inputs, extrapolate)?;
    let (count, stable) = file.evaluate(out, &context.terminal, |group| {
        let standardized: Vec<Vec<f64>> = group.iter().map(|point| surrogate.inputs.standardized(point)).collect();
        let references: Vec<&[f64]> = standardized.iter().map(Vec::as_slice).collect();
        let block = evaluate_points(surrogate, &plan, &references);
        let eigenvalues = |i: usize| block.eigenvalues.iter().map(|mode| mode[i]).collect();
        let results = (0..group.len()).map(|i| (eigenvalues(i), block.max_re[i])).collect();
        Ok(Evaluated { modes: surrogate.modes(), results })
    })?;
    Ok(PointsReport { points: count, stable_points: stable, file: out.display().to_string() })
}
