//! `pcc certify`

use crate::cli::inputs::read_surrogate;
use crate::cli::overwrite::{Output, claim};
use crate::cli::shared_options::{Failures, RecordingOptions, run_count, seed};
use crate::cli::study_of::StudyFile;
use crate::cli::{Context, Ending, about};
use crate::report::{CertifyPlanReport, CertifyReport};
use anyhow::{Context as _, bail};
use clap::Args;
use pcc_compile::campaign::Campaign;
use pcc_compile::reference::{LEAST_RUNS, certify_with_model, runs_for_width};
use pcc_evaluate::artifact::{Format, encode};
use pcc_evaluate::foundation::save;
use std::path::PathBuf;
use std::time::Instant;

/// Probability with which each end of a certificate holds.
const SIDE_LEVEL: f64 = 0.95;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc certify belt.pcc                        450 model runs, and a bound that holds
  pcc certify belt.pcc -n 1000 --seed 2       a narrower one, beside the first
  pcc certify belt.pcc --target-width 0.002   how many runs a bound takes, and no run";

/// Bound the true stability proportion by fresh model runs
///
/// Runs the model at points that neither the build nor any evaluation has used, counts where surrogate and model
/// disagree, and bounds the model's proportion from that: it holds however wrong the surrogate is, and is narrow where
/// it is right. A second, narrower bound assumes that large errors are rarer than small ones, and is not verified. The
/// certificate is added to the surrogate file, beside any earlier one.
///
/// The rarer of stable and not stable, by the surrogate, divides the runs: N at random outside that set, N/3 more in
/// the layer nearest to it, 50 at random inside.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Surrogate file
    pub surrogate: PathBuf,

    /// Study it was built from [default: <name of the study>.toml beside the surrogate]
    #[arg(long, value_name = "STUDY")]
    pub study: Option<PathBuf>,

    /// Number of model runs outside what is predicted to be rare; a third as many and 50 come on top
    #[arg(
        short = 'n',
        long,
        value_name = "N",
        default_value = "300",
        value_parser = certificate_runs,
        allow_negative_numbers = true
    )]
    pub runs: u64,

    /// Say how many runs a bound takes that ends so far above the surrogate's share, as a part of 1, and make none
    #[arg(
        long,
        value_name = "WIDTH",
        value_parser = share_width,
        allow_negative_numbers = true,
        conflicts_with_all = ["runs", "output"]
    )]
    pub target_width: Option<f64>,

    /// Seed of the fresh points; a seed the file has a certificate for is refused
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed())]
    pub seed: u64,

    /// File for the surrogate with its new certificate [default: the surrogate file itself]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Certify against a study that asks another question than the surrogate was built for
    #[arg(long)]
    pub force: bool,

    /// What becomes of model runs that fail
    #[arg(long, value_enum, default_value_t = Failures::Stop)]
    pub failures: Failures,

    #[command(flatten)]
    pub recording: RecordingOptions,
}

/// As many runs as are kept in memory, and no fewer than say something.
fn certificate_runs(text: &str) -> Result<u64, String> {
    match run_count(text) {
        Ok(runs) if runs < LEAST_RUNS => Err(format!("use at least {LEAST_RUNS}: fewer runs bound nothing")),
        other => other,
    }
}

fn share_width(text: &str) -> Result<f64, String> {
    let width: Option<f64> = text.parse().ok().filter(|width| *width > 0.0 && *width < 1.0);
    width.ok_or_else(|| "use a part of 1, above 0 and below 1, like 0.002 for 0.2 % of all cases".to_owned())
}

/// What a certificate takes, and no model run.
fn plan(context: &Context, options: &Options, width: f64) -> anyhow::Result<Ending> {
    let surrogate = read_surrogate(&options.surrogate)?.surrogate;
    let found = runs_for_width(&surrogate, width, options.seed, SIDE_LEVEL, &context.terminal)
        .map_err(|error| about(&options.surrogate.display().to_string(), error))?;
    context.print(&CertifyPlanReport::new(&surrogate, width, SIDE_LEVEL, &found))?;
    Ok(Ending::Done)
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    if let Some(width) = options.target_width {
        return plan(context, options, width);
    }
    let artifact = read_surrogate(&options.surrogate)?;
    artifact.check_lossless().with_context(|| options.surrogate.display().to_string())?;
    let mut surrogate = artifact.surrogate;
    let StudyFile { study, path } = context.study_of(options.study.as_deref(), &options.surrogate, &surrogate)?;
    let (file, source) = (options.surrogate.display(), path.display());
    if study.problem_hash() != surrogate.provenance.problem_hash && !options.force {
        bail!(
            "{source}: asks another question than {file} was built for: model, constants, inputs or spectrum differ; give \
             the study it was built from, or pass --force to certify it against this one all the same"
        );
    }
    let problem = study.problem_hash();
    if surrogate.certificates.iter().any(|known| known.seed == options.seed && known.problem_hash == problem) {
        bail!("{file}: has a certificate of seed {} already; choose another with --seed", options.seed);
    }
    if !study.inputs.is_same_as(&surrogate.inputs) {
        bail!(
            "{source}: has other inputs than {file}; even with --force they must be the same, in order and distribution"
        );
    }
    let output = options.output.as_ref().unwrap_or(&options.surrogate);
    let format = options.output.as_ref().map_or(artifact.format, |path| Format::of_path(path));
    claim(output, Output::Surrogate, &[])?;
    let books = context.books_of_sampling(&study, &options.recording.to_recording())?;
    let campaign = Campaign { counts_failures: options.failures == Failures::Count, ..books.campaign(&study) };
    let start = Instant::now();
    let Options { runs, seed, .. } = *options;
    let certificate = certify_with_model(&surrogate, campaign, runs, seed, SIDE_LEVEL, &context.terminal)
        .inspect_err(|error| context.say_recorded_of(&books, error))
        .map_err(|error| about(&source.to_string(), error))?;
    surrogate.certificates.push(certificate);
    save(output, &encode(&surrogate, format)?)?;
    let elapsed = start.elapsed().as_secs_f64();
    context.print(&CertifyReport::new(&surrogate, output.display().to_string(), elapsed))?;
    context.hint_at("report", output, "to put it on a page");
    Ok(Ending::Done)
}
