//! Checks that need no domain type: every number finite, and small helpers to say what is wrong.

use super::certificates::{self, AnyCertificates};
use super::error::ReadError;
use super::v1::{self, Document};
use super::v2;

/// The first section that holds a NaN or an infinity.
pub(super) fn not_finite(document: &Document) -> Option<&'static str> {
    let sections: [(&str, Vec<f64>); 12] = [
        ("inputs", document.inputs.inputs.iter().flat_map(input).chain(dependence(&document.inputs)).collect()),
        ("outputs", document.outputs.components().flat_map(|component| [component.center, component.scale]).collect()),
        ("elements", elements(&document.elements)),
        ("expansions", document.expansions.expansions.iter().flat_map(expansion).collect()),
        ("training", document.training.settings.iter().filter_map(setting).collect()),
        ("decision", decision(&document.decision)),
        ("self_test", self_test(&document.self_test)),
        (
            "certificates",
            document
                .certificates
                .iter()
                .cloned()
                .flat_map(AnyCertificates::into_latest)
                .flat_map(certificate)
                .collect(),
        ),
        ("verdict", document.verdict.iter().flat_map(verdict).collect()),
        ("coverage", document.coverage.iter().flat_map(coverage).collect()),
        ("domain", document.domain.iter().flat_map(domain).collect()),
        ("left_out", document.left_out.iter().flat_map(|section| section.runs.iter().flatten().copied()).collect()),
    ];
    sections.into_iter().find(|(_, numbers)| numbers.iter().any(|number| !number.is_finite())).map(|(name, _)| name)
}

fn input(input: &v1::Input) -> Vec<f64> {
    let mut numbers = match &input.distribution {
        v1::Distribution::Uniform { lower, upper } => vec![*lower, *upper],
        v1::Distribution::Law { parameters, .. } => parameters.iter().map(|parameter| parameter.value).collect(),
    };
    match &input.transform {
        v1::Transform::Affine { center, half_width } | v1::Transform::Exponential { center, half_width } => {
            numbers.extend([center, half_width]);
        }
        v1::Transform::Pieces { origin, scale, breaks, coefficients } => {
            numbers.extend([origin, scale]);
            numbers.extend(breaks.iter().chain(coefficients.iter().flatten()));
        }
    }
    numbers.extend(&input.recurrence.diagonal);
    numbers.extend(&input.recurrence.off_diagonal);
    numbers.extend(bounds(&input.bounds));
    numbers
}

fn dependence(inputs: &v1::Inputs) -> Vec<f64> {
    match &inputs.dependence {
        v1::Dependence::Independent => Vec::new(),
        v1::Dependence::GaussianCopula { correlations } => correlations.iter().map(|pair| pair.value).collect(),
    }
}

fn bounds(bounds: &Option<v1::Bounds>) -> impl Iterator<Item = f64> {
    bounds.iter().flat_map(|bounds| [bounds.lower, bounds.upper])
}

fn elements(elements: &v1::Elements) -> Vec<f64> {
    let mut numbers: Vec<f64> = elements.splits.iter().map(|split| split.at).collect();
    for element in &elements.elements {
        numbers.push(element.weight);
        for side in &element.sides {
            numbers.extend([side.center, side.half_width]);
            numbers.extend(bounds(&side.bounds));
        }
    }
    numbers
}

fn expansion(expansion: &v1::Expansion) -> Vec<f64> {
    let errors = [expansion.r2, expansion.s2, expansion.corrected_s2];
    expansion.coefficients.iter().copied().chain(errors.into_iter().flatten()).collect()
}

fn setting(setting: &v1::Setting) -> Option<f64> {
    match setting.value {
        v1::SettingValue::Number(number) => Some(number),
        _ => None,
    }
}

fn decision(decision: &v1::Decision) -> Vec<f64> {
    let quantiles = decision.max_re_residuals.iter().flat_map(|quantile| [quantile.level, quantile.value]);
    quantiles.chain(decision.proportion_error).collect()
}

fn self_test(self_test: &v1::SelfTest) -> Vec<f64> {
    let lists = self_test.points.iter().chain(&self_test.components).flatten();
    lists.chain(&self_test.max_re).copied().chain([self_test.tolerance]).collect()
}

fn certificate(certificate: certificates::Certificate) -> Vec<f64> {
    let others = certificate.marginal.iter().flat_map(|bounds| {
        [bounds.marginal_lower, bounds.marginal_upper, bounds.unstable_lower, bounds.unstable_upper]
    });
    let own = [certificate.level, certificate.lower, certificate.upper];
    own.into_iter().chain(others).chain(certificate.strata.iter().flat_map(strata)).collect()
}

fn strata(strata: &certificates::Strata) -> Vec<f64> {
    let assumed = match strata.assumed {
        certificates::Assumed::Upper(upper) => upper,
        certificates::Assumed::Withheld(_) => 0.0,
    };
    let own =
        [strata.side_level, strata.rare_lower, strata.rare_upper, strata.layer_depth, strata.largest_error, assumed];
    own.into_iter().chain(strata.thinning.iter().map(|tail| tail.error)).collect()
}

fn verdict(verdict: &v2::Verdict) -> Vec<f64> {
    let band = verdict.band.iter().flat_map(|band| [band.lower, band.upper]);
    [verdict.tolerance, verdict.margin.value].into_iter().chain(band).collect()
}

fn coverage(coverage: &v2::Coverage) -> Vec<f64> {
    coverage.answered.iter().chain(&coverage.unanswered).flatten().copied().collect()
}

fn domain(domain: &v2::Domain) -> Vec<f64> {
    domain.inputs.iter().flatten().flat_map(|side| [side.lower, side.upper]).collect()
}

/// Fails with `message` unless `holds`.
pub(super) fn ensure(section: &'static str, holds: bool, message: impl FnOnce() -> String) -> Result<(), ReadError> {
    if holds { Ok(()) } else { Err(ReadError::Meaning { section, message: message() }) }
}

/// Whether `hash` is a hexadecimal SHA-256.
pub(super) fn is_hash(hash: &str) -> bool {
    hash.len() == 64 && hash.bytes().all(|byte| byte.is_ascii_hexdigit() && !byte.is_ascii_uppercase())
}

/// Whether `text` can be shown on a terminal without commanding it.
pub(super) fn is_printable(text: &str) -> bool {
    !text.chars().any(char::is_control)
}
