//! `pcc modes`

use crate::cli::inputs::read_study;
use crate::cli::overwrite::{Output, PICTURE, claim};
use crate::cli::question_options::{condition, sweep};
use crate::cli::shared_options::RecordingOptions;
use crate::cli::{Context, Ending, about};
use crate::report::{ModesReport, modes_chart};
use anyhow::{anyhow, bail};
use clap::Args;
use pcc_compile::mechanics::spectrum::{Modes, Target};
use pcc_compile::reference::modes_along;
use pcc_evaluate::evaluation::{Condition, Sweep};
use pcc_evaluate::foundation::save;
use pcc_evaluate::probability::inputs::InputSpace;
use std::path::PathBuf;

/// Columns that a table of modes has at its end.
const COLUMNS: &str = "max_re,verdict";

/// Points of a line at most: each is a model run, a picture shows no more, and following takes the square of them.
const MOST_POINTS: u32 = 5_000;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc modes rotor.toml                                       with all inputs at their medians
  pcc modes rotor.toml --at omega=400,k=1.2e6               at a point of yours
  pcc modes rotor.toml --over omega=300..700:81 --chart campbell.svg";

/// Look at the modes of a model at one point, or along one input
///
/// Frequencies, growth rates and damping ratios of all eigenvalues, each with the error that the solver's rounding can
/// make. Along an input modes are followed by their eigenvectors, so that they keep their numbers where they cross.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Study file
    pub study: PathBuf,

    /// Values of inputs, in physical units, with decimal points: mu=0.2,k_p=15.8e6 [default: their medians]
    #[arg(long, value_name = "INPUT=VALUE,…", value_delimiter = ',', value_parser = condition)]
    pub at: Vec<Condition>,

    /// Set INPUT to POINTS values one after the other
    #[arg(long, value_name = "INPUT=FROM..TO:POINTS", value_parser = sweep)]
    pub over: Option<Sweep>,

    /// CSV file for the modes along --over: the value, re and im of each, max_re, verdict
    #[arg(long, value_name = "FILE.csv", requires = "over")]
    pub table: Option<PathBuf>,

    /// SVG file for a picture of --over: frequencies (a Campbell diagram) and growth rates
    #[arg(long, value_name = "FILE.svg", requires = "over")]
    pub chart: Option<PathBuf>,

    #[command(flatten)]
    pub recording: RecordingOptions,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let mut study = read_study(&options.study)?;
    let source = options.study.display().to_string();
    // All eigenvalues, whatever the study fits.
    (study.spectrum.target, study.spectrum.modes) = (Target::Invariants, Modes::All);
    let (points, along) = points(&study.inputs, &options.at, options.over.as_ref())?;
    if let Some(table) = &options.table {
        claim(table, Output::Table(COLUMNS), &[&options.study])?;
    }
    if let Some(chart) = &options.chart {
        claim(chart, Output::Marked(PICTURE), &[&options.study])?;
    }
    let books = context.books_of_sampling(&study, &options.recording.to_recording())?;
    let found = modes_along(books.campaign(&study), &points, &context.terminal)
        .inspect_err(|_| context.say_recorded(&books))
        .map_err(|error| about(&source, error))?;
    let mut report = ModesReport::new(&study.name, &study.inputs, &points, along, &found);
    if let Some(table) = &options.table {
        save(table, &report.to_csv()?)?;
        report.files.push(table.display().to_string());
    }
    if let Some(chart) = &options.chart {
        save(chart, modes_chart(&report).as_bytes())?;
        report.files.push(chart.display().to_string());
    }
    context.print(&report)?;
    Ok(Ending::Done)
}

/// The physical points, and the number of the input that varies.
fn points(
    inputs: &InputSpace,
    at: &[Condition],
    over: Option<&Sweep>,
) -> anyhow::Result<(Vec<Vec<f64>>, Option<usize>)> {
    let number = |name: &str| {
        let known = || inputs.names().collect::<Vec<_>>().join(", ");
        inputs.names().position(|input| input == name).ok_or_else(|| anyhow!("there is no input {name}: {}", known()))
    };
    let mut point = inputs.physical(&inputs.middle());
    for (k, Condition { input, lower, upper }) in at.iter().enumerate() {
        if lower != upper {
            bail!("--at {input}={lower}..{upper}: a point has one value of each input");
        }
        if at[..k].iter().any(|before| before.input == *input) {
            bail!("--at: {input} is given twice");
        }
        point[number(input)?] = *lower;
    }
    let Some(over) = over else { return Ok((vec![point], None)) };
    if at.iter().any(|fixed| fixed.input == over.input) {
        bail!("{} is fixed by --at and varied by --over; leave one of them out", over.input);
    }
    if over.points > MOST_POINTS {
        bail!("--over: {} points are more than {MOST_POINTS}", over.points);
    }
    let j = number(&over.input)?;
    let along = (0..over.points).map(|k| {
        let mut point = point.clone();
        point[j] = over.value(k);
        point
    });
    Ok((along.collect(), Some(j)))
}
