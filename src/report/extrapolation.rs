//! Samples beyond all model runs, where a surrogate extrapolates.

use super::coverage::Bounds;
use super::numbers::{interval, share};
use pcc_evaluate::evaluation::{Extrapolated, Tally};
use pcc_evaluate::surrogate::Surrogate;

/// The share of extrapolated samples, and between what the shares lie whatever the model would say there; `None` if
/// it is not known where the model was run, or if runs fill the laws of all inputs.
pub(super) fn of(tally: &Tally) -> Option<(f64, Bounds)> {
    let outside = tally.extrapolated?;
    let (summary, Extrapolated { samples, stable, unstable }) = (&tally.summary, outside);
    let all = summary.samples();
    let bounds = Bounds {
        stable: outside.bounds(summary.stable, stable, all),
        unstable: outside.bounds(summary.unstable, unstable, all),
    };
    Some((samples as f64 / all.max(1) as f64, bounds))
}

/// What it means for an answer.
pub(super) fn consequence(bounds: &Bounds) -> String {
    format!("{} are stable, whatever the model would say there", interval(&bounds.stable))
}

/// What to know if more is extrapolated than errors of runs left out hold.
pub(super) fn warning(surrogate: &Surrogate, found: Option<(f64, Bounds)>) -> Option<String> {
    let (proportion, bounds) = found?;
    let foreseen = surrogate.foreseen_extrapolation();
    (proportion > foreseen).then(|| {
        format!(
            "{} of the samples lie beyond all model runs in some input, more than the {} that estimated errors speak \
             for; {}; pcc inspect says where the model was run, pcc compare checks, and more runs reach farther",
            share(proportion),
            share(foreseen),
            consequence(&bounds)
        )
    })
}

/// The same of a sweep, of which these shares of samples are extrapolated at its points.
pub(super) fn warning_of_sweep(surrogate: &Surrogate, proportions: &[Option<f64>]) -> Option<String> {
    let foreseen = surrogate.foreseen_extrapolation();
    let beyond = proportions.iter().flatten().filter(|&&proportion| proportion > foreseen).count();
    (beyond > 0).then(|| {
        format!(
            "at {beyond} of {} points of the sweep more than {} of the samples lie beyond all model runs in some input; \
             there the surrogate extrapolates, and estimated errors do not speak for it",
            proportions.len(),
            share(foreseen)
        )
    })
}
