//! Which inputs the stability of a system depends on: Sobol' indices of max Re λ and of the indicator of stability.
//!
//! Every component has its indices from the coefficients, but max Re λ is the largest of several and the indicator a
//! step of it, so theirs are estimated from samples. For an output f of independent inputs and variance V, the
//! first-order index S_j = Var E\[f | x_j\]/V is the share of the variance that goes away on average once x_j is known,
//! the total index T_j = E Var\[f | all but x_j\]/V the share that stays while only x_j is unknown; 0 ≤ S_j ≤ T_j ≤ 1.
//!
//! *Pick and freeze* (Saltelli, Annoni, Azzini, Campolongo, Ratto and Tarantola 2010,
//! <https://doi.org/10.1016/j.cpc.2009.09.018>): for sample i there are two independent points A_i and B_i, and for
//! every input j the point A_i with coordinate j of B_i, called AB_i: r + 2 evaluations per sample for r inputs. B and
//! AB share x_j alone, A and AB all but x_j:
//!
//! S_j = corr(f(B), f(AB)), T_j = 1 − corr(f(A), f(AB)).
//!
//! Both correlations are estimated after Janon et al. (2014), <https://doi.org/10.1051/ps/2013040>, each with the
//! variance of its own pair; for T_j that is the estimator of Jansen (1999),
//! <https://doi.org/10.1016/S0010-4655(98)00154-4>, E\[(f(A) − f(AB))²\]/2V. The correlation κ of f(A) and f(B), known
//! to be 0, is the control variable of both. For S_j, ρ − cκ with c = 0 is the estimator of Janon et al., precise for
//! large indices, and with c = 1, but for the points that V is taken from, that of Saltelli et al., E\[f(B)(f(AB) −
//! f(A))\]/V, precise for small ones; the c with the least variance is estimated from the samples, so for many samples
//! neither is better for any index.
//!
//! Intervals are from the asymptotic normal law, with the variance by the delta method: unlike intervals from batches
//! they use all samples at once, need no number of batches, and give c as well. Where few samples are unstable, few of
//! them tell anything of the indicator: one more sample whose stability depends on x_j would add 1/(2nV) to the
//! indices. With the normal quantile z, half a width is the root of the sum of the squares of z × standard error and,
//! for the indicator, of z²/(2nV), which is what Wilson's interval leaves open when no such sample was seen.

use super::correlation::{Correlation, Products};
use crate::evaluation::error::EvalError;
use crate::evaluation::kernel::chunks::{CHUNK, in_chunks};
use crate::evaluation::kernel::plan::Plan;
use crate::evaluation::kernel::points::{Evaluator, evaluate_points};
use crate::evaluation::questions::region::Region;
use crate::foundation::Observer;
use crate::probability::inputs::InputSpace;
use crate::probability::random::{Purpose, Stream};
use crate::surrogate::Surrogate;
use statrs::distribution::{ContinuousCDF, Normal};
use std::ops::Range;

/// Confidence level of the intervals of [`Estimate`].
pub const SENSITIVITY_LEVEL: f64 = 0.95;

/// Largest |max Re λ| that is taken, in 1/s: fourth powers, which standard errors are made of, stay finite.
const LARGEST: f64 = 1e75;

/// (1 − 0)²/2: half the square of what one sample can change the indicator by.
pub(super) const INDICATOR_STEP: f64 = 0.5;

/// Sobol' indices of what decides stability.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivities {
    /// Number of samples, each of them r + 2 evaluations for r inputs.
    pub samples: u64,
    /// Indices of the spectral abscissa max Re λ, per input; `None` if it did not vary between some pair's points.
    pub max_re: Option<Vec<Sensitivity>>,
    /// Indices of the indicator of samples that are not unstable, per input; `None` if it did not vary between some
    /// pair's points, because all or nearly all samples are stable, or unstable.
    pub stability: Option<Vec<Sensitivity>>,
}

/// Sobol' indices of one input: shares of the output's variance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensitivity {
    /// First order, S_j: what the input explains on its own.
    pub first: Estimate,
    /// Total, T_j: what it has a part in.
    pub total: Estimate,
}

/// An index, or an effect, with the interval that holds it with probability [`SENSITIVITY_LEVEL`]. What lies outside
/// \[0, 1\] by chance is moved to the nearer end before the interval is laid around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Estimated value.
    pub value: f64,
    /// Lower end of the interval.
    pub lower: f64,
    /// Upper end of the interval.
    pub upper: f64,
}

impl Estimate {
    pub(super) fn new(value: f64, half_width: f64) -> Self {
        let value = value.clamp(0.0, 1.0);
        Self { value, lower: (value - half_width).max(0.0), upper: (value + half_width).min(1.0) }
    }
}

/// Sobol' indices of max Re λ and of the indicator of samples that are not unstable, per input in order, from `samples`
/// samples under `seed`, on the current rayon thread pool.
///
/// A_i is the point that [`monte_carlo`](fn@crate::evaluation::monte_carlo) evaluates as sample i under this seed, B_i
/// what its stream yields next, so no number is used twice. The result is the same bits for any number of threads.
///
/// # Errors
///
/// [`EvalError`]; [`EvalError::NotFinite`] also if |max Re λ| exceeds 10⁷⁵, whose powers are too large;
/// [`EvalError::Dependent`] if inputs depend on each other, which
/// [`shapley_effects`](crate::evaluation::shapley_effects) are for.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::artifact;
/// use pcc_evaluate::evaluation::sensitivities;
/// use pcc_evaluate::foundation::Silent;
/// let surrogate = artifact::decode(include_bytes!("../../../../../surrogates/clutch-r2-eigenvalues.pcc"))?.surrogate;
/// let indices = sensitivities(&surrogate, 4096, 1, &Silent)?.stability.expect("some points are stable, some not");
/// let friction = indices[0].total;
/// assert!(friction.lower <= friction.value && friction.value <= friction.upper);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn sensitivities(
    surrogate: &Surrogate,
    samples: u64,
    seed: u64,
    observer: &dyn Observer,
) -> Result<Sensitivities, EvalError> {
    sensitivities_in(surrogate, &Region::whole(&surrogate.inputs), samples, seed, observer)
}

/// The same for inputs confined to `region`. Inputs that are fixed there have no influence.
///
/// # Errors
///
/// As [`sensitivities`].
pub fn sensitivities_in(
    surrogate: &Surrogate,
    region: &Region,
    samples: u64,
    seed: u64,
    observer: &dyn Observer,
) -> Result<Sensitivities, EvalError> {
    if let Some(&input) = surrogate.inputs.dependence().and_then(|copula| copula.members().first()) {
        return Err(EvalError::Dependent { input: surrogate.inputs.inputs()[input].name.clone() });
    }
    let plan = Plan::new(surrogate);
    let mut middle = vec![0.5; surrogate.inputs.dimension()];
    region.place(&mut middle);
    let center = evaluate_points(surrogate, &plan, &[&middle]).max_re.first().copied().unwrap_or(0.0);
    if !is_usable(center) {
        return Err(not_usable(&surrogate.inputs, &middle));
    }
    let mut comparison = Comparison::new(surrogate.inputs.dimension());
    in_chunks(
        samples,
        CHUNK,
        observer,
        || Comparer { surrogate, region, evaluator: Evaluator::new(surrogate, &plan), seed, center, pairs: Vec::new() },
        |comparer, range| comparer.compare(range, observer),
        |part| comparison.merge(&part),
    )?;
    Ok(Sensitivities {
        samples,
        max_re: estimates(&comparison.max_re, samples, 0.0),
        stability: estimates(&comparison.stability, samples, INDICATOR_STEP),
    })
}

pub(super) fn is_usable(max_re: f64) -> bool {
    // False for NaN.
    max_re.abs() <= LARGEST
}

pub(super) fn not_usable(inputs: &InputSpace, standardized: &[f64]) -> EvalError {
    EvalError::NotFinite { point: inputs.describe(&inputs.physical(standardized)) }
}

/// Outputs at the points that share one input, and at those that share all others.
#[derive(Debug, Clone, PartialEq)]
struct Pairs {
    /// f(B) and f(AB).
    first: Products,
    /// f(A) and f(AB).
    total: Products,
}

impl Pairs {
    fn of(a: &[f64], b: &[f64], mixed: &[f64]) -> Self {
        Self { first: Products::of([b, mixed], [a, b]), total: Products::of([a, mixed], [a, b]) }
    }

    fn merge(&mut self, other: &Self) {
        self.first.merge(&other.first);
        self.total.merge(&other.total);
    }
}

/// The pairs of both outputs, per input.
#[derive(Debug, Clone, PartialEq)]
struct Comparison {
    max_re: Vec<Pairs>,
    stability: Vec<Pairs>,
}

impl Comparison {
    fn new(dimension: usize) -> Self {
        let nothing = vec![Pairs { first: Products::new(), total: Products::new() }; dimension];
        Self { max_re: nothing.clone(), stability: nothing }
    }

    fn merge(&mut self, other: &Self) {
        let own = self.max_re.iter_mut().chain(&mut self.stability);
        for (own, others) in own.zip(other.max_re.iter().chain(&other.stability)) {
            own.merge(others);
        }
    }
}

/// A point of sample i.
#[derive(Debug, Clone, Copy)]
enum Choice {
    A,
    B,
    /// A with this coordinate of B.
    Mixed(usize),
}

impl Choice {
    /// Writes the point, given A and B one after the other.
    fn set(self, pair: &[f64], point: &mut [f64]) {
        let (a, b) = pair.split_at(point.len());
        match self {
            Self::A => point.copy_from_slice(a),
            Self::B => point.copy_from_slice(b),
            Self::Mixed(input) => {
                point.copy_from_slice(a);
                point[input] = b[input];
            }
        }
    }
}

/// Both outputs at one choice of point, per sample.
struct Column {
    /// max Re λ less its value in the middle of all inputs, so that little is lost to cancellation.
    max_re: Vec<f64>,
    /// 0 if unstable, else 1.
    is_stable: Vec<f64>,
}

/// Compares chunks of samples, with memory of its own.
struct Comparer<'a> {
    surrogate: &'a Surrogate,
    region: &'a Region,
    evaluator: Evaluator<'a>,
    seed: u64,
    center: f64,
    /// A and B of every sample of the chunk, standardized.
    pairs: Vec<f64>,
}

impl Comparer<'_> {
    fn compare(&mut self, range: Range<u64>, observer: &dyn Observer) -> Result<Comparison, EvalError> {
        let inputs = &self.surrogate.inputs;
        let dimension = inputs.dimension();
        self.pairs.resize((range.end - range.start) as usize * 2 * dimension, 0.0);
        for (index, pair) in range.zip(self.pairs.chunks_exact_mut(2 * dimension)) {
            draw(self.region, self.seed, index, pair);
        }
        let (a, b) = (self.column(Choice::A)?, self.column(Choice::B)?);
        let mut comparison =
            Comparison { max_re: Vec::with_capacity(dimension), stability: Vec::with_capacity(dimension) };
        for input in 0..dimension {
            observer.check()?;
            let mixed = self.column(Choice::Mixed(input))?;
            comparison.max_re.push(Pairs::of(&a.max_re, &b.max_re, &mixed.max_re));
            comparison.stability.push(Pairs::of(&a.is_stable, &b.is_stable, &mixed.is_stable));
        }
        Ok(comparison)
    }

    fn column(&mut self, choice: Choice) -> Result<Column, EvalError> {
        let dimension = self.surrogate.inputs.dimension();
        let (samples, pairs) = (self.pairs.len() / (2 * dimension), &self.pairs);
        let mut found = Vec::with_capacity(samples);
        let set_point = |number: usize, point: &mut [f64]| {
            choice.set(&pairs[number * 2 * dimension..(number + 1) * 2 * dimension], point);
        };
        self.evaluator.tops(samples, set_point, &mut found);
        if let Some(at) = found.iter().position(|top| !is_usable(top.max_re)) {
            let mut point = vec![0.0; dimension];
            choice.set(&self.pairs[at * 2 * dimension..(at + 1) * 2 * dimension], &mut point);
            return Err(not_usable(&self.surrogate.inputs, &point));
        }
        Ok(Column {
            max_re: found.iter().map(|top| top.max_re - self.center).collect(),
            is_stable: found.iter().map(|top| f64::from(top.excess <= 0.0)).collect(),
        })
    }
}

/// The standardized points A and B of sample `index`, one after the other: the first 2r numbers of its stream. In
/// the whole domain the first r of them are [`crate::probability::inputs::random_point`].
fn draw(region: &Region, seed: u64, index: u64, pair: &mut [f64]) {
    let mut stream = Stream::new(seed, Purpose::Evaluation, index);
    pair.iter_mut().for_each(|coordinate| *coordinate = stream.next_unit());
    let (a, b) = pair.split_at_mut(pair.len() / 2);
    region.place(a);
    region.place(b);
}

/// The indices of one output that a single sample changes by `step`/nV.
fn estimates(pairs: &[Pairs], samples: u64, step: f64) -> Option<Vec<Sensitivity>> {
    let z = Normal::standard().inverse_cdf(0.5 + 0.5 * SENSITIVITY_LEVEL);
    let half_width = |correlation: &Correlation| {
        (z * correlation.standard_error).hypot(z * z * step / (samples as f64 * correlation.variance))
    };
    let sensitivity = |pairs: &Pairs| {
        let (first, total) = (pairs.first.correlation()?, pairs.total.correlation()?);
        Some(Sensitivity {
            first: Estimate::new(first.value, half_width(&first)),
            total: Estimate::new(1.0 - total.value, half_width(&total)),
        })
    };
    pairs.iter().map(sensitivity).collect()
}

#[cfg(test)]
mod tests;
