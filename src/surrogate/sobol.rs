//! Sobol' indices of a component from its coefficients (Sobol' 1993; Sudret 2008, <https://doi.org/10.1016/j.ress.2007.04.002>).
//!
//! First order S_j = Var E\[f | ξ_j\]/V and total T_j = 1 − Var E\[f | ξ_~j\]/V, where ~j is all inputs but j. For one expansion
//! in orthonormal polynomials both are sums of squares. On elements they are not: E\[f | ξ_u\] adds up the elements that hold ξ_u,
//!
//! E\[f | ξ_u\] = Σ_e w_e^~u Σ_{α: α_~u = 0} c_α^e ψ_α(ζ_u^e),
//!
//! with w_e^~u the probability of the element's sides outside u. Its mean square is a sum over pairs of elements whose sides in u
//! overlap, of integrals of products of polynomials over the overlaps, one input at a time: exact by a Gauss rule.

use super::{Expansion, Surrogate};
use crate::input::Element;
use crate::numerics::quadrature::gauss;
use crate::polynomial::Recurrence;

/// More elements have too many pairs to look at.
const MOST_ELEMENTS: usize = 1000;

/// Sobol' indices of one component: shares of its variance.
#[derive(Debug, Clone, PartialEq)]
pub struct SobolIndices {
    /// First order, per input: what it explains on its own.
    pub first: Vec<f64>,
    /// Total, per input: what it has a part in.
    pub total: Vec<f64>,
}

impl Expansion {
    /// Sobol' indices of a global expansion, Σ c_α² over the α that are non-zero in an input alone, and over those that are
    /// non-zero in it, over the variance; `None` if the variance is zero.
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
}

impl Surrogate {
    /// Sobol' indices of a component; `None` if it does not vary, or if there are more than a thousand elements.
    pub fn sobol_indices(&self, component: usize) -> Option<SobolIndices> {
        let elements = self.mesh.elements();
        if elements.len() == 1 {
            return self.expansion(0, component).sobol_indices();
        }
        let unscaled = |(mean, variance): (f64, f64)| {
            let parts = self.components();
            let found = parts.iter().find(|part| part.id == component)?;
            Some(((mean - found.center) / found.scale, variance / (found.scale * found.scale)))
        };
        let (mean, variance) = unscaled(*self.moments().get(component)?)?;
        if variance <= 0.0 || elements.len() > MOST_ELEMENTS {
            return None;
        }
        let conditional = |known: &dyn Fn(usize) -> bool| {
            let square = mean_square(self, component, known);
            ((square - mean * mean) / variance).clamp(0.0, 1.0)
        };
        let inputs = 0..self.inputs.dimension();
        Some(SobolIndices {
            first: inputs.clone().map(|j| conditional(&|k| k == j)).collect(),
            total: inputs.map(|j| 1.0 - conditional(&|k| k != j)).collect(),
        })
    }
}

/// E\[E\[f | ξ_u\]²\] for the inputs u that are `known`.
fn mean_square(surrogate: &Surrogate, component: usize, known: &dyn Fn(usize) -> bool) -> f64 {
    let known: Vec<usize> = (0..surrogate.inputs.dimension()).filter(|&k| known(k)).collect();
    let degree =
        surrogate.expansions_of(component).flat_map(|part| part.indices.iter().flat_map(|alpha| alpha.to_vec()));
    let size = usize::from(degree.max().unwrap_or(0)) + 1;
    let rules: Vec<Rule> = known.iter().map(|&k| Rule::new(surrogate, k, size)).collect();
    let parts: Vec<Part<'_>> = surrogate
        .mesh
        .elements()
        .iter()
        .zip(surrogate.expansions_of(component))
        .map(|(element, expansion)| Part::new(element, expansion, &known))
        .collect();
    let mut sum = 0.0;
    for (at, one) in parts.iter().enumerate() {
        sum += one.product(one, &known, &rules);
        for other in &parts[at + 1..] {
            sum += 2.0 * one.product(other, &known, &rules);
        }
    }
    sum
}

/// A Gauss rule that integrates products of two polynomials of one input.
struct Rule {
    recurrence: Recurrence,
    nodes: Vec<f64>,
    weights: Vec<f64>,
}

impl Rule {
    fn new(surrogate: &Surrogate, input: usize, size: usize) -> Self {
        let recurrence = surrogate.inputs.inputs()[input].marginal.family().recurrence(size);
        let (nodes, weights) = gauss(&recurrence.diagonal[..size], &recurrence.off_diagonal[..size - 1]);
        Self { recurrence, nodes, weights }
    }
}

/// What an element contributes to E\[f | ξ_u\].
struct Part<'a> {
    element: &'a Element,
    /// Degrees in u and w_e^~u c_α, for the α that are zero outside u.
    terms: Vec<(Vec<usize>, f64)>,
}

impl<'a> Part<'a> {
    fn new(element: &'a Element, expansion: &Expansion, known: &[usize]) -> Self {
        let outside = |k: &usize| !known.contains(k);
        let weight: f64 = (0..element.lower.len()).filter(outside).map(|k| element.half_width(k)).product();
        let terms = expansion.indices.iter().zip(&expansion.coefficients);
        let terms = terms.filter(|(alpha, _)| (0..alpha.len()).filter(outside).all(|k| alpha[k] == 0));
        let terms = terms.map(|(alpha, c)| (known.iter().map(|&k| usize::from(alpha[k])).collect(), weight * c));
        Self { element, terms: terms.collect() }
    }

    /// Mean of the product of both contributions over the box where the sides in u overlap.
    fn product(&self, other: &Self, known: &[usize], rules: &[Rule]) -> f64 {
        let mut integrals = Vec::with_capacity(known.len());
        for (&k, rule) in known.iter().zip(rules) {
            match self.overlap(other, k, rule) {
                Some(of_input) => integrals.push(of_input),
                None => return 0.0,
            }
        }
        let mut sum = 0.0;
        for (alpha, a) in &self.terms {
            for (beta, b) in &other.terms {
                let degrees = alpha.iter().zip(beta).zip(&integrals);
                sum += a * b * degrees.map(|((&alpha, &beta), of_input)| of_input[alpha][beta]).product::<f64>();
            }
        }
        sum
    }

    /// ½∫ φ_a(ζ) φ_b(ζ′) dξ over the overlap of both sides k, for all degrees; `None` if they do not overlap.
    fn overlap(&self, other: &Self, k: usize, rule: &Rule) -> Option<Vec<Vec<f64>>> {
        let (one, two) = (self.element, other.element);
        let (lower, upper) = (one.lower[k].max(two.lower[k]), one.upper[k].min(two.upper[k]));
        if lower >= upper {
            return None;
        }
        let size = rule.nodes.len();
        let (mut first, mut second) = (vec![0.0; size], vec![0.0; size]);
        let mut integrals = vec![vec![0.0; size]; size];
        let (middle, half) = (0.5 * (lower + upper), 0.5 * (upper - lower));
        for (node, weight) in rule.nodes.iter().zip(&rule.weights) {
            let xi = middle + half * node;
            rule.recurrence.evaluate((xi - one.center(k)) / one.half_width(k), &mut first);
            rule.recurrence.evaluate((xi - two.center(k)) / two.half_width(k), &mut second);
            for (row, a) in integrals.iter_mut().zip(&first) {
                row.iter_mut().zip(&second).for_each(|(entry, b)| *entry += half * weight * a * b);
            }
        }
        Some(integrals)
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
