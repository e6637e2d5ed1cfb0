//! Hashes that say whether two studies ask the same question.

use std::fmt::Write;

use super::{ModelSettings, Study, Table};
use crate::fitting::fit::method::Value;
use crate::mechanics::model::CLUTCH_PARAMETERS;
use crate::mechanics::model::matrices::{Description, Layout, Term};
use crate::mechanics::spectrum::{Modes, Target};
use pcc_evaluate::foundation::{sha256, sha256_bytes};

pub(super) fn problem_hash(study: &Study) -> String {
    sha256(problem(study).as_bytes())
}

pub(super) fn study_hash(study: &Study) -> String {
    let mut text = problem(study);
    let Study { name, seed, design, fit, .. } = study;
    let _ = writeln!(text, "name {name}\nseed {seed}");
    let _ = writeln!(text, "design {} {} {} {}", design.kind.name(), design.initial, design.step, design.maximum);
    let profile = fit.method.profile();
    let _ = write!(text, "fit {} {}", profile.name, profile.max_degree);
    for setting in profile.settings {
        let _ = match setting.value {
            Value::Whole(value) => write!(text, " {value}"),
            Value::Number(value) => write!(text, " {value:?}"),
            Value::Word(word) => write!(text, " {word}"),
        };
    }
    text.push('\n');
    if study.spectrum.target != Target::Eigenvalues {
        let _ = writeln!(text, "derivatives {}", study.uses_derivatives());
    }
    if let Some(tolerance) = fit.proportion_tolerance {
        let _ = writeln!(text, "proportion tolerance {tolerance:?}");
    }
    sha256(text.as_bytes())
}

pub(super) fn model_hash(study: &Study) -> [u8; 32] {
    let mut text = model(study);
    for name in study.inputs.names() {
        let _ = writeln!(text, "input {name}");
    }
    sha256_bytes(text.as_bytes())
}

/// The model as text, one fact a line: for the clutch with the nominal values that the study left alone; numbers by
/// their shortest exact decimal, what users wrote as they wrote it.
fn model(study: &Study) -> String {
    let mut text = format!("model {}\n", study.model.kind());
    match &study.model {
        ModelSettings::Clutch { constants } => {
            for parameter in CLUTCH_PARAMETERS {
                if study.inputs.names().all(|input| input != parameter.name) {
                    let given = constants.iter().find(|(name, _)| name == parameter.name).map(|(_, value)| *value);
                    let _ = writeln!(text, "constant {} {:?}", parameter.name, given.unwrap_or(parameter.nominal));
                }
            }
        }
        ModelSettings::Matrices(description) => matrices(&mut text, description),
        // Not how and where it is run, but what.
        ModelSettings::Command(command) => {
            let _ = writeln!(text, "command {:?} {}", command.arguments, command.shell);
            answers(&mut text, &command.answers);
        }
        ModelSettings::Table(table) => answers(&mut text, table),
    }
    text
}

fn answers(text: &mut String, table: &Table) {
    let _ = writeln!(text, "eigenvalues {}\nversion {:?}", table.eigenvalues, table.version);
    for (name, value) in &table.constants {
        let _ = writeln!(text, "constant {name} {value:?}");
    }
}

fn matrices(text: &mut String, description: &Description) {
    for (name, value) in &description.constants {
        let _ = writeln!(text, "constant {name} {value:?}");
    }
    for (name, expression) in &description.helpers {
        let _ = writeln!(text, "let {name} {expression:?}");
    }
    for matrix in &description.matrices {
        for Term { factor, form, layout } in &matrix.terms {
            let _ = write!(text, "{} {} ", matrix.role.name(), form.name());
            match factor {
                None => text.push_str("1 "),
                Some(factor) => {
                    let _ = write!(text, "{factor:?} ");
                }
            }
            let _ = match layout {
                Layout::Rows(rows) => writeln!(text, "rows {rows:?}"),
                Layout::Diagonal(list) => writeln!(text, "diagonal {list:?}"),
                Layout::Entries { size, list } => writeln!(text, "entries {size} {list:?}"),
                // Not the name of the file, but what is in it.
                Layout::File { matrix, .. } => {
                    writeln!(text, "file {} {} {:?}", matrix.rows, matrix.columns, matrix.entries)
                }
            };
        }
    }
}

/// What has one true answer, as text: the model, its inputs in the order that gives them meaning, and what of the
/// spectrum is asked.
fn problem(study: &Study) -> String {
    let mut text = model(study);
    for input in study.inputs.inputs() {
        let _ = write!(text, "input {} {}", input.name, input.marginal.name());
        for (_, value) in input.marginal.parameters() {
            let _ = write!(text, " {value:?}");
        }
        text.push('\n');
    }
    let _ = writeln!(text, "target {}", study.spectrum.target.name());
    match &study.spectrum.modes {
        Modes::All => text.push_str("modes all\n"),
        Modes::Ranks(ranks) => {
            let _ = writeln!(text, "modes {ranks:?}");
        }
    }
    text
}
