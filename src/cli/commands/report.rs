//! `pcc report`

use crate::cli::inputs::read_surrogate;
use crate::cli::overwrite::{Output, SURROGATE_PAGE, claim};
use crate::cli::shared_options::{RecordingOptions, SAMPLES, run_count, sample_count, seed};
use crate::cli::study_of::{StudyFile, runs_or_default};
use crate::cli::{Context, Ending, about};
use crate::report::{CompareReport, InspectReport, SurrogatePage, Validation, page_points};
use anyhow::Context as _;
use clap::Args;
use pcc_compile::reference::{ModelSample, check_problem};
use pcc_evaluate::foundation::{count, save};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc report belt.pcc                            writes report.html, without the model
  pcc report belt.pcc --runs 1000 -o belt.html   with the model beside it";

/// Put a surrogate on one page: an HTML file with its answer, pictures and tables
///
/// Samples the surrogate and draws densities, modes over the inputs that matter most, Sobol' indices and the decay of
/// its coefficients. With --study or --runs it also runs the model, and shows where the two differ. The page stands
/// alone: no scripts, nothing to load.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Surrogate file
    pub surrogate: PathBuf,

    /// Study it was built from: the model is run and compared with the surrogate [default with --runs: <name of the
    /// study>.toml beside the surrogate; else no model is run]
    #[arg(long, value_name = "STUDY")]
    pub study: Option<PathBuf>,

    /// HTML file
    #[arg(short, long, value_name = "FILE", default_value = "report.html")]
    pub output: PathBuf,

    /// Number of samples of the surrogate, as in 1000000 or 1e6
    #[arg(short = 'n', long, value_name = "N", value_parser = sample_count, default_value = SAMPLES)]
    pub samples: u64,

    /// Number of model runs that the surrogate is compared with [default with --study: 10000; of a program 100]
    #[arg(long, value_name = "N", value_parser = run_count)]
    pub runs: Option<u64>,

    #[command(flatten)]
    pub recording: RecordingOptions,

    /// Seed of all points
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed())]
    pub seed: u64,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let artifact = read_surrogate(&options.surrogate)?;
    let surrogate = &artifact.surrogate;
    let study = (options.study.is_some() || options.runs.is_some())
        .then(|| context.study_of(options.study.as_deref(), &options.surrogate, surrogate))
        .transpose()?;
    let inputs: Vec<&Path> =
        [Some(&options.surrogate), study.as_ref().map(|file| &file.path)].into_iter().flatten().map(AsRef::as_ref).collect();
    claim(&options.output, Output::Marked(SURROGATE_PAGE), &inputs)?;
    let start = Instant::now();
    let model = match &study {
        Some(StudyFile { study, path }) => {
            let what = path.display().to_string();
            check_problem(surrogate, study).with_context(|| what.clone())?;
            let books = context.books_of_sampling(study, &options.recording.to_recording())?;
            let campaign = books.campaign(study);
            let runs = runs_or_default(options.runs, study);
            let found =
                ModelSample::new(campaign, runs, options.seed, &context.terminal)
                    .and_then(|sample| Ok((sample.compare(surrogate)?, sample.max_re().to_vec())))
                    .inspect_err(|_| context.say_recorded(&books))
                    .map_err(|error| about(&what, error))?;
            let seconds = start.elapsed().as_secs_f64();
            let compare = CompareReport::new(&surrogate.provenance.study_name, surrogate, &found.0, options.seed, seconds);
            Some((found.1, compare))
        }
        None => None,
    };
    let (points, block) = page_points(surrogate, options.seed);
    let eval = context.sample(surrogate, options.samples, options.seed)?;
    let bytes = std::fs::metadata(&options.surrogate).map_or(0, |metadata| metadata.len());
    let html = SurrogatePage {
        surrogate,
        inspect: &InspectReport::new(&artifact, options.surrogate.display().to_string(), bytes),
        eval: &eval,
        points: &points,
        block: &block,
        validation: model.as_ref().map(|(max_re, compare)| Validation { max_re, compare }),
    }
    .to_html();
    save(&options.output, html.as_bytes())?;
    context.print(&Written {
        file: options.output.display().to_string(),
        bytes: html.len(),
        stable_proportion: eval.stable_proportion,
        compare: model.map(|(_, compare)| compare),
    })?;
    Ok(Ending::Done)
}

/// Where the page is.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(in crate::cli) struct Written {
    file: String,
    bytes: usize,
    stable_proportion: f64,
    compare: Option<CompareReport>,
}

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "written to {} ({} bytes); open it in a browser",
            self.file,
            count(self.bytes as u64)
        )
    }
}
