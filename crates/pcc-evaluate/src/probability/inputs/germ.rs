//! Standardized variables: what the polynomials of an expansion are functions of.

use super::normal_quantile::{at_centred, distribution, normal_at};
use crate::polynomials::Family;

/// The law of a standardized variable ξ. Inputs are functions of it, affine ones where their law is of the same kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Germ {
    /// Uniform on [−1, 1].
    Uniform,
    /// Standard normal.
    Normal,
    /// Standard normal on condition that it lies between bounds.
    TruncatedNormal(Cut),
}

/// Bounds of a standard normal variable, infinite where there is none, and the probability beyond each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    lower: f64,
    upper: f64,
    beyond: [f64; 2],
}

impl Cut {
    pub(super) fn new(lower: f64, upper: f64) -> Self {
        Self { lower, upper, beyond: [distribution(lower), distribution(-upper)] }
    }

    /// The probability between the bounds.
    pub(super) fn left(&self) -> f64 {
        1.0 - self.beyond[0] - self.beyond[1]
    }

    /// ξ at the centred probability η.
    #[inline(always)]
    fn at(&self, centred: f64) -> f64 {
        let left = self.left();
        let below = (0.5 * (1.0 + centred)).mul_add(left, self.beyond[0]);
        let above = (0.5 * (1.0 - centred)).mul_add(left, self.beyond[1]);
        // The smaller tail keeps its digits.
        let centred = if below <= above { 2.0f64.mul_add(below, -1.0) } else { (-2.0f64).mul_add(above, 1.0) };
        at_centred(centred, below.min(above)).max(self.lower).min(self.upper)
    }

    fn centred_probability(&self, xi: f64) -> f64 {
        let below = (distribution(xi) - self.beyond[0]) / self.left();
        let above = (distribution(-xi) - self.beyond[1]) / self.left();
        let centred = if below <= above { 2.0f64.mul_add(below, -1.0) } else { (-2.0f64).mul_add(above, 1.0) };
        centred.clamp(-1.0, 1.0)
    }
}

/// The largest |2F − 1| at which a search along an unbounded input looks: 3.7 standard deviations of a normal one.
const REACH: f64 = 1.0 - 1.0 / 4096.0;

impl Germ {
    /// The polynomials that are orthonormal in it.
    pub fn family(self) -> Family {
        match self {
            Self::Uniform => Family::Legendre,
            Self::Normal => Family::Hermite,
            Self::TruncatedNormal(cut) => Family::TruncatedNormal { lower: cut.lower, upper: cut.upper },
        }
    }

    /// ξ at the centred probability η = 2F(ξ) − 1 ∈ (−1, 1), F being its distribution function.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::inputs::Germ;
    /// assert_eq!(Germ::Uniform.at(0.5), 0.5);
    /// assert!((Germ::Normal.at(0.5) - 0.6744897501960817).abs() < 1e-15);
    /// ```
    #[inline(always)]
    pub fn at(self, centred: f64) -> f64 {
        match self {
            Self::Uniform => centred,
            Self::Normal => normal_at(centred),
            Self::TruncatedNormal(cut) => cut.at(centred),
        }
    }

    /// η = 2F(ξ) − 1.
    pub fn centred_probability(self, xi: f64) -> f64 {
        match self {
            Self::Uniform => xi.clamp(-1.0, 1.0),
            // The smaller tail keeps its digits.
            Self::Normal if xi > 0.0 => 1.0 - 2.0 * distribution(-xi),
            Self::Normal => 2.0 * distribution(xi) - 1.0,
            Self::TruncatedNormal(cut) => cut.centred_probability(xi),
        }
    }

    /// The largest |η| at which values of an input are looked for.
    pub fn reach(self) -> f64 {
        match self {
            Self::Uniform => 1.0,
            Self::TruncatedNormal(cut) if cut.lower.is_finite() && cut.upper.is_finite() => 1.0,
            Self::Normal | Self::TruncatedNormal(_) => REACH,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centred_probabilities_are_undone() {
        let cut = |lower, upper| Germ::TruncatedNormal(Cut::new(lower, upper));
        let cuts = [cut(-1.0, 2.0), cut(-1.7, f64::INFINITY), cut(f64::NEG_INFINITY, 0.3), cut(-6.0, 1.0)];
        for germ in [Germ::Uniform, Germ::Normal].into_iter().chain(cuts) {
            for k in -99..100 {
                let centred = f64::from(k) / 100.0;
                assert!((germ.centred_probability(germ.at(centred)) - centred).abs() < 1e-14, "{germ:?} {centred}");
            }
        }
    }
}
