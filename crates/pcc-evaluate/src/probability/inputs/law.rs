//! What a law of an input has to know.

use super::germ::Germ;
use super::marginal::Polynomials;
use super::marginal_error::MarginalError;
use super::pieces::Pieces;
use std::fmt::Debug;

/// A law of an input: a monotone function x(ξ) of a standardized variable.
pub(super) trait Law: Debug + Send + Sync {
    /// Its name in study files and tables.
    fn name(&self) -> &'static str;

    /// Parameters that say which one of its laws it is, with their names in study files, in the order of these files.
    fn parameters(&self) -> Vec<(&'static str, f64)>;

    /// Its standardized variable.
    fn germ(&self) -> &Germ;

    /// x(ξ), in the input's own unit.
    fn physical(&self, xi: f64) -> f64;

    /// dx/dξ.
    fn slope(&self, xi: f64) -> f64;

    /// ξ(x).
    fn standardized(&self, x: f64) -> f64;

    /// Between what values it has all its probability; infinite where it has no bound.
    fn support(&self) -> [f64; 2];

    /// The same map as files keep it.
    fn transform(&self) -> Transform<'_>;

    /// Whether it takes single values.
    fn is_discrete(&self) -> bool {
        false
    }

    /// Where its values were read, if they were.
    fn source(&self) -> Option<&Source> {
        None
    }

    /// The polynomials that a study has asked for, if there was a choice.
    fn chosen(&self) -> Option<Polynomials> {
        None
    }
}

/// A column of a table of measured values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// The file, as the study names it.
    pub file: String,
    /// The column's name, if the study gives one.
    pub column: Option<String>,
}

/// A map from the standardized variable, or from the normal score, to the input's value.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Transform<'a> {
    /// x = center + `half_width` ξ.
    Affine { center: f64, half_width: f64 },
    /// x = exp(center + `half_width` ξ).
    Exponential { center: f64, half_width: f64 },
    /// x = origin + scale q(z), q in pieces, z being the normal score.
    Pieces { origin: f64, scale: f64, quantile: &'a Pieces },
}

/// A finite number.
pub(super) fn finite(name: &'static str, value: f64) -> Result<f64, MarginalError> {
    if value.is_finite() { Ok(value) } else { Err(MarginalError::parameter(name, value, "a finite number")) }
}

/// A positive finite number.
pub(super) fn positive(name: &'static str, value: f64) -> Result<f64, MarginalError> {
    match value.is_finite() && value > 0.0 {
        true => Ok(value),
        false => Err(MarginalError::parameter(name, value, "a positive number")),
    }
}
