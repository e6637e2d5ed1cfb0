//! The gamma law, whose polynomials are those of Laguerre.

use super::density::{Density, Place};
use super::law::positive;
use super::marginal::Polynomials;
use super::marginal_error::MarginalError;
use super::shaped::Draft;

/// Density x^(k − 1) e^(−x/θ) of shape k and scale θ, from 0.
#[derive(Debug)]
struct Gamma {
    shape: f64,
    mean: f64,
}

/// Shapes of which double precision resolves the quantiles; a larger one is a normal law.
const SHAPES: std::ops::RangeInclusive<f64> = 0.05..=1e6;

/// The gamma law of this shape, and of this scale in the input's own unit: mean shape · scale, variance shape · scale².
///
/// # Errors
///
/// Both must be positive, the shape from 0.05 to 10⁶.
pub(super) fn gamma(shape: f64, scale: f64) -> Result<Draft, MarginalError> {
    let (shape, scale) = (positive("shape", shape)?, positive("scale", scale)?);
    if !SHAPES.contains(&shape) {
        return Err(MarginalError::parameter("shape", shape, "from 0.05 to 1e6; above, take a normal law"));
    }
    Ok(Draft {
        name: "gamma",
        parameters: vec![("shape", shape), ("scale", scale)],
        density: Box::new(Gamma { shape, mean: positive("mean", shape * scale)? }),
        family: "laguerre",
        default: Polynomials::Own,
    })
}

/// That with this mean and standard deviation: shape = (mean/std)², scale = std²/mean.
///
/// # Errors
///
/// Both must be positive, and of a shape as [`gamma`] has.
pub(super) fn gamma_with_moments(mean: f64, std: f64) -> Result<Draft, MarginalError> {
    let (mean, std) = (positive("mean", mean)?, positive("std", std)?);
    let shape = (mean / std).powi(2);
    if !SHAPES.contains(&shape) {
        let expected = "from 0.001 to 4.47 times the mean; below, take a normal law";
        return Err(MarginalError::parameter("std", std, expected));
    }
    gamma(shape, std * (std / mean))
}

impl Density for Gamma {
    fn support(&self) -> [f64; 2] {
        [0.0, f64::INFINITY]
    }

    fn log_density(&self, place: Place) -> f64 {
        let ratio = place.from_lower / self.mean;
        // k (ln r − r) − ln r, where a large k must not multiply the rounding of ln r − r.
        let excess = ratio - 1.0;
        let logarithm = if excess.abs() < 0.5 { excess.ln_1p() } else { ratio.ln() };
        self.shape * (logarithm - excess) - logarithm
    }

    fn typical(&self) -> [f64; 2] {
        [self.mean, self.mean / self.shape.sqrt()]
    }
}
