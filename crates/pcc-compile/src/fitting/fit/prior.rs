//! How large coefficients are expected to be before anything is known: falling with the degree, by input.
//!
//! Coefficients of analytic functions fall geometrically with the degree in each variable, faster in variables that
//! matter less. The prior variance of c_α is therefore
//!
//! s_α = Π_{j: α_j > 0} v w_j^{α_j},   0 < w_j < 1,
//!
//! with one decay w_j per input and one weight v that says how far inputs interact. A product over inputs makes K = Σ_α
//! s_α ψ_α ψ_αᵀ, summed over *all* α up to a degree per input, a product of r small sums. With derivatives, ψ_α stands
//! for its value at a point in some rows and for a derivative in others; then one of the sums has φ′ in place of φ.

use pcc_evaluate::polynomials::MultiIndex;

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

    /// The prior variances of degrees 1… of an input, up to where they are negligible or to `degree`, and their
    /// derivatives by ln(−ln w_j).
    pub(super) fn variances(&self, input: usize, degree: u16) -> (Vec<f64>, Vec<f64>) {
        let rate = self.parameters[input].exp();
        let used = (1..degree).find(|&n| (-rate * f64::from(n)).exp() < NEGLIGIBLE).unwrap_or(degree);
        let exponents: Vec<f64> = (1..=used).map(|n| rate * f64::from(n)).collect();
        let variances: Vec<f64> = exponents.iter().map(|exponent| self.weight() * (-exponent).exp()).collect();
        let slopes = variances.iter().zip(&exponents).map(|(variance, exponent)| -variance * exponent).collect();
        (variances, slopes)
    }

    /// The `count` multi-indices with the largest prior variance, the canonically first among equals, with degrees up
    /// to `degree` in each input, in canonical order.
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
