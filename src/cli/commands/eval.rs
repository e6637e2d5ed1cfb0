//! `pcc eval`

use super::super::eval_arguments::{Eval, Pictures, QuestionOptions};
use super::super::points::{Evaluated, PointsFile};
use super::super::question::Shard;
use super::super::{Context, Ending};
use super::{PointsReport, interruptible, keep_inputs, keep_results, keep_unmarked_files, read_surrogate};
use crate::report::{Asked, EvalReport, PartReport, SweepReport, sweep_chart};
use anyhow::{Context as _, bail};
use pcc_evaluate::evaluation::{
    Answer, EvalError, Findings, Pilot, PilotError, Plan, Quantity, Question, Sampler, Survey, SurveyError, Surveyed,
    critical_values_in, evaluate_points, sensitivities_in,
};
use pcc_evaluate::foundation::{InstructionSet, Interrupted, check_writable, save};
use pcc_evaluate::shard_file::{MARK, Part};
use pcc_evaluate::surrogate::Surrogate;
use std::path::Path;
use std::time::Instant;

pub(in super::super) fn eval(context: &Context, options: &Eval) -> anyhow::Result<Ending> {
    let surrogate = read_surrogate(&options.surrogate)?.surrogate;
    let sampling = &options.sampling;
    if let (Some(points), Some(out)) = (&sampling.points, &sampling.out) {
        keep_inputs(out, &[points, &options.surrogate])?;
        context.print(&at_points(context, &surrogate, points, out, sampling.extrapolate)?)?;
        return Ok(Ending::Done);
    }
    let instructions = instructions(options.instructions.as_deref())?;
    let critical = options.critical.as_deref().map(|name| input_position(&surrogate, name)).transpose()?;
    let question = question(&surrogate, &options.asked, sampling.samples.unwrap_or(0), sampling.seed)?;
    if let Some(condition) =
        question.conditions.iter().find(|condition| Some(&condition.input) == options.critical.as_ref())
    {
        bail!(
            "--critical {0} --where {0}=…: the critical value is looked for in all of the domain; leave out one",
            condition.input
        );
    }
    let survey = Survey::new(&surrogate, &question, instructions)?;
    if question.sampler != Sampler::MonteCarlo && critical.is_some() {
        bail!("--critical: critical values are found from random samples; leave out --sampler");
    }
    if options.part.is_some() && (options.pictures.table.is_some() || options.pictures.chart.is_some()) {
        bail!("--part: a part has no table or chart; give --table and --chart to pcc merge");
    }
    let hint = "ask for one with --sweep INPUT=FROM:TO:POINTS";
    check_pictures(&options.pictures, &question, &[&options.surrogate], hint)?;
    if let Some(file) = &options.part {
        return write_part(context, &survey, &surrogate, &question, options.shard, file, &options.surrogate);
    }
    let (answer, elapsed_seconds) = answer(context, &survey, &surrogate)?;
    let asked =
        Asked { surrogate: &surrogate, question: &question, answer: &answer, elapsed_seconds, merged_parts: None };
    present(context, asked, &survey, critical, &options.pictures)
}

/// The plain question: random samples of the whole domain.
pub(super) fn sample(context: &Context, surrogate: &Surrogate, samples: u64, seed: u64) -> anyhow::Result<EvalReport> {
    let question = Question::plain(samples, seed);
    let survey = Survey::new(surrogate, &question, InstructionSet::best())?;
    let (answer, elapsed_seconds) = answer(context, &survey, surrogate)?;
    let asked = Asked { surrogate, question: &question, answer: &answer, elapsed_seconds, merged_parts: None };
    let report = report(context, asked, &survey, None)?.ok_or(Interrupted)?;
    if report.complete { Ok(report) } else { Err(Interrupted.into()) }
}

/// Evaluates all samples, or those before an interruption, and tells the seconds that took.
fn answer(context: &Context, survey: &Survey<'_>, surrogate: &Surrogate) -> anyhow::Result<(Answer, f64)> {
    let start = Instant::now();
    let progress =
        survey.run(0..survey.division().chunks(), &context.terminal).map_err(|error| failed(error, surrogate))?;
    let (Surveyed::Complete(findings) | Surveyed::Interrupted(findings)) = progress;
    Ok((findings.answer(survey.division()), start.elapsed().as_secs_f64()))
}

/// Prints an answer, and writes its pictures if it is complete.
pub(super) fn present(
    context: &Context,
    asked: Asked<'_>,
    survey: &Survey<'_>,
    critical: Option<usize>,
    pictures: &Pictures,
) -> anyhow::Result<Ending> {
    let is_complete = if asked.question.sweeps.is_empty() {
        let report = report(context, asked, survey, critical)?.ok_or(Interrupted)?;
        context.print(&report)?;
        report.complete
    } else {
        let mut report = SweepReport::new(asked);
        if report.complete {
            report.files = save_pictures(&report, pictures)?;
        }
        context.print(&report)?;
        report.complete
    };
    Ok(if is_complete { Ending::Done } else { Ending::Interrupted })
}

/// Samples of the surrogate whose indices are estimated by pick-freeze: they cost r + 2 evaluations each, and their intervals are
/// narrow enough.
const SENSITIVITY_SAMPLES: u64 = 16_384;

/// The report of all samples, with what else is asked for as far as there is time: an interruption leaves out the rest, and the report
/// is not complete. `None` if there are no samples.
fn report(
    context: &Context,
    asked: Asked<'_>,
    survey: &Survey<'_>,
    critical: Option<usize>,
) -> anyhow::Result<Option<EvalReport>> {
    let Asked { surrogate, question, answer, .. } = asked;
    let (region, seed) = (&survey.regions().at(0), question.seed);
    let base = question.samples.min(SENSITIVITY_SAMPLES);
    let mut indices = None;
    if answer.is_complete {
        indices = until_interrupted(sensitivities_in(surrogate, region, base, seed, &context.terminal), surrogate)?;
    }
    let Some(mut report) = EvalReport::of_surrogate(asked, indices.as_ref()) else { return Ok(None) };
    report.complete &= indices.is_some();
    if let Some(input) = critical.filter(|_| report.complete) {
        let found = critical_values_in(surrogate, region, input, question.samples, seed, &context.terminal);
        match until_interrupted(found, surrogate)? {
            Some(found) => report.add_critical_values(surrogate, input, &found),
            None => report.complete = false,
        }
    }
    Ok(Some(report))
}

/// `None` for an interruption.
fn until_interrupted<T>(result: Result<T, EvalError>, surrogate: &Surrogate) -> anyhow::Result<Option<T>> {
    match result {
        Ok(found) => Ok(Some(found)),
        Err(error) if error.is_interruption() => Ok(None),
        Err(error) => Err(failed(error, surrogate)),
    }
}

/// What is asked, in numbers.
fn question(surrogate: &Surrogate, asked: &QuestionOptions, samples: u64, seed: u64) -> anyhow::Result<Question> {
    let sampler = Sampler::from(asked.sampler);
    let mut question = Question {
        sampler,
        replicates: asked.replicates.unwrap_or(sampler.default_replicates()),
        conditions: asked.conditions.clone(),
        sweeps: asked.sweep.clone(),
        events: asked.events.clone(),
        quantile_levels: asked.quantiles.clone(),
        ..Question::plain(samples, seed)
    };
    if asked.histogram.is_empty() && asked.quantiles.is_empty() {
        return Ok(question);
    }
    let name = &surrogate.provenance.study_name;
    let pilot = Pilot::new(surrogate, seed, &question.conditions).map_err(|error| match error {
        PilotError::Survey(error) => anyhow::Error::from(error),
        PilotError::Eval(error) => anyhow::Error::from(error).context(name.clone()),
    })?;
    for request in &asked.histogram {
        let quantity = Quantity::named(&request.quantity, surrogate)
            .ok_or_else(|| SurveyError::unknown_quantity(&request.quantity, surrogate))?;
        let mut bins = pilot.bins(quantity, &request.quantity);
        if let Some((lower, upper, count)) = request.bins {
            (bins.lower, bins.upper, bins.bins) = (lower, upper, count);
        }
        question.histograms.push(bins);
    }
    if !asked.quantiles.is_empty() {
        let of_modes =
            Quantity::all(surrogate).into_iter().filter(|quantity| !matches!(quantity, Quantity::Component(_)));
        question.quantile_bins =
            of_modes.map(|quantity| pilot.fine_bins(quantity, &quantity.name(surrogate))).collect();
    }
    Ok(question)
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
    survey: &Survey<'_>,
    surrogate: &Surrogate,
    question: &Question,
    shard: Option<Shard>,
    file: &Path,
    input: &Path,
) -> anyhow::Result<Ending> {
    keep_inputs(file, &[input])?;
    keep_unmarked_files(file, MARK)?;
    check_writable(file)?;
    let shard = shard.unwrap_or(Shard { number: 0, of: 1 });
    let start = Instant::now();
    let chunks = survey.division().shard(shard.number, shard.of);
    let findings = survey.run(chunks, &context.terminal).map_err(|error| failed(error, surrogate))?;
    let Surveyed::Complete(findings) = findings else { return Err(Interrupted.into()) };
    let samples = survey.division().samples_in(&findings.chunks());
    let stable = stable(&findings);
    let part = Part { surrogate: surrogate.clone(), question: question.clone(), findings };
    save(file, &part.to_bytes()?)?;
    context.print(&PartReport {
        file: file.display().to_string(),
        shard: shard.number,
        shards: shard.of,
        samples,
        stable_samples: stable,
        elapsed_seconds: start.elapsed().as_secs_f64(),
    })?;
    Ok(Ending::Done)
}

pub(super) fn stable(findings: &Findings) -> u64 {
    findings.total().map_or(0, |tally| tally.summary.stable)
}

/// Refuses pictures that nothing would be drawn in, and files that must not be replaced. `hint` says how to get a sweep.
pub(super) fn check_pictures(
    pictures: &Pictures,
    question: &Question,
    inputs: &[&Path],
    hint: &str,
) -> anyhow::Result<()> {
    for (option, file) in [("--table", &pictures.table), ("--chart", &pictures.chart)] {
        let Some(file) = file else { continue };
        if question.sweeps.is_empty() {
            bail!("{option}: there is no sweep to write; {hint}");
        }
        keep_inputs(file, inputs)?;
        keep_results(file)?;
        check_writable(file)?;
    }
    let Some(chart) = &pictures.chart else { return Ok(()) };
    if question.sweeps.len() > 2 {
        bail!("--chart: {} sweeps cannot be drawn; use one or two, or --table", question.sweeps.len());
    }
    if chart.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("svg")) {
        bail!(
            "--chart {0}: charts are drawn as SVG; name it {1}",
            chart.display(),
            chart.with_extension("svg").display()
        );
    }
    Ok(())
}

/// The files that were written.
fn save_pictures(report: &SweepReport, pictures: &Pictures) -> anyhow::Result<Vec<String>> {
    let mut files = Vec::new();
    if let Some(file) = &pictures.table {
        save(file, &report.to_csv()?)?;
        files.push(file.display().to_string());
    }
    if let Some(file) = &pictures.chart {
        save(file, sweep_chart(report).as_bytes())?;
        files.push(file.display().to_string());
    }
    Ok(files)
}

fn failed(error: EvalError, surrogate: &Surrogate) -> anyhow::Error {
    interruptible(error.clone(), error.is_interruption(), &surrogate.provenance.study_name)
}

fn input_position(surrogate: &Surrogate, name: &str) -> anyhow::Result<usize> {
    let names: Vec<&str> = surrogate.inputs.names().collect();
    match names.iter().position(|known| *known == name) {
        Some(position) => Ok(position),
        None => bail!("--critical {name}: the surrogate has no such input; it has {}", names.join(", ")),
    }
}

fn at_points(
    context: &Context,
    surrogate: &Surrogate,
    points: &Path,
    out: &Path,
    extrapolate: bool,
) -> anyhow::Result<PointsReport> {
    let plan = Plan::new(surrogate);
    let file = PointsFile::open(points, &surrogate.inputs, extrapolate)?;
    let (count, stable) = file.evaluate(out, &context.terminal, |group| {
        let standardized: Vec<Vec<f64>> = group.iter().map(|point| surrogate.inputs.standardized(point)).collect();
        let references: Vec<&[f64]> = standardized.iter().map(Vec::as_slice).collect();
        let block = evaluate_points(surrogate, &plan, &references);
        let eigenvalues = |i: usize| block.eigenvalues.iter().map(|mode| mode[i]).collect();
        let results = (0..group.len()).map(|i| (eigenvalues(i), block.max_re[i])).collect();
        Ok(Evaluated { modes: surrogate.modes(), results })
    })?;
    Ok(PointsReport { points: count, stable_points: stable, file: out.display().to_string() })
}
