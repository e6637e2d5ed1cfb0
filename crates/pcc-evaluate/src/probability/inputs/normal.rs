//! The normal law, of a variable itself or of its logarithm, and between bounds.

use super::germ::{Cut, Germ};
use super::law::{Law, finite, positive};
use super::uniform::MarginalError;

/// A standard deviation below this share of the mean cannot be told from none.
const LEAST_SPREAD: f64 = 1e3 * f64::EPSILON;

/// N(mean, std²): x = mean + std ξ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normal {
    mean: f64,
    std: f64,
}

impl Normal {
    /// The normal law with this mean and standard deviation, in the input's own unit.
    ///
    /// # Errors
    ///
    /// The mean must be finite, the standard deviation positive and not lost beside the mean.
    pub fn new(mean: f64, std: f64) -> Result<Self, MarginalError> {
        let (mean, std) = (finite("mean", mean)?, positive("std", std)?);
        match std < LEAST_SPREAD * mean.abs() {
            true => Err(MarginalError::Parameter { name: "std", value: std, expected: "large enough beside the mean" }),
            false => Ok(Self { mean, std }),
        }
    }
}

impl Law for Normal {
    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("mean", self.mean), ("std", self.std)]
    }

    fn germ(&self) -> Germ {
        Germ::Normal
    }

    fn physical(&self, xi: f64) -> f64 {
        self.std.mul_add(xi, self.mean)
    }

    fn slope(&self, _: f64) -> f64 {
        self.std
    }

    fn standardized(&self, x: f64) -> f64 {
        (x - self.mean) / self.std
    }

    fn support(&self) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }
}

/// The law of a variable whose logarithm is normal: x = exp(μ + σξ).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogNormal {
    mean: f64,
    std: f64,
    log_mean: f64,
    log_std: f64,
}

impl LogNormal {
    /// The lognormal law with this mean and standard deviation *of the variable itself*: σ² = ln(1 + std²/mean²),
    /// μ = ln mean − σ²/2.
    ///
    /// # Errors
    ///
    /// Both must be positive, the standard deviation not lost beside the mean.
    pub fn new(mean: f64, std: f64) -> Result<Self, MarginalError> {
        let (mean, std) = (positive("mean", mean)?, positive("std", std)?);
        let variance = (std / mean).powi(2).ln_1p();
        let log_std = positive("std", variance.sqrt())?;
        if std < LEAST_SPREAD * mean {
            let expected = "large enough beside the mean";
            return Err(MarginalError::Parameter { name: "std", value: std, expected });
        }
        Ok(Self { mean, std, log_mean: mean.ln() - 0.5 * variance, log_std })
    }
}

impl Law for LogNormal {
    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("mean", self.mean), ("std", self.std)]
    }

    fn germ(&self) -> Germ {
        Germ::Normal
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
}

/// The normal law between bounds, one or both: mean and standard deviation are those before truncation.
///
/// x = mean + std ξ, where ξ is a standard normal variable between the bounds, which has polynomials of its own:
/// functions of x would be less smooth in a normal variable, and polynomials in that grow fast where it is seldom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruncatedNormal {
    normal: Normal,
    lower: Option<f64>,
    upper: Option<f64>,
    cut: Cut,
}

/// What is left between the bounds at least: less cannot be resolved.
const LEAST_LEFT: f64 = 1e-9;

impl TruncatedNormal {
    /// The law of `normal` on condition that the variable lies between these bounds.
    ///
    /// # Errors
    ///
    /// Bounds must be finite, ascending, at least one, with a billionth of the probability between them.
    pub fn new(normal: Normal, lower: Option<f64>, upper: Option<f64>) -> Result<Self, MarginalError> {
        let lower = lower.map(|lower| finite("lower", lower)).transpose()?;
        let upper = upper.map(|upper| finite("upper", upper)).transpose()?;
        if let (Some(lower), Some(upper)) = (lower, upper)
            && lower >= upper
        {
            return Err(MarginalError::Inverted { lower, upper });
        }
        let cut = Cut::new(
            lower.map_or(f64::NEG_INFINITY, |lower| normal.standardized(lower)),
            upper.map_or(f64::INFINITY, |upper| normal.standardized(upper)),
        );
        let left = cut.left();
        // Not a number, if nothing is.
        if left >= LEAST_LEFT {
            return Ok(Self { normal, lower, upper, cut });
        }
        Err(MarginalError::NothingLeft { share: left.max(0.0) })
    }
}

impl Law for TruncatedNormal {
    fn parameters(&self) -> Vec<(&'static str, f64)> {
        let mut parameters = self.normal.parameters();
        parameters.extend(self.lower.map(|lower| ("lower", lower)));
        parameters.extend(self.upper.map(|upper| ("upper", upper)));
        parameters
    }

    fn germ(&self) -> Germ {
        Germ::TruncatedNormal(self.cut)
    }

    fn physical(&self, xi: f64) -> f64 {
        let [lower, upper] = self.support();
        self.normal.physical(xi).clamp(lower, upper)
    }

    fn slope(&self, xi: f64) -> f64 {
        self.normal.slope(xi)
    }

    fn standardized(&self, x: f64) -> f64 {
        self.normal.standardized(x)
    }

    fn support(&self) -> [f64; 2] {
        [self.lower.unwrap_or(f64::NEG_INFINITY), self.upper.unwrap_or(f64::INFINITY)]
    }
}
