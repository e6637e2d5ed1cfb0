//! A study as a file: every key present and explained.

use std::fmt::Write;

use super::dependence::KIND;
use super::model::{self, unit_of};
use super::{DependenceSettings, DesignKind, Measure, STUDY_FORMAT, Study};
use crate::fitting::fit::method::{Design, MethodSetting, Value};
use crate::mechanics::spectrum::{Modes, Target};
use pcc_evaluate::components::Margin;
use pcc_evaluate::probability::inputs::{Marginal, Source};

/// Column at which explanations start.
const COMMENT_COLUMN: usize = 34;

pub(super) fn study(study: &Study) -> String {
    let mut file = Printer::default();
    file.line("format", STUDY_FORMAT, "of this file");
    file.line("name", format!("{:?}", study.name), "also names the files built from it");
    file.line("seed", study.seed, "of the design");
    model::print(&mut file, &study.model, study.data.as_ref());
    inputs(&mut file, study);
    dependence(&mut file, study);

    file.table("spectrum");
    let modes = match &study.spectrum.modes {
        Modes::All => "\"all\"".to_owned(),
        Modes::Ranks(ranks) => format!("{ranks:?}"),
        Modes::Band(_) => String::new(),
    };
    let expanded = match study.spectrum.target {
        Target::Eigenvalues => "what is expanded: Re and Im of each mode",
        Target::Invariants => "what is expanded: symmetric functions of modes that come close",
    };
    file.line("target", format!("{:?}", study.spectrum.target.name()), expanded);
    match study.spectrum.modes {
        Modes::Band([lower, upper]) => {
            let band = format!("[{}, {}]", float(lower), float(upper));
            file.line("frequencies", band, "modes by their frequency in the middle of the inputs, in Hz");
        }
        _ => file.line("modes", modes, "by frequency rank from 1, or \"all\" that oscillate"),
    }
    if let Some(count) = study.spectrum.rigid_body_modes {
        file.line("rigid_body_modes", count, "eigenvalues that are zero: the body is free to move");
    }
    match study.spectrum.margin {
        margin if margin.is_none() => {}
        Margin::GrowthRate(rate) => file.line("margin", float(rate), "1/s; stable means Re λ below minus this"),
        Margin::DampingRatio(ratio) => {
            let text = format!("{{ damping_ratio = {} }}", float(ratio));
            file.line("margin", text, "stable means every damping ratio above this");
        }
    }
    if study.spectrum.noise > 0.0 {
        file.line("noise", float(study.spectrum.noise), "relative error of the model's eigenvalues");
    }

    file.table("design");
    let kind = match study.design.kind {
        DesignKind::NestedLhs => "nested Latin hypercube levels",
        DesignKind::NestedMaximinLhs => "nested Latin hypercube levels, points spread apart",
        DesignKind::TensorGauss => "the nodes of a tensor Gauss rule",
    };
    file.line("kind", format!("{:?}", study.design.kind.name()), kind);
    let runs = study.design.initial;
    match study.fit.method.profile().design {
        Design::Oversampled(_) | Design::Quadrature => {
            file.comment(&format!("takes {runs} model runs, by the degree"));
        }
        Design::QuadraturePerElement => file.comment(&format!("takes {runs} model runs per element, by the degree")),
        Design::Growing => {
            file.line("initial", runs, "model runs of the first level");
            file.line("step", study.design.step, "model runs added by each enrichment");
        }
    }
    file.line("maximum", study.design.maximum, "model runs never exceeded");

    file.table("fit");
    fit(&mut file, study);
    file.text
}

fn fit(file: &mut Printer, study: &Study) {
    let fit = &study.fit;
    let profile = fit.method.profile();
    file.line("method", format!("{:?}", profile.name), profile.explanation);
    file.line("max_degree", profile.max_degree, profile.degree);
    for MethodSetting { key, value, explanation } in profile.settings {
        let value = match value {
            Value::Whole(value) => value.to_string(),
            Value::Number(value) => float(value),
            Value::Word(word) => format!("{word:?}"),
        };
        file.line(key, value, explanation);
    }
    if study.spectrum.target != Target::Eigenvalues && fit.method.can_use_derivatives() {
        let used =
            if study.uses_derivatives() { "used in the fit: r + 1 equations per run" } else { "not used in the fit" };
        file.line("derivatives", fit.derivatives.describe(), used);
    }
    let tolerance =
        "estimated error of the share p of stable cases that is small enough, as a fraction of √(p (1 − p))";
    match fit.proportion_tolerance {
        Some(value) => file.line("proportion_tolerance", float(value), tolerance),
        None if fit.method.has_fixed_design() => {}
        None => file.line("# proportion_tolerance", "0.0005", &format!("{tolerance}; not used unless written")),
    }
    enrich(file, study);
}

/// Runs beside those of the design are made for the tolerance.
fn enrich(file: &mut Printer, study: &Study) {
    if study.fit.proportion_tolerance.is_some() {
        let explanation = "runs near the boundary where the rarer side is rare or not seen; or \"none\"";
        file.line("enrich", format!("{:?}", study.fit.enrich.name()), explanation);
        let names: Vec<&str> = study.fit.shares.iter().map(|verdict| verdict.name()).collect();
        file.line("shares", format!("{names:?}"), "further shares that the tolerance is of, like [\"divergence\"]");
    }
}

fn inputs(file: &mut Printer, study: &Study) {
    file.table("inputs");
    for input in study.inputs.inputs() {
        let parameters = parameters(&input.marginal);
        let description = &input.description;
        let given = [("unit", description.unit()), ("label", description.label())];
        let texts: String =
            given.into_iter().filter_map(|(key, value)| Some(format!(", {key} = {}", text(value?)))).collect();
        let unit = if description.unit().is_some() { "" } else { unit_of(&study.model, &input.name) };
        let polynomials = input.marginal.chosen_polynomials();
        let polynomials = polynomials.map(|chosen| format!(", polynomials = {:?}", chosen.name())).unwrap_or_default();
        let value = format!("{{ distribution = \"{}\"{parameters}{polynomials}{texts} }}", input.marginal.name());
        file.line(&input.name, value, unit);
    }
}

fn dependence(file: &mut Printer, study: &Study) {
    let Some(DependenceSettings { measure, pairs }) = &study.dependence else { return };
    file.table("dependence");
    file.line("kind", format!("\"{KIND}\""), "of inputs; pairs that are not listed are independent");
    let names: Vec<&str> = study.inputs.names().collect();
    let pair = |&(one, other, value): &(usize, usize, f64)| {
        format!("[{}, {}, {}]", text(names[one]), text(names[other]), float(value))
    };
    let explanation = match measure {
        Measure::Spearman => "correlations of ranks",
        Measure::Pearson => "correlations of values",
    };
    file.line(measure.name(), format!("[{}]", pairs.iter().map(pair).collect::<Vec<_>>().join(", ")), explanation);
}

/// The parameters of a law as they are given.
fn parameters(law: &Marginal) -> String {
    let list = |wanted: &str| {
        let values = law.parameters().into_iter().filter(|(name, _)| *name == wanted);
        values.map(|(_, value)| float(value)).collect::<Vec<_>>().join(", ")
    };
    let number = |(key, value): (&str, f64)| format!(", {key} = {}", float(value));
    match law.source() {
        Some(Source { file, column }) => {
            let column = column.as_ref().map(|column| format!(", column = {}", text(column))).unwrap_or_default();
            let smoothing = if law.is_discrete() { ", smoothing = \"none\"" } else { "" };
            let bounds = law.parameters().into_iter().filter(|(name, _)| ["lower", "upper"].contains(name));
            format!(", file = {}{column}{smoothing}{}", text(file), bounds.map(number).collect::<String>())
        }
        None if law.is_discrete() => format!(", values = [{}], weights = [{}]", list("value"), list("weight")),
        None => law.parameters().into_iter().map(number).collect(),
    }
}

/// A text in quotes, as TOML writes it.
fn text(value: &str) -> String {
    toml::Value::from(value).to_string()
}

/// Shortest text that reads back as the same number, always with a point or an exponent.
pub(super) fn float(value: f64) -> String {
    format!("{value:?}")
}

#[derive(Default)]
pub(super) struct Printer {
    text: String,
}

impl Printer {
    pub(super) fn table(&mut self, name: &str) {
        let _ = write!(self.text, "\n[{name}]\n");
    }

    pub(super) fn comment(&mut self, text: &str) {
        let _ = writeln!(self.text, "# {text}");
    }

    pub(super) fn line(&mut self, key: &str, value: impl std::fmt::Display, comment: &str) {
        let is_bare = |c: char| c.is_ascii_alphanumeric() || "_-# ".contains(c);
        let key = if key.chars().all(is_bare) { key.to_owned() } else { format!("\"{key}\"") };
        let mut line = format!("{key} = {value}");
        if !comment.is_empty() {
            let width = COMMENT_COLUMN.saturating_sub(line.chars().count() + 1);
            let _ = write!(line, "{:width$} # {comment}", "");
        }
        self.text.push_str(&line);
        self.text.push('\n');
    }
}
