//! The model of a study as a file.

use super::print::{Printer, float};
use super::{Command, ModelSettings, Table};
use crate::mechanics::model::CLUTCH_PARAMETERS;
use crate::mechanics::model::command::{Keep, Mode};
use crate::mechanics::model::matrices::{Description, Entry, Form, Layout, Term};

pub(super) fn model(file: &mut Printer, model: &ModelSettings) {
    file.table("model");
    file.line("kind", format!("{:?}", model.kind()), "");
    let constants = match model {
        ModelSettings::Clutch { constants } => constants,
        ModelSettings::Matrices(description) => {
            matrices(file, description);
            &description.constants
        }
        ModelSettings::Command(settings) => {
            command(file, settings);
            &settings.answers.constants
        }
        ModelSettings::Table(settings) => {
            table(file, settings);
            &settings.constants
        }
    };
    if !constants.is_empty() {
        file.table("model.constants");
    }
    for (name, value) in constants {
        file.line(name, float(*value), unit_of(model, name));
    }
    if let ModelSettings::Matrices(description) = model {
        helpers(file, description);
    }
}

/// The unit of an input or constant, if it is known.
pub(super) fn unit_of(model: &ModelSettings, name: &str) -> &'static str {
    match model {
        ModelSettings::Clutch { .. } => {
            CLUTCH_PARAMETERS.iter().find(|parameter| parameter.name == name).map_or("", |parameter| parameter.unit)
        }
        _ => "",
    }
}

fn command(file: &mut Printer, settings: &Command) {
    let arguments: Vec<String> = settings.arguments.iter().map(|argument| quoted(argument)).collect();
    let meaning = if settings.shell { "a line for the shell" } else { "the program and its arguments; no shell" };
    file.line("command", format!("[{}]", arguments.join(", ")), meaning);
    file.line("shell", settings.shell, "whether command is a line for the shell");
    table(file, &settings.answers);
    let (mode, meaning) = match settings.mode {
        Mode::Each => ("each", "a process for each run: params.json in, results.json out; or \"batch\""),
        Mode::Batch => ("batch", "a process for many runs: points.csv in, results.csv out; or \"each\""),
    };
    file.line("mode", format!("{mode:?}"), meaning);
    file.line("jobs", settings.jobs, "processes at once");
    match settings.timeout {
        Some(seconds) => file.line("timeout", float(seconds), "seconds after which a process is stopped"),
        None => file.line("# timeout", "600.0", "seconds after which a process is stopped; no limit unless written"),
    }
    file.line("retries", settings.retries, "further attempts at a run that failed");
    file.line("work", quoted(&settings.work_folder), "folder for the folders of runs");
    let keep = match settings.keep {
        Keep::Failed => "failed",
        Keep::Always => "always",
        Keep::Never => "never",
    };
    file.line("keep", format!("{keep:?}"), "which of them are kept: \"failed\", \"always\", \"never\"");
}

fn table(file: &mut Printer, settings: &Table) {
    file.line("eigenvalues", settings.eigenvalues, "that each run answers");
    let policy = if settings.skips_failures { "skip" } else { "stop" };
    file.line("on_failure", format!("{policy:?}"), "of a run: \"stop\" the build, or \"skip\" the run and report it");
    file.line("version", quoted(&settings.version), "change it when the program answers otherwise");
}

fn matrices(file: &mut Printer, description: &Description) {
    for matrix in &description.matrices {
        let name = matrix.role.name();
        match &matrix.terms[..] {
            [Term { factor: None, form: Form::General, layout: Layout::Rows(rows) }] => {
                let rows: Vec<String> = rows.iter().map(|row| format!("    {},\n", list(row))).collect();
                file.line(name, format!("[\n{}]", rows.concat()), "");
            }
            [term] => file.line(name, inline(term), ""),
            terms => {
                let terms: Vec<String> = terms.iter().map(|term| format!("    {},\n", inline(term))).collect();
                file.line(name, format!("[\n{}]", terms.concat()), "");
            }
        }
    }
}

fn helpers(file: &mut Printer, description: &Description) {
    if !description.helpers.is_empty() {
        file.table("model.let");
    }
    for (name, text) in &description.helpers {
        file.line(name, quoted(text), "");
    }
}

/// A term as a table in one line.
fn inline(term: &Term) -> String {
    let mut parts = Vec::new();
    match &term.layout {
        Layout::Rows(rows) => {
            let rows: Vec<String> = rows.iter().map(|row| list(row)).collect();
            parts.push(format!("rows = [{}]", rows.join(", ")));
        }
        Layout::Diagonal(entries) => parts.push(format!("diagonal = {}", list(entries))),
        Layout::Entries { size, list } => {
            let entries: Vec<String> =
                list.iter().map(|(row, column, value)| format!("[{row}, {column}, {}]", entry(value))).collect();
            parts.push(format!("size = {size}, entries = [{}]", entries.join(", ")));
        }
        Layout::File { name, .. } => parts.push(format!("file = {}", quoted(name))),
    }
    if term.form != Form::General {
        parts.push(format!("form = {:?}", term.form.name()));
    }
    if let Some(factor) = &term.factor {
        parts.push(format!("factor = {}", entry(factor)));
    }
    format!("{{ {} }}", parts.join(", "))
}

fn list(entries: &[Entry]) -> String {
    format!("[{}]", entries.iter().map(entry).collect::<Vec<_>>().join(", "))
}

fn entry(entry: &Entry) -> String {
    match entry {
        Entry::Number(value) => float(*value),
        Entry::Expression(text) => quoted(text),
    }
}

/// A text as TOML writes it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
