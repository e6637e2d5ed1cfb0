//! Laws of single values: levels with their probabilities, and measured values as they are.

use super::marginal::Polynomials;
use super::marginal_error::MarginalError;
use super::normal_quantile::{quantile, upper_quantile};
use super::pieces::{Pieces, REACH};
use super::shaped::{Shaped, Stored};
use crate::polynomials::OwnPolynomials;

/// More levels than anybody writes down; measured values can be as many.
pub(super) const MOST_LEVELS: usize = 10_000;

/// Rounding of a sum of probabilities.
const ONE: f64 = 1e-12;

/// Values less apart than this, relative to the largest, are one.
const APART: f64 = 1e-12;

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

/// The law that takes these levels, [`gathered`] from what was given, under a name with its parameters:
/// ξ = (x − least level)/standard deviation.
pub(super) fn of_levels(
    name: &'static str,
    parameters: Vec<(&'static str, f64)>,
    levels: &[f64],
    probabilities: &[f64],
) -> Result<Shaped, MarginalError> {
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
    let support = [lower, levels[levels.len() - 1]];
    Ok(Shaped::new(name, parameters, support, [lower, scale], quantile, Polynomials::Own, polynomials))
}

/// The law of a map that a file has; a sentence if there is none.
pub(super) fn of_file(
    name: &'static str,
    parameters: Vec<(&'static str, f64)>,
    support: [f64; 2],
    stored: Stored,
) -> Result<Shaped, &'static str> {
    const ROUNDING: f64 = 1e-9;
    let [origin, scale] = stored.map;
    let ends = [-REACH, REACH].map(|z| scale.mul_add(stored.quantile.at(z), origin));
    let width = support[1] - support[0];
    let is_its = ends.into_iter().zip(support).all(|(end, known)| (end - known).abs() <= ROUNDING * width);
    if !(origin == support[0] && is_its && stored.quantile.are_steps()) {
        return Err("its steps do not go from its least value to its largest");
    }
    Shaped::of_file(name, parameters, support, "own", Stored { polynomials: Polynomials::Own, ..stored })
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
pub(super) fn discrete(values: &[f64], weights: &[f64]) -> Result<Shaped, MarginalError> {
    if let Some(&value) = values.iter().find(|value| !value.is_finite()) {
        return Err(MarginalError::parameter("values", value, "finite numbers"));
    }
    if let Some(&value) = weights.iter().find(|weight| !(weight.is_finite() && **weight > 0.0)) {
        return Err(MarginalError::parameter("weights", value, "positive numbers"));
    }
    if values.len() > MOST_LEVELS {
        return Err(MarginalError::Levels { found: values.len(), most: MOST_LEVELS });
    }
    let (levels, probabilities) = gathered(values, weights).ok_or(MarginalError::OneLevel)?;
    let pairs = levels.iter().zip(&probabilities);
    let parameters = pairs.flat_map(|(level, probability)| [("value", *level), ("weight", *probability)]).collect();
    of_levels("discrete", parameters, &levels, &probabilities)
}
