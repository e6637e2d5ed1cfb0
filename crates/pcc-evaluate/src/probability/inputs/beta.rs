//! The beta law on any interval, whose polynomials are those of Jacobi.

use super::density::{Density, Place};
use super::law::{finite, positive};
use super::marginal::Polynomials;
use super::marginal_error::{MarginalError, plain};
use super::shaped::Draft;
use super::uniform::Uniform;

/// Density (x − lower)^(α − 1) (upper − x)^(β − 1).
#[derive(Debug)]
struct Beta {
    alpha: f64,
    beta: f64,
    interval: Uniform,
}

/// Shapes of which double precision resolves the quantiles.
const SHAPES: std::ops::RangeInclusive<f64> = 0.05..=1e6;

/// The beta law of shapes α and β between two bounds in the input's own unit: mean lower + (upper − lower) α/(α + β).
///
/// # Errors
///
/// Shapes must be from 0.05 to 10⁶, bounds ascending and apart.
pub(super) fn beta(alpha: f64, beta: f64, [lower, upper]: [f64; 2]) -> Result<Draft, MarginalError> {
    for (name, value) in [("alpha", alpha), ("beta", beta)] {
        positive(name, value)?;
        if !SHAPES.contains(&value) {
            return Err(MarginalError::parameter(name, value, "from 0.05 to 1e6"));
        }
    }
    let interval = Uniform::new(lower, upper)?;
    Ok(Draft {
        name: "beta",
        parameters: vec![("alpha", alpha), ("beta", beta), ("lower", lower), ("upper", upper)],
        density: Box::new(Beta { alpha, beta, interval }),
        family: "jacobi",
        default: Polynomials::Own,
    })
}

/// That with this mean and standard deviation: α + β = m (1 − m)/s² − 1, with mean m and standard deviation s in units
/// of the interval.
///
/// # Errors
///
/// As [`beta`]; the mean must lie between the bounds, and values between bounds scatter only so much.
pub(super) fn beta_with_moments(mean: f64, std: f64, [lower, upper]: [f64; 2]) -> Result<Draft, MarginalError> {
    let (mean, std) = (finite("mean", mean)?, positive("std", std)?);
    let interval = Uniform::new(lower, upper)?;
    if !(lower < mean && mean < upper) {
        let expected = format!("between lower ({}) and upper ({})", plain(&lower), plain(&upper));
        return Err(MarginalError::parameter("mean", mean, expected));
    }
    let width = 2.0 * interval.half_width();
    let share = (mean - lower) / width;
    let shares = [share, 1.0 - share];
    let (least, largest) = (shares[0].min(shares[1]), shares[0].max(shares[1]));
    let sum = shares[0] * shares[1] / (std / width).powi(2) - 1.0;
    if !(SHAPES.contains(&(least * sum)) && SHAPES.contains(&(largest * sum))) {
        let widest = |shape: f64| width * (least * largest / (1.0 + shape)).sqrt();
        let [from, to] = [SHAPES.end() / largest, SHAPES.start() / least].map(|sum| plain(&three_digits(widest(sum))));
        let expected = format!("from {from} to {to} with this mean between lower and upper");
        return Err(MarginalError::parameter("std", std, expected));
    }
    beta(shares[0] * sum, shares[1] * sum, [lower, upper])
}

/// A number for people.
fn three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

impl Beta {
    fn width(&self) -> f64 {
        2.0 * self.interval.half_width()
    }

    /// Distances of the mean from the bounds.
    fn of_mean(&self) -> [f64; 2] {
        let sum = self.alpha + self.beta;
        [self.alpha, self.beta].map(|shape| self.width() * shape / sum)
    }
}

impl Density for Beta {
    fn support(&self) -> [f64; 2] {
        [self.interval.lower(), self.interval.upper()]
    }

    fn log_density(&self, place: Place) -> f64 {
        // Both logarithms of the same distance from the mean, so that large shapes do not multiply its rounding.
        let [below, above] = self.of_mean();
        let step = if place.from_lower < place.to_upper { place.from_lower - below } else { above - place.to_upper };
        let logarithm = |change: f64, ratio: f64| if change.abs() < 0.5 { change.ln_1p() } else { ratio.ln() };
        let lower = logarithm(step / below, place.from_lower / below);
        let upper = logarithm(-step / above, place.to_upper / above);
        self.alpha.mul_add(lower, self.beta * upper) - lower - upper
    }

    fn typical(&self) -> [f64; 2] {
        let [below, above] = self.of_mean();
        let sum = self.alpha + self.beta;
        [self.interval.lower() + below, (below * above / (sum + 1.0)).sqrt()]
    }
}
