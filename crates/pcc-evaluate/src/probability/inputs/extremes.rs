//! Laws of waiting times and of largest values: exponential, Weibull, Gumbel.
//!
//! Their quantiles are those of E = −ln(1 − F), an exponential variable of mean 1: x = mean E, scale E^(1/shape), and,
//! with −ln F instead, location − scale ln(−ln F). F is the probability of a standard normal variable ξ, of which they
//! are smooth functions.

use super::germ::Germ;
use super::law::{Law, finite, positive};
use super::normal_quantile::{density, distribution, quantile, upper_quantile};
use super::uniform::MarginalError;

/// The standardized value at an end of the support: no probability lies beyond.
const END: f64 = 8.3;

/// −ln(1 − Φ(ξ)).
fn waiting(xi: f64) -> f64 {
    // The smaller tail keeps its digits.
    if xi < 0.0 { -(-distribution(xi)).ln_1p() } else { -distribution(-xi).ln() }
}

/// Its derivative, φ(ξ)/(1 − Φ(ξ)).
fn hazard(xi: f64) -> f64 {
    density(xi) / distribution(-xi)
}

/// ξ where −ln(1 − Φ(ξ)) is `wait`.
fn at_waiting(wait: f64) -> f64 {
    let (below, above) = (-(-wait).exp_m1(), (-wait).exp());
    match below <= above {
        true if below <= 0.0 => -END,
        true => quantile(below),
        false => upper_quantile(above.max(f64::MIN_POSITIVE)),
    }
}

/// Waiting times that remember nothing, from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exponential {
    mean: f64,
}

impl Exponential {
    /// The exponential law with this mean, in the input's own unit.
    ///
    /// # Errors
    ///
    /// It must be positive.
    pub fn new(mean: f64) -> Result<Self, MarginalError> {
        Ok(Self { mean: positive("mean", mean)? })
    }
}

impl Law for Exponential {
    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("mean", self.mean)]
    }

    fn germ(&self) -> Germ {
        Germ::Normal
    }

    fn physical(&self, xi: f64) -> f64 {
        self.mean * waiting(xi)
    }

    fn slope(&self, xi: f64) -> f64 {
        self.mean * hazard(xi)
    }

    fn standardized(&self, x: f64) -> f64 {
        at_waiting(x / self.mean)
    }

    fn support(&self) -> [f64; 2] {
        [0.0, f64::INFINITY]
    }
}

/// Lifetimes and strengths, from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weibull {
    shape: f64,
    scale: f64,
}

impl Weibull {
    /// The Weibull law of this shape, and of this scale in the input's own unit.
    ///
    /// # Errors
    ///
    /// Both must be positive.
    pub fn new(shape: f64, scale: f64) -> Result<Self, MarginalError> {
        Ok(Self { shape: positive("shape", shape)?, scale: positive("scale", scale)? })
    }
}

impl Law for Weibull {
    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("shape", self.shape), ("scale", self.scale)]
    }

    fn germ(&self) -> Germ {
        Germ::Normal
    }

    fn physical(&self, xi: f64) -> f64 {
        self.scale * waiting(xi).powf(1.0 / self.shape)
    }

    fn slope(&self, xi: f64) -> f64 {
        let wait = waiting(xi);
        self.scale / self.shape * wait.powf(1.0 / self.shape - 1.0) * hazard(xi)
    }

    fn standardized(&self, x: f64) -> f64 {
        at_waiting((x / self.scale).max(0.0).powf(self.shape))
    }

    fn support(&self) -> [f64; 2] {
        [0.0, f64::INFINITY]
    }
}

/// The largest of many.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gumbel {
    location: f64,
    scale: f64,
}

impl Gumbel {
    /// The Gumbel law of largest values with this mode and scale, in the input's own unit.
    ///
    /// # Errors
    ///
    /// The location must be finite, the scale positive.
    pub fn new(location: f64, scale: f64) -> Result<Self, MarginalError> {
        Ok(Self { location: finite("location", location)?, scale: positive("scale", scale)? })
    }

    /// That with this mean and standard deviation: scale = √6 std/π, location = mean − γ scale.
    ///
    /// # Errors
    ///
    /// As [`Gumbel::new`].
    pub fn with_moments(mean: f64, std: f64) -> Result<Self, MarginalError> {
        const EULER: f64 = 0.577_215_664_901_532_9;
        let (mean, std) = (finite("mean", mean)?, positive("std", std)?);
        let scale = 6f64.sqrt() / std::f64::consts::PI * std;
        Self::new(mean - EULER * scale, scale)
    }
}

impl Law for Gumbel {
    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("location", self.location), ("scale", self.scale)]
    }

    fn germ(&self) -> Germ {
        Germ::Normal
    }

    fn physical(&self, xi: f64) -> f64 {
        self.location - self.scale * waiting(-xi).ln()
    }

    fn slope(&self, xi: f64) -> f64 {
        self.scale * hazard(-xi) / waiting(-xi)
    }

    fn standardized(&self, x: f64) -> f64 {
        -at_waiting((-(x - self.location) / self.scale).exp())
    }

    fn support(&self) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }
}
