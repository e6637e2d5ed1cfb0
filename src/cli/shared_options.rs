//! Options that several commands have, and how their values are read.

use clap::{Args, ValueEnum};
use pcc_compile::campaign::Recording;
use pcc_compile::study::{DataOptions, HOLDOUT, is_holdout};
use pcc_compile::tables::{Decimal, separator};
use std::path::PathBuf;

/// Points that are given, instead of random ones.
#[derive(Debug, Args)]
#[group(skip)]
#[command(next_help_heading = "Points instead of samples")]
pub(super) struct PointsOptions {
    /// CSV file of points to evaluate instead of samples
    #[arg(long, value_name = "IN.csv", requires = "out")]
    pub points: Option<PathBuf>,

    /// CSV file for the results at these points: the point, re_k and im_k of each mode (re_k_b and real_j where there
    /// are real eigenvalues), max_re, stable, verdict
    #[arg(long, value_name = "OUT.csv", requires = "points")]
    pub out: Option<PathBuf>,

    /// Accept points outside the inputs' domain, where a surrogate knows nothing
    #[arg(long, requires = "points")]
    pub extrapolate: bool,
}

/// Where model runs are recorded.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Recorded model runs")]
pub(super) struct RecordingOptions {
    /// Record model runs in this journal [default: those of programs in <name of the study>.journal, of a build beside
    /// the surrogate; others only while a build lasts]
    #[arg(long, value_name = "FILE")]
    pub journal: Option<PathBuf>,

    /// Use the runs of this model that the journal has instead of running them again
    #[arg(long)]
    pub resume: bool,

    /// Try recorded failures again that the study would skip
    #[arg(long, requires = "resume")]
    pub retry_failed: bool,

    /// Record nothing
    #[arg(long, conflicts_with_all = ["journal", "resume"])]
    pub no_journal: bool,
}

impl RecordingOptions {
    pub fn to_recording(&self) -> Recording {
        Recording {
            journal: self.journal.clone(),
            resumes: self.resume,
            retries_failures: self.retry_failed,
            is_off: self.no_journal,
        }
    }
}

/// Runs that have been made already.
#[derive(Debug, Clone, Default, Args)]
#[group(skip)]
#[command(next_help_heading = "Runs that have been made already")]
pub(super) struct DataArguments {
    /// Table of runs at any points, in place of the study's model.data: one column per input, the eigenvalues as re_1,
    /// im_1, re_2, im_2 and so on, perhaps their derivatives as d_re_1_d_INPUT; can be repeated to put tables together
    #[arg(long, value_name = "RUNS.csv")]
    pub data: Vec<PathBuf>,

    /// What separates columns: comma, semicolon, tab, space, bar or the character [default: semicolons or tabs if the
    /// first line has some, else commas]
    #[arg(long, value_name = "CHAR", value_parser = delimiter)]
    pub delimiter: Option<char>,

    /// What numbers have for a decimal point [default: point]
    #[arg(long, value_enum)]
    pub decimal: Option<DecimalWord>,

    /// Share of these runs that no fit sees, like 0.2; they validate the surrogate
    #[arg(long, value_name = "SHARE", value_parser = holdout)]
    pub holdout: Option<f64>,
}

/// What numbers have for a decimal point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum DecimalWord {
    /// 0.25
    Point,
    /// 0,25
    Comma,
}

impl DataArguments {
    pub fn to_options(&self) -> DataOptions {
        let decimal = self.decimal.map(|word| match word {
            DecimalWord::Point => Decimal::Point,
            DecimalWord::Comma => Decimal::Comma,
        });
        DataOptions { files: self.data.clone(), delimiter: self.delimiter, decimal, holdout: self.holdout }
    }
}

fn delimiter(text: &str) -> Result<char, String> {
    separator(text).ok_or_else(|| "use comma, semicolon, tab, space or bar, or the character itself".to_owned())
}

fn holdout(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|&share| is_holdout(share)).ok_or_else(|| format!("use {HOLDOUT}"))
}

/// What becomes of model runs that fail, where surrogate and model are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Failures {
    /// The first ends the command
    Stop,
    /// They count as disagreement both ways
    Count,
}

/// Where the results of a sweep go beside the terminal.
#[derive(Debug, Args)]
#[group(skip)]
#[command(next_help_heading = "Results of a sweep")]
pub(super) struct Pictures {
    /// CSV file for the points of --sweep: their values, samples, stable proportion, its interval, events
    #[arg(long, value_name = "FILE.csv")]
    pub table: Option<PathBuf>,

    /// SVG file for a picture of --sweep: a curve, or a map for two
    #[arg(long, value_name = "FILE.svg")]
    pub chart: Option<PathBuf>,
}

/// Seeds that a study file can hold, too.
pub(super) fn seed() -> clap::builder::RangedU64ValueParser {
    clap::value_parser!(u64).range(0..=i64::MAX as u64)
}

/// A whole number from 1, also written like 1e6 or 1_000_000.
pub(super) fn sample_count(text: &str) -> Result<u64, String> {
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
pub(super) fn run_count(text: &str) -> Result<u64, String> {
    const MOST: u64 = 10_000_000;
    match sample_count(text)? {
        count if count <= MOST => Ok(count),
        _ => Err("use at most 10000000: the answers are kept in memory".to_owned()),
    }
}

/// Samples of a surrogate where no number of them was asked for.
pub(super) const SAMPLES: &str = "1000000";

pub(super) fn percentage(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("use a number of percent from 0, like 0.5".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
