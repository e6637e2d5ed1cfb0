//! The uniform law.

use super::germ::Germ;
use super::law::{Law, Transform};
use super::marginal_error::MarginalError;

/// The uniform distribution on \[lower, upper\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uniform {
    lower: f64,
    upper: f64,
}

impl Uniform {
    /// The uniform distribution on \[lower, upper\], in the input's own unit.
    ///
    /// # Errors
    ///
    /// Bounds must be finite and ascending, and far enough apart that 2⁵² points fit between them within rounding.
    pub fn new(lower: f64, upper: f64) -> Result<Self, MarginalError> {
        if !(lower.is_finite() && upper.is_finite()) {
            return Err(MarginalError::NotFinite { lower, upper });
        }
        if lower >= upper {
            return Err(MarginalError::Inverted { lower, upper });
        }
        let width = upper - lower;
        let largest = lower.abs().max(upper.abs());
        if !width.is_normal() || !width.is_finite() || width < 1e3 * f64::EPSILON * largest {
            return Err(MarginalError::Unresolved { lower, upper });
        }
        Ok(Self { lower, upper })
    }

    /// Lower bound.
    pub fn lower(&self) -> f64 {
        self.lower
    }

    /// Upper bound.
    pub fn upper(&self) -> f64 {
        self.upper
    }

    /// Middle of the interval.
    pub fn center(&self) -> f64 {
        self.lower + 0.5 * (self.upper - self.lower)
    }

    /// Half the length of the interval.
    pub fn half_width(&self) -> f64 {
        0.5 * (self.upper - self.lower)
    }
}

impl Law for Uniform {
    fn name(&self) -> &'static str {
        "uniform"
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("lower", self.lower), ("upper", self.upper)]
    }

    fn germ(&self) -> &Germ {
        &Germ::Uniform
    }

    #[inline]
    fn physical(&self, xi: f64) -> f64 {
        self.center() + self.half_width() * xi
    }

    fn slope(&self, _: f64) -> f64 {
        self.half_width()
    }

    #[inline]
    fn standardized(&self, x: f64) -> f64 {
        (x - self.center()) / self.half_width()
    }

    fn support(&self) -> [f64; 2] {
        [self.lower, self.upper]
    }

    fn transform(&self) -> Transform<'_> {
        Transform::Affine { center: self.center(), half_width: self.half_width() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_parameters_are_refused() {
        assert!(matches!(Uniform::new(1.0, 1.0), Err(MarginalError::Inverted { .. })));
        assert!(matches!(Uniform::new(2.0, 1.0), Err(MarginalError::Inverted { .. })));
        assert!(matches!(Uniform::new(f64::NAN, 1.0), Err(MarginalError::NotFinite { .. })));
        assert!(matches!(Uniform::new(0.0, f64::INFINITY), Err(MarginalError::NotFinite { .. })));
        assert!(matches!(Uniform::new(1.0, 1.0 + 1e-15), Err(MarginalError::Unresolved { .. })));
        assert!(matches!(Uniform::new(-1.7e308, 1.7e308), Err(MarginalError::Unresolved { .. })));
    }
}
