//! The gamma law, whose polynomials are those of Laguerre.

use super::density::{Density, Place};
use super::law::positive;
use super::marginal::Polynomials;
use super::shaped::Draft;
use super::uniform::MarginalError;

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
        let expected =
            "from 0.05 to 1e6 (std from a thousandth of the mean to four times it; below, take a normal law)";
        return Err(MarginalError::Parameter { name: "shape", value: shape, expected });
    }
    Ok(Draft {
        name: "gamma",
        parameters: vec![("shape", shape), ("scale", scale)],
        density: Box::new(Gamma { shape, mean: positive("scale", shape * scale)? }),
        family: "laguerre",
        default: Polynomials::Own,
    })
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
