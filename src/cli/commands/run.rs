//! `pcc run`: the main job end to end.

use crate::cli::hints::quoted;
use crate::cli::inputs::read_study;
use crate::cli::overwrite::{Output, refuse_to_replace};
use crate::cli::shared_options::{RecordingOptions, seed};
use crate::cli::study_of::runs_or_default;
use crate::cli::{Context, Ending, about};
use crate::report::{Align, BuildReport, CompareReport, EvalReport, Table, width};
use anyhow::Context as _;
use clap::Args;
use pcc_compile::campaign::{Books, Campaign};
use pcc_compile::mechanics::model::ModelError;
use pcc_compile::mechanics::spectrum::Target;
use pcc_compile::reference::compare_with_model;
use pcc_compile::study::{ModelSettings, Study};
use pcc_evaluate::artifact::Format;
use pcc_evaluate::foundation::count;
use pcc_evaluate::surrogate::Surrogate;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc run                        the built-in study, into clutch-r8-run/
  pcc run belt.toml -o results   a study of your own, into results/";

/// Build, evaluate and check a study end to end
///
/// Builds the surrogate, samples it a million times and compares it with ten thousand direct computations at the same
/// points (a hundred, if a program makes them). Without STUDY it takes the built-in one: the clutch of the paper with
/// all eight parameters uncertain.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Study file [default: the built-in clutch with 8 uncertain parameters]
    pub study: Option<PathBuf>,

    /// Folder for the surrogate [default: <name of the study>-run]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,

    /// Build over a surrogate with certificates; they stay only if the build gives the same surrogate again
    #[arg(long)]
    pub replace: bool,

    /// Seed of the design instead of the study's, and of all samples [default: the study's for the design, 1 for
    /// samples]
    #[arg(long, value_name = "S", value_parser = seed())]
    pub seed: Option<u64>,

    #[command(flatten)]
    pub recording: RecordingOptions,
}

/// The clutch of the paper with all eight parameters uncertain, by invariants.
const BUILT_IN_STUDY: &str = include_str!("../../../surrogates/clutch-r8.toml");

/// The same by the paper's method.
const PAPERS_STUDY: &str = include_str!("../../../surrogates/clutch-r8-eigenvalues.toml");

/// What the paper reports for it: its sparse rows with 8 parameters.
const PAPERS_FIGURES: [&str; 4] = ["paper, sparse PC", "1706–2117", "3.15–5.85", "–"];

const EVAL_SAMPLES: u64 = 1_000_000;
const SAMPLE_SEED: u64 = 1;

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let study = match &options.study {
        Some(path) => runnable(read_study(path)?).with_context(|| path.display().to_string())?,
        None => Study::from_toml(BUILT_IN_STUDY).context("the built-in study")?,
    };
    let source = options.study.as_ref().map_or("the built-in study".to_owned(), |path| path.display().to_string());
    let folder = options.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}-run", study.name)));
    context.say(&format!("results go to the folder {}", folder.display()));
    std::fs::create_dir_all(&folder).with_context(|| format!("folder {} cannot be created", folder.display()))?;
    let seed = options.seed.unwrap_or(SAMPLE_SEED);
    let method = method_name(&study);
    let (surrogate, build, compare) = build_and_compare(context, options, &folder, study, &source)?;
    let eval = context
        .sample(&surrogate, EVAL_SAMPLES, seed)
        .with_context(|| format!("after the surrogate was written to {}", build.file))?;
    let mut methods = vec![MethodRow::new(method, &build, &compare)];
    if options.study.is_none() {
        for study in other_built_in_studies()? {
            let method = method_name(&study);
            let (_, build, compare) = build_and_compare(context, options, &folder, study, &source)?;
            methods.insert(0, MethodRow::new(method, &build, &compare));
        }
    }
    context.print(&RunReport { build, eval, compare, methods })?;
    Ok(Ending::Done)
}

/// Refuses models that pcc does not run.
fn runnable(study: Study) -> anyhow::Result<Study> {
    match study.model {
        ModelSettings::Table(_) => Err(ModelError::NotRun.into()),
        _ => Ok(study),
    }
}

/// The built-in study without derivatives, and by the paper's method.
fn other_built_in_studies() -> anyhow::Result<[Study; 2]> {
    let mut values_alone = Study::from_toml(&format!("{BUILT_IN_STUDY}\n[fit]\nderivatives = false\n"))
        .context("the built-in study without derivatives")?;
    values_alone.name.push_str("-values-alone");
    let papers = Study::from_toml(PAPERS_STUDY).context("the built-in study by the paper's method")?;
    Ok([values_alone, papers])
}

/// What a study expands, in words.
fn method_name(study: &Study) -> &'static str {
    match study.spectrum.target {
        Target::Eigenvalues => "eigenvalue components",
        Target::Invariants if study.uses_derivatives() => "invariants with derivatives",
        Target::Invariants => "invariants",
    }
}

/// Builds the surrogate of `study` into `folder` and compares it with the model.
fn build_and_compare(
    context: &Context,
    options: &Options,
    folder: &Path,
    mut study: Study,
    source: &str,
) -> anyhow::Result<(Surrogate, BuildReport, CompareReport)> {
    study.seed = options.seed.unwrap_or(study.seed);
    let seed = options.seed.unwrap_or(SAMPLE_SEED);
    let path = folder.join(format!("{}.{}", study.name, Format::Binary.extension()));
    refuse_to_replace(&path, Output::Surrogate, &[])?;
    let recording = options.recording.to_recording();
    let built = context.build_to_file(&study, source, &path, Format::Binary, &recording, options.replace)?;
    let build = BuildReport::of_file(&study, &built, path.display().to_string());
    let books = Books::after_build(&study, &recording, &path)?;
    books.notes.iter().for_each(|note| context.note(note));
    // Runs that the build may skip do not end the comparison either.
    let campaign = Campaign { counts_failures: study.model.skips_failures(), ..books.campaign(&study) };
    let start = Instant::now();
    let comparison = compare_with_model(&built.surrogate, campaign, runs_or_default(None, &study), seed, &context.terminal)
        .map_err(|error| about(source, error))
        .with_context(|| format!("after the surrogate was written to {}", path.display()))?;
    let compare = CompareReport::new(&study.name, &built.surrogate, &comparison, seed, start.elapsed().as_secs_f64());
    Ok((built.surrogate, build, compare))
}

/// Everything a run found.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(in crate::cli) struct RunReport {
    build: BuildReport,
    eval: EvalReport,
    compare: CompareReport,
    /// One row per method that was tried.
    methods: Vec<MethodRow>,
}

/// What a method costs and how good it is.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(in crate::cli) struct MethodRow {
    method: &'static str,
    file: String,
    direct_computations: u64,
    relative_error_percent: Option<f64>,
    misclassified_percent: f64,
}

impl MethodRow {
    fn new(method: &'static str, build: &BuildReport, compare: &CompareReport) -> Self {
        Self {
            method,
            file: build.file.clone(),
            direct_computations: build.direct_computations,
            relative_error_percent: compare.relative_error_percent,
            misclassified_percent: compare.misclassified_percent,
        }
    }

    /// All rows, with the paper's figures below.
    fn table(rows: &[Self]) -> Table {
        let right = Align::Right;
        let columns = [
            ("method", Align::Left),
            ("model runs", right),
            ("error of proportion %", right),
            ("misclassified %", right),
        ];
        let mut table = Table::new(&columns);
        for row in rows {
            table.row([
                row.method.to_owned(),
                count(row.direct_computations),
                row.relative_error_percent.map_or("–".to_owned(), |error| format!("{error:.2}")),
                format!("{:.2}", row.misclassified_percent),
            ]);
        }
        table.row(PAPERS_FIGURES);
        table
    }
}

impl fmt::Display for RunReport {
    /// The answer stands last, where it is seen.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let heading =
            |f: &mut fmt::Formatter<'_>, text: &str| writeln!(f, "── {text} {}\n", "─".repeat(76 - text.len()));
        let Self { build, eval, compare, methods } = self;
        let columns = width(f);
        heading(f, "build")?;
        writeln!(f, "{}", text(build, f))?;
        heading(f, "compare with the model")?;
        writeln!(f, "{}", text(compare, f))?;
        if methods.len() > 1 {
            heading(f, "methods")?;
            writeln!(f, "{:columns$}", MethodRow::table(methods))?;
        }
        heading(f, "answer")?;
        writeln!(f, "{}", text(eval, f))?;
        writeln!(f, "The surrogate is in {}; sample it again with\n\n    pcc eval {}", build.file, quoted(&build.file))
    }
}

/// A report as it is asked for: with details or without, in so many columns.
fn text(report: &impl fmt::Display, f: &fmt::Formatter<'_>) -> String {
    let columns = width(f);
    if f.alternate() { format!("{report:#columns$}") } else { format!("{report:columns$}") }
}
