//! `pcc report`

use super::super::arguments::Report;
use super::super::recording::open_here;
use super::super::{Context, Ending};
use super::eval::sample;
use super::{SURROGATE_PAGE, interruptible, keep_inputs, keep_unmarked_files, read_study, read_surrogate};
use crate::report::{CompareReport, InspectReport, SurrogatePage, Validation};
use anyhow::Context as _;
use pcc_compile::campaign::Campaign;
use pcc_compile::reference::{ModelSample, check_problem};
use pcc_evaluate::components::Block;
use pcc_evaluate::evaluation::{Plan, evaluate_points};
use pcc_evaluate::foundation::{check_writable, save};
use pcc_evaluate::probability::inputs::random_points;
use pcc_evaluate::probability::random::Purpose;
use pcc_evaluate::surrogate::Surrogate;
use serde::Serialize;
use std::fmt;
use std::path::Path;
use std::time::Instant;

/// Points of the surrogate that are kept for pictures.
const POINTS: u64 = 20_000;

/// Model runs, as many as the paper's reference; of programs, which take their time, fewer.
const RUNS: u64 = 10_000;
const PROGRAM_RUNS: u64 = 100;

pub(in super::super) fn report(context: &Context, options: &Report) -> anyhow::Result<Ending> {
    let artifact = read_surrogate(&options.surrogate)?;
    let study = options.study.as_deref().map(read_study).transpose()?;
    let inputs: Vec<&Path> =
        [Some(options.surrogate.as_path()), options.study.as_deref()].into_iter().flatten().collect();
    keep_inputs(&options.output, &inputs)?;
    keep_unmarked_files(&options.output, SURROGATE_PAGE)?;
    check_writable(&options.output)?;
    let surrogate = &artifact.surrogate;
    let name = &surrogate.provenance.study_name;
    let start = Instant::now();
    let model = match (&study, &options.study) {
        (Some(study), Some(path)) => {
            let what = path.display().to_string();
            check_problem(surrogate, study).with_context(|| what.clone())?;
            let books = open_here(context, study, &options.recording)?;
            let campaign = Campaign { study, ledger: Some(&books.ledger) };
            let default_runs = if study.model.is_external() { PROGRAM_RUNS } else { RUNS };
            let found =
                ModelSample::new(campaign, options.runs.unwrap_or(default_runs), options.seed, &context.terminal)
                    .and_then(|sample| Ok((sample.compare(surrogate)?, sample.max_re_over(&surrogate.modes()))))
                    .inspect_err(|_| books.say_recorded(context))
                    .map_err(|error| interruptible(error.clone(), error.is_interruption(), &what))?;
            Some(found)
        }
        _ => None,
    };
    let runs = surrogate.training.counts.direct_computations;
    let compare = model
        .as_ref()
        .map(|(comparison, _)| CompareReport::new(name, runs, comparison, options.seed, start.elapsed().as_secs_f64()));
    let (points, block) = at_random_points(surrogate, options.seed);
    let eval = sample(context, surrogate, options.samples, options.seed)?;
    let bytes = std::fs::metadata(&options.surrogate).map_or(0, |metadata| metadata.len());
    let html = SurrogatePage {
        surrogate,
        inspect: &InspectReport::new(&artifact, options.surrogate.display().to_string(), bytes),
        eval: &eval,
        points: &points,
        block: &block,
        validation: model.as_ref().zip(compare.as_ref()).map(|((_, max_re), compare)| Validation { max_re, compare }),
    }
    .to_html();
    save(&options.output, html.as_bytes())?;
    context.print(&Written {
        file: options.output.display().to_string(),
        bytes: html.len(),
        stable_proportion: eval.stable_proportion,
        compare,
    })?;
    Ok(Ending::Done)
}

/// The first points that `eval` and `reference` take, and the surrogate there.
fn at_random_points(surrogate: &Surrogate, seed: u64) -> (Vec<Vec<f64>>, Block) {
    let points = random_points(&surrogate.inputs, seed, Purpose::Evaluation, 0..POINTS);
    let references: Vec<&[f64]> = points.iter().map(Vec::as_slice).collect();
    let block = evaluate_points(surrogate, &Plan::new(surrogate), &references);
    (points, block)
}

/// Where the page is.
#[derive(Debug, Serialize)]
struct Written {
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
            crate::report::count(self.bytes as u64)
        )
    }
}
