//! Hashes that say whether two studies ask the same question.

use std::fmt::Write;

use super::model::identity;
use super::settings::Enrich;
use super::{DependenceSettings, Study};
use crate::fitting::fit::method::Value;
use crate::mechanics::spectrum::{Modes, Target};
use pcc_evaluate::components::Margin;
use pcc_evaluate::foundation::{hexadecimal, sha256, sha256_bytes};
use pcc_evaluate::probability::inputs::Marginal;

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
    if fit.enrich != Enrich::default() {
        let _ = writeln!(text, "enrich {}", fit.enrich.name());
    }
    if !fit.shares.is_empty() {
        let names: Vec<&str> = fit.shares.iter().map(|verdict| verdict.name()).collect();
        let _ = writeln!(text, "shares {}", names.join(" "));
    }
    if let Some(data) = &study.data {
        let _ = writeln!(text, "data {} holdout {:?}", hexadecimal(&data.runs.digest()), data.holdout);
    }
    if let Some(tolerance) = fit.proportion_tolerance {
        let _ = writeln!(text, "proportion tolerance {tolerance:?}");
    }
    sha256(text.as_bytes())
}

pub(super) fn model_hash(study: &Study) -> [u8; 32] {
    let mut text = identity(&study.model, &study.inputs);
    for name in study.inputs.names() {
        let _ = writeln!(text, "input {name}");
    }
    sha256_bytes(text.as_bytes())
}

/// What has one true answer, as text: the model, its inputs in the order that gives them meaning, and what of the
/// spectrum is asked.
fn problem(study: &Study) -> String {
    let mut text = identity(&study.model, &study.inputs);
    for input in study.inputs.inputs() {
        let _ = write!(text, "input {} {}", input.name, input.marginal.name());
        // Uniform inputs were alone once; other laws can have the same numbers of different names.
        let is_uniform = matches!(input.marginal, Marginal::Uniform(_));
        for (name, value) in input.marginal.parameters() {
            let _ = if is_uniform { write!(text, " {value:?}") } else { write!(text, " {name} {value:?}") };
        }
        text.push('\n');
    }
    // As it is given: what follows from it may differ between machines in the last bit.
    if let Some(DependenceSettings { measure, pairs }) = &study.dependence {
        let names: Vec<&str> = study.inputs.names().collect();
        for &(one, other, value) in pairs {
            let _ = writeln!(text, "{} {} {} {value:?}", measure.name(), names[one], names[other]);
        }
    }
    let _ = writeln!(text, "target {}", study.spectrum.target.name());
    match &study.spectrum.modes {
        Modes::All => text.push_str("modes all\n"),
        Modes::Ranks(ranks) => {
            let _ = writeln!(text, "modes {ranks:?}");
        }
        Modes::Band([lower, upper]) => {
            let _ = writeln!(text, "frequencies {lower:?} {upper:?}");
        }
    }
    // What has its default says nothing, so that studies keep their hash.
    if let Some(count) = study.spectrum.rigid_body_modes {
        let _ = writeln!(text, "rigid-body modes {count}");
    }
    match study.spectrum.margin {
        margin if margin.is_none() => {}
        Margin::GrowthRate(rate) => {
            let _ = writeln!(text, "margin {rate:?}");
        }
        Margin::DampingRatio(ratio) => {
            let _ = writeln!(text, "margin of the damping ratio {ratio:?}");
        }
    }
    text
}
