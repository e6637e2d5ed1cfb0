//! `pcc compare`

use crate::cli::inputs::read_surrogate;
use crate::cli::shared_options::{Failures, RecordingOptions, percentage, sample_count, seed};
use crate::cli::study_of::{StudyFile, runs_or_default};
use crate::cli::messages::complain;
use crate::cli::{Context, Ending, about};
use crate::report::{ComparedShare, CompareReport, significant};
use clap::Args;
use pcc_compile::campaign::Campaign;
use pcc_compile::reference::compare_with_model;
use std::path::PathBuf;
use std::time::Instant;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc compare belt.pcc                                           with the study that lies beside it
  pcc compare belt.pcc --study belt.toml -n 1000 --max-error 1   fails if the error is above 1 %";

/// Compare a surrogate with its model at the same points
///
/// Errors of the stability proportion, of means and variances, and the share of points on whose stability the two
/// disagree. Refuses a study that asks another question than the surrogate answers.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Surrogate file
    pub surrogate: PathBuf,

    /// Study it was built from [default: <name of the study>.toml beside the surrogate]
    #[arg(long, value_name = "STUDY")]
    pub study: Option<PathBuf>,

    /// Number of model runs, each at a point of its own, as in 10000 or 1e4 [default: 10000; of a program 100]
    #[arg(short = 'n', long, value_name = "N", value_parser = sample_count, allow_negative_numbers = true)]
    pub runs: Option<u64>,

    /// Seed of the points
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed())]
    pub seed: u64,

    /// Exit with code 1 if the relative error of the smallest share is larger, of stable, unstable and those that
    /// fit.shares names
    #[arg(long, value_name = "PERCENT", value_parser = percentage, allow_negative_numbers = true)]
    pub max_error: Option<f64>,

    /// What becomes of model runs that fail
    #[arg(long, value_enum, default_value_t = Failures::Stop)]
    pub failures: Failures,

    #[command(flatten)]
    pub recording: RecordingOptions,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let surrogate = read_surrogate(&options.surrogate)?.surrogate;
    let StudyFile { study, path } = context.study_of(options.study.as_deref(), &options.surrogate, &surrogate)?;
    let books = context.books_of_sampling(&study, &options.recording.to_recording())?;
    let campaign = Campaign { counts_failures: options.failures == Failures::Count, ..books.campaign(&study) };
    let start = Instant::now();
    let runs = runs_or_default(options.runs, &study);
    let comparison = compare_with_model(&surrogate, campaign, runs, options.seed, &context.terminal)
        .inspect_err(|error| context.say_recorded_of(&books, error))
        .map_err(|error| about(&path.display().to_string(), error))?;
    let report = CompareReport::new(&study.name, &surrogate, &comparison, options.seed, start.elapsed().as_secs_f64());
    context.print(&report)?;
    let ComparedShare { name, relative_error_percent, .. } = report.smallest_share;
    match options.max_error {
        Some(limit) if relative_error_percent.is_none_or(|error| error > limit) => {
            let error = relative_error_percent
                .map_or("infinitely".to_owned(), |error| format!("by {} % of itself", significant(error, 4)));
            complain(&format!("the {name} share is off {error}, more than --max-error {limit}"));
            Ok(Ending::CheckFailed)
        }
        _ => Ok(Ending::Done),
    }
}
