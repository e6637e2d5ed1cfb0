//! Local minimum of a smooth function of a few variables in a box.
//!
//! The quasi-Newton method of Broyden, Fletcher, Goldfarb and Shanno with the dense inverse Hessian and a backtracking
//! line search (Nocedal and Wright 2006, algorithm 6.1, <https://doi.org/10.1007/978-0-387-40065-5>). The box becomes
//! the whole space by xⱼ = centre + half width · tanh zⱼ, so no bound needs a case of its own.

use nalgebra::{DMatrix, DVector};

/// Share of the decrease promised by the slope that a step must keep.
const SUFFICIENT_DECREASE: f64 = 1e-4;

/// Halvings of a step before the search is at its end.
const MOST_HALVINGS: usize = 12;

/// Starting points are kept this share of the half width away from the bounds, where tanh has no slope.
const MARGIN: f64 = 0.9;

/// Largest first step in any z: beyond it the function says nothing about here.
const LONGEST_STEP: f64 = 0.5;

/// When a search ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Iterations at most.
    pub iterations: usize,
    /// The search ends when an iteration lowers the value by less.
    pub decrease: f64,
}

/// Value and gradient at a point, or `None` where the function is not defined.
pub type Evaluation = Option<(f64, Vec<f64>)>;

/// Where a search begins, and where it ended: a start for a search of a similar function.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// The point.
    pub point: Vec<f64>,
    /// The inverse Hessian in the variables z, as far as it is known.
    pub inverse_hessian: Option<DMatrix<f64>>,
}

impl Start {
    /// A point where nothing is known.
    pub fn at(point: &[f64]) -> Self {
        Self { point: point.to_vec(), inverse_hessian: None }
    }
}

/// The lowest point found from `start` in the box of `bounds` (lower, upper).
///
/// `evaluate` gives value and gradient at a point, or `None` where the function is not defined; such points are treated
/// as infinitely high. The result is `start` itself if the function is not defined there.
///
/// # Errors
///
/// The first error of `evaluate`.
///
/// # Examples
///
/// ```
/// use pcc_compile::numerics::minimize::{minimize, Limits, Start};
/// let valley = |x: &[f64]| {
///     let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
///     Ok::<_, ()>(Some((a * a + 10.0 * b * b, vec![-2.0 * a - 40.0 * b * x[0], 20.0 * b])))
/// };
/// let limits = Limits { iterations: 100, decrease: 1e-14 };
/// let lowest = minimize(&Start::at(&[-1.0, 2.0]), &[(-3.0, 3.0); 2], limits, valley)?.point;
/// assert!((lowest[0] - 1.0).abs() < 1e-5 && (lowest[1] - 1.0).abs() < 1e-5);
/// # Ok::<(), ()>(())
/// ```
pub fn minimize<E>(
    start: &Start,
    bounds: &[(f64, f64)],
    limits: Limits,
    mut evaluate: impl FnMut(&[f64]) -> Result<Evaluation, E>,
) -> Result<Start, E> {
    let bounded = Box { bounds };
    let mut at = |z: &DVector<f64>| -> Result<Option<(f64, DVector<f64>)>, E> {
        let found = evaluate(&bounded.point(z))?;
        Ok(found.map(|(value, gradient)| (value, bounded.gradient(z, &gradient))))
    };
    let mut z = bounded.free(&start.point);
    let Some((mut value, mut gradient)) = at(&z)? else { return Ok(start.clone()) };
    let identity = DMatrix::identity(start.point.len(), start.point.len());
    let mut inverse_hessian = match &start.inverse_hessian {
        Some(known) => known.clone(),
        None => &identity * (LONGEST_STEP / gradient.amax().max(LONGEST_STEP)),
    };
    for _ in 0..limits.iterations {
        let mut step = -(&inverse_hessian * &gradient);
        let slope = step.dot(&gradient);
        if slope >= 0.0 || slope.is_nan() {
            break;
        }
        step *= (2.0 * LONGEST_STEP / step.amax()).min(1.0);
        let mut accepted = None;
        for _ in 0..MOST_HALVINGS {
            let trial = &z + &step;
            if let Some((lower, slopes)) = at(&trial)?
                && lower <= value + SUFFICIENT_DECREASE * step.dot(&gradient)
            {
                accepted = Some((trial, lower, slopes));
                break;
            }
            step *= 0.5;
        }
        let Some((trial, lower, slopes)) = accepted else { break };
        let decrease = value - lower;
        update(&mut inverse_hessian, &step, &(&slopes - &gradient), &identity);
        (z, value, gradient) = (trial, lower, slopes);
        if decrease < limits.decrease {
            break;
        }
    }
    Ok(Start { point: bounded.point(&z), inverse_hessian: Some(inverse_hessian) })
}

/// H ← (1 − ρsyᵀ)H(1 − ρysᵀ) + ρssᵀ with ρ = 1/yᵀs, where curvature was found.
fn update(inverse_hessian: &mut DMatrix<f64>, step: &DVector<f64>, change: &DVector<f64>, identity: &DMatrix<f64>) {
    let curvature = step.dot(change);
    if curvature > f64::EPSILON * step.norm() * change.norm() {
        let left = identity - step * change.transpose() / curvature;
        *inverse_hessian = &left * &*inverse_hessian * left.transpose() + step * step.transpose() / curvature;
    }
}

/// The map between the box and the whole space.
struct Box<'a> {
    bounds: &'a [(f64, f64)],
}

impl Box<'_> {
    fn point(&self, z: &DVector<f64>) -> Vec<f64> {
        let inside =
            |(&(lower, upper), z): (&(f64, f64), &f64)| 0.5 * (lower + upper) + 0.5 * (upper - lower) * z.tanh();
        self.bounds.iter().zip(z.iter()).map(inside).collect()
    }

    fn free(&self, point: &[f64]) -> DVector<f64> {
        let free = |(&(lower, upper), &x): (&(f64, f64), &f64)| {
            ((x - 0.5 * (lower + upper)) / (0.5 * (upper - lower))).clamp(-MARGIN, MARGIN).atanh()
        };
        DVector::from_iterator(point.len(), self.bounds.iter().zip(point).map(free))
    }

    fn gradient(&self, z: &DVector<f64>, gradient: &[f64]) -> DVector<f64> {
        let slope = |((&(lower, upper), z), slope): ((&(f64, f64), &f64), &f64)| {
            slope * 0.5 * (upper - lower) * (1.0 - z.tanh().powi(2))
        };
        DVector::from_iterator(gradient.len(), self.bounds.iter().zip(z.iter()).zip(gradient).map(slope))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn a_minimum_outside_ends_at_the_bound() {
        let slide = |x: &[f64]| Ok::<_, Infallible>(Some(((x[0] - 5.0).powi(2), vec![2.0 * (x[0] - 5.0)])));
        let limits = Limits { iterations: 200, decrease: 1e-12 };
        let lowest = minimize(&Start::at(&[0.0]), &[(-1.0, 1.0)], limits, slide).unwrap().point;
        assert!(lowest[0] <= 1.0 && lowest[0] > 0.999);
    }

    #[test]
    fn undefined_regions_are_avoided() {
        // −ln(1 − x) − 2 ln x is lowest at x = 2/3 and undefined from 1 on.
        let wall = |x: &[f64]| {
            let inside = (x[0] > 0.0 && x[0] < 1.0)
                .then(|| (-(1.0 - x[0]).ln() - 2.0 * x[0].ln(), vec![1.0 / (1.0 - x[0]) - 2.0 / x[0]]));
            Ok::<_, Infallible>(inside)
        };
        let limits = Limits { iterations: 100, decrease: 1e-14 };
        let lowest = minimize(&Start::at(&[0.1]), &[(-4.0, 4.0)], limits, wall).unwrap().point;
        assert!((lowest[0] - 2.0 / 3.0).abs() < 1e-5);
        assert_eq!(minimize(&Start::at(&[2.0]), &[(-4.0, 4.0)], limits, wall).unwrap(), Start::at(&[2.0]));
    }

    #[test]
    fn errors_end_the_search() {
        let limits = Limits { iterations: 10, decrease: 0.0 };
        let mut calls = 0;
        let failing = |_: &[f64]| {
            calls += 1;
            if calls < 3 { Ok(Some((-f64::from(calls), vec![1.0]))) } else { Err("stop") }
        };
        assert_eq!(minimize(&Start::at(&[0.0]), &[(-1.0, 1.0)], limits, failing), Err("stop"));
    }
}
