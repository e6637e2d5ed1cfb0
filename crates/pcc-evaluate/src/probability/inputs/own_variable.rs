//! Standardized variables with a law of their own.

use super::pieces::Pieces;
use crate::polynomials::OwnPolynomials;
use std::sync::Arc;

/// A variable ξ = q(z), z being standard normal, with its orthonormal polynomials.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnVariable {
    pub(super) quantile: Arc<Pieces>,
    pub(super) polynomials: Arc<OwnPolynomials>,
    /// Whether it has a lower and an upper bound.
    pub(super) is_bounded: [bool; 2],
}

impl OwnVariable {
    /// Its value at a normal score.
    #[inline(always)]
    pub(crate) fn at_score(&self, z: f64) -> f64 {
        self.quantile.at(z)
    }

    /// The normal score of a value.
    pub(crate) fn score(&self, xi: f64) -> f64 {
        self.quantile.score(xi)
    }
}
