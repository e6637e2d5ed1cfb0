//! A surrogate at given points.

use super::plan::{LANES, Plan, Workspace};
use crate::spectrum::{Block, spectral_abscissa};
use crate::surrogate::Surrogate;
use nalgebra::Complex;

/// Components, eigenvalues and max Re λ of `surrogate`, compiled to `plan`, at standardized points.
pub fn evaluate_points(surrogate: &Surrogate, plan: &Plan, points: &[&[f64]]) -> Block {
    let mut evaluator = Evaluator::new(surrogate, plan);
    let mut block = evaluator.block(points.len());
    for group in points.chunks(LANES) {
        evaluator.evaluate(group.len(), |lane, point| point.copy_from_slice(group[lane]), &mut block);
    }
    block
}

/// Evaluates up to [`LANES`] points at a time, with memory of its own.
pub(super) struct Evaluator<'a> {
    surrogate: &'a Surrogate,
    plan: &'a Plan,
    modes: usize,
    workspace: Workspace,
    point: Vec<f64>,
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
            point: vec![0.0; surrogate.inputs.dimension()],
            values: vec![0.0; surrogate.expansions.len()],
            eigenvalues: Vec::with_capacity(modes),
        }
    }

    /// An empty block with room for `samples`.
    pub fn block(&self, samples: usize) -> Block {
        Block::with_capacity(self.values.len(), self.modes, samples)
    }

    /// Evaluates `lanes` points, at most [`LANES`], and appends the results to `block`. `set_point` writes the
    /// standardized coordinates of the point with the given number.
    pub fn evaluate(&mut self, lanes: usize, mut set_point: impl FnMut(usize, &mut [f64]), block: &mut Block) {
        for lane in 0..lanes {
            set_point(lane, &mut self.point);
            for (coordinate, &xi) in self.workspace.points_mut().iter_mut().zip(&self.point) {
                coordinate[lane] = xi;
            }
        }
        self.plan.evaluate(&mut self.workspace);
        for lane in 0..lanes {
            for (value, component) in self.values.iter_mut().zip(self.workspace.components()) {
                *value = component[lane];
            }
            self.eigenvalues.clear();
            for output in &self.surrogate.outputs {
                output.recombine(&self.values, &mut self.eigenvalues);
            }
            let max_re = spectral_abscissa(&self.eigenvalues);
            block.push(&self.values, &self.eigenvalues, max_re);
        }
    }
}
