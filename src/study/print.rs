//! A study as a file: every key present and explained.

use std::fmt::Write;

use super::{FitMethod, ModelSettings, STUDY_FORMAT, Study};
use crate::input::Marginal;
use crate::model::CLUTCH_PARAMETERS;
use crate::spectrum::Modes;

/// Column at which explanations start.
const COMMENT_COLUMN: usize = 34;

pub(super) fn study(study: &Study) -> String {
    let mut file = Printer::default();
    file.line("format", STUDY_FORMAT, "of this file");
    file.line("name", format!("{:?}", study.name), "also names the files built from it");
    file.line("seed", study.seed, "of the design");
    model(&mut file, &study.model);
    inputs(&mut file, study);

    file.table("spectrum");
    let modes = match &study.spectrum.modes {
        Modes::All => "\"all\"".to_owned(),
        Modes::Ranks(ranks) => format!("{ranks:?}"),
    };
    file.line("target", format!("{:?}", study.spectrum.target.name()), "what is expanded: Re and Im of each mode");
    file.line("modes", modes, "by frequency rank from 1, or \"all\" that oscillate");

    file.table("design");
    file.line("kind", format!("{:?}", study.design.kind.name()), "nested Latin hypercube levels");
    file.line("initial", study.design.initial, "model runs of the first level");
    file.line("step", study.design.step, "model runs added by each enrichment");
    file.line("maximum", study.design.maximum, "model runs never exceeded");

    file.table("fit");
    let fit = &study.fit;
    file.line("method", format!("{:?}", FitMethod::Stepwise.name()), "the paper's algorithm");
    file.line("max_degree", fit.max_degree, "p_max");
    file.line("q_norm", float(fit.q_norm), "q of the hyperbolic index sets, above 0 and at most 1");
    file.line("s2_target", float(fit.s2_target), "leave-one-out S² that is accurate enough");
    file.line("epsilon_forward", float(fit.epsilon_forward), "ε₁: a term is kept if it raises R² by this");
    file.line("epsilon_backward", float(fit.epsilon_backward), "ε₂: a term is dropped if that lowers R² by less");
    file.text
}

fn model(file: &mut Printer, model: &ModelSettings) {
    let ModelSettings::Clutch { constants } = model;
    file.table("model");
    file.line("kind", format!("{:?}", model.kind()), "");
    if !constants.is_empty() {
        file.table("model.constants");
    }
    for (name, value) in constants {
        let unit = CLUTCH_PARAMETERS.iter().find(|parameter| parameter.name == name).map_or("", |p| p.unit);
        file.line(name, float(*value), unit);
    }
}

fn inputs(file: &mut Printer, study: &Study) {
    file.table("inputs");
    for input in study.inputs.inputs() {
        let Marginal::Uniform(uniform) = &input.marginal;
        let (lower, upper) = (float(uniform.lower()), float(uniform.upper()));
        let unit = CLUTCH_PARAMETERS.iter().find(|parameter| parameter.name == input.name).map_or("", |p| p.unit);
        let value = format!("{{ distribution = \"uniform\", lower = {lower}, upper = {upper} }}");
        file.line(&input.name, value, unit);
    }
}

/// Shortest text that reads back as the same number, always with a point or an exponent.
fn float(value: f64) -> String {
    format!("{value:?}")
}

#[derive(Default)]
struct Printer {
    text: String,
}

impl Printer {
    fn table(&mut self, name: &str) {
        let _ = write!(self.text, "\n[{name}]\n");
    }

    fn line(&mut self, key: &str, value: impl std::fmt::Display, comment: &str) {
        let mut line = format!("{key} = {value}");
        if !comment.is_empty() {
            let width = COMMENT_COLUMN.saturating_sub(line.chars().count() + 1);
            let _ = write!(line, "{:width$} # {comment}", "");
        }
        self.text.push_str(&line);
        self.text.push('\n');
    }
}
