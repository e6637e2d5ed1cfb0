//! Laws of waiting times and of largest values: exponential, Weibull, Gumbel.

use super::density::{Density, Place};
use super::law::{finite, positive};
use super::marginal::Polynomials;
use super::marginal_error::MarginalError;
use super::shaped::Draft;

/// Waiting times that remember nothing, from 0: density e^(−x/mean).
#[derive(Debug)]
struct Exponential {
    mean: f64,
}

/// The exponential law with this mean, in the input's own unit.
///
/// # Errors
///
/// It must be positive.
pub(super) fn exponential(mean: f64) -> Result<Draft, MarginalError> {
    let density = Box::new(Exponential { mean: positive("mean", mean)? });
    let parameters = vec![("mean", mean)];
    Ok(Draft { name: "exponential", parameters, density, family: "laguerre", default: Polynomials::Own })
}

impl Density for Exponential {
    fn support(&self) -> [f64; 2] {
        [0.0, f64::INFINITY]
    }

    fn log_density(&self, place: Place) -> f64 {
        -place.from_lower / self.mean
    }

    fn typical(&self) -> [f64; 2] {
        [self.mean, self.mean]
    }
}

/// Lifetimes and strengths, from 0: density (x/λ)^(k − 1) exp(−(x/λ)^k).
#[derive(Debug)]
struct Weibull {
    shape: f64,
    scale: f64,
}

/// The Weibull law of this shape, and of this scale in the input's own unit.
///
/// # Errors
///
/// Both must be positive, the shape from 0.1 to 10⁴.
pub(super) fn weibull(shape: f64, scale: f64) -> Result<Draft, MarginalError> {
    const SHAPES: std::ops::RangeInclusive<f64> = 0.1..=1e4;
    let (shape, scale) = (positive("shape", shape)?, positive("scale", scale)?);
    if !SHAPES.contains(&shape) {
        return Err(MarginalError::parameter("shape", shape, "from 0.1 to 10000"));
    }
    // Below, quantiles spread over orders of magnitude, and so do moments.
    let default = if shape < 0.8 { Polynomials::Hermite } else { Polynomials::Own };
    let parameters = vec![("shape", shape), ("scale", scale)];
    Ok(Draft { name: "weibull", parameters, density: Box::new(Weibull { shape, scale }), family: "own", default })
}

impl Density for Weibull {
    fn support(&self) -> [f64; 2] {
        [0.0, f64::INFINITY]
    }

    fn log_density(&self, place: Place) -> f64 {
        let growth = self.shape * (place.from_lower / self.scale).ln();
        growth - growth.exp() - place.from_lower.ln()
    }

    fn typical(&self) -> [f64; 2] {
        [self.scale, self.scale / self.shape]
    }
}

/// The largest of many: density e^(−t − e^−t) of t = (x − location)/scale.
#[derive(Debug)]
struct Gumbel {
    location: f64,
    scale: f64,
}

/// The Gumbel law of largest values with this mode and scale, in the input's own unit.
///
/// # Errors
///
/// The location must be finite, the scale positive.
pub(super) fn gumbel(location: f64, scale: f64) -> Result<Draft, MarginalError> {
    let density = Box::new(Gumbel { location: finite("location", location)?, scale: positive("scale", scale)? });
    let parameters = vec![("location", location), ("scale", scale)];
    Ok(Draft { name: "gumbel", parameters, density, family: "own", default: Polynomials::Own })
}

/// That with this mean and standard deviation: scale = √6 std/π, location = mean − γ scale.
///
/// # Errors
///
/// As [`gumbel`].
pub(super) fn gumbel_with_moments(mean: f64, std: f64) -> Result<Draft, MarginalError> {
    const EULER: f64 = 0.577_215_664_901_532_9;
    let (mean, std) = (finite("mean", mean)?, positive("std", std)?);
    let scale = 6f64.sqrt() / std::f64::consts::PI * std;
    gumbel(mean - EULER * scale, scale)
}

impl Density for Gumbel {
    fn support(&self) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }

    fn log_density(&self, place: Place) -> f64 {
        let t = (place.x - self.location) / self.scale;
        -t - (-t).exp()
    }

    fn typical(&self) -> [f64; 2] {
        [self.location + 0.5 * self.scale, 1.3 * self.scale]
    }
}
