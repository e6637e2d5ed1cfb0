//! A study as a file: every key present and explained.

use std::fmt::Write;

use super::print_model::{self, unit_of};
use super::{DesignKind, FitMethod, FullExpansion, MultiElement, STUDY_FORMAT, Solver, Study};
use crate::mechanics::spectrum::{Modes, Target};

/// Column at which explanations start.
const COMMENT_COLUMN: usize = 34;

pub(super) fn study(study: &Study) -> String {
    let mut file = Printer::default();
    file.line("format", STUDY_FORMAT, "of this file");
    file.line("name", format!("{:?}", study.name), "also names the files built from it");
    file.line("seed", study.seed, "of the design");
    print_model::model(&mut file, &study.model);
    inputs(&mut file, study);

    file.table("spectrum");
    let modes = match &study.spectrum.modes {
        Modes::All => "\"all\"".to_owned(),
        Modes::Ranks(ranks) => format!("{ranks:?}"),
    };
    let expanded = match study.spectrum.target {
        Target::Eigenvalues => "what is expanded: Re and Im of each mode",
        Target::Invariants => "what is expanded: symmetric functions of modes that come close",
    };
    file.line("target", format!("{:?}", study.spectrum.target.name()), expanded);
    file.line("modes", modes, "by frequency rank from 1, or \"all\" that oscillate");

    file.table("design");
    let kind = match study.design.kind {
        DesignKind::NestedLhs => "nested Latin hypercube levels",
        DesignKind::NestedMaximinLhs => "nested Latin hypercube levels, points spread apart",
        DesignKind::TensorGauss => "the nodes of a tensor Gauss rule",
    };
    file.line("kind", format!("{:?}", study.design.kind.name()), kind);
    let runs = study.design.initial;
    match study.fit.method {
        FitMethod::Gpc(_) => file.comment(&format!("takes {runs} model runs, by the degree")),
        FitMethod::MultiElement(_) => file.comment(&format!("takes {runs} model runs per element, by the degree")),
        _ => {
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
    let (explanation, degree) = match fit.method {
        FitMethod::Stepwise(_) => ("the paper's algorithm", "p_max"),
        FitMethod::Omp(_) => ("orthogonal matching pursuit", "of the candidates"),
        FitMethod::MinimumNorm(_) => ("weighted minimum norm", "in each input"),
        FitMethod::Auto(_) => ("the better of minimum-norm and omp", "in each input"),
        FitMethod::Gpc(_) => ("full expansion", "total degree p"),
        FitMethod::MultiElement(_) => ("full expansions on elements", "total degree p in each element"),
    };
    file.line("method", format!("{:?}", fit.method.name()), explanation);
    file.line("max_degree", fit.method.max_degree(), degree);
    if let FitMethod::Stepwise(stepwise) = &fit.method {
        file.line("q_norm", float(stepwise.q_norm), "q of the hyperbolic index sets, above 0 and at most 1");
    }
    if let Some(s2_target) = fit.method.s2_target() {
        file.line("s2_target", float(s2_target), "leave-one-out S² that is accurate enough");
    }
    match &fit.method {
        FitMethod::Gpc(settings) => full_expansion(file, settings),
        FitMethod::MultiElement(settings) => multi_element(file, settings),
        _ => {}
    }
    if let FitMethod::Stepwise(stepwise) = &fit.method {
        let (forward, backward) = (float(stepwise.epsilon_forward), float(stepwise.epsilon_backward));
        file.line("epsilon_forward", forward, "ε₁: a term is kept if it raises R² by this");
        file.line("epsilon_backward", backward, "ε₂: a term is dropped if that lowers R² by less");
    }
    if study.spectrum.target != Target::Eigenvalues && fit.method.can_use_derivatives() {
        let used =
            if study.uses_derivatives() { "used in the fit: r + 1 equations per run" } else { "not used in the fit" };
        file.line("derivatives", fit.derivatives.describe(), used);
    }
    let tolerance = "estimated relative error of the stability proportion that is small enough";
    match fit.proportion_tolerance {
        Some(value) => file.line("proportion_tolerance", float(value), tolerance),
        None if fit.method.has_fixed_design() => {}
        None => file.line("# proportion_tolerance", "0.001", &format!("{tolerance}; not used unless written")),
    }
}

fn full_expansion(file: &mut Printer, settings: &FullExpansion) {
    match settings.solver {
        Solver::Quadrature => file.line("solver", "\"quadrature\"", "(p + 1)^r model runs; or \"least-squares\""),
        Solver::LeastSquares { oversampling } => {
            file.line("solver", "\"least-squares\"", "or \"quadrature\"");
            file.line("oversampling", float(oversampling), "equations per term");
        }
    }
}

fn multi_element(file: &mut Printer, settings: &MultiElement) {
    file.line("theta_1", float(settings.theta_1), "θ₁: elements with η^γ × probability from here on are divided");
    file.line(
        "theta_2",
        float(settings.theta_2),
        "θ₂: along inputs with this part of the largest share of the highest order",
    );
    file.line("gamma", float(settings.gamma), "γ: exponent of the decay rate η");
    file.line("elements", settings.elements, "at most");
}

fn inputs(file: &mut Printer, study: &Study) {
    file.table("inputs");
    for input in study.inputs.inputs() {
        let parameters: String =
            input.marginal.parameters().into_iter().map(|(key, value)| format!(", {key} = {}", float(value))).collect();
        let unit = unit_of(&study.model, &input.name);
        let value = format!("{{ distribution = \"{}\"{parameters} }}", input.marginal.name());
        file.line(&input.name, value, unit);
    }
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
