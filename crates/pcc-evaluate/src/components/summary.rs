//! What many samples of a spectrum say: stability, and per eigenvalue what engineers read.

use super::verdict::{Margin, Verdict, beyond_rounding};
use crate::probability::statistics::{Merge, Moments, Proportion};
use num_complex::Complex;
use serde::{Deserialize, Serialize};

/// Statistics of one eigenvalue: the first of a mode, its second, or one that belongs to no mode.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EigenvalueSummary {
    /// Growth rate Re λ, in 1/s.
    pub growth_rate: Moments,
    /// Angular frequency Im λ, in rad/s.
    pub angular_frequency: Moments,
    /// Damping ratio −Re λ/|λ|.
    pub damping_ratio: Moments,
    /// Samples in which it is unstable: its excess is positive.
    pub unstable: u64,
    /// Samples in which its excess cannot be told from zero.
    pub marginal: u64,
    /// Samples in which it is real.
    pub real: u64,
    /// Samples in which it is real and unstable.
    pub divergent: u64,
    /// Angular frequency Im λ, in rad/s, of the samples in which it is unstable and oscillates; absent without any.
    pub flutter_frequency: Option<Moments>,
}

/// Damping ratio −Re λ/|λ|; 0 for λ = 0.
#[inline(always)]
pub fn damping_ratio(re: f64, im: f64) -> f64 {
    let square = re * re + im * im;
    if square > 0.0 { -re / square.sqrt() } else { 0.0 }
}

/// Statistics of many samples. Parts merge in a fixed order to the same bits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Summary {
    /// Stable samples: the largest excess is negative. Those that are neither stable nor unstable are marginal.
    pub stable: u64,
    /// Unstable samples: the largest excess is positive.
    pub unstable: u64,
    /// Unstable samples whose eigenvalue with the largest excess is real: they diverge, the other unstable ones
    /// flutter.
    pub divergent: u64,
    /// Samples that are not marginal and would be stable if the excess were larger by the first, and by the second, of
    /// two shifts.
    pub stable_if_shifted: [u64; 2],
    /// Spectral abscissa max Re λ, in 1/s.
    pub max_re: Moments,
    /// Every component by id.
    pub components: Vec<Moments>,
    /// Every eigenvalue.
    pub eigenvalues: Vec<EigenvalueSummary>,
}

impl Summary {
    /// No samples yet, of so many components and eigenvalues.
    pub fn new(components: usize, eigenvalues: usize) -> Self {
        Self {
            stable: 0,
            unstable: 0,
            divergent: 0,
            stable_if_shifted: [0; 2],
            max_re: Moments::default(),
            components: vec![Moments::default(); components],
            eigenvalues: vec![EigenvalueSummary::default(); eigenvalues],
        }
    }

    /// All moments: of max Re λ, of every component, of every eigenvalue.
    pub fn moments(&self) -> impl Iterator<Item = &Moments> {
        let of_eigenvalues =
            self.eigenvalues.iter().flat_map(|own| [&own.growth_rate, &own.angular_frequency, &own.damping_ratio]);
        std::iter::once(&self.max_re).chain(&self.components).chain(of_eigenvalues)
    }

    /// Number of samples.
    pub fn samples(&self) -> u64 {
        self.max_re.count()
    }

    /// The share of stable samples.
    pub fn stable_proportion(&self) -> Proportion {
        Proportion { hits: self.stable, samples: self.samples() }
    }

    /// Samples that are neither stable nor unstable.
    pub fn marginal(&self) -> u64 {
        self.samples() - self.stable - self.unstable
    }

    /// Unstable samples whose eigenvalue with the largest excess oscillates.
    pub fn fluttering(&self) -> u64 {
        self.unstable - self.divergent
    }

    /// The statistics of one block of samples. `shifts`, in 1/s, are errors of max Re λ that could be; each eigenvalue
    /// is judged by its `margin`.
    pub fn of(block: &Block, margin: Margin, tolerance: f64, shifts: [f64; 2]) -> Self {
        let eigenvalues = block.eigenvalues.iter().map(|lambdas| {
            let part = |part: fn(&Complex<f64>) -> f64| Moments::of(&lambdas.iter().map(part).collect::<Vec<_>>());
            let count =
                |holds: &dyn Fn(&Complex<f64>) -> bool| lambdas.iter().filter(|lambda| holds(lambda)).count() as u64;
            let excess = |lambda: &Complex<f64>| beyond_rounding(margin.excess(*lambda), tolerance);
            EigenvalueSummary {
                growth_rate: part(|lambda| lambda.re),
                angular_frequency: part(|lambda| lambda.im),
                damping_ratio: part(|lambda| damping_ratio(lambda.re, lambda.im)),
                unstable: count(&|lambda| excess(lambda) > 0.0),
                marginal: count(&|lambda| excess(lambda) == 0.0),
                real: count(&|lambda| lambda.im == 0.0),
                divergent: count(&|lambda| lambda.im == 0.0 && excess(lambda) > 0.0),
                flutter_frequency: {
                    let flutters = lambdas.iter().filter(|lambda| lambda.im != 0.0 && excess(lambda) > 0.0);
                    let frequencies: Vec<f64> = flutters.map(|lambda| lambda.im).collect();
                    (!frequencies.is_empty()).then(|| Moments::of(&frequencies))
                },
            }
        });
        let count = |holds: &dyn Fn(f64) -> bool| block.excess.iter().filter(|excess| holds(**excess)).count() as u64;
        let diverges = |(excess, frequency): &(&f64, &f64)| Verdict::of(**excess, **frequency) == Verdict::Divergence;
        Self {
            stable: count(&|excess| excess < 0.0),
            unstable: count(&|excess| excess > 0.0),
            divergent: block.excess.iter().zip(&block.top_frequency).filter(diverges).count() as u64,
            stable_if_shifted: shifts.map(|shift| count(&|excess| excess != 0.0 && excess + shift < 0.0)),
            max_re: Moments::of(&block.max_re),
            components: block.components.iter().map(|values| Moments::of(values)).collect(),
            eigenvalues: eigenvalues.collect(),
        }
    }
}

impl Merge for Summary {
    /// Adds the samples of `other`, which has as many components and eigenvalues.
    fn merge(&mut self, other: &Self) {
        self.stable += other.stable;
        self.unstable += other.unstable;
        self.divergent += other.divergent;
        self.stable_if_shifted[0] += other.stable_if_shifted[0];
        self.stable_if_shifted[1] += other.stable_if_shifted[1];
        self.max_re.merge(&other.max_re);
        for (own, added) in self.components.iter_mut().zip(&other.components) {
            own.merge(added);
        }
        for (own, added) in self.eigenvalues.iter_mut().zip(&other.eigenvalues) {
            own.growth_rate.merge(&added.growth_rate);
            own.angular_frequency.merge(&added.angular_frequency);
            own.damping_ratio.merge(&added.damping_ratio);
            own.unstable += added.unstable;
            own.marginal += added.marginal;
            own.real += added.real;
            own.divergent += added.divergent;
            match (&mut own.flutter_frequency, &added.flutter_frequency) {
                (Some(own), Some(added)) => own.merge(added),
                (own, added) => *own = own.or(*added),
            }
        }
    }
}

/// What decides on one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Top {
    /// max Re λ, in 1/s.
    pub max_re: f64,
    /// The largest excess, in 1/s; 0 where it cannot be told from zero.
    pub excess: f64,
    /// Im λ of the eigenvalue with the largest excess, in rad/s: 0 where it is real.
    pub frequency: f64,
}

impl Top {
    /// What it says of stability.
    pub fn verdict(self) -> Verdict {
        Verdict::of(self.excess, self.frequency)
    }
}

/// Samples side by side: one list per quantity.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Block {
    /// Values of every component by id.
    pub components: Vec<Vec<f64>>,
    /// Every eigenvalue, in the order of the labels, in 1/s.
    pub eigenvalues: Vec<Vec<Complex<f64>>>,
    /// max Re λ, in 1/s.
    pub max_re: Vec<f64>,
    /// The largest excess, in 1/s: max Re λ without a margin; 0 where it cannot be told from zero.
    pub excess: Vec<f64>,
    /// Im λ of the eigenvalue with the largest excess, in rad/s: 0 where it is real.
    pub top_frequency: Vec<f64>,
}

impl Block {
    /// An empty block with room for `samples` samples.
    pub fn with_capacity(components: usize, eigenvalues: usize, samples: usize) -> Self {
        Self {
            components: (0..components).map(|_| Vec::with_capacity(samples)).collect(),
            eigenvalues: (0..eigenvalues).map(|_| Vec::with_capacity(samples)).collect(),
            max_re: Vec::with_capacity(samples),
            excess: Vec::with_capacity(samples),
            top_frequency: Vec::with_capacity(samples),
        }
    }

    /// Adds the samples of `other`, which has as many components and eigenvalues.
    pub fn append(&mut self, mut other: Self) {
        self.components.iter_mut().zip(&mut other.components).for_each(|(own, added)| own.append(added));
        self.eigenvalues.iter_mut().zip(&mut other.eigenvalues).for_each(|(own, added)| own.append(added));
        self.max_re.append(&mut other.max_re);
        self.excess.append(&mut other.excess);
        self.top_frequency.append(&mut other.top_frequency);
    }

    /// The first `count` samples.
    pub fn first(&self, count: usize) -> Self {
        let few = |list: &[f64]| list[..count.min(list.len())].to_vec();
        Self {
            components: self.components.iter().map(|list| few(list)).collect(),
            eigenvalues: self.eigenvalues.iter().map(|list| list[..count.min(list.len())].to_vec()).collect(),
            max_re: few(&self.max_re),
            excess: few(&self.excess),
            top_frequency: few(&self.top_frequency),
        }
    }

    /// What decides on a sample.
    pub fn top(&self, sample: usize) -> Top {
        let (max_re, excess) = (self.max_re[sample], self.excess[sample]);
        Top { max_re, excess, frequency: self.top_frequency[sample] }
    }

    /// The first sample whose max Re λ is not finite, because a component overflowed.
    pub fn first_not_finite(&self) -> Option<usize> {
        self.max_re.iter().position(|max_re| !max_re.is_finite())
    }

    /// Adds one sample; `top` decides on it, and need not be among the `eigenvalues`.
    #[inline]
    pub fn push(&mut self, components: &[f64], eigenvalues: &[Complex<f64>], top: Top) {
        for (list, &value) in self.components.iter_mut().zip(components) {
            list.push(value);
        }
        for (list, &lambda) in self.eigenvalues.iter_mut().zip(eigenvalues) {
            list.push(lambda);
        }
        self.max_re.push(top.max_re);
        self.excess.push(top.excess);
        self.top_frequency.push(top.frequency);
    }
}
