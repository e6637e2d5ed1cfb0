//! The distribution of one input and its map to the standardized variable of its polynomial family.

use crate::polynomial::Family;
use thiserror::Error;

/// Values that leave the domain by less than this share of its width still count as inside: bounds given as
/// nominal × (1 ± spread) and the same bounds written out differ by an ulp.
const BOUNDARY: f64 = 1e-9;

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

/// The distribution of one input.
///
/// # Examples
///
/// ```
/// use pcc::input::{Marginal, Uniform};
/// let friction = Marginal::Uniform(Uniform::new(0.0, 0.5)?);
/// assert_eq!(friction.physical(0.5), 0.375);
/// assert_eq!(friction.standardized(0.375), 0.5);
/// # Ok::<(), pcc::input::MarginalError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Marginal {
    /// Uniform on an interval; the standardized variable is ξ = (x − centre)/half width ∈ [−1, 1].
    Uniform(Uniform),
}

impl Marginal {
    /// The polynomial family that is orthonormal in the standardized variable.
    pub fn family(&self) -> Family {
        match self {
            Self::Uniform(_) => Family::Legendre,
        }
    }

    /// The standardized value ξ whose probability to be undercut is `unit` ∈ (0, 1).
    #[inline]
    pub fn standardized_quantile(&self, unit: f64) -> f64 {
        match self {
            Self::Uniform(_) => 2.0 * unit - 1.0,
        }
    }

    /// The physical value at the standardized value ξ.
    #[inline]
    pub fn physical(&self, standardized: f64) -> f64 {
        match self {
            Self::Uniform(uniform) => uniform.center() + uniform.half_width() * standardized,
        }
    }

    /// dx/dξ, the derivative of the physical value x by the standardized one: what the chain rule needs.
    #[inline]
    pub fn slope(&self, standardized: f64) -> f64 {
        let _ = standardized;
        match self {
            Self::Uniform(uniform) => uniform.half_width(),
        }
    }

    /// The standardized value ξ at a physical value.
    #[inline]
    pub fn standardized(&self, physical: f64) -> f64 {
        match self {
            Self::Uniform(uniform) => (physical - uniform.center()) / uniform.half_width(),
        }
    }

    /// Whether `physical` lies in the support.
    pub fn contains(&self, physical: f64) -> bool {
        match self {
            Self::Uniform(_) => self.standardized(physical).abs() <= 1.0 + 2.0 * BOUNDARY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn standardizing_undoes_the_physical_map(lower in -1e7..1e7f64, width in 1e-3..1e7f64, xi in -1.0..=1.0f64) {
            let marginal = Marginal::Uniform(Uniform::new(lower, lower + width).unwrap());
            let back = marginal.standardized(marginal.physical(xi));
            // One rounding of x, which is large where the interval is far from zero.
            let resolution = 4.0 * f64::EPSILON * (1.0 + (lower.abs() + width) / width);
            prop_assert!((back - xi).abs() <= resolution);
            prop_assert!(marginal.contains(marginal.physical(xi)));
            let chord = marginal.physical(0.5) - marginal.physical(-0.5);
            prop_assert!((marginal.slope(xi) - chord).abs() <= 4.0 * f64::EPSILON * (lower.abs() + 2.0 * width));
        }
    }

    #[test]
    fn bad_parameters_are_refused() {
        assert!(matches!(Uniform::new(1.0, 1.0), Err(MarginalError::Inverted { .. })));
        assert!(matches!(Uniform::new(2.0, 1.0), Err(MarginalError::Inverted { .. })));
        assert!(matches!(Uniform::new(f64::NAN, 1.0), Err(MarginalError::NotFinite { .. })));
        assert!(matches!(Uniform::new(0.0, f64::INFINITY), Err(MarginalError::NotFinite { .. })));
        assert!(matches!(Uniform::new(1.0, 1.0 + 1e-15), Err(MarginalError::Unresolved { .. })));
        assert!(matches!(Uniform::new(-1.7e308, 1.7e308), Err(MarginalError::Unresolved { .. })));
    }

    #[test]
    fn bounds_computed_from_a_spread_contain_the_bounds_written_out() {
        let marginal = Marginal::Uniform(Uniform::new(0.95 * 16e6, 1.05 * 16e6).unwrap());
        assert!(marginal.contains(15.2e6) && marginal.contains(16.8e6));
        assert!(!marginal.contains(15.199e6) && !marginal.contains(f64::NAN));
    }
}
