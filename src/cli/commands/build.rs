//! `pcc build`

use super::super::arguments::{Build, FileFormat};
use super::super::{Context, Ending};
use super::{interruptible, keep_other_files, read_study};
use crate::artifact::{Format, check_writable, encode, save};
use crate::report::BuildReport;
use crate::study::Study;
use crate::surrogate::Surrogate;
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
    let (_, report) = build_to_file(context, &study, &options.study.display().to_string(), &path, format)?;
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
) -> anyhow::Result<(Surrogate, BuildReport)> {
    check_writable(path)?;
    let start = Instant::now();
    let surrogate = crate::build::build(study, &context.terminal)
        .map_err(|error| interruptible(error.clone(), error.is_interruption(), source))?;
    let elapsed = start.elapsed().as_secs_f64();
    let bytes = encode(&surrogate, format)?;
    save(path, &bytes)?;
    let report = BuildReport::new(&surrogate, path.display().to_string(), bytes.len() as u64, elapsed);
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
