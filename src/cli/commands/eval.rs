//! `pcc eval`

use super::super::arguments::Eval;
use super::super::points::{Evaluated, PointsFile};
use super::super::{Context, Ending};
use super::{PointsReport, interruptible, keep_inputs, read_surrogate};
use crate::eval::{EvalError, Plan, critical_values, evaluate_points, monte_carlo, sensitivities};
use crate::report::EvalReport;
use crate::surrogate::Surrogate;
use anyhow::bail;
use std::path::Path;
use std::time::Instant;

pub(in super::super) fn eval(context: &Context, options: &Eval) -> anyhow::Result<Ending> {
    let surrogate = read_surrogate(&options.surrogate)?.surrogate;
    let sampling = &options.sampling;
    if let (Some(points), Some(out)) = (&sampling.points, &sampling.out) {
        keep_inputs(out, &[points, &options.surrogate])?;
        context.print(&at_points(context, &surrogate, points, out, sampling.extrapolate)?)?;
    } else {
        let input = options.critical.as_deref().map(|name| input_position(&surrogate, name)).transpose()?;
        let samples = sampling.samples.unwrap_or(0);
        let mut report = sample(context, &surrogate, samples, sampling.seed)?;
        if let Some(input) = input {
            let found = critical_values(&surrogate, input, samples, sampling.seed, &context.terminal)
                .map_err(|error| interrupted(error, &surrogate))?;
            report.add_critical_values(&surrogate, input, &found);
        }
        context.print(&report)?;
    }
    Ok(Ending::Done)
}

/// Samples of the surrogate whose indices are estimated by pick-freeze: beyond, their intervals are narrow enough.
const SENSITIVITY_SAMPLES: u64 = 50_000;

pub(super) fn sample(context: &Context, surrogate: &Surrogate, samples: u64, seed: u64) -> anyhow::Result<EvalReport> {
    let start = Instant::now();
    let summary =
        monte_carlo(surrogate, samples, seed, &context.terminal).map_err(|error| interrupted(error, surrogate))?;
    let elapsed = start.elapsed().as_secs_f64();
    let base = samples.min(SENSITIVITY_SAMPLES);
    let indices =
        sensitivities(surrogate, base, seed, &context.terminal).map_err(|error| interrupted(error, surrogate))?;
    Ok(EvalReport::of_surrogate(surrogate, &summary, &indices, seed, elapsed))
}

fn interrupted(error: EvalError, surrogate: &Surrogate) -> anyhow::Error {
    interruptible(error.clone(), error.is_interruption(), &surrogate.provenance.study_name)
}

fn input_position(surrogate: &Surrogate, name: &str) -> anyhow::Result<usize> {
    let names: Vec<&str> = surrogate.inputs.names().collect();
    match names.iter().position(|known| *known == name) {
        Some(position) => Ok(position),
        None => bail!("--critical {name}: the surrogate has no such input; it has {}", names.join(", ")),
    }
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
