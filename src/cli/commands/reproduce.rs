//! `pcc reproduce`

use super::super::arguments::{Part, Reproduce};
use super::super::{Context, Ending, complain};
use super::{REPRODUCTION_PAGE, interruptible, keep_unmarked_files};
use crate::report::{figure_sheets, short_table_2};
use crate::reproduce::{Options, Reproduction, Row};
use anyhow::Context as _;
use pcc_evaluate::foundation::{check_writable, save};
use serde::Serialize;
use std::fmt;
use std::path::Path;
use std::time::Instant;

/// What `table2.csv` starts with.
const ROWS: &str = "r,method,order,direct_computations";

/// What figures have near their start.
const SHEET: &str = "sheet-title";

/// The files that are written, and what each has near its start.
fn targets(wanted: &Options) -> Vec<(&'static str, &'static str)> {
    let mut targets = vec![("report.html", REPRODUCTION_PAGE)];
    if wanted.table_2 {
        let table = [("table2.csv", ROWS), ("table2.partial.csv", ROWS), ("table2.md", "# Table 2 of Kieu")];
        targets.extend(table);
        targets.push(("errors.svg", SHEET));
    }
    if wanted.figure_3 {
        targets.push(("figure3.svg", SHEET));
    }
    if wanted.figure_4 {
        targets.push(("figure4.svg", SHEET));
    }
    targets
}

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
    for (name, mark) in targets(&wanted) {
        keep_unmarked_files(&folder.join(name), mark)?;
        check_writable(&folder.join(name))?;
    }
    let start = Instant::now();
    let mut work = Reproduction::new(wanted);
    // A table that is there already is replaced by a complete one only.
    let complete = folder.join("table2.csv");
    let partial = if complete.exists() { folder.join("table2.partial.csv") } else { complete.clone() };
    loop {
        match work.step(&context.terminal) {
            Ok(true) => save_rows(&partial, &work)?,
            Ok(false) => break,
            Err(error) => {
                match save_rows(&partial, &work) {
                    Ok(()) if work.rows.is_empty() => {}
                    Ok(()) => {
                        complain(&format!("{} rows that were done are in {}", work.rows.len(), partial.display()))
                    }
                    Err(lost) => complain(&format!("the rows that were done could not be kept: {lost:#}")),
                }
                return Err(interruptible(error.clone(), error.is_interruption(), "reproduce"));
            }
        }
    }
    let mut files = Vec::new();
    if wanted.table_2 {
        save_rows(&complete, &work)?;
        if partial != complete {
            let _ = std::fs::remove_file(&partial); // what it held is in the complete table
        }
        let markdown = folder.join("table2.md");
        save(&markdown, work.to_markdown().as_bytes())?;
        files.extend([complete, markdown]);
    }
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

/// Writes the rows that are done; nothing without rows.
fn save_rows(path: &Path, work: &Reproduction) -> anyhow::Result<()> {
    if work.rows.is_empty() {
        return Ok(());
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    work.rows.iter().try_for_each(|row| writer.serialize(row))?;
    Ok(save(path, &writer.into_inner()?)?)
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
        for (number, table) in short_table_2(&self.rows).iter().enumerate() {
            let heading = ["table 2: the paper's methods, with the paper's figures", "the same methods on invariants"];
            writeln!(f, "{}\n\n{table}", heading[number.min(1)])?;
        }
        if !self.rows.is_empty() {
            writeln!(f, "errors in percent; those of means and variances are in table2.md and table2.csv")?;
        }
        writeln!(f, "{:.1} s; written:", self.elapsed_seconds)?;
        self.files.iter().try_for_each(|file| writeln!(f, "  {file}"))
    }
}
