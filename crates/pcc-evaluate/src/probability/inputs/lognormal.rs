//! The lognormal law.

use super::density::{Density, Place};
use super::germ::Germ;
use super::law::{Law, Transform, positive};
use super::marginal::Polynomials;
use super::marginal_error::MarginalError;
use super::normal::LEAST_SPREAD;
use super::shaped::Draft;

/// The law of a variable whose logarithm is normal: x = exp(μ + σξ).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LogNormal {
    mean: f64,
    std: f64,
    log_mean: f64,
    log_std: f64,
    chosen: Option<Polynomials>,
}

/// Up to this σ, polynomials of the variable itself are the usual ones: beyond, their moments grow out of bounds.
const WIDEST_OF_ITS_OWN: f64 = 0.8;

impl LogNormal {
    /// The lognormal law with this mean and standard deviation *of the variable itself*: σ² = ln(1 + std²/mean²),
    /// μ = ln mean − σ²/2.
    ///
    /// # Errors
    ///
    /// Both must be positive, the standard deviation not lost beside the mean.
    pub fn new(mean: f64, std: f64, chosen: Option<Polynomials>) -> Result<Self, MarginalError> {
        let (mean, std) = (positive("mean", mean)?, positive("std", std)?);
        if std < LEAST_SPREAD * mean {
            return Err(MarginalError::parameter("std", std, "large enough beside the mean"));
        }
        let variance = (std / mean).powi(2).ln_1p();
        if !variance.is_finite() {
            return Err(MarginalError::parameter("std", std, "less beside the mean"));
        }
        let log_std = variance.sqrt();
        Ok(Self { mean, std, log_mean: mean.ln() - 0.5 * variance, log_std, chosen })
    }

    /// The polynomials that are chosen, or the usual ones.
    pub fn polynomials(&self) -> Polynomials {
        let usual = if self.log_std <= WIDEST_OF_ITS_OWN { Polynomials::Own } else { Polynomials::Hermite };
        self.chosen.unwrap_or(usual)
    }

    /// The law with polynomials of the variable itself.
    pub fn of_its_own(self) -> Draft {
        let parameters = self.parameters();
        Draft { name: "lognormal", parameters, density: Box::new(self), family: "own", default: Polynomials::Own }
    }
}

impl Law for LogNormal {
    fn name(&self) -> &'static str {
        "lognormal"
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("mean", self.mean), ("std", self.std)]
    }

    fn germ(&self) -> &Germ {
        &Germ::Normal
    }

    fn physical(&self, xi: f64) -> f64 {
        self.log_std.mul_add(xi, self.log_mean).exp()
    }

    fn slope(&self, xi: f64) -> f64 {
        self.log_std * self.physical(xi)
    }

    fn standardized(&self, x: f64) -> f64 {
        (x.ln() - self.log_mean) / self.log_std
    }

    fn support(&self) -> [f64; 2] {
        [0.0, f64::INFINITY]
    }

    fn transform(&self) -> Transform<'_> {
        Transform::Exponential { center: self.log_mean, half_width: self.log_std }
    }

    fn chosen(&self) -> Option<Polynomials> {
        self.chosen
    }
}

impl Density for LogNormal {
    fn support(&self) -> [f64; 2] {
        [0.0, f64::INFINITY]
    }

    fn log_density(&self, place: Place) -> f64 {
        let logarithm = place.from_lower.ln();
        -0.5 * ((logarithm - self.log_mean) / self.log_std).powi(2) - logarithm
    }

    fn typical(&self) -> [f64; 2] {
        let median = self.log_mean.exp();
        [median, self.log_std * median]
    }
}
