//! The law of a variable whose logarithm is uniform: of what is known to its order of magnitude.

use super::germ::Germ;
use super::law::{Law, Transform, positive};
use super::marginal_error::MarginalError;
use super::uniform::Uniform;

/// x = exp(c + hξ) between two positive bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogUniform {
    lower: f64,
    upper: f64,
    logarithm: Uniform,
}

impl LogUniform {
    /// The log-uniform law on \[lower, upper\], in the input's own unit.
    ///
    /// # Errors
    ///
    /// Bounds must be positive and ascending, and their logarithms far enough apart.
    pub fn new(lower: f64, upper: f64) -> Result<Self, MarginalError> {
        let (lower, upper) = (positive("lower", lower)?, positive("upper", upper)?);
        if lower >= upper {
            return Err(MarginalError::Inverted { lower, upper });
        }
        let logarithm = Uniform::new(lower.ln(), upper.ln()).map_err(|_| MarginalError::Unresolved { lower, upper })?;
        Ok(Self { lower, upper, logarithm })
    }
}

impl Law for LogUniform {
    fn name(&self) -> &'static str {
        "log-uniform"
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("lower", self.lower), ("upper", self.upper)]
    }

    fn germ(&self) -> &Germ {
        &Germ::Uniform
    }

    fn physical(&self, xi: f64) -> f64 {
        self.logarithm.physical(xi).exp()
    }

    fn slope(&self, xi: f64) -> f64 {
        self.logarithm.half_width() * self.physical(xi)
    }

    fn standardized(&self, x: f64) -> f64 {
        self.logarithm.standardized(x.ln())
    }

    fn support(&self) -> [f64; 2] {
        [self.lower, self.upper]
    }

    fn transform(&self) -> Transform<'_> {
        Transform::Exponential { center: self.logarithm.center(), half_width: self.logarithm.half_width() }
    }
}
