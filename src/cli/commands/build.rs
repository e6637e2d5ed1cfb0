//! `pcc build`

use super::super::arguments::{Build, FileFormat};
use super::super::recording::{self, journal_of_build};
use super::super::run_arguments::Recording;
use super::super::{Context, Ending};
use super::{interruptible, keep_other_files, read_study};
use crate::report::{BuildReport, FailedRun, RecordedRuns};
use pcc_compile::campaign::Campaign;
use pcc_compile::compilation::BuildError;
use pcc_compile::study::Study;
use pcc_evaluate::artifact::{Format, encode};
use pcc_evaluate::foundation::{check_writable, save};
use pcc_evaluate::surrogate::Surrogate;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

pub(in super::super) fn build(context: &Context, options: &Build) -> anyhow::Result<Ending> {
    let mut study = read_study(&options.study)?;
    study.seed = options.seed.unwrap_or(study.seed);
    if options.show_study {
        context.print(&ShownStudy { study: study.to_toml() })?;
        return Ok(Ending::Done);
    }
    let asked = options.format.map(|format| match format {
        FileFormat::Binary => Format::Binary,
        FileFormat::Json => Format::Json,
    });
    let path = options
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}.{}", study.name, asked.unwrap_or(Format::Binary).extension())));
    let format = asked.unwrap_or_else(|| Format::of_path(&path));
    keep_other_files(&path)?;
    let source = options.study.display().to_string();
    let (_, report) = build_to_file(context, &study, &source, &path, format, &options.recording)?;
    context.print(&report)?;
    Ok(Ending::Done)
}

/// Builds the surrogate of `study`, read from `source`, and writes it; asks for the place before the first model run.
pub(super) fn build_to_file(
    context: &Context,
    study: &Study,
    source: &str,
    path: &Path,
    format: Format,
    recording: &Recording,
) -> anyhow::Result<(Surrogate, BuildReport)> {
    check_writable(path)?;
    let books = recording::open(context, study, recording, Some(journal_of_build(study, path)))?;
    let start = Instant::now();
    let campaign = Campaign { study, ledger: Some(&books.ledger) };
    let surrogate = match pcc_compile::compilation::build(campaign, &context.terminal) {
        Ok(surrogate) => surrogate,
        Err(error) => {
            if matches!(error, BuildError::TooManyFailures { .. }) && books.ledger.reused() > 0 {
                context.say("failures were recorded earlier; --resume --retry-failed tries them again");
            }
            books.give_up(context, error.is_interruption());
            return Err(interruptible(error.clone(), error.is_interruption(), source));
        }
    };
    let elapsed = start.elapsed().as_secs_f64();
    let bytes = encode(&surrogate, format)?;
    save(path, &bytes)?;
    let runs = RecordedRuns {
        journal: books.kept_journal().map(|journal| journal.display().to_string()),
        reused: books.ledger.reused(),
        failed: books.ledger.failures().iter().map(|failure| FailedRun::new(&study.inputs, failure)).collect(),
    };
    books.close();
    let report = BuildReport::new(&surrogate, path.display().to_string(), bytes.len() as u64, elapsed, runs);
    Ok((surrogate, report))
}

/// A study with its defaults.
#[derive(Debug, Serialize)]
struct ShownStudy {
    study: String,
}

impl fmt::Display for ShownStudy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.study)
    }
}
