//! `pcc reproduce`

use super::super::arguments::{Part, Reproduce};
use super::super::{Context, Ending, complain};
use super::{interruptible, keep_other_pages};
use crate::artifact::{check_writable, save};
use crate::report::{figure_sheets, table_2};
use crate::reproduce::{Options, Reproduction, Row};
use anyhow::Context as _;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

pub(in super::super) fn reproduce(context: &Context, options: &Reproduce) -> anyhow::Result<Ending> {
    let wants = |part| options.only.is_none_or(|only| only == part);
    let wanted = Options {
        table_2: wants(Part::Table2),
        figure_3: wants(Part::Figure3),
        figure_4: wants(Part::Figure4),
        runs: options.runs,
        seed: options.seed,
    };
    let folder = &options.output;
    std::fs::create_dir_all(folder).with_context(|| format!("folder {} cannot be created", folder.display()))?;
    let page = folder.join("report.html");
    keep_other_pages(&page)?;
    check_writable(&page)?;
    let start = Instant::now();
    let mut work = Reproduction::new(wanted);
    loop {
        match work.step(&context.terminal) {
            Ok(true) => {
                save_table(folder, &work)?;
            }
            Ok(false) => break,
            Err(error) => {
                let kept = save_table(folder, &work)?;
                if let Some(file) = kept.first() {
                    complain(&format!("{} rows that were done are in {}", work.rows.len(), file.display()));
                }
                return Err(interruptible(error.clone(), error.is_interruption(), "reproduce"));
            }
        }
    }
    let mut files = save_table(folder, &work)?;
    for (name, svg) in figure_sheets(&work) {
        files.push(folder.join(name));
        save(&folder.join(name), svg.as_bytes())?;
    }
    save(&page, work.to_html().as_bytes())?;
    files.push(page);
    let files = files.iter().map(|file| file.display().to_string()).collect();
    context.print(&Reproduced { rows: work.rows, files, elapsed_seconds: start.elapsed().as_secs_f64() })?;
    Ok(Ending::Done)
}

/// Writes the rows that are done as CSV and Markdown; nothing without rows.
fn save_table(folder: &Path, work: &Reproduction) -> anyhow::Result<Vec<PathBuf>> {
    if work.rows.is_empty() {
        return Ok(Vec::new());
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    work.rows.iter().try_for_each(|row| writer.serialize(row))?;
    let (rows, markdown) = (folder.join("table2.csv"), folder.join("table2.md"));
    save(&rows, &writer.into_inner()?)?;
    let tables: Vec<String> = table_2(&work.rows).iter().map(|table| table.to_markdown()).collect();
    save(&markdown, tables.join("\n").as_bytes())?;
    Ok(vec![rows, markdown])
}

/// What was found and where it is.
#[derive(Debug, Serialize)]
struct Reproduced {
    rows: Vec<Row>,
    files: Vec<String>,
    elapsed_seconds: f64,
}

impl fmt::Display for Reproduced {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, table) in table_2(&self.rows).iter().enumerate() {
            let heading = ["table 2: the paper's methods", "the same methods on invariants"];
            writeln!(f, "{}\n\n{table}", heading[number.min(1)])?;
        }
        writeln!(f, "{:.1} s; written:", self.elapsed_seconds)?;
        self.files.iter().try_for_each(|file| writeln!(f, "  {file}"))
    }
}
