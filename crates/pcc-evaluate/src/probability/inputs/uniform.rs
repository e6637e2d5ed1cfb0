//! The uniform law.

use super::germ::Germ;
use super::law::{Law, Transform};
use thiserror::Error;

/// Why a distribution's parameters are unusable.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MarginalError {
    /// A bound is NaN or infinite.
    #[error("bounds [{lower}, {upper}] must be finite numbers")]
    NotFinite {
        /// Lower bound found.
        lower: f64,
        /// Upper bound found.
        upper: f64,
    },
    /// The interval is empty.
    #[error("lower ({lower}) is not below upper ({upper}); swap or widen them")]
    Inverted {
        /// Lower bound found.
        lower: f64,
        /// Upper bound found.
        upper: f64,
    },
    /// The interval is too narrow for its position, or too wide, to be told apart in double precision.
    #[error("the interval [{lower}, {upper}] is too narrow or too wide for double precision")]
    Unresolved {
        /// Lower bound found.
        lower: f64,
        /// Upper bound found.
        upper: f64,
    },
    /// A parameter is not what it has to be.
    #[error("{name} is {value}, but must be {expected}")]
    Parameter {
        /// Its name in study files.
        name: &'static str,
        /// What was found.
        value: f64,
        /// What it has to be.
        expected: &'static str,
    },
    /// There is no such law.
    #[error("{found:?} is not known; choose one of {known}")]
    Unknown {
        /// Its name.
        found: String,
        /// Names of those there are.
        known: String,
    },
    /// A law has other parameters.
    #[error("a {law} law has {expected}")]
    Form {
        /// Its name.
        law: &'static str,
        /// What its parameters can be.
        expected: &'static str,
    },
    /// A coefficient of variation of nothing.
    #[error("cv = {cv} is a share of the mean, but the mean is 0; give std instead")]
    NoScatter {
        /// The coefficient.
        cv: f64,
    },
    /// Values without weights of their own.
    #[error("there are {values} values and {weights} weights; give one for each, or none")]
    Weights {
        /// Number of values.
        values: usize,
        /// Number of weights.
        weights: usize,
    },
    /// Levels that do not differ.
    #[error("all values are equal; an uncertain input has at least two that differ, and a certain one is a constant")]
    OneLevel,
    /// Too many single values.
    #[error("there are {found} different values, more than {most}; smooth them, or give their law")]
    Levels {
        /// What was found.
        found: usize,
        /// Most of them.
        most: usize,
    },
    /// Too few measured values.
    #[error("there are {found} values, but a law takes at least {least}; give a law with its parameters")]
    FewValues {
        /// What was found.
        found: usize,
        /// Least of them.
        least: usize,
    },
    /// A measured value beyond the bounds of its law.
    #[error("{value} was measured, but lies beyond lower or upper; move the bound or remove the value")]
    BeyondBounds {
        /// The value.
        value: f64,
    },
    /// A law has one kind of polynomials.
    #[error("a {law} law leaves no choice of polynomials; remove the key")]
    NoChoice {
        /// Its name.
        law: &'static str,
    },
    /// A law's quantiles cannot be computed to all digits.
    #[error(
        "a {law} law with these parameters or values cannot be resolved in double precision; move them away from \
         extremes, or leave out values far from all others"
    )]
    Shape {
        /// Its name.
        law: &'static str,
    },
    /// The bounds of a truncated law leave next to nothing.
    #[error("the bounds leave {share:e} of the probability; move them or the mean")]
    NothingLeft {
        /// What is left.
        share: f64,
    },
}

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
