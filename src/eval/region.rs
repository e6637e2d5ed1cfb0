//! The part of the domain that samples are drawn from.

use super::lanes::{LANES, Lanes};

/// A box in the standardized domain: every input is confined to an interval, or fixed.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// ξ = lower + width · u for u uniform on (0, 1), per input.
    lower: Vec<f64>,
    width: Vec<f64>,
}

impl Region {
    /// The whole domain.
    pub fn whole(dimension: usize) -> Self {
        Self { lower: vec![-1.0; dimension], width: vec![2.0; dimension] }
    }

    /// Confines an input to this interval of its standardized variable; equal ends fix it.
    ///
    /// # Panics
    ///
    /// If there is no such input.
    pub fn confine(&mut self, input: usize, lower: f64, upper: f64) {
        self.lower[input] = lower;
        self.width[input] = upper - lower;
    }

    /// Whether an input is fixed.
    pub fn is_fixed(&self, input: usize) -> bool {
        self.width[input] == 0.0
    }

    /// Whether nothing is confined.
    pub fn is_whole(&self) -> bool {
        *self == Self::whole(self.lower.len())
    }

    /// The standardized coordinate at a place u ∈ (0, 1) inside the interval of an input. In the whole domain 2u − 1 without rounding.
    #[inline(always)]
    pub fn place(&self, input: usize, unit: f64) -> f64 {
        self.width[input].mul_add(unit, self.lower[input])
    }

    /// [`Self::place`] in all lanes.
    #[inline(always)]
    pub(super) fn place_lanes(&self, input: usize, units: &mut Lanes) {
        let (lower, width) = (self.lower[input], self.width[input]);
        for lane in 0..LANES {
            units.0[lane] = width.mul_add(units.0[lane], lower);
        }
    }
}
