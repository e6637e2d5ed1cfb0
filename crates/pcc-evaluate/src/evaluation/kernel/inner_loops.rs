//! The inner loops of evaluation: [`Operations`] at the points of a block.
//!
//! Written once for all instruction sets: every lane holds one point and goes through the same operations in the same
//! order, fused multiply-add among them, so all sets give the same bits.
//!
//! All of it must end up in the one function that is compiled for an instruction set: a part that does not is twenty
//! times slower. Hence `inline(always)`, and loops in place of closures, which the compiler may leave apart.

#![allow(clippy::needless_range_loop, reason = "indices below a constant leave no check and no iterator behind")]

use super::lanes::{Lanes, VECTORS, Vectors};
use super::operations::{Leaf, Operations, Step};
use pulp::Simd;

/// Evaluates `program` at `points`, one entry per input: fills the `table` of univariate values and products, and
/// writes `components` by id.
#[inline(always)]
pub(crate) fn evaluate<S: Simd>(
    simd: S,
    program: &Operations,
    points: &[Lanes],
    table: &mut [Lanes],
    components: &mut [Lanes],
) {
    for part in 0..Lanes::parts::<S>() {
        univariates(simd, program, part, points, table);
        constants_and_singles(simd, program, part, table, components);
        stages(simd, program, part, table, components);
    }
}

/// φ_1, φ_2, … of every input, φ_k(x) = (a_k x + b_k) φ_{k−1}(x) − c_k φ_{k−2}(x).
#[inline(always)]
fn univariates<S: Simd>(simd: S, program: &Operations, part: usize, points: &[Lanes], table: &mut [Lanes]) {
    let mut rows = table.iter_mut();
    let mut steps = &program.steps[..];
    for (point, &degree) in points.iter().zip(&program.degrees) {
        let x = point.read::<S>(part);
        let (of_input, rest) = steps.split_at(degree);
        steps = rest;
        let (mut before, mut current) = ([simd.splat_f64s(0.0); VECTORS], [simd.splat_f64s(1.0); VECTORS]);
        for (&Step { slope, offset, coupling }, row) in of_input.iter().zip(&mut rows) {
            let (slope, offset) = (simd.splat_f64s(slope), simd.splat_f64s(offset));
            let coupling = simd.splat_f64s(coupling);
            for v in 0..VECTORS {
                let line = simd.mul_add_f64s(slope, x[v], offset);
                let next = simd.mul_add_f64s(line, current[v], simd.mul_f64s(coupling, before[v]));
                (before[v], current[v]) = (current[v], next);
            }
            row.write::<S>(part, current);
        }
    }
}

/// Every component's constant, and its terms in one input that no product extends.
#[inline(always)]
fn constants_and_singles<S: Simd>(
    simd: S,
    program: &Operations,
    part: usize,
    table: &[Lanes],
    components: &mut [Lanes],
) {
    let mut start = 0;
    for (component, &(constant, end)) in components.iter_mut().zip(&program.constants) {
        let sum = [simd.splat_f64s(constant); VECTORS];
        component.write::<S>(part, add_leaves(simd, &program.singles[start..end], part, table, sum));
        start = end;
    }
}

/// Stage by stage: the products, then for each component the sums of leaves, times their parents.
#[inline(always)]
fn stages<S: Simd>(simd: S, program: &Operations, part: usize, table: &mut [Lanes], components: &mut [Lanes]) {
    let (groups, leaves) = (&program.groups[..], &program.leaves[..]);
    let (mut product, mut run, mut group, mut leaf) = (0, 0, 0, 0);
    for stage in &program.stages {
        for (number, factors) in program.products[product..stage.products_end].iter().enumerate() {
            let mut value = table[factors[0] as usize].read::<S>(part);
            let univariate = table[factors[1] as usize].read::<S>(part);
            for v in 0..VECTORS {
                value[v] = simd.mul_f64s(value[v], univariate[v]);
            }
            table[program.steps.len() + product + number].write::<S>(part, value);
        }
        product = stage.products_end;
        for of_component in &program.runs[run..stage.runs_end] {
            let component = &mut components[of_component.component];
            let mut total = component.read::<S>(part);
            for sum_of in &groups[group..of_component.groups_end] {
                let initial = [simd.splat_f64s(sum_of.initial); VECTORS];
                let end = sum_of.leaves_end as usize;
                let sum = add_leaves(simd, &leaves[leaf..end], part, table, initial);
                leaf = end;
                let parent = table[sum_of.parent as usize].read::<S>(part);
                for v in 0..VECTORS {
                    total[v] = simd.mul_add_f64s(sum[v], parent[v], total[v]);
                }
            }
            group = of_component.groups_end;
            component.write::<S>(part, total);
        }
        run = stage.runs_end;
    }
}

/// sum + Σ coefficient × row.
#[inline(always)]
fn add_leaves<S: Simd>(simd: S, leaves: &[Leaf], part: usize, table: &[Lanes], mut sum: Vectors<S>) -> Vectors<S> {
    for leaf in leaves {
        let row = table[leaf.row as usize].read::<S>(part);
        let coefficient = simd.splat_f64s(leaf.coefficient);
        for v in 0..VECTORS {
            sum[v] = simd.mul_add_f64s(coefficient, row[v], sum[v]);
        }
    }
    sum
}
