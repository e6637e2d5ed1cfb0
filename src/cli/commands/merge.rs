//! `pcc merge`

use super::super::eval_arguments::Merge;
use super::super::{Context, Ending};
use super::eval::{check_pictures, present, stable};
use super::{keep_inputs, keep_unmarked_files};
use crate::artifact::{check_writable, save};
use crate::part::{MARK, Part, PartError, merge as merge_parts};
use crate::report::{Asked, MergeReport};
use anyhow::Context as _;
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
    if let Some(file) = &options.part {
        keep_inputs(file, &files)?;
        keep_unmarked_files(file, MARK)?;
        check_writable(file)?;
        save(file, &whole.to_bytes()?)?;
        if !whole.is_complete() {
            let survey = whole.survey()?;
            let samples = survey.layout().samples_in(&whole.findings.chunks());
            let report = MergeReport {
                file: file.display().to_string(),
                parts: files.len(),
                samples,
                of: survey.layout().samples(),
                stable_samples: stable(&whole.findings),
            };
            context.print(&report)?;
            return Ok(Ending::Done);
        }
    }
    let survey = whole.survey()?;
    let (found, all) = (whole.findings.chunks(), survey.layout().chunks());
    if found != (0..all) {
        let (place, missing) = match found.start {
            0 => ("after those of all parts", found.end..all),
            start => ("before those of all parts", 0..start),
        };
        return Err(PartError::Gap { place: place.to_owned(), missing, chunks: all }.into());
    }
    check_pictures(&options.pictures, &whole.question, &files)?;
    let answer = whole.findings.answer(survey.layout());
    let elapsed_seconds = start.elapsed().as_secs_f64();
    let asked = Asked { surrogate: &whole.surrogate, question: &whole.question, answer: &answer, elapsed_seconds };
    present(context, asked, &survey, None, &options.pictures)
}
