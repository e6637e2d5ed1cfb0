//! `pcc run`: the main job end to end.

use super::super::arguments::Run;
use super::super::{Context, Ending};
use super::build::build_to_file;
use super::compare::judge;
use super::eval::sample;
use super::{keep_other_files, read_study};
use crate::artifact::Format;
use crate::report::{BuildReport, CompareReport, EvalReport};
use crate::study::Study;
use anyhow::Context as _;
use serde::Serialize;
use std::fmt;

/// The clutch of the paper with all eight parameters uncertain.
const BUILT_IN_STUDY: &str = include_str!("../../../surrogates/clutch-r8-eigenvalues.toml");

const EVAL_SAMPLES: u64 = 1_000_000;
/// As many direct computations as the paper's reference.
const COMPARE_SAMPLES: u64 = 10_000;
const SAMPLE_SEED: u64 = 1;

pub(in super::super) fn run(context: &Context, options: &Run) -> anyhow::Result<Ending> {
    let mut study = match &options.study {
        Some(path) => read_study(path)?,
        None => Study::from_toml(BUILT_IN_STUDY).context("the built-in study")?,
    };
    let source = options.study.as_ref().map_or("the built-in study".to_owned(), |path| path.display().to_string());
    study.seed = options.seed.unwrap_or(study.seed);
    let seed = options.seed.unwrap_or(SAMPLE_SEED);
    let path = options.output.join(format!("{}.{}", study.name, Format::Binary.extension()));
    std::fs::create_dir_all(&options.output)
        .with_context(|| format!("folder {} cannot be created", options.output.display()))?;

    keep_other_files(&path)?;
    let (surrogate, build) = build_to_file(context, &study, &source, &path, Format::Binary)?;
    let finished = || format!("after the surrogate was written to {}", path.display());
    let eval = sample(context, &surrogate, EVAL_SAMPLES, seed).with_context(finished)?;
    let compare = judge(context, &surrogate, &study, &source, COMPARE_SAMPLES, seed).with_context(finished)?;
    context.print(&RunReport { build, eval, compare })?;
    Ok(Ending::Done)
}

/// A file name as a shell takes it.
fn quoted(name: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+".contains(c);
    if name.chars().all(is_plain) { name.to_owned() } else { format!("'{}'", name.replace('\'', r"'\''")) }
}

/// Everything a run found.
#[derive(Debug, Serialize)]
struct RunReport {
    build: BuildReport,
    eval: EvalReport,
    compare: CompareReport,
}

impl fmt::Display for RunReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let heading =
            |f: &mut fmt::Formatter<'_>, text: &str| writeln!(f, "── {text} {}\n", "─".repeat(76 - text.len()));
        heading(f, "build")?;
        writeln!(f, "{}", self.build)?;
        heading(f, "evaluate")?;
        writeln!(f, "{}", self.eval)?;
        heading(f, "compare with the model")?;
        writeln!(f, "{}", self.compare)?;
        heading(f, "answer")?;
        let Self { build, eval, compare } = self;
        writeln!(
            f,
            "The system is stable in {:.2} % of cases, by a surrogate built from {} model runs.\n\
             On {} points where the model was run as well, the proportion is {} % off and {:.2} % of points are \
             misclassified.\n\
             The surrogate is in {}; sample it again with\n\n    pcc eval {} -n 1e6",
            100.0 * eval.stable_proportion,
            build.direct_computations,
            crate::report::count(compare.samples),
            compare.relative_error_percent.map_or("infinitely".to_owned(), |error| format!("{error:.2}")),
            compare.misclassified_percent,
            build.file,
            quoted(&build.file)
        )?;
        self.eval.warnings.iter().try_for_each(|warning| writeln!(f, "\nwarning: {warning}"))
    }
}
