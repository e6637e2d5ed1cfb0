//! Laws of single values: levels with their probabilities, and measured values as they are.

use super::germ::Germ;
use super::law::{Law, Source, Transform};
use super::normal_quantile::{quantile, upper_quantile};
use super::own_variable::OwnVariable;
use super::pieces::{Pieces, REACH};
use super::shaped::{Stored, are_polynomials_of};
use super::uniform::MarginalError;
use crate::polynomials::OwnPolynomials;
use std::sync::Arc;

/// More levels than anybody writes down; measured values can be as many.
pub(super) const MOST_LEVELS: usize = 10_000;

/// Rounding of a sum of probabilities.
const ONE: f64 = 1e-12;

/// Values less apart than this, relative to the largest, are one.
const APART: f64 = 1e-12;

/// x takes one of its levels; ξ = (x − least level)/standard deviation.
#[derive(Debug)]
pub(super) struct Levels {
    name: &'static str,
    parameters: Vec<(&'static str, f64)>,
    support: [f64; 2],
    scale: f64,
    quantile: Arc<Pieces>,
    germ: Germ,
    source: Option<Source>,
}

/// Levels in ascending order with probabilities that sum to one; `None` if there are not at least two that differ.
pub(super) fn gathered(values: &[f64], weights: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let mut pairs: Vec<(f64, f64)> = values.iter().copied().zip(weights.iter().copied()).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    // Weights that sum to one but for rounding stay what they are.
    let sum: f64 = weights.iter().sum();
    let sum = if (sum - 1.0).abs() < ONE { 1.0 } else { sum };
    let (mut levels, mut shares): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    for (value, weight) in pairs.into_iter().filter(|(_, weight)| *weight > 0.0) {
        match (levels.last(), shares.last_mut()) {
            (Some(last), Some(share)) if value - last <= APART * largest => *share += weight / sum,
            _ => {
                levels.push(value);
                shares.push(weight / sum);
            }
        }
    }
    (levels.len() > 1).then_some((levels, shares))
}

impl Levels {
    /// The law of these levels, [`gathered`] from what was given, under a name with its parameters.
    pub fn new(
        name: &'static str,
        parameters: Vec<(&'static str, f64)>,
        levels: &[f64],
        probabilities: &[f64],
    ) -> Result<Self, MarginalError> {
        let moment = |of: &dyn Fn(f64) -> f64| -> f64 {
            levels.iter().zip(probabilities).map(|(level, probability)| probability * of(*level)).sum()
        };
        let (lower, mean) = (levels[0], moment(&|x| x));
        let scale = moment(&|x| (x - mean).powi(2)).sqrt();
        if !scale.is_normal() {
            return Err(MarginalError::Shape { law: name });
        }
        let nodes: Vec<f64> = levels.iter().map(|level| (level - lower) / scale).collect();
        let quantile = Pieces::steps(&nodes, &scores_between(probabilities));
        let polynomials = OwnPolynomials::of_density("own", nodes, probabilities.to_vec());
        Ok(Self::with(name, parameters, [lower, levels[levels.len() - 1]], scale, quantile, polynomials))
    }

    /// The same from a file.
    pub fn with(
        name: &'static str,
        parameters: Vec<(&'static str, f64)>,
        support: [f64; 2],
        scale: f64,
        quantile: Pieces,
        polynomials: OwnPolynomials,
    ) -> Self {
        let quantile = Arc::new(quantile);
        let germ = Germ::Own(Arc::new(OwnVariable {
            quantile: quantile.clone(),
            polynomials: Arc::new(polynomials),
            is_bounded: [true; 2],
        }));
        Self { name, parameters, support, scale, quantile, germ, source: None }
    }

    /// The law as a file has it; a sentence if that is not its map.
    pub fn stored(self, stored: Stored) -> Result<Self, &'static str> {
        if stored.map != [self.support[0], self.scale] || stored.quantile != *self.quantile {
            return Err("its steps are not those of its law");
        }
        Self::of_file(self.name, self.parameters, self.support, stored)
    }

    /// The law of a map that a file has; a sentence if there is none.
    pub fn of_file(
        name: &'static str,
        parameters: Vec<(&'static str, f64)>,
        support: [f64; 2],
        Stored { map: [origin, scale], quantile, recurrence, .. }: Stored,
    ) -> Result<Self, &'static str> {
        const ROUNDING: f64 = 1e-9;
        let ends = [-REACH, REACH].map(|z| scale.mul_add(quantile.at(z), origin));
        let width = support[1] - support[0];
        let is_its = ends.into_iter().zip(support).all(|(end, known)| (end - known).abs() <= ROUNDING * width);
        if !(origin == support[0] && scale.is_normal() && scale > 0.0 && is_its && quantile.are_steps()) {
            return Err("its steps do not go from its least value to its largest");
        }
        let own = OwnPolynomials::stored("own", recurrence);
        if !are_polynomials_of(&own, &quantile) {
            return Err("its recurrence is not that of its law");
        }
        Ok(Self::with(name, parameters, support, scale, quantile, own))
    }

    /// The same, whose values were read there.
    pub fn measured_in(self, source: Option<Source>) -> Self {
        Self { source, ..self }
    }
}

/// Normal scores at which one level gives way to the next: of the probability of all before, in the digits of the
/// nearer tail.
fn scores_between(probabilities: &[f64]) -> Vec<f64> {
    let mut above: Vec<f64> = probabilities.to_vec();
    for k in (1..above.len()).rev() {
        above[k - 1] += above[k];
    }
    let mut below = 0.0;
    let score = |(probability, above): (&f64, &f64)| {
        below += probability;
        let score = if below < *above { quantile(below) } else { upper_quantile(*above) };
        score.clamp(-REACH, REACH)
    };
    probabilities.iter().zip(&above[1..]).map(score).collect()
}

/// The law of levels with their weights.
///
/// # Errors
///
/// Levels must be finite numbers, at least two that differ, weights positive.
pub(super) fn discrete(values: &[f64], weights: &[f64]) -> Result<Levels, MarginalError> {
    if let Some(&value) = values.iter().find(|value| !value.is_finite()) {
        return Err(MarginalError::Parameter { name: "values", value, expected: "finite numbers" });
    }
    if let Some(&value) = weights.iter().find(|weight| !(weight.is_finite() && **weight > 0.0)) {
        return Err(MarginalError::Parameter { name: "weights", value, expected: "positive numbers" });
    }
    if values.len() > MOST_LEVELS {
        return Err(MarginalError::Levels { found: values.len(), most: MOST_LEVELS });
    }
    let (levels, probabilities) = gathered(values, weights).ok_or(MarginalError::OneLevel)?;
    let pairs = levels.iter().zip(&probabilities);
    let parameters = pairs.flat_map(|(level, probability)| [("value", *level), ("weight", *probability)]).collect();
    Levels::new("discrete", parameters, &levels, &probabilities)
}

impl Law for Levels {
    fn name(&self) -> &'static str {
        self.name
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        self.parameters.clone()
    }

    fn germ(&self) -> &Germ {
        &self.germ
    }

    fn physical(&self, xi: f64) -> f64 {
        let [lower, upper] = self.support;
        self.scale.mul_add(xi, lower).max(lower).min(upper)
    }

    fn slope(&self, _: f64) -> f64 {
        self.scale
    }

    fn standardized(&self, x: f64) -> f64 {
        (x - self.support[0]) / self.scale
    }

    fn support(&self) -> [f64; 2] {
        self.support
    }

    fn transform(&self) -> Transform<'_> {
        Transform::Pieces { origin: self.support[0], scale: self.scale, quantile: &self.quantile }
    }

    fn is_discrete(&self) -> bool {
        true
    }

    fn source(&self) -> Option<&Source> {
        self.source.as_ref()
    }
}
