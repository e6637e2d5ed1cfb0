//! The merged expansions of one element, as a list of operations.
//!
//! The union of all components' multi-indices is a prefix tree: a term is its *parent* (the same factors but for the
//! last) times one univariate value. Only parents are computed as products; the terms below a parent that are parents
//! of no more in their component are *leaves*, folded into a sum before it is multiplied by the parent:
//!
//! f = c_0 + Σ_singles c_α φ + Σ_parents ψ_parent · (c_parent + Σ_leaves c_α φ_last).
//!
//! A coefficient so costs one fused multiply-add, and nothing else in the groups' inner loops. Parents are treated in
//! *stages*, few at a time, so that their values are still in the processor's nearest memory when the components use
//! them, one component after the other.

use crate::polynomials::MultiIndex;
use crate::surrogate::Surrogate;
use std::collections::{BTreeMap, BTreeSet};

/// Parents of one stage: 32 blocks of 64 doubles are half of a nearest memory of 32 KiB.
const PARENTS_PER_STAGE: usize = 32;

/// The factors of a term: inputs with their degrees, by input.
type Factors = Vec<(usize, u16)>;

/// One step of a three-term recurrence: φ_k(x) = (slope x + offset) φ_{k−1}(x) + coupling φ_{k−2}(x).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Step {
    pub slope: f64,
    pub offset: f64,
    pub coupling: f64,
}

/// A term that is a coefficient times one univariate value, inside a sum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Leaf {
    pub coefficient: f64,
    /// Row of the table.
    pub row: u32,
}

/// The sum of the leaves of one parent in one component, and the coefficient of the parent itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Group {
    /// Coefficient of the parent, 0 if the component has no such term.
    pub initial: f64,
    /// Row of the parent.
    pub parent: u32,
    /// End of its part of the leaves; it starts where that of the group before ends.
    pub leaves_end: u32,
}

/// The groups of one component in one stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Run {
    pub component: usize,
    pub groups_end: usize,
}

/// Some parents and what is made of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stage {
    pub products_end: usize,
    pub runs_end: usize,
}

/// What the evaluation of one element does, in order. The table has the univariate values in its first rows, input by
/// input, then the products.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Operations {
    /// Highest degree of every input.
    pub degrees: Vec<usize>,
    /// Recurrences of all inputs, one after the other: one row each.
    pub steps: Vec<Step>,
    /// Constant and end of the singles of every component.
    pub constants: Vec<(f64, usize)>,
    /// Terms in one input, component by component.
    pub singles: Vec<Leaf>,
    /// Rows of the two factors of every product: its parent and a univariate value.
    pub products: Vec<[u32; 2]>,
    pub stages: Vec<Stage>,
    pub runs: Vec<Run>,
    pub groups: Vec<Group>,
    pub leaves: Vec<Leaf>,
    /// Number of different terms, the constant not counted.
    pub terms: usize,
}

/// The terms of one component but for the constant.
type Terms = BTreeMap<Factors, f64>;

impl Operations {
    /// The program of one element. Centre and scale of the components are folded into the coefficients.
    pub fn new(surrogate: &Surrogate, element: usize) -> Self {
        let mut program = Self::default();
        let mut all: Vec<(f64, Terms)> = Vec::new();
        for component in surrogate.components() {
            let expansion = surrogate.expansion(element, component.id);
            let (mut constant, mut terms) = (component.center, Terms::new());
            for (alpha, coefficient) in expansion.indices.iter().zip(&expansion.coefficients) {
                let factors = factors(alpha);
                let coefficient = component.scale * coefficient;
                match factors.is_empty() {
                    true => constant += coefficient,
                    false => {
                        terms.insert(factors, coefficient);
                    }
                }
            }
            all.push((constant, terms));
        }
        program.add_univariates(surrogate, &all);
        program.add_singles(&all);
        program.add_stages(&all);
        program
    }

    /// Number of rows of the table.
    pub fn rows(&self) -> usize {
        self.steps.len() + self.products.len()
    }

    /// Floating-point operations per point. A fused multiply-add counts as two. Per univariate value five; per product
    /// one; per single and per leaf two, one less for the first leaf of a group whose parent has no coefficient; per
    /// group two.
    pub fn flops(&self) -> usize {
        let without_initial = self.groups.iter().filter(|group| group.initial == 0.0).count();
        let sums = self.singles.len() + self.leaves.len() + self.groups.len();
        5 * self.steps.len() + self.products.len() + 2 * sums - without_initial
    }

    fn add_univariates(&mut self, surrogate: &Surrogate, all: &[(f64, Terms)]) {
        let inputs = surrogate.inputs.inputs();
        let mut degrees = vec![0; inputs.len()];
        let mut different = BTreeSet::new();
        for factors in all.iter().flat_map(|(_, terms)| terms.keys()) {
            different.insert(factors);
            for &(input, degree) in factors {
                degrees[input] = degrees[input].max(usize::from(degree));
            }
        }
        self.terms = different.len();
        for (input, &degree) in inputs.iter().zip(&degrees) {
            let recurrence = input.marginal.family().recurrence(degree);
            let mut coupling_before = 0.0;
            for (center, coupling) in recurrence.diagonal.iter().zip(&recurrence.off_diagonal).take(degree) {
                let step =
                    Step { slope: 1.0 / coupling, offset: -center / coupling, coupling: -coupling_before / coupling };
                self.steps.push(step);
                coupling_before = *coupling;
            }
        }
        self.degrees = degrees;
    }

    /// Row of a univariate value.
    fn row(&self, (input, degree): (usize, u16)) -> u32 {
        let first: usize = self.degrees[..input].iter().sum();
        (first + usize::from(degree) - 1) as u32
    }

    fn add_singles(&mut self, all: &[(f64, Terms)]) {
        for (constant, terms) in all {
            for (factors, &coefficient) in terms {
                if let [factor] = factors[..]
                    && !is_parent(factors, terms)
                {
                    self.singles.push(Leaf { coefficient, row: self.row(factor) });
                }
            }
            self.constants.push((*constant, self.singles.len()));
        }
    }

    fn add_stages(&mut self, all: &[(f64, Terms)]) {
        let parents: BTreeSet<&[(usize, u16)]> = all
            .iter()
            .flat_map(|(_, terms)| terms.keys())
            .flat_map(|factors| (1..factors.len()).map(|length| &factors[..length]))
            .collect();
        let parents: Vec<_> = parents.into_iter().collect();
        let mut rows = BTreeMap::new();
        for stage in parents.chunks(PARENTS_PER_STAGE) {
            for &parent in stage {
                let row = self.add_parent(parent, &rows);
                rows.insert(parent, row);
            }
            for (component, (_, terms)) in all.iter().enumerate() {
                let groups_before = self.groups.len();
                stage.iter().for_each(|parent| self.add_group(parent, rows[parent], terms));
                if self.groups.len() > groups_before {
                    self.runs.push(Run { component, groups_end: self.groups.len() });
                }
            }
            self.stages.push(Stage { products_end: self.products.len(), runs_end: self.runs.len() });
        }
    }

    /// The row of a parent, all shorter ones having theirs.
    fn add_parent(&mut self, parent: &[(usize, u16)], rows: &BTreeMap<&[(usize, u16)], u32>) -> u32 {
        match *parent {
            [factor] => self.row(factor),
            [.., last] => {
                self.products.push([rows[&parent[..parent.len() - 1]], self.row(last)]);
                (self.rows() - 1) as u32
            }
            [] => 0,
        }
    }

    /// What one component makes of one parent.
    fn add_group(&mut self, parent: &[(usize, u16)], row: u32, terms: &Terms) {
        let leaves_before = self.leaves.len();
        for (factors, &coefficient) in below(parent, terms) {
            if factors.len() == parent.len() + 1 && !is_parent(factors, terms) {
                self.leaves.push(Leaf { coefficient, row: self.row(factors[parent.len()]) });
            }
        }
        let own = terms.get(parent).filter(|_| is_parent(parent, terms));
        if self.leaves.len() > leaves_before || own.is_some() {
            let initial = own.copied().unwrap_or(0.0);
            self.groups.push(Group { initial, parent: row, leaves_end: self.leaves.len() as u32 });
        }
    }
}

/// Inputs with their degrees, those of degree 0 left out.
fn factors(alpha: &MultiIndex) -> Factors {
    alpha.iter().copied().enumerate().filter(|&(_, degree)| degree > 0).collect()
}

/// The terms that extend `parent`, in order.
fn below<'a>(parent: &'a [(usize, u16)], terms: &'a Terms) -> impl Iterator<Item = (&'a Factors, &'a f64)> {
    terms
        .range(parent.to_vec()..)
        .take_while(|(factors, _)| factors.starts_with(parent))
        .filter(|(factors, _)| factors.len() > parent.len())
}

/// Whether there is a term with one factor more: then there is a group for `factors`, which takes its coefficient.
fn is_parent(factors: &[(usize, u16)], terms: &Terms) -> bool {
    below(factors, terms).any(|(longer, _)| longer.len() == factors.len() + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::test_surrogates::{expansion, inputs, surrogate};

    #[test]
    fn leaves_are_folded_and_coefficients_of_parents_start_the_sums() {
        // ξ1 is a parent of ξ1 ξ2 and ξ1 ξ3; ξ1 ξ2 of ξ1 ξ2 ξ3, without a coefficient of its own in the second
        // component.
        let first =
            expansion(&[(&[0, 0, 0], 0.5), (&[1, 0, 0], 1.0), (&[1, 1, 0], 2.0), (&[1, 0, 1], 3.0), (&[0, 0, 2], 4.0)]);
        let second = expansion(&[(&[1, 1, 1], 5.0), (&[0, 1, 0], 6.0)]);
        let surrogate = surrogate(inputs(&[(-1.0, 1.0); 3]), vec![first, second]);
        let program = Operations::new(&surrogate, 0);
        assert_eq!((program.degrees.as_slice(), program.terms), (&[1, 1, 2][..], 6));
        // Components: Re and Im of two modes. φ_2(ξ3) of the first, φ_1(ξ2) of the second.
        let constants: Vec<f64> = program.constants.iter().map(|&(constant, _)| constant).collect();
        assert_eq!(constants, [0.5, 10.0, 0.0, 11.0]);
        assert_eq!(program.singles.iter().map(|leaf| leaf.coefficient).collect::<Vec<_>>(), [4.0, 6.0]);
        // φ_1(ξ1) φ_1(ξ2) is the only product.
        assert_eq!(program.products, [[0, 1]]);
        let groups: Vec<(f64, u32)> = program.groups.iter().map(|group| (group.initial, group.parent)).collect();
        assert_eq!(groups, [(1.0, 0), (0.0, 4)]);
        assert_eq!(program.leaves.iter().map(|leaf| leaf.coefficient).collect::<Vec<_>>(), [2.0, 3.0, 5.0]);
        // Four univariate values, a product, two singles, three leaves, the first of the second group a product, two
        // groups.
        assert_eq!(program.flops(), 4 * 5 + 1 + 2 * 2 + 2 * 3 - 1 + 2 * 2);
    }

    #[test]
    fn constants_need_no_operations() {
        let surrogate = surrogate(inputs(&[(0.0, 1.0)]), vec![expansion(&[(&[0], -2.0)])]);
        let program = Operations::new(&surrogate, 0);
        assert_eq!((program.flops(), program.rows(), program.terms), (0, 0, 0));
    }
}
