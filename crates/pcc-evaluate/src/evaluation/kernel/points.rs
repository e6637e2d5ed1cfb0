//! A surrogate at many points, in blocks of lanes.

use super::lanes::{BLOCK_POINTS, Lanes};
use super::plan::{Plan, Workspace};
use super::results::Results;
use crate::components::{Block, Top};
use crate::surrogate::Surrogate;
use num_complex::Complex;

/// Components, eigenvalues and max Re λ of `surrogate`, compiled to `plan`, at standardized points.
pub fn evaluate_points(surrogate: &Surrogate, plan: &Plan, points: &[&[f64]]) -> Block {
    let mut evaluator = Evaluator::new(surrogate, plan);
    let mut block = evaluator.block(points.len());
    evaluator.evaluate(points.len(), |number, point| point.copy_from_slice(points[number]), &mut block);
    block
}

/// Evaluates points [`BLOCK_POINTS`] at a time, with memory of its own. Points in the same element are evaluated
/// together, and results come in the order of the points.
pub(crate) struct Evaluator<'a> {
    surrogate: &'a Surrogate,
    plan: &'a Plan,
    workspace: Workspace,
    /// One point.
    point: Vec<f64>,
    /// With several elements: all points, block by block.
    points: Vec<Lanes>,
    /// Their numbers, element by element.
    order: Vec<usize>,
    /// Their results, block by block.
    results: Vec<Results>,
}

impl<'a> Evaluator<'a> {
    pub fn new(surrogate: &'a Surrogate, plan: &'a Plan) -> Self {
        Self {
            surrogate,
            plan,
            workspace: plan.workspace(),
            point: vec![0.0; surrogate.inputs.dimension()],
            points: Vec::new(),
            order: Vec::new(),
            results: Vec::new(),
        }
    }

    /// An empty block with room for `samples`.
    pub fn block(&self, samples: usize) -> Block {
        Block::with_capacity(self.surrogate.component_count(), self.surrogate.labels().len(), samples)
    }

    /// Evaluates `count` points. `fill` writes the standardized coordinates of the points from the given number on, one
    /// entry per input; `visit` is given these coordinates, results and number of points, block by block.
    pub fn each_block(
        &mut self,
        count: usize,
        mut fill: impl FnMut(usize, &mut [Lanes]),
        mut visit: impl FnMut(&[Lanes], &Results, usize),
    ) {
        if self.plan.mesh().elements().len() > 1 {
            return self.by_element(count, fill, visit);
        }
        for start in (0..count).step_by(BLOCK_POINTS) {
            fill(start, self.workspace.points_mut());
            self.plan.evaluate(0, &mut self.workspace);
            visit(self.workspace.points(), self.workspace.results(), BLOCK_POINTS.min(count - start));
        }
    }

    /// Evaluates `count` points and appends the results to `block`. `set_point` writes the standardized coordinates of
    /// the point with the given number.
    pub fn evaluate(&mut self, count: usize, set_point: impl FnMut(usize, &mut [f64]), block: &mut Block) {
        let fill = in_lanes(count, self.point.len(), set_point);
        self.each_block(count, fill, |_, results, lanes| append(results, lanes, block));
    }

    /// Evaluates `count` points and appends what decides at each to `list`.
    pub fn tops(&mut self, count: usize, set_point: impl FnMut(usize, &mut [f64]), list: &mut Vec<Top>) {
        let fill = in_lanes(count, self.point.len(), set_point);
        self.each_block(count, fill, |_, results, lanes| list.extend((0..lanes).map(|lane| top(results, lane))));
    }

    /// The same with the position among the surrogate's labels of the eigenvalue that decides.
    pub fn deciding(&mut self, count: usize, set_point: impl FnMut(usize, &mut [f64]), list: &mut Vec<(Top, usize)>) {
        let margin = self.surrogate.verdict.margin;
        let fill = in_lanes(count, self.point.len(), set_point);
        self.each_block(count, fill, |_, results, lanes| {
            for lane in 0..lanes {
                let excess = |k: usize| {
                    margin.excess(Complex::new(results.growth_rates[k].0[lane], results.angular_frequencies[k].0[lane]))
                };
                let larger = |a: usize, b: usize| if excess(b) > excess(a) { b } else { a };
                let position = (0..results.growth_rates.len()).reduce(larger).unwrap_or_default();
                list.push((top(results, lane), position));
            }
        });
    }

    /// Sorts the points by element, maps them to the local variables, and evaluates those of each element together.
    fn by_element(
        &mut self,
        count: usize,
        mut fill: impl FnMut(usize, &mut [Lanes]),
        mut visit: impl FnMut(&[Lanes], &Results, usize),
    ) {
        let dimension = self.point.len();
        let blocks = count.div_ceil(BLOCK_POINTS);
        self.points.resize(blocks * dimension, Lanes::splat(0.0));
        self.results.resize(blocks, self.workspace.results().clone());
        for (number, points) in self.points.chunks_exact_mut(dimension).enumerate() {
            fill(number * BLOCK_POINTS, points);
        }
        let starts = self.sort(count);
        let order = std::mem::take(&mut self.order);
        for element in 0..starts.len() - 1 {
            for group in order[starts[element]..starts[element + 1]].chunks(BLOCK_POINTS) {
                self.evaluate_group(element, group);
            }
        }
        self.order = order;
        for (number, (points, results)) in self.points.chunks_exact(dimension).zip(&self.results).enumerate() {
            visit(points, results, BLOCK_POINTS.min(count - number * BLOCK_POINTS));
        }
    }

    /// Orders the numbers of the points by element; where the part of each element starts.
    fn sort(&mut self, count: usize) -> Vec<usize> {
        let (mesh, dimension) = (self.plan.mesh(), self.point.len());
        let mut starts = vec![0; mesh.elements().len() + 1];
        let mut found = Vec::with_capacity(count);
        for number in 0..count {
            let points = &self.points[number / BLOCK_POINTS * dimension..][..dimension];
            self.point.iter_mut().zip(points).for_each(|(xi, coordinate)| *xi = coordinate.0[number % BLOCK_POINTS]);
            let element = mesh.locate(&self.point);
            starts[element + 1] += 1;
            found.push(element);
        }
        for element in 1..starts.len() {
            starts[element] += starts[element - 1];
        }
        let mut next = starts.clone();
        self.order.resize(count, 0);
        for (number, &element) in found.iter().enumerate() {
            self.order[next[element]] = number;
            next[element] += 1;
        }
        starts
    }

    /// Evaluates the points with these numbers, all in this element.
    fn evaluate_group(&mut self, element: usize, numbers: &[usize]) {
        let (dimension, space) = (self.point.len(), &self.plan.mesh().elements()[element]);
        for (j, coordinate) in self.workspace.points_mut().iter_mut().enumerate() {
            let (center, half_width) = (space.center(j), space.half_width(j));
            for (lane, &number) in numbers.iter().enumerate() {
                let xi = self.points[number / BLOCK_POINTS * dimension + j].0[number % BLOCK_POINTS];
                coordinate.0[lane] = (xi - center) / half_width;
            }
        }
        self.plan.evaluate(element, &mut self.workspace);
        let found = self.workspace.results();
        for (lane, &number) in numbers.iter().enumerate() {
            copy_lane(found, lane, &mut self.results[number / BLOCK_POINTS], number % BLOCK_POINTS);
        }
    }
}

/// What decides in a lane.
pub(crate) fn top(results: &Results, lane: usize) -> Top {
    Top { max_re: results.max_re.0[lane], excess: results.excess.0[lane], frequency: results.top_frequency.0[lane] }
}

/// Writes points that are set one by one into lanes.
fn in_lanes(
    count: usize,
    dimension: usize,
    mut set_point: impl FnMut(usize, &mut [f64]),
) -> impl FnMut(usize, &mut [Lanes]) {
    let mut point = vec![0.0; dimension];
    move |start, points| {
        for lane in 0..BLOCK_POINTS.min(count - start) {
            set_point(start + lane, &mut point);
            points.iter_mut().zip(&point).for_each(|(coordinate, &xi)| coordinate.0[lane] = xi);
        }
    }
}

fn copy_lane(from: &Results, lane: usize, to: &mut Results, target: usize) {
    let lists = [
        (&from.components, &mut to.components),
        (&from.growth_rates, &mut to.growth_rates),
        (&from.angular_frequencies, &mut to.angular_frequencies),
    ];
    for (from, to) in lists {
        from.iter().zip(to).for_each(|(from, to)| to.0[target] = from.0[lane]);
    }
    to.max_re.0[target] = from.max_re.0[lane];
    to.excess.0[target] = from.excess.0[lane];
    to.top_frequency.0[target] = from.top_frequency.0[lane];
}

fn append(results: &Results, lanes: usize, block: &mut Block) {
    for (list, component) in block.components.iter_mut().zip(&results.components) {
        list.extend_from_slice(&component.0[..lanes]);
    }
    let eigenvalues = results.growth_rates.iter().zip(&results.angular_frequencies);
    for (list, (re, im)) in block.eigenvalues.iter_mut().zip(eigenvalues) {
        list.extend(re.0[..lanes].iter().zip(&im.0).map(|(&re, &im)| Complex::new(re, im)));
    }
    block.max_re.extend_from_slice(&results.max_re.0[..lanes]);
    block.excess.extend_from_slice(&results.excess.0[..lanes]);
    block.top_frequency.extend_from_slice(&results.top_frequency.0[..lanes]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::monte_carlo;
    use crate::evaluation::test_surrogates::{expansion, inputs, surrogate};
    use crate::foundation::Silent;
    use crate::polynomials::Mesh;
    use crate::probability::random::{Purpose, Stream};

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
        let (nodes, weights) = crate::polynomials::gauss(&[0.0; 3], &[1.0 / 3f64.sqrt(), 2.0 / 15f64.sqrt()]);
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
