//! Tensor products of Gauss rules: all combinations of the nodes of one rule per input.
//!
//! With p + 1 nodes per input the rule integrates polynomials of degree 2p + 1 in each input exactly, so polynomials of
//! degree up to p are orthonormal on the nodes, too. Nodes are made from their numbers; none is stored.

use super::samples::Samples;
use crate::numerics::quadrature::gauss;
use pcc_evaluate::polynomials::Recurrence;
use std::ops::Range;

/// A tensor product of Gauss rules, in standardized or local variables.
///
/// # Examples
///
/// ```
/// use pcc_compile::fitting::design::TensorGauss;
/// use pcc_evaluate::polynomials::Family;
/// let grid = TensorGauss::new(&vec![Family::Legendre.recurrence(3); 2], 3);
/// assert_eq!(grid.len(), 9);
/// // E[x⁴ y²] = 1/5 · 1/3 for uniform x and y on [−1, 1].
/// let nodes = grid.nodes(0..9);
/// let integral: f64 = nodes.points().zip(grid.weights(0..9)).map(|(x, w)| w * x[0].powi(4) * x[1].powi(2)).sum();
/// assert!((integral - 1.0 / 15.0).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TensorGauss {
    /// Nodes and weights per input.
    rules: Vec<(Vec<f64>, Vec<f64>)>,
    len: usize,
}

impl TensorGauss {
    /// The product of rules with `size` nodes each, one for the orthonormal polynomials of each recurrence.
    ///
    /// # Panics
    ///
    /// If `size` is zero or a recurrence does not reach degree `size`.
    pub fn new(recurrences: &[Recurrence], size: usize) -> Self {
        assert!(size > 0, "a rule needs nodes");
        let rule = |recurrence: &Recurrence| gauss(&recurrence.diagonal[..size], &recurrence.off_diagonal[..size - 1]);
        Self { rules: recurrences.iter().map(rule).collect(), len: size.pow(recurrences.len() as u32) }
    }

    /// Number of nodes, the product of those of all rules.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Never: there is a node at least.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The nodes with these numbers; the last input changes fastest.
    pub fn nodes(&self, range: Range<usize>) -> Samples {
        let mut coordinates = Vec::with_capacity(range.len() * self.rules.len());
        for number in range {
            self.positions(number, |(nodes, _), at| coordinates.push(nodes[at]));
        }
        Samples::new(self.rules.len(), coordinates)
    }

    /// Their weights; those of all nodes sum to one.
    pub fn weights(&self, range: Range<usize>) -> impl Iterator<Item = f64> {
        range.map(|number| {
            let mut weight = 1.0;
            self.positions(number, |(_, weights), at| weight *= weights[at]);
            weight
        })
    }

    /// Calls `visit` with each input's rule and the position of node `number` in it.
    fn positions(&self, number: usize, mut visit: impl FnMut(&(Vec<f64>, Vec<f64>), usize)) {
        let (mut rest, mut stride) = (number, self.len);
        for rule in &self.rules {
            stride /= rule.0.len();
            visit(rule, rest / stride);
            rest %= stride;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::polynomials::Family;

    #[test]
    fn nodes_are_all_combinations_in_order() {
        let grid = TensorGauss::new(&vec![Family::Legendre.recurrence(2); 3], 2);
        let signs: Vec<Vec<f64>> = grid.nodes(0..8).points().map(|x| x.iter().map(|x| x.signum()).collect()).collect();
        assert_eq!(signs[0], [-1.0, -1.0, -1.0]);
        assert_eq!(signs[1], [-1.0, -1.0, 1.0]);
        assert_eq!(signs[6], [1.0, 1.0, -1.0]);
        assert_eq!(grid.nodes(3..5).point(0), grid.nodes(0..8).point(3));
        assert!((grid.weights(0..8).sum::<f64>() - 1.0).abs() < 1e-15);
    }
}
