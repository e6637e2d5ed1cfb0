//! What follows from the coefficients of an orthonormal expansion without sampling.

use super::{Expansion, StopReason, Surrogate};
use crate::polynomials::Element;

impl Expansion {
    /// Mean of Σ c_α ψ_α: the coefficient of {0}.
    pub fn mean(&self) -> f64 {
        self.indices.first().filter(|alpha| alpha.is_constant()).map_or(0.0, |_| self.coefficients[0])
    }

    /// Variance of Σ c_α ψ_α: Σ c_α² over α ≠ 0.
    pub fn variance(&self) -> f64 {
        self.squares(|alpha| alpha.iter().any(|&degree| degree > 0))
    }

    pub(super) fn squares(&self, select: impl Fn(&[u16]) -> bool) -> f64 {
        let terms = self.indices.iter().zip(&self.coefficients);
        terms.filter(|(alpha, _)| select(alpha)).fold(0.0, |sum, (_, c)| sum + c * c)
    }
}

impl Surrogate {
    /// Mean and variance of each component by id, from the coefficients, in the component's own unit: Σ_e w_e m_e and
    /// Σ_e w_e (v_e + (m_e − m)²) over elements of probability w_e, mean m_e and variance v_e. Where inputs depend on
    /// each other they are those of independent inputs with the same laws.
    pub fn moments(&self) -> Vec<(f64, f64)> {
        let weights = || self.mesh.elements().iter().map(|element| element.weight);
        let moments = |component: &crate::components::Component| {
            let parts = || weights().zip(self.expansions_of(component.id));
            let mean = parts().map(|(weight, part)| weight * part.mean()).sum::<f64>();
            let square = |part: &Expansion| part.variance() + (part.mean() - mean).powi(2);
            let variance = parts().map(|(weight, part)| weight * square(part)).sum::<f64>();
            (component.center + component.scale * mean, component.scale * component.scale * variance)
        };
        self.components().into_iter().map(moments).collect()
    }

    /// How well a component is fitted over all elements: degree and terms are the most of any element, R² and S² the
    /// means by probability.
    pub fn fit_of(&self, component: usize) -> FitQuality {
        let parts = || self.expansions_of(component);
        let mean = |share: fn(&Expansion) -> Option<f64>| -> Option<f64> {
            let of_element = |(element, part): (&Element, &Expansion)| match share(part) {
                None if part.stop == StopReason::Constant => Some(element.weight),
                share => share.map(|share| element.weight * share),
            };
            let shares: Option<Vec<f64>> = self.mesh.elements().iter().zip(parts()).map(of_element).collect();
            shares.map(|shares| shares.iter().sum())
        };
        let is_constant = parts().all(|part| part.stop == StopReason::Constant);
        let mean = |share| if is_constant { None } else { mean(share) };
        FitQuality {
            degree: parts().map(|part| part.degree).max().unwrap_or(0),
            terms: parts().map(|part| part.indices.len()).max().unwrap_or(0),
            r2: mean(|part| part.r2),
            s2: mean(|part| part.s2),
            corrected_s2: mean(|part| part.corrected_s2),
            stop: parts().map(|part| part.stop).max_by_key(|&stop| severity(stop)).unwrap_or(StopReason::Constant),
        }
    }
}

/// How well a component is fitted over all elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitQuality {
    /// Highest degree.
    pub degree: u16,
    /// Most terms.
    pub terms: usize,
    /// R².
    pub r2: Option<f64>,
    /// Leave-one-out S².
    pub s2: Option<f64>,
    /// S² with the correction for small designs.
    pub corrected_s2: Option<f64>,
    /// Why the search ended: the least satisfied element.
    pub stop: StopReason,
}

fn severity(stop: StopReason) -> usize {
    match stop {
        StopReason::Constant => 0,
        StopReason::Accurate | StopReason::GivenDegree | StopReason::Settled => 1,
        StopReason::HighestDegree | StopReason::Stalled => 2,
        StopReason::DesignExhausted | StopReason::Limited => 3,
    }
}
