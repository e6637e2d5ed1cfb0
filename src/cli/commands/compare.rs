//! `pcc compare`

use super::super::arguments::Compare;
use super::super::recording::open_here;
use super::super::{Context, Ending, complain};
use super::{interruptible, read_study, read_surrogate};
use crate::report::CompareReport;
use pcc_compile::campaign::Campaign;
use pcc_compile::reference::compare as compare_with_model;
use pcc_evaluate::surrogate::Surrogate;
use std::time::Instant;

pub(in super::super) fn compare(context: &Context, options: &Compare) -> anyhow::Result<Ending> {
    let surrogate = read_surrogate(&options.surrogate)?.surrogate;
    let study = read_study(&options.study)?;
    let books = open_here(context, &study, &options.recording)?;
    let campaign = Campaign { study: &study, ledger: Some(&books.ledger) };
    let source = options.study.display().to_string();
    let report = judge(context, &surrogate, campaign, &source, options.samples, options.seed);
    let report = report.inspect_err(|_| books.say_recorded(context))?;
    context.print(&report)?;
    match options.max_error {
        Some(limit) if report.relative_error_percent.is_none_or(|error| error > limit) => {
            let error = report
                .relative_error_percent
                .map_or("infinitely".to_owned(), |error| format!("by {} %", crate::report::significant(error, 4)));
            complain(&format!("the proportion is off {error}, more than --max-error {limit}"));
            Ok(Ending::CheckFailed)
        }
        _ => Ok(Ending::Done),
    }
}

pub(super) fn judge(
    context: &Context,
    surrogate: &Surrogate,
    campaign: Campaign<'_>,
    source: &str,
    samples: u64,
    seed: u64,
) -> anyhow::Result<CompareReport> {
    let start = Instant::now();
    let comparison = compare_with_model(surrogate, campaign, samples, seed, &context.terminal)
        .map_err(|error| interruptible(error.clone(), error.is_interruption(), source))?;
    let runs = surrogate.training.counts.direct_computations;
    Ok(CompareReport::new(&campaign.study.name, runs, &comparison, seed, start.elapsed().as_secs_f64()))
}
