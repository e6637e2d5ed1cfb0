//! The normal law, also between bounds.

use super::density::{Density, Place};
use super::germ::Germ;
use super::law::{Law, Transform, finite, positive};
use super::marginal::Polynomials;
use super::marginal_error::{MarginalError, plain};
use super::normal_quantile::distribution;
use super::shaped::Draft;

/// A standard deviation below this share of the mean cannot be told from none.
pub(super) const LEAST_SPREAD: f64 = 1e3 * f64::EPSILON;

/// N(mean, std²): x = mean + std ξ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Normal {
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
            true => Err(MarginalError::parameter("std", std, "large enough beside the mean")),
            false => Ok(Self { mean, std }),
        }
    }

    /// The law on condition that the variable lies between bounds; mean and standard deviation are those before.
    ///
    /// # Errors
    ///
    /// Bounds must be finite, ascending, at least one, with a billionth of the probability between them.
    pub fn between(self, lower: Option<f64>, upper: Option<f64>) -> Result<Draft, MarginalError> {
        /// What is left between the bounds at least.
        const LEAST_LEFT: f64 = 1e-9;
        let lower = lower.map(|lower| finite("lower", lower)).transpose()?;
        let upper = upper.map(|upper| finite("upper", upper)).transpose()?;
        if let (Some(lower), Some(upper)) = (lower, upper)
            && lower >= upper
        {
            return Err(MarginalError::Inverted { lower, upper });
        }
        let support = [lower.unwrap_or(f64::NEG_INFINITY), upper.unwrap_or(f64::INFINITY)];
        let [below, above] = [self.standardized(support[0]), -self.standardized(support[1])].map(distribution);
        let left = 1.0 - below - above;
        // Not a number, if nothing is.
        if left.is_nan() || left < LEAST_LEFT {
            let given = [("lower", lower), ("upper", upper)].into_iter();
            let given = given.filter_map(|(name, bound)| Some(format!("{name} = {}", plain(&bound?))));
            let given = given.collect::<Vec<_>>().join(" and ");
            return Err(MarginalError::NothingLeft { given, share: left.max(0.0), least: LEAST_LEFT });
        }
        let mut parameters = self.parameters();
        parameters.extend(lower.map(|lower| ("lower", lower)));
        parameters.extend(upper.map(|upper| ("upper", upper)));
        let density = Box::new(Between { normal: self, support });
        Ok(Draft { name: "normal", parameters, density, family: "own", default: Polynomials::Own })
    }
}

impl Law for Normal {
    fn name(&self) -> &'static str {
        "normal"
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("mean", self.mean), ("std", self.std)]
    }

    fn germ(&self) -> &Germ {
        &Germ::Normal
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

    fn transform(&self) -> Transform<'_> {
        Transform::Affine { center: self.mean, half_width: self.std }
    }
}

/// A normal density between bounds.
#[derive(Debug)]
struct Between {
    normal: Normal,
    support: [f64; 2],
}

impl Density for Between {
    fn support(&self) -> [f64; 2] {
        self.support
    }

    fn log_density(&self, place: Place) -> f64 {
        let [lower, upper] = self.support.map(|end| self.normal.standardized(end));
        let std = self.normal.std;
        // Of distances from the bound nearer to the mean, so that a tail keeps its digits.
        if lower > 0.0 {
            let d = place.from_lower / std;
            -d * (0.5f64).mul_add(d, lower)
        } else if upper < 0.0 {
            let d = place.to_upper / std;
            -d * (0.5f64).mul_add(d, -upper)
        } else {
            -0.5 * self.normal.standardized(place.x).powi(2)
        }
    }

    fn typical(&self) -> [f64; 2] {
        /// Two standard deviations on either side of the mean, or as much of a tail as lasts.
        const FAR: f64 = 2.0;
        let Normal { mean, std } = self.normal;
        let [lower, upper] = self.support.map(|end| self.normal.standardized(end));
        let from = lower.max(-FAR).min(upper - 1.0 / (1.0 + upper.abs()));
        let to = upper.min(FAR).max(lower + 1.0 / (1.0 + lower.abs()));
        let [from, to] = [from.max(lower), to.min(upper)];
        [std.mul_add(0.5 * (from + to), mean), 0.25 * std * (to - from)]
    }
}
