//! What can be typed.

use super::eval_arguments::{Eval, Merge};
use super::run_arguments::{Design, Ingest, Recording, ShowJournal};
use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use std::path::PathBuf;

/// How likely is this machine to squeal, flutter or whirl, given what is not known about it?
///
/// pcc runs a model of the machine at a few dozen well-chosen points, fits sparse polynomial chaos expansions to smooth
/// functions of its eigenvalues, and writes them to a small file, the surrogate. Millions of samples of the surrogate then tell how
/// often the machine is stable.
#[derive(Debug, Parser)]
#[command(name = "pcc", version, max_term_width = 110)]
#[command(
    after_help = "First steps:\n  pcc run                                the built-in clutch study, end to end\n  pcc build STUDY.toml                   build a surrogate from a study\n  pcc eval SURROGATE.pcc -n 1e6          stability proportion from the surrogate alone\n  pcc help COMMAND                       everything about one command\n\nExit codes: 0 done, 1 a requested check did not hold, 2 bad usage or input, 130 interrupted."
)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub command: Command,

    /// Print one JSON document on standard output and nothing else there
    #[arg(long, global = true, display_order = 100)]
    pub json: bool,

    /// Number of threads [default: all processors]; results do not depend on it
    #[arg(long, global = true, value_name = "N", display_order = 101, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,

    /// Show no progress
    #[arg(long, global = true, display_order = 102)]
    pub quiet: bool,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Build, evaluate and check a study end to end
    ///
    /// Builds the surrogate, samples it a million times and compares it with ten thousand direct computations at the same
    /// points (a hundred, if a program makes them). Without STUDY it takes the built-in one: the clutch of the paper with all eight parameters uncertain.
    Run(Run),

    /// Build a surrogate from a study
    ///
    /// Runs the model on a nested Latin hypercube design that grows until every component is fitted and the stability
    /// proportion is accurate enough, as far as the study asks for it, and writes index sets and coefficients. Full expansions
    /// (methods gpc and me-gpc) run it on a grid, or on a design whose size their degree fixes. The same study gives the same
    /// bytes on any number of threads.
    Build(Build),

    /// Write the model runs that a build is waiting for as a table
    ///
    /// For models that something else than pcc runs: a scheduler, a cluster, a laboratory. Steps the build of STUDY as far as
    /// the recorded answers carry it, and writes the points whose answers it needs next. Run them, hand the answers over with pcc
    /// ingest, and repeat until there are no more: pcc build STUDY --resume then writes the surrogate.
    Design(Design),

    /// Take answers to the points of a design from a table
    ///
    /// RESULTS.csv has the inputs of the table that pcc design wrote, and its column run if they have lost digits, and the eigenvalues as
    /// re_1, im_1, re_2, im_2 and so on in 1/s; a text in a column error marks a run that failed. Rows may come in any order, in part, and more than
    /// once; a row that contradicts an earlier answer is refused, and then none is taken.
    Ingest(Ingest),

    /// Show the model runs that are recorded in a journal
    Journal(ShowJournal),

    /// Sample a surrogate: stability proportion, modes, moments, Sobol' indices, critical values
    ///
    /// Needs the surrogate file only. Samples can be confined to a part of the domain (--where), and the proportion be had
    /// along one input or over two (--sweep). The answer is the same for any number of threads; with --shard it can be computed in
    /// parts, on any number of machines, for pcc merge to put together. With --points it evaluates the points of a CSV file
    /// instead, whose columns are named like the inputs, in physical units; other columns are ignored.
    #[command(
        group = clap::ArgGroup::new("what").required(true).args(["samples", "points"]),
        override_usage = "pcc eval <SURROGATE> --samples <N> [OPTIONS]\n       pcc eval <SURROGATE> --points <IN.csv> --out <OUT.csv> [OPTIONS]"
    )]
    Eval(Box<Eval>),

    /// Put the parts of an evaluation together
    ///
    /// Takes the files that eval has written with --shard and --part, in any order, and prints what one evaluation of all samples
    /// would have printed. Parts of different evaluations, missing and repeated shards are refused.
    Merge(Merge),

    /// Sample the model itself: the reference for surrogates
    ///
    /// Direct computations at the points that eval takes with the same seed, or at the points of a CSV file.
    #[command(group = clap::ArgGroup::new("what").required(true).args(["samples", "points"]))]
    Reference(Reference),

    /// Compare a surrogate with its model at the same points
    ///
    /// Errors of the stability proportion, of means and variances, and the share of points on whose stability the two
    /// disagree. Refuses a study that asks another question than the surrogate answers.
    Compare(Compare),

    /// Bound the true stability proportion by fresh model runs
    ///
    /// Runs the model at points that neither the build nor any evaluation has used, counts where surrogate and model
    /// disagree, and bounds the model's proportion from that: it holds however wrong the surrogate is, and is narrow where
    /// it is right. The certificate is added to the surrogate file, beside any earlier one.
    Certify(Certify),

    /// Show what is inside a surrogate file
    Inspect(Inspect),

    /// Put a surrogate on one page: an HTML file with its answer, pictures and tables
    ///
    /// Samples the surrogate and draws densities, modes over the inputs that matter most, Sobol' indices and the decay of its
    /// coefficients. With --study it also runs the model, and shows where the two differ. The page stands alone: no scripts, nothing
    /// to load.
    Report(Report),

    /// Reproduce the paper: its table 2 and figures 3 and 4, and what lies beyond
    ///
    /// Builds the clutch by full, multi-element and sparse expansions of its eigenvalues and of invariants, for one to eight
    /// uncertain parameters, compares all with the model on the same points, and writes table2.csv, table2.md, the figures as SVG
    /// and report.html; files of these names in DIR are replaced. Takes about half a minute on two cores. If it is interrupted, the rows
    /// that are done are kept until the next run, in table2.partial.csv if there was a table already.
    Reproduce(Reproduce),

    /// Convert a surrogate between binary (.pcc) and JSON (.json), without loss
    Convert(Convert),

    /// Print a completion script for a shell
    ///
    /// For example: pcc completions bash > ~/.local/share/bash-completion/completions/pcc
    Completions {
        /// The shell
        shell: Shell,
    },
}

#[derive(Debug, Args)]
pub(super) struct Run {
    /// Study file [default: the built-in clutch with 8 uncertain parameters]
    pub study: Option<PathBuf>,

    /// Folder for the surrogate
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub output: PathBuf,

    /// Seed of the design instead of the study's, and of all samples [default: the study's for the design, 1 for samples]
    #[arg(long, value_name = "S", value_parser = seed())]
    pub seed: Option<u64>,

    #[command(flatten)]
    pub recording: Recording,
}

#[derive(Debug, Args)]
pub(super) struct Build {
    /// Study file
    pub study: PathBuf,

    /// Surrogate file [default: <name of the study>.pcc in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Form of the file [default: by the ending of FILE, .json or other]
    #[arg(long, value_enum)]
    pub format: Option<FileFormat>,

    /// Seed of the design instead of the study's
    #[arg(long, value_name = "S", value_parser = seed())]
    pub seed: Option<u64>,

    /// Print the study with every default filled in, and build nothing
    #[arg(long)]
    pub show_study: bool,

    #[command(flatten)]
    pub recording: Recording,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum FileFormat {
    /// Compact and checksummed
    Binary,
    /// Readable
    Json,
}

/// Random samples, or given points.
#[derive(Debug, Args)]
pub(super) struct Sampling {
    /// Number of samples, as in 1000000 or 1e6
    #[arg(short = 'n', long, value_name = "N", value_parser = sample_count, allow_negative_numbers = true)]
    pub samples: Option<u64>,

    /// Seed of the samples
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed())]
    pub seed: u64,

    /// CSV file of points to evaluate instead of samples
    #[arg(long, value_name = "IN.csv", requires = "out")]
    pub points: Option<PathBuf>,

    /// CSV file for the results at these points: the point, re_k and im_k of each mode, max_re, stable
    #[arg(long, value_name = "OUT.csv", requires = "points", conflicts_with = "samples")]
    pub out: Option<PathBuf>,

    /// Accept points outside the inputs' domain, where a surrogate knows nothing
    #[arg(long, requires = "points")]
    pub extrapolate: bool,
}

#[derive(Debug, Args)]
pub(super) struct Reference {
    /// Study file
    pub study: PathBuf,

    #[command(flatten)]
    pub sampling: Sampling,

    #[command(flatten)]
    pub recording: Recording,
}

#[derive(Debug, Args)]
pub(super) struct Compare {
    /// Surrogate file
    pub surrogate: PathBuf,

    /// Study it was built from
    #[arg(long, value_name = "STUDY")]
    pub study: PathBuf,

    /// Number of points, as in 10000 or 1e4
    #[arg(short = 'n', long, value_name = "N", value_parser = sample_count, allow_negative_numbers = true)]
    pub samples: u64,

    /// Seed of the points
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed())]
    pub seed: u64,

    /// Exit with code 1 if the relative error of the stability proportion is larger
    #[arg(long, value_name = "PERCENT", value_parser = percentage, allow_negative_numbers = true)]
    pub max_error: Option<f64>,

    #[command(flatten)]
    pub recording: Recording,
}

#[derive(Debug, Args)]
pub(super) struct Certify {
    /// Surrogate file
    pub surrogate: PathBuf,

    /// Study it was built from
    #[arg(long, value_name = "STUDY")]
    pub study: PathBuf,

    /// Number of fresh model runs
    #[arg(short = 'm', long, value_name = "M", value_parser = sample_count, allow_negative_numbers = true)]
    pub runs: u64,

    /// Seed of the fresh points; a seed the file has a certificate for is refused
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed())]
    pub seed: u64,

    /// File for the surrogate with its new certificate [default: the surrogate file itself]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Certify against a study that asks another question than the surrogate was built for
    #[arg(long)]
    pub force: bool,

    #[command(flatten)]
    pub recording: Recording,
}

#[derive(Debug, Args)]
pub(super) struct Inspect {
    /// Surrogate file
    pub surrogate: PathBuf,

    /// Exit with code 1 if this evaluator does not find the values of the self-test
    #[arg(long)]
    pub check: bool,
}

#[derive(Debug, Args)]
pub(super) struct Report {
    /// Surrogate file
    pub surrogate: PathBuf,

    /// Study it was built from: the model is run and compared with the surrogate
    #[arg(long, value_name = "STUDY")]
    pub study: Option<PathBuf>,

    /// HTML file
    #[arg(short, long, value_name = "FILE", default_value = "report.html")]
    pub output: PathBuf,

    /// Number of samples of the surrogate, as in 1000000 or 1e6
    #[arg(short = 'n', long, value_name = "N", value_parser = sample_count, default_value = "1000000")]
    pub samples: u64,

    /// Number of model runs with --study [default: 10000; of a program 100]
    #[arg(long, value_name = "M", value_parser = run_count, requires = "study")]
    pub runs: Option<u64>,

    #[command(flatten)]
    pub recording: Recording,

    /// Seed of all points
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed())]
    pub seed: u64,
}

#[derive(Debug, Args)]
pub(super) struct Reproduce {
    /// Only this part
    #[arg(long, value_enum)]
    pub only: Option<Part>,

    /// Folder for the files
    #[arg(short, long, value_name = "DIR", default_value = "reproduction")]
    pub output: PathBuf,

    /// Seed of the points, and of the first of five designs
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed())]
    pub seed: u64,

    /// Model runs to compare with, for each number of uncertain parameters
    #[arg(long, value_name = "N", value_parser = run_count, default_value = "10000")]
    pub runs: u64,
}

/// A part of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Part {
    /// All methods compared
    Table2,
    /// Coalescence of the two modes
    Figure3,
    /// Growth rates by model and surrogate
    Figure4,
}

#[derive(Debug, Args)]
pub(super) struct Convert {
    /// Surrogate file to read, binary or JSON
    pub input: PathBuf,

    /// Surrogate file to write: JSON if it ends in .json, else binary
    pub output: PathBuf,
}

/// Seeds that a study file can hold, too.
fn seed() -> clap::builder::RangedU64ValueParser {
    clap::value_parser!(u64).range(0..=i64::MAX as u64)
}

/// A whole number from 1, also written like 1e6 or 1_000_000.
fn sample_count(text: &str) -> Result<u64, String> {
    /// Whole numbers up to here are exact in double precision.
    const EXACT: f64 = 9_007_199_254_740_992.0;
    let plain: String = text.chars().filter(|&c| c != '_').collect();
    let count = plain.parse::<u64>().ok().or_else(|| {
        let number = plain.parse::<f64>().ok()?;
        (number.fract() == 0.0 && (0.0..=EXACT).contains(&number)).then_some(number as u64)
    });
    match count {
        Some(0) => Err("use at least 1".to_owned()),
        Some(count) => Ok(count),
        None => Err("use a whole number from 1 to 9e15, like 1000000 or 1e6".to_owned()),
    }
}

/// As many model runs as are kept in memory.
fn run_count(text: &str) -> Result<u64, String> {
    const MOST: u64 = 10_000_000;
    match sample_count(text)? {
        count if count <= MOST => Ok(count),
        _ => Err("use at most 10000000: the answers are kept in memory".to_owned()),
    }
}

fn percentage(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("use a number of percent from 0, like 0.5".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn sample_counts_are_whole_numbers_from_one() {
        assert_eq!(sample_count("1e6"), Ok(1_000_000));
        assert_eq!(sample_count("1_000"), Ok(1000));
        assert_eq!(sample_count("18446744073709551615"), Ok(u64::MAX));
        for bad in ["0", "-1", "1.5", "nan", "inf", "1e300", "many", ""] {
            assert!(sample_count(bad).is_err(), "{bad}");
        }
    }
}
