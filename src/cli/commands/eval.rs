//! `pcc eval`

use crate::cli::answers::{check_pictures, present};
use crate::cli::inputs::read_surrogate;
use crate::cli::overwrite::{Output, claim};
use crate::cli::points::{Evaluated, IntervalReport, PointsFile, PointsReport};
use crate::cli::question_options::{ASKED, QuestionOptions, Shard, shard};
use crate::cli::shared_options::{Pictures, PointsOptions, SAMPLES, sample_count, seed};
use crate::cli::{Context, Ending, about};
use crate::report::PartReport;
use anyhow::{Context as _, anyhow, bail};
use clap::Args;
use clap::builder::PossibleValuesParser;
use pcc_evaluate::evaluation::{IntervalLevel, Plan, evaluate_points, point_intervals};
use pcc_evaluate::foundation::{InstructionSet, save};
use pcc_evaluate::session::{Request, Session, SessionError};
use pcc_evaluate::shard_file::MARK;
use pcc_evaluate::surrogate::{LeftOut, Surrogate};
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A group of the help.
const PARTS: &str = "How it is computed";

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc eval belt.pcc                                              how likely it is to be stable
  pcc eval belt.pcc --where mu=0.1..0.2 --events flutter         in a part of the domain
  pcc eval belt.pcc --critical mu                                where it loses stability
  pcc eval belt.pcc -n 1e5 --sweep mu=0..0.5:51 --chart mu.svg   along one input";

/// Sample a surrogate: stability proportion, modes, moments, Sobol' indices, critical values
///
/// Needs the surrogate file only. --where confines the samples to a part of the domain. --sweep gives the proportion
/// along one input, or as a map over two. The answer is the same for any number of threads; with --shard it can be
/// computed in parts, on any number of machines, for pcc merge to put together. With --points it evaluates the points
/// of a CSV file instead, whose columns are named like the inputs, in physical units; other columns are ignored.
#[derive(Debug, Args)]
#[command(
    after_help = EXAMPLES,
    override_usage = "pcc eval <SURROGATE> [--samples <N>] [OPTIONS]\n       pcc eval <SURROGATE> --points <IN.csv> --out <OUT.csv> [OPTIONS]"
)]
pub(in crate::cli) struct Options {
    /// Surrogate file
    pub surrogate: PathBuf,

    /// Number of samples, as in 1000000 or 1e6
    #[arg(
        short = 'n',
        long,
        value_name = "N",
        default_value = SAMPLES,
        value_parser = sample_count,
        allow_negative_numbers = true,
        conflicts_with_all = ["points", "out"]
    )]
    pub samples: u64,

    /// Seed of the samples
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed())]
    pub seed: u64,

    #[command(flatten)]
    pub given: PointsOptions,

    /// Beside each eigenvalue and max_re at these points, its interval at this level, like 0.9: columns named _lower
    /// and _upper, from what the surrogate missed at model runs left out
    #[arg(long, help_heading = "Points instead of samples", value_name = "LEVEL", requires = "points")]
    pub interval: Option<IntervalLevel>,

    /// Also show where the system loses stability: the smallest value of INPUT, given the other inputs
    #[arg(long, help_heading = ASKED, value_name = "INPUT", conflicts_with_all = ["points", "sweep", "part"])]
    pub critical: Option<String>,

    #[command(flatten)]
    pub asked: QuestionOptions,

    #[command(flatten)]
    pub pictures: Pictures,

    /// Evaluate only this shard, numbers from 0: 0/8 to 7/8 are all of it
    #[arg(long, help_heading = PARTS, value_name = "I/N", value_parser = shard, requires = "part")]
    pub shard: Option<Shard>,

    /// Write what was counted to FILE, for pcc merge
    #[arg(long, help_heading = PARTS, value_name = "FILE", conflicts_with = "points")]
    pub part: Option<PathBuf>,

    /// Vector instructions to use [default: the fastest of this processor]; results do not depend on them
    #[arg(long, help_heading = PARTS, value_name = "NAME", conflicts_with = "points", value_parser = PossibleValuesParser::new(InstructionSet::NAMES))]
    pub instructions: Option<String>,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let surrogate = read_surrogate(&options.surrogate)?.surrogate;
    let name = &surrogate.provenance.study_name;
    if let (Some(points), Some(out)) = (&options.given.points, &options.given.out) {
        claim(out, Output::Results, &[points, &options.surrogate])?;
        context.print(&at_points(context, &surrogate, (points, out), options)?)?;
        return Ok(Ending::Done);
    }
    let instructions = instructions(options.instructions.as_deref())?;
    let request = request(options);
    let typed = |error| as_typed(error, name);
    let question = request.question(&surrogate).map_err(typed)?;
    let session = Session::new(&surrogate, &question, options.critical.as_deref(), instructions).map_err(typed)?;
    if options.part.is_some() && (options.pictures.table.is_some() || options.pictures.chart.is_some()) {
        bail!("--part: a part has no table or chart; give --table and --chart to pcc merge");
    }
    let hint = "ask for one with --sweep INPUT=FROM..TO:POINTS";
    check_pictures(&options.pictures, &question, &[&options.surrogate], hint)?;
    if let Some(file) = &options.part {
        claim(file, Output::Marked(MARK), &[&options.surrogate])?;
        let shard = options.shard.unwrap_or(Shard { number: 0, of: 1 });
        context.print(&write_part(context, &session, shard, file, name)?)?;
        return Ok(Ending::Done);
    }
    let found = session.run(&context.terminal).map_err(|error| about(name, error))?;
    let ending = present(context, &found, &options.pictures)?;
    if surrogate.certificates.is_empty() && ending == Ending::Done {
        context.hint_at("certify", &options.surrogate, "to bound the true share by fresh model runs");
    }
    Ok(ending)
}

fn request(options: &Options) -> Request {
    let asked = &options.asked;
    Request {
        sampler: asked.sampler.into(),
        replicates: asked.replicates,
        conditions: asked.conditions.clone(),
        sweeps: asked.sweep.clone(),
        events: asked.events.clone(),
        histograms: asked.histogram.clone(),
        quantile_levels: asked.quantiles.clone(),
        critical: options.critical.clone(),
        ..Request::plain(options.samples, options.seed)
    }
}

/// A refusal in the words of the options that were typed.
fn as_typed(error: SessionError, surrogate: &str) -> anyhow::Error {
    match error {
        SessionError::NoSuchInput { input, known } => {
            anyhow!("--critical {input}: the surrogate has no such input; it has {}", known.join(", "))
        }
        SessionError::ConfinedInput { input } => anyhow!(
            "--critical {input} --where {input}=…: the critical value is looked for in all of the domain; leave out one"
        ),
        SessionError::CriticalOfDependent { input, others } => anyhow!(
            "--critical {input}: {} and {input} depend on each other, so that {input} cannot be varied alone; fix the \
             others ({}), or with --sweep {input}=FROM..TO:POINTS they follow",
            others.join(", "),
            others.iter().map(|other| format!("--where {other}=VALUE")).collect::<Vec<_>>().join(" ")
        ),
        SessionError::CriticalSampler => {
            anyhow!("--critical: critical values are found from random samples; leave out --sampler")
        }
        SessionError::Eval(error) => about(surrogate, error),
        other => other.into(),
    }
}

fn instructions(name: Option<&str>) -> anyhow::Result<InstructionSet> {
    let Some(name) = name else { return Ok(InstructionSet::best()) };
    InstructionSet::named(name).with_context(|| {
        let known: Vec<&str> = InstructionSet::available().iter().map(|set| set.name()).collect();
        format!("--instructions {name}: this processor has {}", known.join(", "))
    })
}

/// Evaluates one shard, and keeps what was found in a file.
fn write_part(
    context: &Context,
    session: &Session<'_>,
    shard: Shard,
    file: &Path,
    surrogate: &str,
) -> anyhow::Result<PartReport> {
    let start = Instant::now();
    let found = session.run_shard(shard.number, shard.of, &context.terminal);
    let part = found.map_err(|error| as_typed(error, surrogate))?;
    save(file, &part.to_bytes()?)?;
    Ok(PartReport {
        file: file.display().to_string(),
        shard: shard.number,
        shards: shard.of,
        samples: part.samples()?,
        stable_samples: part.findings.stable(),
        elapsed_seconds: start.elapsed().as_secs_f64(),
    })
}

fn at_points(
    context: &Context,
    surrogate: &Surrogate,
    (points, out): (&Path, &Path),
    options: &Options,
) -> anyhow::Result<PointsReport> {
    let asked = match options.interval {
        Some(level) => Some((level, left_out(surrogate, options)?)),
        None => None,
    };
    let plan = Plan::new(surrogate);
    let file = PointsFile::open(points, &surrogate.inputs, options.given.extrapolate)?;
    let (unanswered, extrapolated) = (Cell::new(0), Cell::new(0));
    let (count, stable) = file.evaluate(out, &context.terminal, |group| {
        let standardized: Vec<Vec<f64>> = group.iter().map(|point| surrogate.inputs.standardized(point)).collect();
        if let Some(coverage) = &surrogate.coverage {
            let count = standardized.iter().filter(|point| coverage.is_unanswered(point)).count();
            unanswered.set(unanswered.get() + count as u64);
        }
        if let Some(domain) = &surrogate.trained_domain {
            let count = standardized.iter().filter(|point| !domain.holds(point)).count();
            extrapolated.set(extrapolated.get() + count as u64);
        }
        let references: Vec<&[f64]> = standardized.iter().map(Vec::as_slice).collect();
        let block = evaluate_points(surrogate, &plan, &references);
        let eigenvalues = |i: usize| block.eigenvalues.iter().map(|mode| mode[i]).collect();
        let results = (0..group.len()).map(|i| (eigenvalues(i), block.top(i))).collect();
        let intervals = |(level, left_out)| point_intervals(surrogate, left_out, &block, level, &context.terminal);
        Ok(Evaluated { labels: surrogate.labels(), results, intervals: asked.map(intervals).transpose()? })
    })?;
    Ok(PointsReport {
        points: count,
        stable_points: stable,
        unanswered_points: surrogate.coverage.as_ref().map(|_| unanswered.get()),
        extrapolated_points: surrogate.trained_domain.as_ref().map(|_| extrapolated.get()),
        interval: asked.map(|(level, left_out)| interval_report(level, left_out.runs().len())),
        file: out.display().to_string(),
    })
}

/// What intervals are made of.
fn left_out<'s>(surrogate: &'s Surrogate, options: &Options) -> anyhow::Result<&'s LeftOut> {
    surrogate.left_out.as_ref().with_context(|| {
        format!(
            "--interval: {} does not say what the surrogate missed at model runs left out: quadratures leave none out, and \
             files of pcc 0.1.0 do not keep it; build it again, by another method than gpc and me-gpc, or leave out \
             --interval",
            options.surrogate.display()
        )
    })
}

fn interval_report(level: IntervalLevel, runs: usize) -> IntervalReport {
    let least_runs = level.least_runs();
    let is_infinite = runs < least_runs;
    IntervalReport { level: level.value(), runs: runs as u64, least_runs: least_runs as u64, is_infinite }
}
