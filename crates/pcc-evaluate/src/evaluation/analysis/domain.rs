//! Where values of an input are looked for.

use crate::probability::inputs::Marginal;

/// The range of an input in which values of it are looked for, in places from −1 to 1: its interval, or if that has an
/// open end, what lies between two quantiles far out of the law that fixed inputs leave it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Domain {
    law: Marginal,
    /// Mean and standard deviation of its normal score.
    of_scores: [f64; 2],
}

impl Domain {
    pub fn new(law: Marginal, of_scores: [f64; 2]) -> Self {
        Self { law, of_scores }
    }

    /// The standardized value at a place.
    pub fn standardized(&self, place: f64) -> f64 {
        self.law.germ().along(place, self.of_scores)
    }

    /// The value at a place, in the input's own unit.
    pub fn along(&self, place: f64) -> f64 {
        self.law.along(place, self.of_scores)
    }

    /// Its ends, in the input's own unit.
    pub fn ends(&self) -> [f64; 2] {
        if self.tail() > 0.0 { [-1.0, 1.0].map(|place| self.along(place)) } else { self.law.support() }
    }

    /// The probability beyond either end.
    pub fn tail(&self) -> f64 {
        0.5 * (1.0 - self.law.germ().reach())
    }
}
