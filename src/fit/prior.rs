//! How large coefficients are expected to be before anything is known: falling with the degree, by input.
//!
//! Coefficients of analytic functions fall geometrically with the degree in each variable, faster in variables that
//! matter less. The prior variance of c_α is therefore
//!
//! s_α = Π_{j: α_j > 0} v w_j^{α_j},   0 < w_j < 1,
//!
//! with one decay w_j per input and one weight v that says how far inputs interact. A product over inputs makes
//! K = Σ_α s_α ψ_α ψ_αᵀ, summed over *all* α up to a degree per input, a product of r small sums.

use crate::index_set::MultiIndex;
use crate::regression::BasisTables;
use nalgebra::DMatrix;

/// Range of ln(−ln w): from w = 0.95, hardly any decay, to w = 1e-24, an input without influence.
const DECAY: (f64, f64) = (-3.0, 4.0);

/// Range of ln v: interaction from next to nothing to everything.
const WEIGHT: (f64, f64) = (-8.0, 6.0);

/// Parameters are rounded to this, so that last-bit differences between processors do not survive the search for them.
const GRAIN: f64 = 1.0 / 64.0;

/// Share of the first degree's variance below which higher degrees are left out of K.
const NEGLIGIBLE: f64 = 1e-14;

/// The parameters of the prior: ln(−ln w_j) per input, then ln v.
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    parameters: Vec<f64>,
}

/// The matrix K of a prior on a design, with what its derivatives need.
pub(super) struct Kernel {
    /// K.
    pub matrix: DMatrix<f64>,
    /// Per input, k_j with K = Π k_j entry by entry.
    factors: Vec<DMatrix<f64>>,
    /// Per input, dk_j by ln(−ln w_j).
    by_decay: Vec<DMatrix<f64>>,
}

impl Prior {
    /// A prior from which searches start: decay by a factor of about 0.04 per degree, moderate interaction.
    pub fn start(inputs: usize) -> Self {
        let mut parameters = vec![1.2; inputs];
        parameters.push(-1.0);
        Self { parameters }
    }

    /// A prior with these parameters, moved into their ranges and rounded.
    pub(super) fn rounded(parameters: &[f64]) -> Self {
        let bounds = Self::bounds(parameters.len() - 1);
        let round = |(&x, (lower, upper)): (&f64, (f64, f64))| ((x / GRAIN).round() * GRAIN).clamp(lower, upper);
        Self { parameters: parameters.iter().zip(bounds).map(round).collect() }
    }

    /// A prior with exactly these parameters, for the search.
    pub(super) fn with(parameters: &[f64]) -> Self {
        Self { parameters: parameters.to_vec() }
    }

    pub(super) fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// (lower, upper) of each parameter.
    pub(super) fn bounds(inputs: usize) -> Vec<(f64, f64)> {
        let mut bounds = vec![DECAY; inputs];
        bounds.push(WEIGHT);
        bounds
    }

    pub(super) fn inputs(&self) -> usize {
        self.parameters.len() - 1
    }

    /// w_j, the factor by which variances fall per degree of input j.
    pub fn decay(&self, input: usize) -> f64 {
        (-self.parameters[input].exp()).exp()
    }

    /// v.
    pub fn weight(&self) -> f64 {
        self.parameters[self.inputs()].exp()
    }

    /// ln s_α of one input's factor.
    fn log_factor(&self, input: usize, degree: u16) -> f64 {
        if degree == 0 {
            0.0
        } else {
            self.parameters[self.inputs()] - self.parameters[input].exp() * f64::from(degree)
        }
    }

    /// s_α.
    pub(super) fn variance(&self, alpha: &[u16]) -> f64 {
        self.log_variance(alpha).exp()
    }

    fn log_variance(&self, alpha: &[u16]) -> f64 {
        alpha.iter().enumerate().map(|(j, &degree)| self.log_factor(j, degree)).sum()
    }

    /// K and its parts on the first `samples` points of a design, with degrees up to `degree` in each input.
    pub(super) fn kernel(&self, tables: &BasisTables, samples: usize, degree: u16) -> Kernel {
        let mut kernel = Kernel {
            matrix: DMatrix::from_element(samples, samples, 1.0),
            factors: Vec::with_capacity(self.inputs()),
            by_decay: Vec::with_capacity(self.inputs()),
        };
        for input in 0..self.inputs() {
            let rate = self.parameters[input].exp();
            let used = (1..degree).find(|&n| (-rate * f64::from(n)).exp() < NEGLIGIBLE).unwrap_or(degree);
            let powers = tables.powers(input, used).rows(0, samples).into_owned();
            let (mut scaled, mut slopes) = (powers.clone(), powers.clone());
            for n in 0..usize::from(used) {
                let variance = self.weight() * (-rate * (n + 1) as f64).exp();
                scaled.column_mut(n).scale_mut(variance);
                slopes.column_mut(n).scale_mut(-variance * rate * (n + 1) as f64);
            }
            let transposed = powers.transpose();
            let mut factor = scaled * &transposed;
            factor.add_scalar_mut(1.0);
            kernel.matrix.component_mul_assign(&factor);
            kernel.factors.push(factor);
            kernel.by_decay.push(slopes * transposed);
        }
        kernel
    }

    /// The `count` multi-indices with the largest prior variance, the canonically first among equals, with degrees up to
    /// `degree` in each input, in canonical order.
    pub(super) fn likeliest(&self, count: usize, degree: u16) -> Vec<MultiIndex> {
        let walk = Walk::new(self, degree);
        // Bisection for the threshold of ln s_α: members can only become fewer as it rises.
        let (mut low, mut high) = (LOWEST, walk.rest[0] + 1.0);
        if walk.above(low, count).len() <= count {
            high = low;
        }
        while high - low > THRESHOLD_GRAIN {
            let middle = 0.5 * (low + high);
            if walk.above(middle, count).len() > count { low = middle } else { high = middle }
        }
        let mut members = walk.above(low, MOST_TIES.max(2 * count));
        // {0} belongs to every expansion, whatever its rank.
        members.sort_by(|a, b| {
            let rank = |alpha: &MultiIndex| if alpha.is_constant() { f64::INFINITY } else { self.log_variance(alpha) };
            rank(b).total_cmp(&rank(a)).then_with(|| a.cmp(b))
        });
        members.truncate(count.max(1));
        members.sort_unstable();
        members
    }
}

/// Prior variances below e^LOWEST are never of use.
const LOWEST: f64 = -200.0;

/// Equally likely indices that are considered at most.
const MOST_TIES: usize = 100_000;

/// Resolution of the threshold of ln s_α.
const THRESHOLD_GRAIN: f64 = 1e-6;

/// Depth-first walk over multi-indices whose prior variance reaches a threshold.
struct Walk<'a> {
    prior: &'a Prior,
    degree: u16,
    /// Largest ln of the factors of the inputs from j on.
    rest: Vec<f64>,
}

impl<'a> Walk<'a> {
    fn new(prior: &'a Prior, degree: u16) -> Self {
        let mut rest = vec![0.0; prior.inputs() + 1];
        for input in (0..prior.inputs()).rev() {
            rest[input] = rest[input + 1] + prior.log_factor(input, 1).max(0.0);
        }
        Self { prior, degree, rest }
    }

    /// The indices with ln s_α ≥ `threshold`; the walk ends early beyond `limit`.
    fn above(&self, threshold: f64, limit: usize) -> Vec<MultiIndex> {
        let (mut members, mut alpha) = (Vec::new(), vec![0; self.prior.inputs()]);
        self.extend(0, 0.0, threshold, limit, &mut alpha, &mut members);
        members
    }

    fn extend(
        &self,
        input: usize,
        sum: f64,
        threshold: f64,
        limit: usize,
        alpha: &mut Vec<u16>,
        members: &mut Vec<MultiIndex>,
    ) {
        if members.len() > limit {
            return;
        }
        if input == alpha.len() {
            if alpha.iter().all(|&degree| degree == 0) || sum >= threshold {
                members.push(MultiIndex::new(alpha.clone()));
            }
            return;
        }
        for degree in 0..=self.degree {
            let extended = sum + self.prior.log_factor(input, degree);
            if extended + self.rest[input + 1] >= threshold || (degree == 0 && sum == 0.0) {
                alpha[input] = degree;
                self.extend(input + 1, extended, threshold, limit, alpha, members);
            } else if degree > 0 {
                break;
            }
        }
        alpha[input] = 0;
    }
}

impl Kernel {
    /// For a function f of K with df = Σ G_ab dK_ab, its derivatives by the parameters of the prior.
    pub fn gradient(&self, by_matrix: &DMatrix<f64>) -> Vec<f64> {
        let (mut gradient, mut by_weight) = (Vec::with_capacity(self.factors.len() + 1), 0.0);
        let weighted = by_matrix.component_mul(&self.matrix);
        for (factor, slope) in self.factors.iter().zip(&self.by_decay) {
            let [decay, weight] = sums(weighted.as_slice(), factor.as_slice(), slope.as_slice());
            gradient.push(decay);
            by_weight += weight;
        }
        gradient.push(by_weight);
        gradient
    }
}

/// Entries summed side by side.
const LANES: usize = 8;

/// Σ h b/k and Σ h (k − 1)/k over the entries h, k, b of three matrices, in eight interleaved parts.
fn sums(weighted: &[f64], factor: &[f64], slope: &[f64]) -> [f64; 2] {
    let (mut decay, mut weight) = ([0.0; LANES], [0.0; LANES]);
    let mut add = |h: &[f64; LANES], k: &[f64; LANES], b: &[f64; LANES]| {
        for lane in 0..LANES {
            // No entry of a kernel is exactly zero but by chance, and then h is, too.
            let others = h[lane] / if k[lane] == 0.0 { 1.0 } else { k[lane] };
            decay[lane] += others * b[lane];
            weight[lane] += others * (k[lane] - 1.0);
        }
    };
    let ((h, h_rest), (k, k_rest), (b, b_rest)) = (weighted.as_chunks(), factor.as_chunks(), slope.as_chunks());
    for ((h, k), b) in h.iter().zip(k).zip(b) {
        add(h, k, b);
    }
    let padded = |rest: &[f64], filling: f64| {
        let mut lanes = [filling; LANES];
        lanes[..rest.len()].copy_from_slice(rest);
        lanes
    };
    add(&padded(h_rest, 0.0), &padded(k_rest, 1.0), &padded(b_rest, 0.0));
    [decay.iter().sum(), weight.iter().sum()]
}
