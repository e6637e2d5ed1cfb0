//! Hashes that say whether two studies ask the same question.

use serde::Serialize;
use sha2::{Digest, Sha256};

use super::{ModelSettings, Study};
use crate::input::Marginal;
use crate::model::CLUTCH_PARAMETERS;
use crate::spectrum::Modes;

/// What has one true answer, in canonical form: names sorted or in the order that gives them meaning, numbers by their
/// shortest exact decimal, constants with the nominal values that the study left alone.
#[derive(Serialize)]
struct Problem<'a> {
    model: &'a str,
    constants: Vec<(&'a str, f64)>,
    inputs: Vec<(&'a str, &'a str, [f64; 2])>,
    target: &'a str,
    modes: Option<&'a [usize]>,
}

pub(super) fn problem_hash(study: &Study) -> String {
    let ModelSettings::Clutch { constants } = &study.model;
    let value_of = |name: &str| constants.iter().find(|(known, _)| known == name).map(|(_, value)| *value);
    let problem = Problem {
        model: study.model.kind(),
        constants: CLUTCH_PARAMETERS
            .iter()
            .filter(|parameter| study.inputs.names().all(|input| input != parameter.name))
            .map(|parameter| (parameter.name, value_of(parameter.name).unwrap_or(parameter.nominal)))
            .collect(),
        inputs: study
            .inputs
            .inputs()
            .iter()
            .map(|input| match &input.marginal {
                Marginal::Uniform(uniform) => (&*input.name, "uniform", [uniform.lower(), uniform.upper()]),
            })
            .collect(),
        target: study.spectrum.target.name(),
        modes: match &study.spectrum.modes {
            Modes::All => None,
            Modes::Ranks(ranks) => Some(ranks),
        },
    };
    let canonical = serde_json::to_vec(&problem).unwrap_or_default();
    hexadecimal(&Sha256::digest(canonical))
}

pub(super) fn study_hash(study: &Study) -> String {
    hexadecimal(&Sha256::digest(study.to_toml()))
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
