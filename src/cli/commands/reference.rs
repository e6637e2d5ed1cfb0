//! `pcc reference`

use crate::cli::inputs::read_study;
use crate::cli::overwrite::{Output, claim};
use crate::cli::points::{Evaluated, PointsFile, PointsReport};
use crate::cli::shared_options::{PointsOptions, RecordingOptions, sample_count, seed};
use crate::cli::study_of::runs_or_default;
use crate::cli::{Context, Ending, about};
use crate::report::EvalReport;
use clap::Args;
use pcc_compile::campaign::Campaign;
use pcc_compile::reference::{PointReference, monte_carlo};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc reference belt.toml                                         10 000 model runs
  pcc reference belt.toml --points points.csv --out results.csv   at points of yours";

/// Sample the model itself: the reference for surrogates
///
/// Direct computations at the points that eval takes with the same seed, or at the points of a CSV file.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Study file
    pub study: PathBuf,

    /// Number of model runs at random points, as in 10000 or 1e4 [default: 10000; of a program 100]
    #[arg(
        short = 'n',
        long,
        value_name = "N",
        value_parser = sample_count,
        allow_negative_numbers = true,
        conflicts_with_all = ["points", "out"]
    )]
    pub runs: Option<u64>,

    /// Seed of the random points
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed())]
    pub seed: u64,

    #[command(flatten)]
    pub given: PointsOptions,

    #[command(flatten)]
    pub recording: RecordingOptions,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let study = read_study(&options.study)?;
    if let (Some(points), Some(out)) = (&options.given.points, &options.given.out) {
        claim(out, Output::Results, &[points, &options.study])?;
        let books = context.books_of_sampling(&study, &options.recording.to_recording())?;
        let campaign = books.campaign(&study);
        let source = options.study.display().to_string();
        context.print(&at_points(context, campaign, source, points, out, options.given.extrapolate)?)?;
        return Ok(Ending::Done);
    }
    let books = context.books_of_sampling(&study, &options.recording.to_recording())?;
    let campaign = books.campaign(&study);
    let start = Instant::now();
    let found = monte_carlo(campaign, runs_or_default(options.runs, &study), options.seed, &context.terminal)
        .inspect_err(|_| context.say_recorded(&books))
        .map_err(|error| about(&options.study.display().to_string(), error))?;
    let elapsed = start.elapsed().as_secs_f64();
    let report = EvalReport::of_model(&study.name, &found, study.spectrum.margin, options.seed, elapsed);
    context.print(&report.with_dependence_of(&study.inputs))?;
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
    let mut reference = PointReference::new(campaign)?;
    let file = PointsFile::open(points, &campaign.study.inputs, extrapolate)?;
    let (count, stable) = file.evaluate(out, &context.terminal, |group| {
        let answers = reference.run(group, &context.terminal).map_err(|error| about(&source, error))?;
        let results = answers.into_iter().map(|answer| (answer.eigenvalues, answer.top)).collect();
        Ok(Evaluated { labels: reference.labels().to_vec(), results, intervals: None })
    })?;
    Ok(PointsReport {
        points: count,
        stable_points: stable,
        unanswered_points: None,
        extrapolated_points: None,
        interval: None,
        file: out.display().to_string(),
    })
}
