//! Pearson's correlation of inputs from the correlation of their normal scores, and back: the transformation of Nataf.
//!
//! Liu and Der Kiureghian (1986), <https://doi.org/10.1016/0266-8920(86)90033-0>: for inputs x = x(z) of normal scores
//! z with the correlation ρ,
//!
//! corr(x_1, x_2) = ∫∫ (x_1(z_1) − m_1)/s_1 (x_2(ρ z_1 + √(1 − ρ²) z_2) − m_2)/s_2 φ(z_1) φ(z_2) dz_1 dz_2,
//!
//! which grows with ρ. The trapezoidal rule is exact to rounding here: the integrand is smooth and vanishes at both
//! ends.

use super::germ::Germ;
use super::law::Transform;
use super::marginal::Marginal;
use super::normal_quantile::density;
use thiserror::Error;

/// Nodes from −16 to 16, where the density vanishes beside what laws grow by.
const NODES: i32 = 64;
const STEP: f64 = 0.25;

/// Steps of the search, which takes about ten.
const MOST_STEPS: usize = 200;

/// What the outermost nodes may add to a variance: beyond them lies about as much.
const NEGLIGIBLE: f64 = 1e-13;

/// Correlations of scores closer than this are one.
const NARROW: f64 = 4.0 * f64::EPSILON;

/// Why no correlation of normal scores gives inputs a correlation.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum PearsonError {
    /// Inputs with these laws cannot have it.
    #[error("inputs with these laws have correlations from {least} to {largest}")]
    Impossible {
        /// The least they can have.
        least: f64,
        /// The largest.
        largest: f64,
    },
    /// Most of a variance lies where values practically never are.
    #[error("a law is too wide for its correlations to be computed")]
    TooWide,
}

/// The correlation of inputs with these laws whose normal scores have the correlation `of_scores` ∈ \[−1, 1\]; not a
/// number if a law is too wide.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::inputs::{Marginal, Parameters, pearson_of_scores, scores_of_pearson};
/// let law = Marginal::named("lognormal", &Parameters::of([("mean", 1.0), ("std", 0.5)]))?;
/// let variance = (1.0f64 + 0.25).ln();
/// let found = pearson_of_scores(&law, &law, 0.6);
/// assert!((found - (0.6 * variance).exp_m1() / variance.exp_m1()).abs() < 1e-13);
/// assert!((scores_of_pearson(&law, &law, found).unwrap() - 0.6).abs() < 1e-13);
/// # Ok::<(), pcc_evaluate::probability::inputs::MarginalError>(())
/// ```
pub fn pearson_of_scores(one: &Marginal, other: &Marginal, of_scores: f64) -> f64 {
    if are_normal(one, other) {
        return of_scores;
    }
    let pair = Pair::new(one, other);
    if pair.one.is_resolved && pair.other.is_resolved { pair.pearson(of_scores) } else { f64::NAN }
}

/// The correlation of normal scores that gives inputs with these laws the correlation `pearson`.
///
/// # Errors
///
/// [`PearsonError`], with the least and the largest correlation that inputs with these laws can have, if `pearson` is
/// not between them.
pub fn scores_of_pearson(one: &Marginal, other: &Marginal, pearson: f64) -> Result<f64, PearsonError> {
    if are_normal(one, other) {
        let impossible = PearsonError::Impossible { least: -1.0, largest: 1.0 };
        return if pearson.abs() <= 1.0 { Ok(pearson) } else { Err(impossible) };
    }
    if pearson == 0.0 {
        return Ok(0.0);
    }
    let pair = Pair::new(one, other);
    if !(pair.one.is_resolved && pair.other.is_resolved) {
        return Err(PearsonError::TooWide);
    }
    let excess = |of_scores: f64| pair.pearson(of_scores) - pearson;
    let (mut lower, mut upper) = ((-1.0, excess(-1.0)), (1.0, excess(1.0)));
    // False for what is no number.
    let is_possible = lower.1 <= 0.0 && upper.1 >= 0.0;
    if !is_possible {
        return Err(PearsonError::Impossible { least: pair.pearson(-1.0), largest: pair.pearson(1.0) });
    }
    // Regula falsi that halves the value of an end that stays (Dowell and Jarratt 1971, "Illinois").
    let mut stayed = 0;
    for _ in 0..MOST_STEPS {
        if lower.1 == 0.0 || upper.0 - lower.0 <= NARROW {
            return Ok(lower.0);
        }
        if upper.1 == 0.0 {
            return Ok(upper.0);
        }
        let middle = (lower.0 * upper.1 - upper.0 * lower.1) / (upper.1 - lower.1);
        let found = excess(middle);
        if found <= 0.0 {
            upper.1 *= if stayed == 1 { 0.5 } else { 1.0 };
            (lower, stayed) = ((middle, found), 1);
        } else {
            lower.1 *= if stayed == -1 { 0.5 } else { 1.0 };
            (upper, stayed) = ((middle, found), -1);
        }
        if found.abs() <= NARROW {
            return Ok(middle);
        }
    }
    Ok(0.5 * (lower.0 + upper.0))
}

/// Whether the correlation is that of the scores: the inputs are affine functions of them.
fn are_normal(one: &Marginal, other: &Marginal) -> bool {
    let is_normal =
        |law: &Marginal| matches!(law.germ(), Germ::Normal) && matches!(law.transform(), Transform::Affine { .. });
    is_normal(one) && is_normal(other)
}

/// Two laws with their means and standard deviations.
struct Pair<'a> {
    one: Standard<'a>,
    other: Standard<'a>,
}

struct Standard<'a> {
    law: &'a Marginal,
    mean: f64,
    deviation: f64,
    /// Whether the nodes hold all of the variance.
    is_resolved: bool,
}

fn nodes() -> impl Iterator<Item = (f64, f64)> {
    (-NODES..=NODES).map(|k| (STEP * f64::from(k), STEP * density(STEP * f64::from(k))))
}

impl<'a> Standard<'a> {
    fn new(law: &'a Marginal) -> Self {
        let raw = Self { law, mean: 0.0, deviation: 1.0, is_resolved: true };
        // About the median first, so that nothing is lost where a law is narrow.
        let median = raw.at(0.0);
        let shift: f64 = nodes().map(|(z, weight)| weight * (raw.at(z) - median)).sum();
        let mean = median + shift;
        let squares: Vec<f64> = nodes().map(|(z, weight)| weight * (raw.at(z) - mean).powi(2)).collect();
        let square: f64 = squares.iter().sum();
        // False for what is no number.
        let is_small = |end: Option<&f64>| end.is_some_and(|&end| end <= NEGLIGIBLE * square);
        let is_resolved = square > 0.0 && square.is_finite() && is_small(squares.first()) && is_small(squares.last());
        Self { law, mean, deviation: square.sqrt(), is_resolved }
    }

    /// (x(z) − m)/s.
    fn at(&self, score: f64) -> f64 {
        (self.law.physical(self.law.germ().at_score(score)) - self.mean) / self.deviation
    }
}

impl<'a> Pair<'a> {
    fn new(one: &'a Marginal, other: &'a Marginal) -> Self {
        Self { one: Standard::new(one), other: Standard::new(other) }
    }

    fn pearson(&self, of_scores: f64) -> f64 {
        let rest = (1.0 - of_scores * of_scores).max(0.0).sqrt();
        let inner = |z: f64| match rest == 0.0 {
            true => self.other.at(of_scores * z),
            false => nodes().map(|(other, weight)| weight * self.other.at(rest.mul_add(other, of_scores * z))).sum(),
        };
        nodes().map(|(z, weight)| weight * self.one.at(z) * inner(z)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::super::parameters::Parameters;
    use super::*;

    fn law(name: &'static str, parameters: &[(&'static str, f64)]) -> Marginal {
        Marginal::named(name, &Parameters::of(parameters.iter().copied())).unwrap()
    }

    #[test]
    fn closed_forms_are_found_and_undone() {
        let uniform = law("uniform", &[("lower", 2.0), ("upper", 5.0)]);
        let normal = law("normal", &[("mean", 1e6), ("std", 1e3)]);
        let (first, second) =
            (law("lognormal", &[("mean", 2.0), ("std", 0.5)]), law("lognormal", &[("mean", 1.0), ("std", 1.5)]));
        let sigma = |cv: f64| (1.0 + cv * cv).ln().sqrt();
        let (a, b) = (sigma(0.25), sigma(1.5));
        for rho in [-0.95f64, -0.3, 0.1, 0.5, 0.99] {
            let cases = [
                (&normal, &normal, rho),
                (&uniform, &uniform, 6.0 / std::f64::consts::PI * (0.5 * rho).asin()),
                // Cov(z, Φ(z′)) = ρ/√(4π).
                (&normal, &uniform, rho * (3.0 / std::f64::consts::PI).sqrt()),
                (&first, &second, (rho * a * b).exp_m1() / ((a * a).exp_m1() * (b * b).exp_m1()).sqrt()),
                (&normal, &second, rho * b / (b * b).exp_m1().sqrt()),
            ];
            for (one, other, expected) in cases {
                let found = pearson_of_scores(one, other, rho);
                assert!((found - expected).abs() < 1e-13, "{one:?} {other:?} {rho}: {found} {expected}");
                let back = scores_of_pearson(one, other, expected).unwrap();
                assert!((back - rho).abs() < 2e-13, "{one:?} {other:?} {rho}: {back}");
            }
        }
        assert_eq!(scores_of_pearson(&uniform, &first, 0.0), Ok(0.0));
    }

    /// By a composite Gauss rule over SciPy's quantiles: correlations of normal scores of 0.7.
    const QUADRATURE: [f64; 3] = [0.6640777123786441, 0.6849398272625875, 0.6523576955626004];

    #[test]
    fn other_laws_have_the_correlations_of_an_independent_quadrature() {
        let exponential = law("exponential", &[("mean", 3.0)]);
        let weibull = law("weibull", &[("shape", 1.5), ("scale", 2.0)]);
        let cut = law("normal", &[("mean", 1.0), ("std", 0.5), ("lower", 0.5), ("upper", 2.5)]);
        let gumbel = law("gumbel", &[("mean", 1.0), ("std", 0.2)]);
        for (one, other, expected) in [
            (&exponential, &weibull, QUADRATURE[0]),
            (&cut, &gumbel, QUADRATURE[1]),
            (&cut, &exponential, QUADRATURE[2]),
        ] {
            let found = pearson_of_scores(one, other, 0.7);
            assert!((found - expected).abs() < 1e-9, "{one:?} {other:?}: {found}");
            assert!((pearson_of_scores(other, one, 0.7) - found).abs() < 1e-12);
        }
    }

    #[test]
    fn what_no_scores_give_is_refused_with_what_is_possible() {
        let law = law("lognormal", &[("mean", 1.0), ("std", 1.0)]);
        // −e^(−σ²) to 1 for σ² = ln 2.
        let Err(PearsonError::Impossible { least, largest }) = scores_of_pearson(&law, &law, -0.6) else { panic!() };
        assert!((least + 0.5).abs() < 1e-12 && (largest - 1.0).abs() < 1e-12);
        let wide = self::law("lognormal", &[("mean", 1.0), ("cv", 1e12)]);
        assert_eq!(scores_of_pearson(&law, &wide, 0.1), Err(PearsonError::TooWide));
        assert!(pearson_of_scores(&wide, &law, 0.1).is_nan());
        assert!(scores_of_pearson(&law, &law, -0.4999).unwrap() > -1.0);
        assert!(scores_of_pearson(&law, &law, f64::NAN).is_err());
    }
}
