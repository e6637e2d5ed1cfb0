//! Hashes that say whether two studies ask the same question.

use std::fmt::Write;

use super::{FitMethod, FullExpansion, ModelSettings, MultiElement, Solver, Study};
use crate::digest::sha256;
use crate::input::Marginal;
use crate::model::CLUTCH_PARAMETERS;
use crate::spectrum::{Modes, Target};

pub(super) fn problem_hash(study: &Study) -> String {
    sha256(problem(study).as_bytes())
}

pub(super) fn study_hash(study: &Study) -> String {
    let mut text = problem(study);
    let Study { name, seed, design, fit, .. } = study;
    let _ = writeln!(text, "name {name}\nseed {seed}");
    let _ = writeln!(text, "design {} {} {} {}", design.kind.name(), design.initial, design.step, design.maximum);
    let method = &fit.method;
    let _ = write!(text, "fit {} {}", method.name(), method.max_degree());
    if let FitMethod::Stepwise(stepwise) = method {
        let _ = write!(text, " {:?}", stepwise.q_norm);
    }
    match method {
        FitMethod::Gpc(FullExpansion { solver: Solver::Quadrature, .. }) => text.push_str(" quadrature"),
        FitMethod::Gpc(FullExpansion { solver: Solver::LeastSquares { oversampling }, .. }) => {
            let _ = write!(text, " least-squares {oversampling:?}");
        }
        FitMethod::MultiElement(MultiElement { theta_1, theta_2, gamma, elements, .. }) => {
            let _ = write!(text, " {theta_1:?} {theta_2:?} {gamma:?} {elements}");
        }
        _ => {}
    }
    if let Some(s2_target) = method.s2_target() {
        let _ = write!(text, " {s2_target:?}");
    }
    if let FitMethod::Stepwise(stepwise) = method {
        let _ = write!(text, " {:?} {:?}", stepwise.epsilon_forward, stepwise.epsilon_backward);
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

/// What has one true answer, as text, one fact a line: constants with the nominal values that the study left alone,
/// inputs in the order that gives them meaning, numbers by their shortest exact decimal.
fn problem(study: &Study) -> String {
    let ModelSettings::Clutch { constants } = &study.model;
    let mut text = format!("model {}\n", study.model.kind());
    for parameter in CLUTCH_PARAMETERS {
        if study.inputs.names().all(|input| input != parameter.name) {
            let given = constants.iter().find(|(name, _)| name == parameter.name).map(|(_, value)| *value);
            let _ = writeln!(text, "constant {} {:?}", parameter.name, given.unwrap_or(parameter.nominal));
        }
    }
    for input in study.inputs.inputs() {
        let Marginal::Uniform(uniform) = &input.marginal;
        let _ = writeln!(text, "input {} uniform {:?} {:?}", input.name, uniform.lower(), uniform.upper());
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
