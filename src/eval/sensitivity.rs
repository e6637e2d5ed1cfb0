//! Which inputs the stability of a system depends on: Sobol' indices of max Re λ and of the indicator max Re λ < 0.
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

use super::chunks::{CHUNK, in_chunks};
use super::correlation::{Correlation, Products};
use super::monte_carlo::EvalError;
use super::plan::Plan;
use super::points::{Evaluator, evaluate_points};
use super::region::Region;
use crate::input::InputSpace;
use crate::progress::Observer;
use crate::random::{Purpose, Stream};
use crate::surrogate::Surrogate;
use statrs::distribution::{ContinuousCDF, Normal};
use std::ops::Range;

/// Confidence level of the intervals of [`Estimate`].
pub const SENSITIVITY_LEVEL: f64 = 0.95;

/// Largest |max Re λ| that is taken, in 1/s: fourth powers, which standard errors are made of, stay finite.
const LARGEST: f64 = 1e75;

/// (1 − 0)²/2: half the square of what one sample can change the indicator by.
const INDICATOR_STEP: f64 = 0.5;

/// Sobol' indices of what decides stability.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivities {
    /// Number of samples, each of them r + 2 evaluations for r inputs.
    pub samples: u64,
    /// Indices of the spectral abscissa max Re λ, per input; `None` if it did not vary between some pair's points.
    pub max_re: Option<Vec<Sensitivity>>,
    /// Indices of the indicator max Re λ < 0, per input; `None` if it did not vary between some pair's points, because
    /// all or nearly all samples are stable, or unstable.
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

/// An index with the interval that holds it with probability [`SENSITIVITY_LEVEL`]. What lies outside \[0, 1\] by
/// chance is moved to the nearer end before the interval is laid around it.
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
    fn new(value: f64, half_width: f64) -> Self {
        let value = value.clamp(0.0, 1.0);
        Self { value, lower: (value - half_width).max(0.0), upper: (value + half_width).min(1.0) }
    }
}

/// Sobol' indices of max Re λ and of the indicator max Re λ < 0, per input in order, from `samples` samples under
/// `seed`, on the current rayon thread pool.
///
/// A_i is the point that [`monte_carlo`](fn@super::monte_carlo) evaluates as sample i under this seed, B_i what its
/// stream yields next, so no number is used twice. The result is the same bits for any number of threads.
///
/// # Errors
///
/// [`EvalError`]; [`EvalError::NotFinite`] also if |max Re λ| exceeds 10⁷⁵, whose powers are too large.
///
/// # Examples
///
/// ```
/// use pcc::{artifact, eval::sensitivities, progress::Silent};
/// let surrogate = artifact::decode(include_bytes!("../../surrogates/clutch-r2-eigenvalues.pcc"))?.surrogate;
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
    sensitivities_in(surrogate, &Region::whole(surrogate.inputs.dimension()), samples, seed, observer)
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
    let plan = Plan::new(surrogate);
    let middle: Vec<f64> = (0..surrogate.inputs.dimension()).map(|input| region.place(input, 0.5)).collect();
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

fn is_usable(max_re: f64) -> bool {
    // False for NaN.
    max_re.abs() <= LARGEST
}

fn not_usable(inputs: &InputSpace, standardized: &[f64]) -> EvalError {
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
    /// 1 if stable, 0 if not.
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
        self.evaluator.max_re(samples, set_point, &mut found);
        if let Some(at) = found.iter().position(|&max_re| !is_usable(max_re)) {
            let mut point = vec![0.0; dimension];
            choice.set(&self.pairs[at * 2 * dimension..(at + 1) * 2 * dimension], &mut point);
            return Err(not_usable(&self.surrogate.inputs, &point));
        }
        Ok(Column {
            max_re: found.iter().map(|max_re| max_re - self.center).collect(),
            is_stable: found.iter().map(|&max_re| f64::from(max_re < 0.0)).collect(),
        })
    }
}

/// The standardized points A and B of sample `index`, one after the other: the first 2r numbers of its stream. In
/// the whole domain the first r of them are [`crate::input::random_point`].
fn draw(region: &Region, seed: u64, index: u64, pair: &mut [f64]) {
    let mut stream = Stream::new(seed, Purpose::Evaluation, index);
    let dimension = pair.len() / 2;
    for (j, coordinate) in pair.iter_mut().enumerate() {
        *coordinate = region.place(j % dimension, stream.next_unit());
    }
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
mod tests {
    use super::*;
    use crate::eval::handmade::{XI, expansion, inputs, on_threads, polynomial, surrogate};
    use crate::eval::monte_carlo;
    use crate::input::random_point;
    use crate::progress::Silent;

    /// Strong and weak inputs, an interaction, and one input without influence.
    fn mixture() -> Surrogate {
        polynomial(
            4,
            &[
                (&[0, 0, 0, 0], -1.0),
                (&[1, 0, 0, 0], 3.0),
                (&[0, 2, 0, 0], 1.0),
                (&[1, 1, 0, 0], 1.5),
                (&[0, 0, 3, 0], 0.2),
            ],
        )
    }

    fn holds(estimate: Estimate, exact: f64) -> bool {
        // The indices of inputs without influence, and those of 1, are found but for rounding.
        estimate.lower <= exact + 1e-12 && exact - 1e-12 <= estimate.upper
    }

    /// For every index, the share of seeds whose interval holds the exact value, first and total alternating.
    fn coverage(
        surrogate: &Surrogate,
        samples: u64,
        output: fn(Sensitivities) -> Option<Vec<Sensitivity>>,
        exact: &[(f64, f64)],
    ) -> Vec<f64> {
        const SEEDS: u64 = 400;
        let mut covered = vec![0.0; 2 * exact.len()];
        for seed in 0..SEEDS {
            let found = output(sensitivities(surrogate, samples, seed, &Silent).unwrap()).unwrap();
            for (j, (sensitivity, &(first, total))) in found.iter().zip(exact).enumerate() {
                covered[2 * j] += f64::from(holds(sensitivity.first, first)) / SEEDS as f64;
                covered[2 * j + 1] += f64::from(holds(sensitivity.total, total)) / SEEDS as f64;
            }
        }
        covered
    }

    /// 0.92 is nearly three standard errors of 400 seeds below 0.95.
    const LOWEST_COVERAGE: f64 = 0.92;

    #[test]
    fn intervals_of_max_re_hold_the_indices_of_the_coefficients_at_their_level() {
        let surrogate = mixture();
        let exact = surrogate.expansions[0].sobol_indices().unwrap();
        let exact: Vec<(f64, f64)> = exact.first.into_iter().zip(exact.total).collect();
        for samples in [300, 2000] {
            let covered = coverage(&surrogate, samples, |found| found.max_re, &exact);
            assert!(covered.iter().all(|&share| share >= LOWEST_COVERAGE), "{samples} samples: {covered:?}");
        }
    }

    #[test]
    fn indices_converge_to_those_of_the_coefficients() {
        let surrogate = mixture();
        let exact = surrogate.expansions[0].sobol_indices().unwrap();
        let found = sensitivities(&surrogate, 200_000, 1, &Silent).unwrap().max_re.unwrap();
        for (j, sensitivity) in found.iter().enumerate() {
            assert!((sensitivity.first.value - exact.first[j]).abs() < 0.01, "S_{j}: {sensitivity:?}");
            assert!((sensitivity.total.value - exact.total[j]).abs() < 0.01, "T_{j}: {sensitivity:?}");
        }
        let none = found[3];
        assert!(none.first.upper < 1e-6 && none.total.upper < 1e-12, "no influence: {none:?}");
    }

    /// max(ξ1, ξ2): E\[f | ξ1\] = (1 + ξ1)²/4, of variance 4/45; f has variance 2/9.
    #[test]
    fn the_largest_of_two_modes_has_its_own_indices() {
        let modes = vec![expansion(&[(&[1, 0], XI)]), expansion(&[(&[0, 1], XI)])];
        let surrogate = surrogate(inputs(&[(-1.0, 1.0), (3.0, 8.0)]), modes);
        let exact = [(0.4, 0.6), (0.4, 0.6)];
        let covered = coverage(&surrogate, 1000, |found| found.max_re, &exact);
        assert!(covered.iter().all(|&share| share >= LOWEST_COVERAGE), "{covered:?}");
    }

    #[test]
    fn a_single_input_that_decides_has_indices_1_and_others_0() {
        let surrogate = polynomial(2, &[(&[0, 0], -0.3), (&[1, 0], XI)]);
        let found = sensitivities(&surrogate, 100_000, 3, &Silent).unwrap();
        for output in [found.max_re.unwrap(), found.stability.unwrap()] {
            for (sensitivity, exact) in output.iter().zip([1.0, 0.0]) {
                for estimate in [sensitivity.first, sensitivity.total] {
                    assert!((estimate.value - exact).abs() < 1e-3, "{estimate:?}");
                    assert!(holds(estimate, exact) && estimate.upper - estimate.lower < 1e-3, "{estimate:?}");
                }
            }
        }
    }

    /// ξ1 + ξ2 < 0 has probability ½ and, given ξ1, (1 − ξ1)/2, of variance 1/12: S = (1/12)/(1/4).
    #[test]
    fn intervals_of_the_indicator_hold_the_indices_of_a_half_plane_at_their_level() {
        let surrogate = polynomial(2, &[(&[1, 0], XI), (&[0, 1], XI)]);
        let exact = [(1.0 / 3.0, 2.0 / 3.0); 2];
        for samples in [200, 2000] {
            let covered = coverage(&surrogate, samples, |found| found.stability, &exact);
            assert!(covered.iter().all(|&share| share >= LOWEST_COVERAGE), "{samples} samples: {covered:?}");
        }
    }

    /// max(ξ1, ξ2) − c ≥ 0, each alone with probability q: the indicator is a product, (1 − q)² and 1 − q given ξ1 < c.
    #[test]
    fn intervals_of_the_indicator_hold_where_few_samples_are_unstable() {
        let q = 0.01;
        let mode = |alpha| expansion(&[(&[0, 0], 2.0 * q - 1.0), (alpha, XI)]);
        let surrogate = surrogate(inputs(&[(-1.0, 1.0); 2]), vec![mode(&[1, 0]), mode(&[0, 1])]);
        let stable = (1.0 - q) * (1.0 - q);
        let variance = stable * (1.0 - stable);
        let first = (1.0 - q) * (1.0 - q) * q * (1.0 - q) / variance;
        let exact = [(first, 1.0 - first); 2];
        // About 20 of 1000 samples are unstable.
        let covered = coverage(&surrogate, 1000, |found| found.stability, &exact);
        assert!(covered.iter().all(|&share| share >= LOWEST_COVERAGE), "{covered:?}");
    }

    /// ξ1 + ε ξ2 < 0 is decided by ξ2 in n ε/3 of n samples: given ξ2, it has probability (1 − ε ξ2)/2, of variance
    /// ε²/12, so S_2 = ε²/3; given ξ1, stability is open where |ξ1| < ε, and T_2 = 2ε/3.
    #[test]
    fn intervals_of_the_indicator_hold_where_an_input_decides_few_samples() {
        const SAMPLES: u64 = 300;
        for deciding in [0.1, 1.0, 3.0, 10.0] {
            let epsilon = 3.0 * deciding / SAMPLES as f64;
            let surrogate = polynomial(2, &[(&[1, 0], XI), (&[0, 1], epsilon * XI)]);
            let (first, total) = (epsilon * epsilon / 3.0, 2.0 * epsilon / 3.0);
            let covered =
                coverage(&surrogate, SAMPLES, |found| found.stability, &[(1.0 - total, 1.0 - first), (first, total)]);
            assert!(covered.iter().all(|&share| share >= LOWEST_COVERAGE), "{deciding} samples: {covered:?}");
        }
    }

    #[test]
    fn an_input_that_was_not_seen_to_matter_is_not_excluded() {
        // Stability changes with ξ2 only where |ξ1| < 10⁻⁶.
        let surrogate = polynomial(2, &[(&[1, 0], XI), (&[0, 1], 1e-6 * XI)]);
        let found = sensitivities(&surrogate, 10_000, 1, &Silent).unwrap().stability.unwrap();
        assert_eq!((found[1].first.lower, found[1].total.lower), (0.0, 0.0));
        // 1.96²/(2 · 10⁴ · ¼)
        assert!((found[1].total.upper - 7.68e-4).abs() < 1e-5, "{found:?}");
    }

    #[test]
    fn small_indices_are_sharper_than_those_of_a_plain_correlation() {
        let found = sensitivities(&mixture(), 10_000, 1, &Silent).unwrap().max_re.unwrap();
        let plain = 2.0 * 1.96 / 10_000f64.sqrt();
        let weak = found[2].first;
        assert!(weak.upper - weak.lower < 0.3 * plain, "{weak:?}");
    }

    #[test]
    fn outputs_that_do_not_vary_have_no_indices() {
        let constant = sensitivities(&polynomial(2, &[(&[0, 0], -0.1)]), 5000, 1, &Silent).unwrap();
        assert_eq!(constant, Sensitivities { samples: 5000, max_re: None, stability: None });
        let stable = sensitivities(&polynomial(2, &[(&[0, 0], -9.0), (&[1, 0], 1.0)]), 5000, 1, &Silent).unwrap();
        assert!(stable.max_re.is_some() && stable.stability.is_none());
    }

    #[test]
    fn few_samples_leave_everything_open() {
        let surrogate = polynomial(2, &[(&[1, 0], 1.0), (&[1, 1], 0.5)]);
        for samples in 1..10 {
            let found = sensitivities(&surrogate, samples, 1, &Silent).unwrap();
            for estimate in found.max_re.iter().chain(&found.stability).flatten().flat_map(|s| [s.first, s.total]) {
                assert!(0.0 <= estimate.lower && estimate.lower <= estimate.value, "{estimate:?}");
                assert!(estimate.value <= estimate.upper && estimate.upper <= 1.0, "{estimate:?}");
            }
        }
        let single = sensitivities(&surrogate, 1, 1, &Silent).unwrap().max_re.unwrap();
        assert_eq!((single[0].first.lower, single[0].first.upper), (0.0, 1.0));
    }

    #[test]
    fn a_large_mean_costs_no_accuracy() {
        let near = polynomial(2, &[(&[1, 0], 1.0), (&[1, 1], 0.5)]);
        let far = polynomial(2, &[(&[0, 0], -1e8), (&[1, 0], 1.0), (&[1, 1], 0.5)]);
        let found = |surrogate| sensitivities(surrogate, 2000, 1, &Silent).unwrap().max_re.unwrap();
        for (near, far) in found(&near).iter().zip(found(&far)) {
            for (near, far) in [(near.first, far.first), (near.total, far.total)] {
                assert!((near.value - far.value).abs() < 1e-6 && (near.upper - far.upper).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn results_are_the_same_bits_on_1_and_3_threads() {
        let found = |threads| on_threads(threads, || sensitivities(&mixture(), 10_007, 5, &Silent).unwrap());
        assert_eq!(found(1), found(3));
    }

    #[test]
    fn a_is_the_point_of_plain_sampling_and_b_is_another() {
        let space = inputs(&[(-1.0, 1.0), (0.0, 5.0), (-1.0, 1.0)]);
        let (mut pair, mut point) = ([0.0; 6], [0.0; 3]);
        for index in [0, 1, 1 << 40] {
            draw(&Region::whole(space.dimension()), 9, index, &mut pair);
            random_point(&space, 9, Purpose::Evaluation, index, &mut point);
            assert_eq!(pair[..3], point);
            assert!(pair[..3].iter().zip(&pair[3..]).all(|(a, b)| a != b));
        }
    }

    #[test]
    fn values_that_are_no_use_are_refused_with_their_point() {
        let refused = |terms: &[(&[u16], f64)]| sensitivities(&polynomial(1, terms), 100, 1, &Silent).unwrap_err();
        for terms in [&[(&[0][..], 1e80)][..], &[(&[1][..], 1e80)], &[(&[30][..], 1e308), (&[31][..], 1e308)]] {
            let error = refused(terms);
            assert!(matches!(&error, EvalError::NotFinite { point } if point.starts_with("x1 = ")), "{error}");
        }
        assert_eq!(sensitivities(&mixture(), 0, 1, &Silent), Err(EvalError::NoSamples));
        assert!(monte_carlo(&mixture(), 1, 1, &Silent).is_ok());
    }
}
