//! The triangular law: of what has a least, a likeliest and a largest value.

use super::density::{Density, Place};
use super::law::finite;
use super::marginal::Polynomials;
use super::marginal_error::MarginalError;
use super::shaped::Draft;
use super::uniform::Uniform;

/// A density that rises along a line up to its mode, and falls along another.
#[derive(Debug)]
struct Triangular {
    interval: Uniform,
    mode: f64,
}

/// The triangular law between two bounds, with its likeliest value, all in the input's own unit.
///
/// # Errors
///
/// Bounds must be ascending and apart, the mode between them or at one of them.
pub(super) fn triangular(lower: f64, mode: f64, upper: f64) -> Result<Draft, MarginalError> {
    let (interval, mode) = (Uniform::new(lower, upper)?, finite("mode", mode)?);
    if !(lower..=upper).contains(&mode) {
        return Err(MarginalError::parameter("mode", mode, "between lower and upper"));
    }
    Ok(Draft {
        name: "triangular",
        parameters: vec![("lower", lower), ("mode", mode), ("upper", upper)],
        density: Box::new(Triangular { interval, mode }),
        family: "own",
        default: Polynomials::Own,
    })
}

impl Density for Triangular {
    fn support(&self) -> [f64; 2] {
        [self.interval.lower(), self.interval.upper()]
    }

    fn log_density(&self, place: Place) -> f64 {
        let [rise, fall] = [self.mode - self.interval.lower(), self.interval.upper() - self.mode];
        if place.x <= self.mode && rise > 0.0 { (place.from_lower / rise).ln() } else { (place.to_upper / fall).ln() }
    }

    fn typical(&self) -> [f64; 2] {
        let [lower, upper] = self.support();
        [(lower + self.mode + upper) / 3.0, (upper - lower) / 4.5]
    }

    fn kinks(&self) -> Vec<f64> {
        let [lower, upper] = self.support();
        if lower < self.mode && self.mode < upper { vec![self.mode] } else { Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Their mode has the normal score zero but for rounding, which is an end of pieces.
    #[test]
    fn symmetric_laws_are_resolved_wherever_they_stand() {
        for center in [0.15, 0.3, 0.5, 0.6, 1.1, 2.1, 7.3, 11.0, 100.0, -3.7] {
            for half in [0.1, 0.15, 0.3, 1.0] {
                let law = triangular(center - half, center, center + half).and_then(|draft| draft.law(None));
                let law = law.unwrap_or_else(|error| panic!("{center} ± {half}: {error}"));
                // A quarter of the way up, F = 2 · 0.25²; half way, 1/2.
                let quarter = law.physical(law.standardized_quantile(0.125));
                assert!((quarter - (center - 0.5 * half)).abs() < 1e-11 * half.max(center.abs()), "{center} ± {half}");
            }
        }
    }
}
