//! Sobol' indices of components from their coefficients (Sobol' 1993; Sudret 2008,
//! <https://doi.org/10.1016/j.ress.2007.04.002>).
//!
//! First order S_j = Var E\[f | ξ_j\]/V and total T_j = 1 − Var E\[f | ξ_~j\]/V, where ~j is all inputs but j. For one
//! expansion in orthonormal polynomials both are sums of squares. On elements they are not: E\[f | ξ_u\] adds up the
//! elements that hold ξ_u,
//!
//! E\[f | ξ_u\] = Σ_e w_e^~u Σ_{α: α_~u = 0} c_α^e ψ_α(ζ_u^e),
//!
//! with w_e^~u the probability of the element's sides outside u. With the mean taken off every c_0^e first, its
//! variance is a sum over pairs of elements whose sides in u overlap, of integrals of products of polynomials over the
//! overlaps, one input at a time: exact by a Gauss rule. For u = {j} all elements with the same side are added up
//! before.

use super::{Expansion, Surrogate};
use crate::polynomials::{Element, Recurrence, gauss};
use std::collections::BTreeMap;

/// More elements, which no study asks for, have too many pairs to look at.
const MOST_ELEMENTS: usize = 10_000;

/// Higher degrees, which no study asks for either, make Gauss rules and integrals too large.
const HIGHEST_DEGREE: usize = 100;

/// Integrals for one input that are held in memory at most; a mesh of halves has few overlaps for each side.
const MOST_INTEGRALS: usize = 50_000_000;

/// Sobol' indices of one component: shares of its variance.
#[derive(Debug, Clone, PartialEq)]
pub struct SobolIndices {
    /// First order, per input: what it explains on its own.
    pub first: Vec<f64>,
    /// Total, per input: what it has a part in.
    pub total: Vec<f64>,
}

impl Expansion {
    /// Sobol' indices of a global expansion, Σ c_α² over the α that are non-zero in an input alone, and over those that
    /// are non-zero in it, over the variance; `None` if the variance is zero.
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
    /// Sobol' indices of every component by id; `None` for those that do not vary. All `None` where inputs depend on
    /// each other, which leaves coefficients without this meaning, and for meshes that no study gives, of more than ten
    /// thousand elements, a degree above 100, or millions of overlaps.
    pub fn sobol_indices(&self) -> Vec<Option<SobolIndices>> {
        let components = 0..self.component_count();
        if self.inputs.dependence().is_some() {
            return vec![None; components.len()];
        }
        if self.mesh.elements().len() == 1 {
            return components.map(|id| self.expansion(0, id).sobol_indices()).collect();
        }
        match Overlaps::new(self) {
            Some(overlaps) => components.map(|id| on_elements(self, id, &overlaps)).collect(),
            None => vec![None; self.component_count()],
        }
    }
}

/// The indices of one component.
fn on_elements(surrogate: &Surrogate, component: usize, overlaps: &Overlaps) -> Option<SobolIndices> {
    let elements = surrogate.mesh.elements();
    let parts: Vec<&Expansion> = surrogate.expansions_of(component).collect();
    let weighted = || elements.iter().zip(&parts);
    let mean: f64 = weighted().map(|(element, part)| element.weight * part.mean()).sum();
    let square = |part: &Expansion| part.variance() + (part.mean() - mean).powi(2);
    let variance: f64 = weighted().map(|(element, part)| element.weight * square(part)).sum();
    let inputs = 0..surrogate.inputs.dimension();
    let share = |conditional: f64| (conditional / variance).clamp(0.0, 1.0);
    (variance > 0.0).then(|| SobolIndices {
        first: inputs.clone().map(|j| share(overlaps.variance_alone(j, elements, &parts, mean))).collect(),
        total: inputs.map(|j| 1.0 - share(overlaps.variance_without(j, elements, &parts, mean))).collect(),
    })
}

/// ½∫ φ_a(ζ) φ_b(ζ′) dξ over the overlap of two sides, with b running fastest.
type Integrals = Vec<f64>;

/// The different sides of the elements along one input, and where they overlap.
struct Sides {
    /// The side of each element.
    of_element: Vec<usize>,
    /// For each side, those that overlap it, ascending, with the integrals.
    overlapping: Vec<Vec<(usize, Integrals)>>,
}

impl Sides {
    fn integrals(&self, a: usize, b: usize) -> Option<&Integrals> {
        let found = &self.overlapping[a];
        found.binary_search_by_key(&b, |(other, _)| *other).ok().map(|at| &found[at].1)
    }
}

/// Everything about a mesh that does not depend on the component.
struct Overlaps {
    sides: Vec<Sides>,
    /// For each input j, the pairs of elements whose sides overlap in all others; each pair once.
    pairs: Vec<Vec<(usize, usize)>>,
    /// Highest degree plus one.
    size: usize,
    /// The index of the mean.
    constant: Vec<u16>,
}

impl Overlaps {
    fn new(surrogate: &Surrogate) -> Option<Self> {
        let elements = surrogate.mesh.elements();
        if elements.len() > MOST_ELEMENTS {
            return None;
        }
        let degrees = surrogate.expansions.iter().flat_map(|part| part.indices.iter().flat_map(|alpha| alpha.to_vec()));
        let size = usize::from(degrees.max().unwrap_or(0)) + 1;
        if size > HIGHEST_DEGREE + 1 {
            return None;
        }
        let inputs = surrogate.inputs.inputs().iter().enumerate();
        let sides: Option<Vec<Sides>> =
            inputs.map(|(k, input)| Sides::new(elements, k, &input.marginal.family().recurrence(size), size)).collect();
        let sides = sides?;
        let pairs = (0..sides.len()).map(|j| pairs_without(&sides, j, elements)).collect();
        Some(Self { constant: vec![0; sides.len()], sides, pairs, size })
    }

    /// Var E\[f | ξ_j\].
    fn variance_alone(&self, j: usize, elements: &[Element], parts: &[&Expansion], mean: f64) -> f64 {
        let Sides { of_element, overlapping } = &self.sides[j];
        let mut sums = vec![vec![0.0; self.size]; overlapping.len()];
        for ((element, part), &side) in elements.iter().zip(parts).zip(of_element) {
            let weight = element.weight / element.half_width(j);
            for (alpha, c) in centred(part, mean, &self.constant) {
                if alpha.iter().enumerate().all(|(k, &degree)| k == j || degree == 0) {
                    sums[side][usize::from(alpha[j])] += weight * c;
                }
            }
        }
        let mut variance = 0.0;
        for (a, others) in overlapping.iter().enumerate() {
            for (b, integrals) in others {
                for (row, one) in integrals.chunks_exact(self.size).zip(&sums[a]) {
                    variance += row.iter().zip(&sums[*b]).map(|(integral, other)| one * other * integral).sum::<f64>();
                }
            }
        }
        variance
    }

    /// Var E\[f | ξ_~j\].
    fn variance_without(&self, j: usize, elements: &[Element], parts: &[&Expansion], mean: f64) -> f64 {
        let terms: Vec<Vec<(&[u16], f64)>> = elements
            .iter()
            .zip(parts)
            .map(|(element, part)| {
                let without_j = centred(part, mean, &self.constant).filter(|(alpha, _)| alpha[j] == 0);
                without_j.map(|(alpha, c)| (alpha, element.half_width(j) * c)).collect()
            })
            .collect();
        let inputs: Vec<usize> = (0..self.sides.len()).filter(|&k| k != j).collect();
        let mut variance = 0.0;
        for &(one, other) in &self.pairs[j] {
            let overlaps: Vec<&Integrals> = inputs.iter().filter_map(|&k| self.of_pair(k, one, other)).collect();
            let mut sum = 0.0;
            for (alpha, a) in &terms[one] {
                for (beta, b) in &terms[other] {
                    let product = inputs.iter().zip(&overlaps).fold(a * b, |product, (&k, integrals)| {
                        product * integrals[usize::from(alpha[k]) * self.size + usize::from(beta[k])]
                    });
                    sum += product;
                }
            }
            variance += if one == other { sum } else { 2.0 * sum };
        }
        variance
    }

    fn of_pair(&self, k: usize, one: usize, other: usize) -> Option<&Integrals> {
        let sides = &self.sides[k];
        sides.integrals(sides.of_element[one], sides.of_element[other])
    }
}

/// The terms of f − `mean` in an element; `constant` is the index of the mean.
fn centred<'a>(part: &'a Expansion, mean: f64, constant: &'a [u16]) -> impl Iterator<Item = (&'a [u16], f64)> {
    let others = part.indices.iter().zip(&part.coefficients).filter(|(alpha, _)| !alpha.is_constant());
    std::iter::once((constant, part.mean() - mean)).chain(others.map(|(alpha, c)| (&**alpha, *c)))
}

impl Sides {
    fn new(elements: &[Element], k: usize, recurrence: &Recurrence, size: usize) -> Option<Self> {
        // Bounds by their bits: equal sides come from the same splits.
        let key = |element: &Element| (element.lower[k].to_bits(), element.upper[k].to_bits());
        let mut numbers = BTreeMap::new();
        let mut of_side: Vec<&Element> = Vec::new();
        let of_element = elements
            .iter()
            .map(|element| {
                *numbers.entry(key(element)).or_insert_with(|| {
                    of_side.push(element);
                    of_side.len() - 1
                })
            })
            .collect();
        let (nodes, weights) = gauss(&recurrence.diagonal[..size], &recurrence.off_diagonal[..size - 1]);
        let rule = Rule { recurrence, nodes, weights };
        let mut count = 0;
        let mut overlapping = Vec::with_capacity(of_side.len());
        for one in &of_side {
            let mut found = Vec::new();
            for (b, other) in of_side.iter().enumerate() {
                let Some(integrals) = rule.integrals(one, other, k) else { continue };
                count += integrals.len();
                if count > MOST_INTEGRALS {
                    return None;
                }
                found.push((b, integrals));
            }
            overlapping.push(found);
        }
        Some(Self { of_element, overlapping })
    }
}

/// Pairs of elements whose sides overlap along every input but j.
fn pairs_without(sides: &[Sides], j: usize, elements: &[Element]) -> Vec<(usize, usize)> {
    let overlap = |one: &Element, other: &Element| {
        (0..sides.len()).all(|k| k == j || (one.lower[k] < other.upper[k] && other.lower[k] < one.upper[k]))
    };
    let others = |one: usize| (one..elements.len()).map(move |other| (one, other));
    let pairs = (0..elements.len()).flat_map(others);
    pairs.filter(|&(one, other)| overlap(&elements[one], &elements[other])).collect()
}

/// A Gauss rule that integrates products of two polynomials of one input exactly.
struct Rule<'a> {
    recurrence: &'a Recurrence,
    nodes: Vec<f64>,
    weights: Vec<f64>,
}

impl Rule<'_> {
    /// The integrals over the overlap of both sides k; `None` if they do not overlap.
    fn integrals(&self, one: &Element, two: &Element, k: usize) -> Option<Integrals> {
        let (lower, upper) = (one.lower[k].max(two.lower[k]), one.upper[k].min(two.upper[k]));
        if lower >= upper {
            return None;
        }
        let size = self.nodes.len();
        let (mut first, mut second) = (vec![0.0; size], vec![0.0; size]);
        let mut integrals = vec![0.0; size * size];
        let (middle, half) = (0.5 * (lower + upper), 0.5 * (upper - lower));
        for (node, weight) in self.nodes.iter().zip(&self.weights) {
            let xi = middle + half * node;
            self.recurrence.evaluate((xi - one.center(k)) / one.half_width(k), &mut first);
            self.recurrence.evaluate((xi - two.center(k)) / two.half_width(k), &mut second);
            for (row, a) in integrals.chunks_exact_mut(size).zip(&first) {
                row.iter_mut().zip(&second).for_each(|(entry, b)| *entry += half * weight * a * b);
            }
        }
        Some(integrals)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polynomials::{IndexSet, MultiIndex};
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
