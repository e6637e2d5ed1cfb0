//! `pcc reproduce`

use crate::cli::overwrite::{Output, PICTURE, REPRODUCTION_PAGE, claim};
use crate::cli::shared_options::{run_count, seed};
use crate::cli::messages::complain;
use crate::cli::{Context, Ending, about};
use crate::report::{figure_sheets, short_table_2};
use crate::reproduce::{Options as Parts, Reproduction, Row};
use anyhow::Context as _;
use clap::{Args, ValueEnum};
use pcc_evaluate::foundation::save;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc reproduce                             all of it, into reproduction/
  pcc reproduce --only figure3 -o figures   figure 3 alone";

/// Reproduce the paper: its table 2 and figures 3 and 4, and what lies beyond
///
/// Builds the clutch by full, multi-element and sparse expansions of its eigenvalues and of invariants, for one to
/// eight uncertain parameters, compares all with the model on the same points, and writes table2.csv, table2.md, the
/// figures as SVG and report.html; files of these names in DIR are replaced. Takes about half a minute on two cores. If
/// it is interrupted, the rows that are done are kept until the next run, in table2.partial.csv if there was a table
/// already.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
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
pub(in crate::cli) enum Part {
    /// All methods compared
    Table2,
    /// Coalescence of the two modes
    Figure3,
    /// Growth rates by model and surrogate
    Figure4,
}

/// What `table2.csv` starts with.
const ROWS: &str = "r,method,order,direct_computations";

/// The files that are written, and what each has near its start.
fn targets(wanted: &Parts) -> Vec<(&'static str, &'static str)> {
    let mut targets = vec![("report.html", REPRODUCTION_PAGE)];
    if wanted.table_2 {
        let table = [("table2.csv", ROWS), ("table2.partial.csv", ROWS), ("table2.md", "# Table 2 of Kieu")];
        targets.extend(table);
        targets.push(("errors.svg", PICTURE));
    }
    if wanted.figure_3 {
        targets.push(("figure3.svg", PICTURE));
    }
    if wanted.figure_4 {
        targets.push(("figure4.svg", PICTURE));
    }
    targets
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let wants = |part| options.only.is_none_or(|only| only == part);
    let wanted = Parts {
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
        claim(&folder.join(name), Output::Marked(mark), &[])?;
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
                return Err(about("reproduce", error));
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
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(in crate::cli) struct Reproduced {
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
