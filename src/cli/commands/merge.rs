//! `pcc merge`

use super::super::eval_arguments::Merge;
use super::super::{Context, Ending};
use super::eval::{check_pictures, present, stable};
use super::{keep_inputs, keep_unmarked_files};
use crate::report::{Asked, MergeReport};
use anyhow::Context as _;
use pcc_evaluate::foundation::{check_writable, save};
use pcc_evaluate::shard_file::{MARK, Part, PartError, merge as merge_parts};
use std::path::Path;
use std::time::Instant;

pub(in super::super) fn merge(context: &Context, options: &Merge) -> anyhow::Result<Ending> {
    let start = Instant::now();
    let files: Vec<&Path> = options.parts.iter().map(AsRef::as_ref).collect();
    let mut parts = Vec::with_capacity(files.len());
    for file in &files {
        let name = file.display().to_string();
        let part = Part::read(file).with_context(|| name.clone())?;
        parts.push((name, part));
    }
    let whole = merge_parts(parts)?;
    let survey = whole.survey()?;
    let (found, all) = (whole.findings.chunks(), survey.division().chunks());
    let is_complete = found == (0..all);
    if let Some(file) = &options.part {
        keep_inputs(file, &files)?;
        keep_unmarked_files(file, MARK)?;
        check_writable(file)?;
    }
    check_pictures(&options.pictures, &whole.question, &files, "these parts are of plain samples")?;
    if !is_complete && (options.part.is_none() || options.pictures.table.is_some() || options.pictures.chart.is_some())
    {
        let (place, missing) = match found.start {
            0 => ("after those of all parts", found.end..all),
            start => ("before those of all parts", 0..start),
        };
        return Err(PartError::Gap { place: place.to_owned(), missing, chunks: all }.into());
    }
    if let Some(file) = &options.part {
        save(file, &whole.to_bytes()?)?;
        if !is_complete {
            context.print(&MergeReport {
                file: file.display().to_string(),
                parts: files.len(),
                samples: survey.division().samples_in(&found),
                of: survey.division().samples(),
                stable_samples: stable(&whole.findings),
            })?;
            return Ok(Ending::Done);
        }
        context.say(&format!("written to {}", file.display()));
    }
    let answer = whole.findings.answer(survey.division());
    let asked = Asked {
        surrogate: &whole.surrogate,
        question: &whole.question,
        answer: &answer,
        elapsed_seconds: start.elapsed().as_secs_f64(),
        merged_parts: Some(files.len()),
    };
    present(context, asked, &survey, None, &options.pictures)
}
