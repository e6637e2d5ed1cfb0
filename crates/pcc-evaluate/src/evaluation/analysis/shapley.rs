//! Which inputs stability depends on where inputs depend on each other: Shapley effects.
//!
//! For a set S of inputs, Var E\[f | x_S\] is the variance of the output f that is explained once they are known. The
//! Shapley effect of input i (Owen 2014, <https://doi.org/10.1137/130936233>; Owen and Prieur 2017,
//! <https://doi.org/10.1137/16M1097717>) is the mean, over all orders in which inputs become known one after the other,
//! of what it adds to that: Sh_i = E\[Var E\[f | x_{S∪i}\] − Var E\[f | x_S\]\]/Var f, with S the inputs before i.
//! Effects are not negative and sum to 1. Of independent inputs they lie between first-order and total Sobol' indices.
//!
//! For every sample (Song, Nelson and Staum 2016, <https://doi.org/10.1137/15M1048070>, with one value of each kind)
//! there is a random order of the inputs, a point x and a point x′, and f_S is the output at x_S with the other
//! inputs of their law given x_S: in this order, normal scores are L w with the Cholesky factor L of the correlations,
//! and those of x_S with others are L (w_S, w′). From S = ∅, x′, to all inputs, x, these are r + 1 evaluations. The
//! terms are those of Goda (2021), <https://doi.org/10.1016/j.ress.2021.107702>,
//!
//! a_i = (f(x) − (f_S + f_{S∪i})/2) (f_{S∪i} − f_S), of mean Sh_i Var f,
//!
//! since f_S and f_{S∪i} have the same law. They sum to v = (f(x) − f(x′))²/2 for every sample, so that the estimates
//! mean(a_i)/mean(v) sum to 1 exactly. Intervals are from the asymptotic normal law of this ratio, as
//! those of Sobol' indices.

use super::sensitivity::{Estimate, INDICATOR_STEP, SENSITIVITY_LEVEL, is_usable, not_usable};
use crate::evaluation::error::EvalError;
use crate::evaluation::kernel::chunks::{CHUNK, in_chunks};
use crate::evaluation::kernel::lanes::BLOCK_POINTS;
use crate::evaluation::kernel::plan::Plan;
use crate::evaluation::kernel::points::Evaluator;
use crate::evaluation::questions::region::Region;
use crate::foundation::Observer;
use crate::probability::dependence::{Factor, GaussianCopula};
use crate::probability::inputs::Germ;
use crate::probability::random::{Purpose, Stream, UNIT_BITS};
use crate::surrogate::Surrogate;
use statrs::distribution::{ContinuousCDF, Normal};
use std::ops::Range;

/// Shapley effects of what decides stability.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapleyEffects {
    /// Number of samples, each of them r + 1 evaluations for r inputs.
    pub samples: u64,
    /// Effects on the spectral abscissa max Re λ, per input; `None` if it did not vary.
    pub max_re: Option<Vec<Estimate>>,
    /// Effects on the indicator of samples that are not unstable, per input; `None` if it did not vary.
    pub stability: Option<Vec<Estimate>>,
}

/// Shapley effects on max Re λ and on the indicator of samples that are not unstable, per input in order, from
/// `samples` samples under `seed`, on the current rayon thread pool. The result is the same bits for any number of
/// threads.
///
/// # Errors
///
/// [`EvalError`]; [`EvalError::NotFinite`] also if |max Re λ| exceeds 10⁷⁵, whose powers are too large.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::artifact;
/// use pcc_evaluate::evaluation::shapley_effects;
/// use pcc_evaluate::foundation::Silent;
/// let surrogate = artifact::decode(include_bytes!("../../../../../surrogates/clutch-r2-eigenvalues.pcc"))?.surrogate;
/// let effects = shapley_effects(&surrogate, 4096, 1, &Silent)?.max_re.expect("max Re varies");
/// assert!((effects[0].value + effects[1].value - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn shapley_effects(
    surrogate: &Surrogate,
    samples: u64,
    seed: u64,
    observer: &dyn Observer,
) -> Result<ShapleyEffects, EvalError> {
    shapley_effects_in(surrogate, &Region::whole(&surrogate.inputs), samples, seed, observer)
}

/// The same for inputs confined to `region`. Inputs that are fixed there have none.
///
/// # Errors
///
/// As [`shapley_effects`]; [`EvalError::ConfinedDependent`] if an input that others depend on is confined to an
/// interval ([`Region::has_effects`]).
pub fn shapley_effects_in(
    surrogate: &Surrogate,
    region: &Region,
    samples: u64,
    seed: u64,
    observer: &dyn Observer,
) -> Result<ShapleyEffects, EvalError> {
    if let Some(input) = region.correlated().interval() {
        return Err(EvalError::ConfinedDependent { input: surrogate.inputs.inputs()[input].name.clone() });
    }
    let plan = Plan::new(surrogate);
    let dimension = surrogate.inputs.dimension();
    let mut terms = [Terms::new(dimension), Terms::new(dimension)];
    in_chunks(
        samples,
        CHUNK,
        observer,
        || Walker::new(surrogate, region, Evaluator::new(surrogate, &plan), seed),
        |walker, range| walker.walk(range, observer),
        |part| terms.iter_mut().zip(&part).for_each(|(own, added)| own.merge(added)),
    )?;
    let [max_re, stability] = terms;
    Ok(ShapleyEffects { samples, max_re: max_re.effects(0.0), stability: stability.effects(INDICATOR_STEP) })
}

/// The terms a_i and v of one output over the samples seen so far.
#[derive(Debug, Clone, PartialEq)]
struct Terms {
    count: u64,
    /// Means of a_i, and of v last.
    mean: Vec<f64>,
    /// Per input Σ (a_i − ā_i)² and Σ (a_i − ā_i)(v − v̄), and Σ (v − v̄)² last with itself.
    centred: Vec<[f64; 2]>,
    /// The largest size of an output.
    largest: f64,
}

/// Variances below this times the square of the largest output are rounding.
const ROUNDING: f64 = 1e-24;

impl Terms {
    fn new(inputs: usize) -> Self {
        Self { count: 0, mean: vec![0.0; inputs + 1], centred: vec![[0.0; 2]; inputs + 1], largest: 0.0 }
    }

    /// Rows of a_i and v.
    fn of(rows: &[f64], inputs: usize, largest: f64) -> Self {
        let mut terms = Self { count: (rows.len() / (inputs + 1)) as u64, largest, ..Self::new(inputs) };
        let rows = || rows.chunks_exact(inputs + 1);
        rows().for_each(|row| terms.mean.iter_mut().zip(row).for_each(|(sum, term)| *sum += term));
        let count = (terms.count as f64).max(1.0);
        terms.mean.iter_mut().for_each(|sum| *sum /= count);
        for row in rows() {
            let deviation: Vec<f64> = row.iter().zip(&terms.mean).map(|(term, mean)| term - mean).collect();
            add_products(&mut terms.centred, &deviation, 1.0);
        }
        terms
    }

    /// Adds all samples that `other` has seen, by the formula of Chan, Golub and LeVeque.
    fn merge(&mut self, other: &Self) {
        self.largest = self.largest.max(other.largest);
        if other.count == 0 {
            return;
        }
        let (before, added) = (self.count as f64, other.count as f64);
        self.count += other.count;
        let total = self.count as f64;
        let deviation: Vec<f64> = other.mean.iter().zip(&self.mean).map(|(theirs, own)| theirs - own).collect();
        self.mean.iter_mut().zip(&deviation).for_each(|(mean, deviation)| *mean += deviation * (added / total));
        for (own, others) in self.centred.iter_mut().flatten().zip(other.centred.iter().flatten()) {
            *own += others;
        }
        add_products(&mut self.centred, &deviation, before * added / total);
    }

    /// The effects on an output that a single sample changes by `step`/nV.
    fn effects(&self, step: f64) -> Option<Vec<Estimate>> {
        let (samples, inputs) = (self.count as f64, self.mean.len() - 1);
        let variance = self.mean[inputs];
        let varies = variance.is_finite() && variance > (ROUNDING * self.largest * self.largest).max(f64::MIN_POSITIVE);
        if !varies {
            return None;
        }
        let z = Normal::standard().inverse_cdf(0.5 + 0.5 * SENSITIVITY_LEVEL);
        let of_variance = self.centred[inputs][0];
        let effect = |i: usize| {
            let value = self.mean[i] / variance;
            let [own, shared] = self.centred[i];
            // Of a_i − Sh_i v; rounding may leave a remainder just below zero.
            let remaining = (own - 2.0 * value * shared + value * value * of_variance).max(0.0);
            let standard_error = if self.count < 2 {
                f64::INFINITY
            } else {
                (remaining / (samples * (samples - 1.0))).sqrt() / variance
            };
            Estimate::new(value, (z * standard_error).hypot(z * z * step / (samples * variance)))
        };
        Some((0..inputs).map(effect).collect())
    }
}

/// Adds weight times the products of deviations that are kept.
fn add_products(centred: &mut [[f64; 2]], deviation: &[f64], weight: f64) {
    let of_variance = deviation.last().copied().unwrap_or(0.0);
    for (entries, own) in centred.iter_mut().zip(deviation) {
        entries[0] += weight * (own * own);
        entries[1] += weight * (own * of_variance);
    }
}

/// Walks samples from x′ to x, with memory of its own.
struct Walker<'a> {
    surrogate: &'a Surrogate,
    region: &'a Region,
    evaluator: Evaluator<'a>,
    seed: u64,
    /// Inputs that others depend on and that are fixed, with their normal scores.
    fixed: Vec<(usize, f64)>,
    /// The points from x′ to x of the samples of a block, standardized.
    points: Vec<f64>,
    /// The order of the inputs, sample by sample.
    orders: Vec<usize>,
}

impl<'a> Walker<'a> {
    fn new(surrogate: &'a Surrogate, region: &'a Region, evaluator: Evaluator<'a>, seed: u64) -> Self {
        let fixed = region.correlated().fixed().to_vec();
        Self { surrogate, region, evaluator, seed, fixed, points: Vec::new(), orders: Vec::new() }
    }

    /// The terms of max Re λ, and of the indicator.
    fn walk(&mut self, range: Range<u64>, observer: &dyn Observer) -> Result<[Terms; 2], EvalError> {
        let inputs = self.surrogate.inputs.dimension();
        let mut rows = [Vec::new(), Vec::new()];
        let mut largest = [0.0f64; 2];
        let mut first = range.start;
        while first < range.end {
            observer.check()?;
            let block = first..range.end.min(first + BLOCK_POINTS as u64);
            first = block.end;
            self.lay_out(block);
            let points = self.points.len() / inputs;
            let mut found = Vec::with_capacity(points);
            let at = |number: usize| &self.points[number * inputs..(number + 1) * inputs];
            self.evaluator.tops(points, |number, point: &mut [f64]| point.copy_from_slice(at(number)), &mut found);
            if let Some(bad) = found.iter().position(|top| !is_usable(top.max_re)) {
                return Err(not_usable(&self.surrogate.inputs, at(bad)));
            }
            let values = [
                found.iter().map(|top| top.max_re).collect::<Vec<f64>>(),
                found.iter().map(|top| f64::from(top.excess <= 0.0)).collect(),
            ];
            for ((values, rows), largest) in values.iter().zip(&mut rows).zip(&mut largest) {
                for (chain, order) in values.chunks_exact(inputs + 1).zip(self.orders.chunks_exact(inputs)) {
                    add_row(chain, order, rows);
                }
                *largest = values.iter().fold(*largest, |most, value| most.max(value.abs()));
            }
        }
        let [max_re, stability] = rows;
        Ok([Terms::of(&max_re, inputs, largest[0]), Terms::of(&stability, inputs, largest[1])])
    }

    /// Lays out the points of these samples.
    fn lay_out(&mut self, samples: Range<u64>) {
        self.points.clear();
        self.orders.clear();
        for index in samples {
            let mut stream = Stream::new(self.seed, Purpose::Evaluation, index);
            let inputs = self.surrogate.inputs.dimension();
            let mut draw = || -> Vec<f64> { (0..inputs).map(|_| stream.next_unit()).collect() };
            let units = [draw(), draw()];
            let order = shuffled(inputs, &mut stream);
            self.chain(&units, &order);
            self.orders.extend(order);
        }
    }

    /// The points of one sample, given the uniform numbers of x and x′.
    fn chain(&mut self, [units, others]: &[Vec<f64>; 2], order: &[usize]) {
        let Self { region, points, fixed, .. } = self;
        let copula = self.surrogate.inputs.dependence();
        // x′, with all inputs that depend on no other where they belong.
        let mut point: Vec<f64> =
            others.iter().enumerate().map(|(input, &unit)| region.place_alone(input, unit)).collect();
        let mut scores = copula.map(|copula| Scores::new(copula, region, fixed, order, [units, others]));
        if let Some(scores) = &scores {
            scores.write(region, &mut point);
        }
        points.extend(&point);
        for &input in order {
            match scores.as_mut().filter(|_| region.correlated().places(input)) {
                Some(scores) => {
                    scores.step();
                    scores.write(region, &mut point);
                }
                None => point[input] = region.place_alone(input, units[input]),
            }
            points.extend(&point);
        }
    }
}

/// Normal scores L w of inputs that depend on each other, while more and more of w′ become those of w.
struct Scores {
    /// Fixed inputs first, then the others as they become known.
    order: Vec<usize>,
    factor: Factor,
    /// w − w′, 0 for fixed inputs.
    differences: Vec<f64>,
    scores: Vec<f64>,
    /// How many of the order are known.
    known: usize,
    fixed: usize,
}

impl Scores {
    fn new(
        copula: &GaussianCopula,
        region: &Region,
        fixed: &[(usize, f64)],
        order: &[usize],
        [units, others]: [&[f64]; 2],
    ) -> Self {
        let free = order.iter().copied().filter(|&input| region.correlated().places(input));
        let order: Vec<usize> = fixed.iter().map(|&(input, _)| input).chain(free).collect();
        let factor = copula.factor(&order);
        let number = |unit: f64| Germ::Normal.at(2.0f64.mul_add(unit, -1.0));
        let mut numbers: Vec<f64> = Vec::with_capacity(order.len());
        let mut scores = Vec::with_capacity(order.len());
        for (k, &input) in order.iter().enumerate() {
            let row = factor.row(k);
            let before: f64 = row.iter().zip(&numbers).map(|(entry, w)| entry * w).sum();
            let own = match fixed.get(k) {
                Some((_, score)) => (score - before) / row[k],
                None => number(others[input]),
            };
            numbers.push(own);
            scores.push(before + row[k] * own);
        }
        let difference = |(k, &input): (usize, &usize)| match k < fixed.len() {
            true => 0.0,
            false => number(units[input]) - numbers[k],
        };
        let differences = order.iter().enumerate().map(difference).collect();
        Self { order, factor, differences, scores, known: fixed.len(), fixed: fixed.len() }
    }

    /// One more input becomes known, and those after it follow.
    fn step(&mut self) {
        let known = self.known;
        for k in known..self.order.len() {
            self.scores[k] += self.factor.row(k)[known] * self.differences[known];
        }
        self.known += 1;
    }

    /// Writes the coordinates of inputs that are not fixed.
    fn write(&self, region: &Region, point: &mut [f64]) {
        for (&input, &score) in self.order.iter().zip(&self.scores).skip(self.fixed) {
            point[input] = region.at_score(input, score);
        }
    }
}

/// A row of a_i by input, and v, from the outputs along a chain.
fn add_row(chain: &[f64], order: &[usize], rows: &mut Vec<f64>) {
    let start = rows.len();
    rows.resize(start + order.len() + 1, 0.0);
    let row = &mut rows[start..];
    let (first, last) = (chain[0], chain[chain.len() - 1]);
    for (&input, pair) in order.iter().zip(chain.windows(2)) {
        row[input] = (last - 0.5 * (pair[0] + pair[1])) * (pair[1] - pair[0]);
    }
    row[order.len()] = 0.5 * (last - first) * (last - first);
}

/// A random order of numbers below `count` (Fisher and Yates), from integers alone.
fn shuffled(count: usize, stream: &mut Stream) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    for k in (1..count).rev() {
        let at = (u128::from(stream.next_cell()) * (k as u128 + 1)) >> UNIT_BITS;
        order.swap(k, at as usize);
    }
    order
}

#[cfg(test)]
mod tests;
