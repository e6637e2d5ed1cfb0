//! What can be typed after `pcc eval` and `pcc merge`.

use super::arguments::Sampling;
use super::question::{HistogramRequest, SamplerName, Shard, condition, event, histogram, level, shard, sweep};
use clap::Args;
use clap::builder::PossibleValuesParser;
use pcc_evaluate::evaluation::{Condition, Event, Sweep};
use pcc_evaluate::foundation::InstructionSet;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct Eval {
    /// Surrogate file
    pub surrogate: PathBuf,

    #[command(flatten)]
    pub sampling: Sampling,

    /// Also show where the system loses stability: the smallest value of INPUT, given the other inputs
    #[arg(long, value_name = "INPUT", conflicts_with_all = ["points", "sweep", "part"])]
    pub critical: Option<String>,

    #[command(flatten)]
    pub asked: QuestionOptions,

    #[command(flatten)]
    pub pictures: Pictures,

    /// Evaluate only this shard, numbers from 0: 0/8 to 7/8 are all of it
    #[arg(long, value_name = "I/N", value_parser = shard, requires = "part")]
    pub shard: Option<Shard>,

    /// Write what was counted to FILE, for pcc merge
    #[arg(long, value_name = "FILE", conflicts_with = "points")]
    pub part: Option<PathBuf>,

    /// Vector instructions to use [default: the fastest of this processor]; results do not depend on them
    #[arg(long, value_name = "NAME", conflicts_with = "points", value_parser = PossibleValuesParser::new(InstructionSet::NAMES))]
    pub instructions: Option<String>,
}

/// What is asked beside the stability of random samples.
#[derive(Debug, Args)]
#[group(skip)]
pub(super) struct QuestionOptions {
    /// How samples are drawn
    #[arg(long, value_enum, default_value = "monte-carlo", conflicts_with = "points")]
    pub sampler: SamplerName,

    /// Independent randomisations that the samples of sobol or latin-hypercube are divided among, at least 2; the error is
    /// estimated from their spread [default: 16]
    #[arg(long, value_name = "R", conflicts_with = "points", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub replicates: Option<u32>,

    /// Confine or fix inputs, in physical units, with decimal points: mu=0.1..0.2,k_p=15.8e6
    #[arg(long = "where", value_name = "CONDITIONS", value_delimiter = ',', value_parser = condition, conflicts_with = "points")]
    pub conditions: Vec<Condition>,

    /// Set INPUT to POINTS values one after the other, each with all samples; give it twice for a stability map, more often for a
    /// longer table. Without --histogram, --quantiles and --critical
    #[arg(long, value_name = "INPUT=FROM:TO:POINTS", value_parser = sweep, conflicts_with = "points")]
    pub sweep: Vec<Sweep>,

    /// Also count the samples with max_re, re_K, im_K, frequency_K, damping_K (mode K) or a component below or above a value:
    /// 'max_re<-0.1,frequency_3>600'
    #[arg(long, value_name = "EVENTS", value_delimiter = ',', value_parser = event, conflicts_with = "points")]
    pub events: Vec<Event>,

    /// Also show the histogram of a quantity, as in --events [default: max_re]
    #[arg(
        long,
        value_name = "QUANTITY[=LOWER:UPPER:BINS]",
        value_parser = histogram,
        num_args = 0..=1,
        default_missing_value = "max_re",
        conflicts_with_all = ["points", "sweep"]
    )]
    pub histogram: Vec<HistogramRequest>,

    /// Also show quantiles of max_re and of every mode at these probabilities, from 0 to 1 [default:
    /// 0.01,0.05,0.25,0.5,0.75,0.95,0.99]
    #[arg(
        long,
        value_name = "LEVELS",
        value_delimiter = ',',
        value_parser = level,
        num_args = 0..=1,
        default_missing_values = ["0.01", "0.05", "0.25", "0.5", "0.75", "0.95", "0.99"],
        conflicts_with_all = ["points", "sweep"]
    )]
    pub quantiles: Vec<f64>,
}

/// Where the results of a sweep go beside the terminal.
#[derive(Debug, Args)]
#[group(skip)]
pub(super) struct Pictures {
    /// CSV file for the points of --sweep: their values, samples, stable proportion, its interval, events
    #[arg(long, value_name = "FILE.csv")]
    pub table: Option<PathBuf>,

    /// SVG file for a picture of --sweep: a curve, or a map for two
    #[arg(long, value_name = "FILE.svg")]
    pub chart: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct Merge {
    /// Files that eval --part has written
    #[arg(required = true)]
    pub parts: Vec<PathBuf>,

    /// Write the parts as one part to FILE; then the first and the last shards may be missing
    #[arg(long, value_name = "FILE")]
    pub part: Option<PathBuf>,

    #[command(flatten)]
    pub pictures: Pictures,
}
