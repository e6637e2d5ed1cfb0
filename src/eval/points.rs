//! A surrogate at given points.

use super::plan::{LANES, Plan, Workspace};
use crate::spectrum::{Block, spectral_abscissa};
use crate::surrogate::Surrogate;
use nalgebra::Complex;

/// Components, eigenvalues and max Re λ of `surrogate`, compiled to `plan`, at standardized points.
pub fn evaluate_points(surrogate: &Surrogate, plan: &Plan, points: &[&[f64]]) -> Block {
    let mut evaluator = Evaluator::new(surrogate, plan);
    let mut block = evaluator.block(points.len());
    evaluator.evaluate(points.len(), |number, point| point.copy_from_slice(points[number]), &mut block);
    block
}

/// Evaluates points [`LANES`] at a time, with memory of its own. Points in the same element are evaluated together, and results
/// come in the order of the points.
pub(super) struct Evaluator<'a> {
    surrogate: &'a Surrogate,
    plan: &'a Plan,
    modes: usize,
    workspace: Workspace,
    /// The points one after the other.
    points: Vec<f64>,
    /// Their numbers, element by element.
    order: Vec<usize>,
    /// The values of all components at each point.
    values: Vec<f64>,
    eigenvalues: Vec<Complex<f64>>,
}

impl<'a> Evaluator<'a> {
    pub fn new(surrogate: &'a Surrogate, plan: &'a Plan) -> Self {
        let modes = surrogate.modes().len();
        Self {
            surrogate,
            plan,
            modes,
            workspace: plan.workspace(),
            points: Vec::new(),
            order: Vec::new(),
            values: Vec::new(),
            eigenvalues: Vec::with_capacity(modes),
        }
    }

    /// An empty block with room for `samples`.
    pub fn block(&self, samples: usize) -> Block {
        Block::with_capacity(self.surrogate.component_count(), self.modes, samples)
    }

    /// Evaluates `count` points and appends the results to `block`. `set_point` writes the standardized coordinates of the
    /// point with the given number.
    pub fn evaluate(&mut self, count: usize, mut set_point: impl FnMut(usize, &mut [f64]), block: &mut Block) {
        let (dimension, components) = (self.surrogate.inputs.dimension(), self.surrogate.component_count());
        self.points.resize(count * dimension, 0.0);
        self.values.resize(count * components, 0.0);
        for (number, point) in self.points.chunks_exact_mut(dimension).enumerate() {
            set_point(number, point);
        }
        match self.plan.mesh().elements().len() {
            1 => {
                for start in (0..count).step_by(LANES) {
                    self.evaluate_lanes(0, count.min(start + LANES) - start, |lane| start + lane);
                }
            }
            elements => self.evaluate_by_element(elements, count),
        }
        for values in self.values.chunks_exact(components) {
            self.eigenvalues.clear();
            for output in &self.surrogate.outputs {
                output.recombine(values, &mut self.eigenvalues);
            }
            let max_re = spectral_abscissa(&self.eigenvalues);
            block.push(values, &self.eigenvalues, max_re);
        }
    }

    /// Sorts the points by element, maps them to the local variables, and evaluates those of each element together.
    fn evaluate_by_element(&mut self, elements: usize, count: usize) {
        let dimension = self.surrogate.inputs.dimension();
        let mesh = self.plan.mesh();
        let found: Vec<usize> = self.points.chunks_exact(dimension).map(|point| mesh.locate(point)).collect();
        let mut starts = vec![0; elements + 1];
        found.iter().for_each(|&element| starts[element + 1] += 1);
        for element in 0..elements {
            starts[element + 1] += starts[element];
        }
        let mut next = starts.clone();
        self.order.resize(count, 0);
        for (number, (&element, point)) in found.iter().zip(self.points.chunks_exact_mut(dimension)).enumerate() {
            self.order[next[element]] = number;
            next[element] += 1;
            let space = &mesh.elements()[element];
            for (j, coordinate) in point.iter_mut().enumerate() {
                *coordinate = (*coordinate - space.center(j)) / space.half_width(j);
            }
        }
        let order = std::mem::take(&mut self.order);
        for element in 0..elements {
            for group in order[starts[element]..starts[element + 1]].chunks(LANES) {
                self.evaluate_lanes(element, group.len(), |lane| group[lane]);
            }
        }
        self.order = order;
    }

    /// Evaluates the points with the numbers `number(lane)`, all in this element.
    fn evaluate_lanes(&mut self, element: usize, lanes: usize, number: impl Fn(usize) -> usize) {
        let (dimension, components) = (self.surrogate.inputs.dimension(), self.surrogate.component_count());
        for lane in 0..lanes {
            let point = &self.points[number(lane) * dimension..][..dimension];
            for (coordinate, &xi) in self.workspace.points_mut().iter_mut().zip(point) {
                coordinate[lane] = xi;
            }
        }
        self.plan.evaluate(element, &mut self.workspace);
        for lane in 0..lanes {
            let values = &mut self.values[number(lane) * components..][..components];
            for (value, component) in values.iter_mut().zip(self.workspace.components()) {
                *value = component[lane];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eval::handmade::{expansion, inputs, surrogate};
    use crate::eval::monte_carlo;
    use crate::input::Mesh;
    use crate::progress::Silent;
    use crate::random::{Purpose, Stream};

    /// Three elements with other polynomials in each.
    fn in_elements() -> Surrogate {
        let mut whole = surrogate(inputs(&[(-1.0, 1.0), (2.0, 4.0)]), vec![expansion(&[(&[0, 0], 1.0)])]);
        let mut mesh = Mesh::whole(2);
        mesh.halve(0, &[0]);
        mesh.halve(1, &[1]);
        let im = whole.expansions[1].clone();
        let growth_rate = |terms: &[(&[u16], f64)]| [expansion(terms), im.clone()];
        whole.expansions = [
            growth_rate(&[(&[0, 0], -1.0), (&[1, 0], 2.0)]),
            growth_rate(&[(&[0, 1], 3.0), (&[2, 1], 0.5)]),
            growth_rate(&[(&[0, 0], 0.25)]),
        ]
        .concat();
        whole.mesh = mesh;
        whole
    }

    #[test]
    fn points_in_any_order_are_evaluated_in_their_element() {
        let surrogate = in_elements();
        let mut stream = Stream::new(3, Purpose::Evaluation, 0);
        let points: Vec<[f64; 2]> = (0..1001).map(|_| [0; 2].map(|_| 2.0 * stream.next_unit() - 1.0)).collect();
        let references: Vec<&[f64]> = points.iter().map(|point| point.as_slice()).collect();
        let block = evaluate_points(&surrogate, &Plan::new(&surrogate), &references);
        for (i, point) in references.iter().enumerate() {
            let expected = surrogate.evaluate(point);
            assert!((block.components[0][i] - expected[0]).abs() < 1e-14 && block.components[1][i] == expected[1]);
        }
    }

    /// E\[f | ξ_u\] by composite Gauss rules on cells that no element divides.
    #[test]
    fn sobol_indices_over_elements_equal_brute_force() {
        const CELLS: usize = 4;
        let surrogate = in_elements();
        let (nodes, weights) = crate::numerics::quadrature::gauss(&[0.0; 3], &[1.0 / 3f64.sqrt(), 2.0 / 15f64.sqrt()]);
        let node = |i: usize| -1.0 + (2.0 * (i / 3) as f64 + 1.0 + nodes[i % 3]) / CELLS as f64;
        let weight = |i: usize| weights[i % 3] / CELLS as f64;
        let count = 3 * CELLS;
        let value = |i: usize, k: usize| surrogate.evaluate(&[node(i), node(k)])[0];
        let sum = |f: &dyn Fn(usize) -> f64| (0..count).map(|i| weight(i) * f(i)).sum::<f64>();
        let mean = sum(&|i| sum(&|k| value(i, k)));
        let variance = sum(&|i| sum(&|k| (value(i, k) - mean).powi(2)));
        let alone = [
            sum(&|i| (sum(&|k| value(i, k)) - mean).powi(2)) / variance,
            sum(&|k| (sum(&|i| value(i, k)) - mean).powi(2)) / variance,
        ];
        let found = surrogate.sobol_indices()[0].clone().unwrap();
        for j in 0..2 {
            assert!((found.first[j] - alone[j]).abs() < 1e-12, "{found:?}");
            assert!((found.total[j] - (1.0 - alone[1 - j])).abs() < 1e-12, "{found:?}");
        }
        assert!(found.first[0] + found.first[1] < 0.99, "there is an interaction");

        // Far from zero, where squares of means hide the variance.
        let mut far = surrogate;
        for part in far.expansions.iter_mut().step_by(2) {
            let mut terms: Vec<(Vec<u16>, f64)> =
                part.indices.iter().zip(&part.coefficients).map(|(alpha, c)| (alpha.to_vec(), *c)).collect();
            match terms.first_mut() {
                Some((alpha, c)) if alpha[..] == [0, 0] => *c += 1e9,
                _ => terms.insert(0, (vec![0, 0], 1e9)),
            }
            let terms: Vec<(&[u16], f64)> = terms.iter().map(|(alpha, c)| (alpha.as_slice(), *c)).collect();
            *part = expansion(&terms);
        }
        let far_away = far.sobol_indices()[0].clone().unwrap();
        for (near, far) in found.first.iter().chain(&found.total).zip(far_away.first.iter().chain(&far_away.total)) {
            assert!((near - far).abs() < 1e-6, "{found:?} and {far_away:?}");
        }
    }

    #[test]
    fn moments_over_elements_equal_those_of_samples() {
        let surrogate = in_elements();
        let summary = monte_carlo(&surrogate, 400_000, 1, &Silent).unwrap();
        let (mean, variance) = surrogate.moments()[0];
        let found = &summary.components[0];
        // Four standard errors, the fourth moment being below ten times the square of the variance.
        assert!((found.mean() - mean).abs() < 4.0 * (variance / 4e5).sqrt());
        assert!((found.variance() - variance).abs() < 4.0 * variance * (10.0 / 4e5f64).sqrt());
    }
}
