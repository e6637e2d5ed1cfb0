//! What follows from the coefficients of an orthonormal expansion without sampling.

use super::{Expansion, Surrogate};

/// Sobol' indices of one component: shares of its variance (Sudret 2008, <https://doi.org/10.1016/j.ress.2007.04.002>).
#[derive(Debug, Clone, PartialEq)]
pub struct SobolIndices {
    /// First order, per input: Σ c_α² over the α that are non-zero in this input alone, over the variance.
    pub first: Vec<f64>,
    /// Total, per input: Σ c_α² over the α that are non-zero in this input, over the variance.
    pub total: Vec<f64>,
}

impl Expansion {
    /// Mean of Σ c_α ψ_α: the coefficient of {0}.
    pub fn mean(&self) -> f64 {
        self.indices.first().filter(|alpha| alpha.is_constant()).map_or(0.0, |_| self.coefficients[0])
    }

    /// Variance of Σ c_α ψ_α: Σ c_α² over α ≠ 0.
    pub fn variance(&self) -> f64 {
        self.squares(|alpha| alpha.iter().any(|&degree| degree > 0))
    }

    /// Sobol' indices, or `None` if the variance is zero.
    pub fn sobol_indices(&self) -> Option<SobolIndices> {
        let variance = self.variance();
        let inputs = self.indices.first()?.len();
        let share = |select: &dyn Fn(usize, &[u16]) -> bool| {
            (0..inputs).map(|j| self.squares(|alpha| select(j, alpha)) / variance).collect()
        };
        let depends = |j: usize, alpha: &[u16]| alpha[j] > 0;
        let depends_only = |j: usize, alpha: &[u16]| {
            alpha[j] > 0 && alpha.iter().enumerate().all(|(other, &degree)| other == j || degree == 0)
        };
        (variance > 0.0).then(|| SobolIndices { first: share(&depends_only), total: share(&depends) })
    }

    fn squares(&self, select: impl Fn(&[u16]) -> bool) -> f64 {
        let terms = self.indices.iter().zip(&self.coefficients);
        terms.filter(|(alpha, _)| select(alpha)).fold(0.0, |sum, (_, c)| sum + c * c)
    }
}

impl Surrogate {
    /// Mean and variance of each component by id, from the coefficients, in the component's own unit.
    pub fn moments(&self) -> Vec<(f64, f64)> {
        let moments = |component: &crate::spectrum::Component| {
            let expansion = &self.expansions[component.id];
            let mean = component.center + component.scale * expansion.mean();
            (mean, component.scale * component.scale * expansion.variance())
        };
        self.components().into_iter().map(moments).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::index_set::{IndexSet, MultiIndex};
    use crate::surrogate::{LeaveOut, StopReason};

    #[test]
    fn indices_of_a_known_expansion() {
        let indices = [[0, 0], [1, 0], [0, 2], [1, 1]].map(|alpha| MultiIndex::new(alpha.to_vec()));
        let expansion = Expansion {
            indices: IndexSet::from_unsorted(indices.to_vec()),
            coefficients: vec![5.0, 3.0, 2.0, 1.0], // canonical order: 00, 10, 11, 02
            r2: None,
            s2: None,
            corrected_s2: None,
            leave_out: LeaveOut::Row,
            degree: 2,
            stop: StopReason::Accurate,
        };
        assert_eq!((expansion.mean(), expansion.variance()), (5.0, 14.0));
        let sobol = expansion.sobol_indices().unwrap();
        assert_eq!(sobol.first, [9.0 / 14.0, 1.0 / 14.0]);
        assert_eq!(sobol.total, [13.0 / 14.0, 5.0 / 14.0]);
    }
}
