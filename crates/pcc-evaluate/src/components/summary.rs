//! What many samples of a spectrum say: stability, and per mode what engineers read.

use crate::probability::statistics::{Merge, Moments, Proportion};
use num_complex::Complex;
use serde::{Deserialize, Serialize};

/// Statistics of one mode.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModeSummary {
    /// Growth rate Re λ, in 1/s.
    pub growth_rate: Moments,
    /// Angular frequency Im λ, in rad/s.
    pub angular_frequency: Moments,
    /// Damping ratio −Re λ/|λ|.
    pub damping_ratio: Moments,
    /// Samples in which this mode is unstable, Re λ ≥ 0.
    pub unstable: u64,
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
    /// Samples with max Re λ < 0.
    pub stable: u64,
    /// Samples that would be stable if max Re λ were larger by the first, and by the second, of two shifts.
    pub stable_if_shifted: [u64; 2],
    /// Spectral abscissa max Re λ, in 1/s.
    pub max_re: Moments,
    /// Every component by id.
    pub components: Vec<Moments>,
    /// Every mode.
    pub modes: Vec<ModeSummary>,
}

impl Summary {
    /// No samples yet, of so many components and modes.
    pub fn new(components: usize, modes: usize) -> Self {
        Self {
            stable: 0,
            stable_if_shifted: [0; 2],
            max_re: Moments::default(),
            components: vec![Moments::default(); components],
            modes: vec![ModeSummary::default(); modes],
        }
    }

    /// All moments: of max Re λ, of every component, of every mode.
    pub fn moments(&self) -> impl Iterator<Item = &Moments> {
        let modes = self.modes.iter();
        let of_modes = modes.flat_map(|mode| [&mode.growth_rate, &mode.angular_frequency, &mode.damping_ratio]);
        std::iter::once(&self.max_re).chain(&self.components).chain(of_modes)
    }

    /// Number of samples.
    pub fn samples(&self) -> u64 {
        self.max_re.count()
    }

    /// The share of stable samples.
    pub fn stable_proportion(&self) -> Proportion {
        Proportion { hits: self.stable, samples: self.samples() }
    }

    /// The statistics of one block of samples. `shifts`, in 1/s, are errors of max Re λ that could be.
    pub fn of(block: &Block, shifts: [f64; 2]) -> Self {
        let modes = block.eigenvalues.iter().map(|lambdas| {
            let part = |part: fn(&Complex<f64>) -> f64| Moments::of(&lambdas.iter().map(part).collect::<Vec<_>>());
            ModeSummary {
                growth_rate: part(|lambda| lambda.re),
                angular_frequency: part(|lambda| lambda.im),
                damping_ratio: part(|lambda| damping_ratio(lambda.re, lambda.im)),
                unstable: lambdas.iter().filter(|lambda| lambda.re >= 0.0).count() as u64,
            }
        });
        let stable = |shift: f64| block.max_re.iter().filter(|&&max_re| max_re + shift < 0.0).count() as u64;
        Self {
            stable: stable(0.0),
            stable_if_shifted: shifts.map(stable),
            max_re: Moments::of(&block.max_re),
            components: block.components.iter().map(|values| Moments::of(values)).collect(),
            modes: modes.collect(),
        }
    }
}

impl Merge for Summary {
    /// Adds the samples of `other`, which has as many components and modes.
    fn merge(&mut self, other: &Self) {
        self.stable += other.stable;
        self.stable_if_shifted[0] += other.stable_if_shifted[0];
        self.stable_if_shifted[1] += other.stable_if_shifted[1];
        self.max_re.merge(&other.max_re);
        for (own, added) in self.components.iter_mut().zip(&other.components) {
            own.merge(added);
        }
        for (own, added) in self.modes.iter_mut().zip(&other.modes) {
            own.growth_rate.merge(&added.growth_rate);
            own.angular_frequency.merge(&added.angular_frequency);
            own.damping_ratio.merge(&added.damping_ratio);
            own.unstable += added.unstable;
        }
    }
}

/// Samples side by side: one list per quantity.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Block {
    /// Values of every component by id.
    pub components: Vec<Vec<f64>>,
    /// Eigenvalues of every mode, in 1/s.
    pub eigenvalues: Vec<Vec<Complex<f64>>>,
    /// max Re λ, in 1/s.
    pub max_re: Vec<f64>,
}

impl Block {
    /// An empty block with room for `samples` samples.
    pub fn with_capacity(components: usize, modes: usize, samples: usize) -> Self {
        Self {
            components: (0..components).map(|_| Vec::with_capacity(samples)).collect(),
            eigenvalues: (0..modes).map(|_| Vec::with_capacity(samples)).collect(),
            max_re: Vec::with_capacity(samples),
        }
    }

    /// Adds the samples of `other`, which has as many components and modes.
    pub fn append(&mut self, mut other: Self) {
        self.components.iter_mut().zip(&mut other.components).for_each(|(own, added)| own.append(added));
        self.eigenvalues.iter_mut().zip(&mut other.eigenvalues).for_each(|(own, added)| own.append(added));
        self.max_re.append(&mut other.max_re);
    }

    /// The first `count` samples.
    pub fn first(&self, count: usize) -> Self {
        let lists = |lists: &[Vec<f64>]| lists.iter().map(|list| list[..count.min(list.len())].to_vec()).collect();
        let lambdas = self.eigenvalues.iter().map(|list| list[..count.min(list.len())].to_vec()).collect();
        let max_re = self.max_re[..count.min(self.max_re.len())].to_vec();
        Self { components: lists(&self.components), eigenvalues: lambdas, max_re }
    }

    /// The first sample whose max Re λ is not finite, because a component overflowed.
    pub fn first_not_finite(&self) -> Option<usize> {
        self.max_re.iter().position(|max_re| !max_re.is_finite())
    }

    /// Adds one sample.
    #[inline]
    pub fn push(&mut self, components: &[f64], eigenvalues: &[Complex<f64>], max_re: f64) {
        for (list, &value) in self.components.iter_mut().zip(components) {
            list.push(value);
        }
        for (list, &lambda) in self.eigenvalues.iter_mut().zip(eigenvalues) {
            list.push(lambda);
        }
        self.max_re.push(max_re);
    }
}
