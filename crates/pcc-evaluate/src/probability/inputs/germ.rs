//! Standardized variables: what the polynomials of an expansion are functions of.

use super::normal_quantile::{distribution, normal_at};
use super::own_variable::OwnVariable;
use crate::polynomials::Family;
use std::sync::Arc;

/// The law of a standardized variable ξ. Inputs are functions of it, affine ones where their law is of the same kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Germ {
    /// Uniform on [−1, 1].
    Uniform,
    /// Standard normal.
    Normal,
    /// Of a law of its own.
    Own(Arc<OwnVariable>),
}

/// The largest |2F − 1| at which a search along an unbounded input looks: 3.7 standard deviations of a normal one.
const REACH: f64 = 1.0 - 1.0 / 4096.0;

impl Germ {
    /// The polynomials that are orthonormal in it.
    pub fn family(&self) -> Family {
        match self {
            Self::Uniform => Family::Legendre,
            Self::Normal => Family::Hermite,
            Self::Own(own) => Family::Own(own.polynomials.clone()),
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
    pub fn at(&self, centred: f64) -> f64 {
        match self {
            Self::Uniform => centred,
            Self::Normal => normal_at(centred),
            Self::Own(own) => own.at_score(normal_at(centred)),
        }
    }

    /// η = 2F(ξ) − 1.
    pub fn centred_probability(&self, xi: f64) -> f64 {
        match self {
            Self::Uniform => xi.clamp(-1.0, 1.0),
            Self::Normal => centred_probability_of_score(xi),
            Self::Own(own) => centred_probability_of_score(own.score(xi)),
        }
    }

    /// The largest |η| at which values of an input are looked for.
    pub fn reach(&self) -> f64 {
        match self {
            Self::Uniform => 1.0,
            Self::Own(own) if own.is_bounded == [true; 2] => 1.0,
            Self::Normal | Self::Own(_) => REACH,
        }
    }
}

/// 2Φ(z) − 1. The smaller tail keeps its digits.
fn centred_probability_of_score(z: f64) -> f64 {
    if z > 0.0 { 1.0 - 2.0 * distribution(-z) } else { 2.0 * distribution(z) - 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centred_probabilities_are_undone() {
        for germ in [Germ::Uniform, Germ::Normal] {
            for k in -99..100 {
                let centred = f64::from(k) / 100.0;
                assert!((germ.centred_probability(germ.at(centred)) - centred).abs() < 1e-14, "{germ:?} {centred}");
            }
        }
    }
}
