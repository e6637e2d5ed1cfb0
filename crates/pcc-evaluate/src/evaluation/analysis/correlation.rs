//! Correlation of two outputs that are alike, sharpened by two outputs that are known to be uncorrelated.
//!
//! (y, z) are pairs of outputs with the same distribution, n of them independent. Their correlation is estimated after
//! Janon, Klein, Lagnoux, Nodet and Prieur (2014), <https://doi.org/10.1051/ps/2013040>, by
//!
//! ρ = (p − m²)/v, v = s − m², with the means p of yz, s of (y² + z²)/2 and m of (y + z)/2,
//!
//! which no other regular estimator from these pairs undercuts in variance as n grows. (u, v) are outputs of the same
//! samples, with the same distribution, that are independent of each other: their correlation κ, estimated in the same
//! way, is known to be 0 and serves as control variable (Lavenberg and Welch 1981,
//! <https://doi.org/10.1287/mnsc.27.3.322>): the result is ρ − cκ with c = Cov(ρ, κ)/Var κ, which has the least
//! variance, (1 − corr(ρ, κ)²) Var ρ. Variances and covariances of ρ and κ follow from those of the five means by the
//! delta method.

/// What is averaged over samples: yz, (y² + z²)/2, (y + z)/2, uv, (u + v)/2.
const TERMS: usize = 5;

/// Passes in which c is found: the derivatives of ρ are taken at the plain estimate first, then at the sharpened one,
/// which is nearer to the truth.
const PASSES: usize = 2;

/// Variances below this times the mean square are rounding: the outputs do not vary.
const ROUNDING: f64 = 1e-12;

/// Variances below this are none: their squares, which standard errors are made of, are no normal numbers.
const SMALLEST_VARIANCE: f64 = 1e-150;

/// Means and centred products of the five terms over the samples seen so far.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Products {
    count: u64,
    mean: [f64; TERMS],
    /// Σ (t_a − t̄_a)(t_b − t̄_b) by a and b.
    centred: [[f64; TERMS]; TERMS],
}

/// An estimated correlation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Correlation {
    /// Its value, not confined to \[−1, 1\].
    pub value: f64,
    /// Standard error of the value; infinite for a single sample.
    pub standard_error: f64,
    /// Variance of the outputs.
    pub variance: f64,
}

impl Products {
    /// No samples yet.
    pub fn new() -> Self {
        Self { count: 0, mean: [0.0; TERMS], centred: [[0.0; TERMS]; TERMS] }
    }

    /// The samples of `pair` (y, z) and `control` (u, v): four lists of the same length.
    pub fn of(pair: [&[f64]; 2], control: [&[f64]; 2]) -> Self {
        let samples = || pair[0].iter().zip(pair[1]).zip(control[0].iter().zip(control[1]));
        let terms = |((&y, &z), (&u, &v)): ((&f64, &f64), (&f64, &f64))| {
            [y * z, 0.5 * (y * y + z * z), 0.5 * (y + z), u * v, 0.5 * (u + v)]
        };
        let mut products = Self { count: pair[0].len() as u64, ..Self::new() };
        if products.count == 0 {
            return products;
        }
        for row in samples().map(terms) {
            for (sum, term) in products.mean.iter_mut().zip(row) {
                *sum += term;
            }
        }
        products.mean = products.mean.map(|sum| sum / products.count as f64);
        for row in samples().map(terms) {
            let mut deviation = row;
            for (term, mean) in deviation.iter_mut().zip(products.mean) {
                *term -= mean;
            }
            products.add_outer(&deviation, 1.0);
        }
        products
    }

    /// Adds all samples that `other` has seen, by the formula of Chan, Golub and LeVeque as
    /// [`crate::probability::statistics::Moments`].
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let (before, added) = (self.count as f64, other.count as f64);
        self.count += other.count;
        let total = self.count as f64;
        let mut deviation = other.mean;
        for (mean, deviation) in self.mean.iter_mut().zip(&mut deviation) {
            *deviation -= *mean;
            *mean += *deviation * (added / total);
        }
        for (own, others) in self.centred.iter_mut().flatten().zip(other.centred.iter().flatten()) {
            *own += others;
        }
        self.add_outer(&deviation, before * added / total);
    }

    /// Adds weight · d dᵀ to the centred products.
    fn add_outer(&mut self, deviation: &[f64; TERMS], weight: f64) {
        for (row, a) in self.centred.iter_mut().zip(deviation) {
            for (entry, b) in row.iter_mut().zip(deviation) {
                *entry += weight * (a * b);
            }
        }
    }

    /// The correlation of y and z, or `None` if they do not vary.
    pub fn correlation(&self) -> Option<Correlation> {
        let [product, square, mean, control_product, control_mean] = self.mean;
        let variance = square - mean * mean;
        let varies = variance.is_finite() && variance > SMALLEST_VARIANCE.max(ROUNDING * square);
        if !varies {
            return None;
        }
        let plain = (product - mean * mean) / variance;
        let control = (control_product - control_mean * control_mean) / variance;
        // The derivatives of ρ and κ by the five means; that of κ by v is left out, because κ is 0 but for sampling.
        let control_slope = [0.0, 0.0, 0.0, 1.0, -2.0 * control_mean].map(|entry| entry / variance);
        let of_control = self.covariance(&control_slope, &control_slope);
        let (mut value, mut remaining) = (plain, f64::INFINITY);
        for _ in 0..PASSES {
            let slope = [1.0, -value, -2.0 * mean * (1.0 - value), 0.0, 0.0].map(|entry| entry / variance);
            let shared = self.covariance(&slope, &control_slope);
            let coefficient = if of_control > 0.0 { shared / of_control } else { 0.0 };
            value = plain - coefficient * control;
            // Rounding may leave a remainder just below zero.
            remaining = (self.covariance(&slope, &slope) - coefficient * shared).max(0.0);
        }
        let standard_error = if self.count < 2 { f64::INFINITY } else { remaining.sqrt() };
        Some(Correlation { value, standard_error, variance })
    }

    /// Covariance of gᵀt̄ and hᵀt̄ for the means t̄ of the terms; 0 for a single sample.
    fn covariance(&self, g: &[f64; TERMS], h: &[f64; TERMS]) -> f64 {
        let rows = self.centred.iter().map(|row| row.iter().zip(h).map(|(entry, h)| entry * h).sum::<f64>());
        let form: f64 = rows.zip(g).map(|(row, g)| row * g).sum();
        let count = self.count as f64;
        form / (count * (count - 1.0).max(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probability::random::{Purpose, Stream};

    /// Lists u, v, w of unit variance with u and v independent and w = a u + √(1 − a²) v.
    fn lists(seed: u64, samples: usize, a: f64) -> [Vec<f64>; 3] {
        let mut stream = Stream::new(seed, Purpose::Evaluation, 0);
        let mut draw = || -> Vec<f64> { (0..samples).map(|_| 12f64.sqrt() * (stream.next_unit() - 0.5)).collect() };
        let (u, v) = (draw(), draw());
        let w = u.iter().zip(&v).map(|(u, v)| a * u + (1.0 - a * a).sqrt() * v).collect();
        [u, v, w]
    }

    #[test]
    fn merged_parts_equal_the_whole() {
        let [u, v, w] = lists(1, 1000, 0.6);
        let whole = Products::of([&v, &w], [&u, &v]).correlation().unwrap();
        let mut parts = Products::new();
        for part in [0..300, 300..300, 300..1000] {
            parts.merge(&Products::of([&v[part.clone()], &w[part.clone()]], [&u[part.clone()], &v[part.clone()]]));
        }
        let merged = parts.correlation().unwrap();
        assert!((merged.value - whole.value).abs() < 1e-13);
        assert!((merged.standard_error - whole.standard_error).abs() < 1e-13);
        assert!((merged.variance - whole.variance).abs() < 1e-13);
    }

    #[test]
    fn standard_error_is_the_spread_over_repetitions() {
        const REPETITIONS: u64 = 2000;
        for (a, exact) in [(0.0, 1.0), (0.6, 0.8), (0.995, 0.1)] {
            let exact = if a == 0.995 { f64::sqrt(1.0 - 0.995 * 0.995) } else { exact };
            let estimates: Vec<Correlation> = (0..REPETITIONS)
                .map(|seed| {
                    let [u, v, w] = lists(seed, 400, a);
                    Products::of([&v, &w], [&u, &v]).correlation().unwrap()
                })
                .collect();
            let of = |part: fn(&Correlation) -> f64| estimates.iter().map(part).sum::<f64>() / REPETITIONS as f64;
            let (mean, stated) = (of(|estimate| estimate.value), of(|estimate| estimate.standard_error));
            let squares: f64 = estimates.iter().map(|estimate| (estimate.value - mean).powi(2)).sum();
            let spread = (squares / (REPETITIONS - 1) as f64).sqrt();
            // Four standard errors of the mean; of the spread (1/√2n of it), and a bias of order 1/400.
            assert!((mean - exact).abs() < 4.0 * spread / (REPETITIONS as f64).sqrt() + 0.002, "{a}: {mean}");
            assert!((stated - spread).abs() < 0.08 * spread + 1e-12, "{a}: {stated} stated, {spread} found");
        }
    }

    /// w ≈ u, so the correlation of v and w is nearly that of u and v, which is known.
    #[test]
    fn the_control_variable_sharpens_small_correlations() {
        let [u, v, w] = lists(5, 1000, 0.999);
        let sharpened = Products::of([&v, &w], [&u, &v]).correlation().unwrap();
        let blunt = 1.0 / 1000f64.sqrt();
        assert!(sharpened.standard_error < 0.1 * blunt, "{sharpened:?}");
    }

    #[test]
    fn equal_outputs_correlate_without_error() {
        let [u, v, _] = lists(2, 100, 0.0);
        let found = Products::of([&v, &v], [&u, &v]).correlation().unwrap();
        assert!((found.value - 1.0).abs() < 1e-15 && found.standard_error < 1e-9, "{found:?}");
        let control = Products::of([&u, &v], [&u, &v]).correlation().unwrap();
        assert!(control.value.abs() < 0.02, "{control:?}");
    }

    #[test]
    fn outputs_that_do_not_vary_have_no_correlation() {
        for constant in [0.0, 1.0, 0.1, -3e70, 1e-200] {
            let list = vec![constant; 100];
            assert_eq!(Products::of([&list, &list], [&list, &list]).correlation(), None, "{constant}");
        }
        assert_eq!(Products::new().correlation(), None);
        let single = Products::of([&[1.0], &[2.0]], [&[1.0], &[2.0]]).correlation().unwrap();
        assert_eq!(single.standard_error, f64::INFINITY);
    }
}
