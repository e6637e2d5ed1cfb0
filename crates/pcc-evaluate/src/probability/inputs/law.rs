//! What a law of an input has to know.

use super::germ::Germ;
use super::uniform::MarginalError;

/// A law of an input: a monotone function x(ξ) of a standardized variable.
pub(super) trait Law {
    /// Parameters that say which one of its laws it is, with their names in study files, in the order of these files.
    fn parameters(&self) -> Vec<(&'static str, f64)>;

    /// Its standardized variable.
    fn germ(&self) -> Germ;

    /// x(ξ), in the input's own unit.
    fn physical(&self, xi: f64) -> f64;

    /// dx/dξ.
    fn slope(&self, xi: f64) -> f64;

    /// ξ(x).
    fn standardized(&self, x: f64) -> f64;

    /// Between what values it has all its probability; infinite where it has no bound.
    fn support(&self) -> [f64; 2];
}

/// A finite number.
pub(super) fn finite(name: &'static str, value: f64) -> Result<f64, MarginalError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(MarginalError::Parameter { name, value, expected: "a finite number" })
    }
}

/// A positive finite number.
pub(super) fn positive(name: &'static str, value: f64) -> Result<f64, MarginalError> {
    match value.is_finite() && value > 0.0 {
        true => Ok(value),
        false => Err(MarginalError::Parameter { name, value, expected: "a positive number" }),
    }
}
