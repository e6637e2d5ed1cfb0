//! The distribution of one input and its map to the standardized variable of its polynomial family.

use super::uniform::Uniform;
use crate::polynomials::Family;

/// Values that leave the domain by less than this share of its width still count as inside: bounds given as
/// nominal × (1 ± spread) and the same bounds written out differ by an ulp.
const BOUNDARY: f64 = 1e-9;

/// The distribution of one input.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::inputs::{Marginal, Uniform};
/// let friction = Marginal::Uniform(Uniform::new(0.0, 0.5)?);
/// assert_eq!(friction.physical(0.5), 0.375);
/// assert_eq!(friction.standardized(0.375), 0.5);
/// # Ok::<(), pcc_evaluate::probability::inputs::MarginalError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Marginal {
    /// Uniform on an interval; the standardized variable is ξ = (x − centre)/half width ∈ [−1, 1].
    Uniform(Uniform),
}

impl Marginal {
    /// Name of the law in study files and tables.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Uniform(_) => "uniform",
        }
    }

    /// The parameters that say which one of its laws it is, with their names in study files, in the order of these
    /// files.
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Uniform(uniform) => vec![("lower", uniform.lower()), ("upper", uniform.upper())],
        }
    }

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
    fn bounds_computed_from_a_spread_contain_the_bounds_written_out() {
        let marginal = Marginal::Uniform(Uniform::new(0.95 * 16e6, 1.05 * 16e6).unwrap());
        assert!(marginal.contains(15.2e6) && marginal.contains(16.8e6));
        assert!(!marginal.contains(15.199e6) && !marginal.contains(f64::NAN));
    }
}
