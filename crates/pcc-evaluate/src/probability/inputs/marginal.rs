//! The law of one input, whichever it is, and its map to the standardized variable of its polynomial family.

use super::germ::{Germ, centred_probability_of_score};
use super::law::{Law, Source, Transform};
use super::uniform::Uniform;
use crate::polynomials::Family;
use std::sync::Arc;

/// Values that leave the domain by less than this share of its width still count as inside: bounds given as
/// nominal × (1 ± spread) and the same bounds written out differ by an ulp.
const BOUNDARY: f64 = 1e-9;

/// The distribution of one input.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::inputs::{Marginal, Parameters, Uniform};
/// let friction = Marginal::Uniform(Uniform::new(0.0, 0.5)?);
/// assert_eq!(friction.physical(0.5), 0.375);
/// assert_eq!(friction.standardized(0.375), 0.5);
/// let stiffness = Marginal::named("normal", &Parameters::of([("mean", 2e6), ("std", 1e5)]))?;
/// assert_eq!(stiffness.physical(2.0), 2.2e6);
/// # Ok::<(), pcc_evaluate::probability::inputs::MarginalError>(())
/// ```
#[derive(Debug, Clone)]
pub enum Marginal {
    /// Uniform on an interval; the standardized variable is ξ = (x − centre)/half width ∈ [−1, 1].
    Uniform(Uniform),
    /// Another law; [`Marginal::named`] makes it.
    Other(Other),
}

/// A law that is not uniform.
#[derive(Debug, Clone)]
pub struct Other(Arc<dyn Law>);

/// Which polynomials an expansion has, where a law leaves the choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Polynomials {
    /// Orthonormal under the law itself: for models that are smooth functions of the input.
    Own,
    /// Of a standard normal variable of which the input is a function: for inputs over orders of magnitude.
    Hermite,
}

impl Polynomials {
    /// All, with their names in study files.
    pub const ALL: [(&'static str, Self); 2] = [("own", Self::Own), ("hermite", Self::Hermite)];

    /// Name in study files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Own => "own",
            Self::Hermite => "hermite",
        }
    }
}

/// The same law gives the same values, whatever polynomials are chosen.
impl PartialEq for Marginal {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name() && self.parameters() == other.parameters()
    }
}

impl Marginal {
    pub(super) fn of(law: impl Law + 'static) -> Self {
        Self::Other(Other(Arc::new(law)))
    }

    fn law(&self) -> &dyn Law {
        match self {
            Self::Uniform(law) => law,
            Self::Other(Other(law)) => &**law,
        }
    }

    /// Name of the law in study files and tables.
    pub fn name(&self) -> &'static str {
        self.law().name()
    }

    /// The parameters that say which one of its laws it is, with their names in study files, in the order of these
    /// files.
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        self.law().parameters()
    }

    /// Whether it takes single values.
    pub fn is_discrete(&self) -> bool {
        self.law().is_discrete()
    }

    /// Where its values were read, if they were measured and it was made from them.
    pub fn source(&self) -> Option<&Source> {
        self.law().source()
    }

    /// The polynomials that were asked for, if there was a choice.
    pub fn chosen_polynomials(&self) -> Option<Polynomials> {
        self.law().chosen()
    }

    /// The map from the standardized variable as files keep it.
    pub(crate) fn transform(&self) -> Transform<'_> {
        self.law().transform()
    }

    /// The law of its standardized variable.
    #[inline]
    pub fn germ(&self) -> &Germ {
        match self {
            Self::Uniform(_) => &Germ::Uniform,
            Self::Other(Other(law)) => law.germ(),
        }
    }

    /// Whether it is a uniform law, or one of which the logarithm is: all of its interval is equally likely to be
    /// sampled, and can be divided.
    pub fn is_divisible(&self) -> bool {
        matches!(self.germ(), Germ::Uniform)
    }

    /// The polynomial family that is orthonormal in the standardized variable.
    pub fn family(&self) -> Family {
        self.germ().family()
    }

    /// The standardized value ξ whose probability to be undercut is `unit` ∈ (0, 1).
    #[inline]
    pub fn standardized_quantile(&self, unit: f64) -> f64 {
        self.germ().at(2.0 * unit - 1.0)
    }

    /// The physical value at the standardized value ξ.
    #[inline]
    pub fn physical(&self, standardized: f64) -> f64 {
        match self {
            Self::Uniform(uniform) => uniform.physical(standardized),
            Self::Other(Other(law)) => law.physical(standardized),
        }
    }

    /// dx/dξ, the derivative of the physical value x by the standardized one: what the chain rule needs.
    #[inline]
    pub fn slope(&self, standardized: f64) -> f64 {
        self.law().slope(standardized)
    }

    /// The standardized value ξ at a physical value.
    #[inline]
    pub fn standardized(&self, physical: f64) -> f64 {
        match self {
            Self::Uniform(uniform) => uniform.standardized(physical),
            Self::Other(Other(law)) => law.standardized(physical),
        }
    }

    /// η = 2F(x) − 1 ∈ [−1, 1] at a physical value, F being its distribution function: random values are uniform in it.
    pub fn centred_probability(&self, physical: f64) -> f64 {
        self.germ().centred_probability(self.standardized(physical))
    }

    /// η at the ends of an interval of values, in which all of its probability lies: of single values too.
    pub fn centred_interval(&self, [lower, upper]: [f64; 2]) -> [f64; 2] {
        match self.transform() {
            Transform::Pieces { origin, scale, quantile } if self.is_discrete() => {
                let ends = [lower, upper].map(|x| (x - origin) / scale);
                quantile.scores_of_levels(ends).map(centred_probability_of_score)
            }
            _ => [lower, upper].map(|x| self.centred_probability(x)),
        }
    }

    /// Whether it can take a value inside its support: a law of single values takes its levels alone.
    pub fn takes(&self, physical: f64) -> bool {
        const ROUNDING: f64 = 1e-9;
        let [lower, upper] = self.support();
        let nearest = || self.at_centred_probability(self.centred_probability(physical));
        !self.is_discrete() || (nearest() - physical).abs() <= ROUNDING * (upper - lower)
    }

    /// The values next to one between them, of a law of single values; `None` if it can take that.
    pub fn levels_around(&self, physical: f64) -> Option<[f64; 2]> {
        let Transform::Pieces { origin, scale, quantile } = self.transform() else { return None };
        let levels = || quantile.levels_around((physical - origin) / scale).map(|level| scale.mul_add(level, origin));
        (!self.takes(physical)).then(levels)
    }

    /// The physical value where 2F(x) − 1 is η ∈ (−1, 1).
    pub fn at_centred_probability(&self, centred: f64) -> f64 {
        self.physical(self.germ().at(centred))
    }

    /// The physical value at a place of the range in which values are looked for ([`Germ::along`]).
    pub fn along(&self, place: f64, of_scores: [f64; 2]) -> f64 {
        let [lower, upper] = self.support();
        match self {
            Self::Uniform(_) => (lower + 0.5 * (1.0 + place) * (upper - lower)).clamp(lower, upper),
            Self::Other(_) => self.physical(self.germ().along(place, of_scores)),
        }
    }

    /// How many orders of magnitude lie between the ends of the range in which values are looked for, where expansions
    /// are polynomials of the logarithm, or of a normal variable: there all of them have to be followed. `None` where
    /// they are polynomials of the value, beside the largest of which small ones are as good as zero.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::inputs::{Marginal, Parameters};
    /// let law = Marginal::named("log-uniform", &Parameters::of([("lower", 1e-2), ("upper", 1e4)]))?;
    /// assert!((law.orders_of_magnitude().unwrap() - 6.0).abs() < 1e-12);
    /// # Ok::<(), pcc_evaluate::probability::inputs::MarginalError>(())
    /// ```
    pub fn orders_of_magnitude(&self) -> Option<f64> {
        let is_of_logarithm = match self.transform() {
            Transform::Affine { .. } => false,
            Transform::Exponential { .. } => true,
            Transform::Pieces { .. } => matches!(self.germ(), Germ::Normal) && self.support()[0] == 0.0,
        };
        let end = |place: f64| self.along(place, [0.0, 1.0]).log10();
        is_of_logarithm.then(|| end(1.0) - end(-1.0))
    }

    /// The interval that has all probability; infinite where it has no bound.
    pub fn support(&self) -> [f64; 2] {
        self.law().support()
    }

    /// Between what values a million random ones lie, about: the support where it is bounded.
    pub fn range(&self) -> [f64; 2] {
        const REACH: f64 = 1.0 - 1e-6;
        let [lower, upper] = self.support();
        let finite = |end: f64, centred: f64| if end.is_finite() { end } else { self.at_centred_probability(centred) };
        [finite(lower, -REACH), finite(upper, REACH)]
    }

    /// Whether `physical` lies in the support.
    pub fn contains(&self, physical: f64) -> bool {
        let [lower, upper] = self.support();
        match self {
            Self::Uniform(uniform) => uniform.standardized(physical).abs() <= 1.0 + 2.0 * BOUNDARY,
            _ => {
                let slack = |end: f64| if end.is_finite() { BOUNDARY * end.abs() } else { 0.0 };
                physical.is_finite() && physical >= lower - slack(lower) && physical <= upper + slack(upper)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::parameters::Parameters;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn standardizing_undoes_the_physical_map(lower in -1e7..1e7f64, width in 1e-3..1e7f64, xi in -1.0..=1.0f64) {
            let marginal = Marginal::Uniform(Uniform::new(lower, lower + width).unwrap());
            let back = marginal.standardized(marginal.physical(xi));
            // One rounding of x, which is large where the interval is far from zero.
            let resolution = 4.0 * f64::EPSILON * (1.0 + (lower.abs() + width) / width);
            prop_assert!((back - xi).abs() <= resolution);
            prop_assert!(marginal.contains(marginal.physical(xi)));
            let chord = marginal.physical(0.5) - marginal.physical(-0.5);
            prop_assert!((marginal.slope(xi) - chord).abs() <= 4.0 * f64::EPSILON * (lower.abs() + 2.0 * width));
        }
    }

    /// One of each, and some that are not easy.
    fn laws() -> Vec<Marginal> {
        type Given = &'static [(&'static str, f64)];
        let given: [(&str, Given); 17] = [
            ("uniform", &[("lower", -1.0), ("upper", 3.0)]),
            ("normal", &[("mean", 2.0), ("std", 0.5)]),
            ("lognormal", &[("mean", 2.0), ("std", 0.5)]),
            ("normal", &[("mean", 2.0), ("std", 0.5), ("lower", 1.5), ("upper", 2.6)]),
            ("normal", &[("mean", 2.0), ("std", 0.5), ("lower", 0.0)]),
            ("normal", &[("mean", 2.0), ("std", 0.5), ("upper", 2.1)]),
            ("normal", &[("mean", 2.0), ("std", 0.5), ("lower", 4.0)]),
            ("log-uniform", &[("lower", 0.1), ("upper", 10.0)]),
            ("exponential", &[("mean", 3.0)]),
            ("weibull", &[("shape", 1.5), ("scale", 2.0)]),
            ("gumbel", &[("mean", 1.0), ("std", 0.2)]),
            ("gamma", &[("mean", 3.0), ("std", 1.0)]),
            ("gamma", &[("shape", 0.5), ("scale", 2.0)]),
            ("beta", &[("alpha", 2.0), ("beta", 3.0), ("lower", -1.0), ("upper", 4.0)]),
            ("beta", &[("alpha", 0.5), ("beta", 0.7)]),
            ("triangular", &[("lower", 1.0), ("mode", 1.5), ("upper", 3.0)]),
            ("triangular", &[("lower", 1.0), ("mode", 3.0), ("upper", 3.0)]),
        ];
        given.map(|(name, given)| Marginal::named(name, &Parameters::of(given.iter().copied())).unwrap()).to_vec()
    }

    #[test]
    fn standardizing_undoes_every_law_and_slopes_are_its_derivatives() {
        for law in laws() {
            let [lower, upper] = law.support();
            for k in -49..50 {
                let centred = f64::from(k) / 50.0;
                let xi = law.germ().at(centred);
                let x = law.physical(xi);
                assert!(lower <= x && x <= upper && law.contains(x), "{law:?}: {x}");
                assert!((law.standardized(x) - xi).abs() < 1e-10, "{law:?} at {xi}: {}", law.standardized(x));
                assert!((law.centred_probability(x) - centred).abs() < 1e-12, "{law:?}");
                let step = 1e-5;
                let chord = (law.physical(xi + step) - law.physical(xi - step)) / (2.0 * step);
                let slope = law.slope(xi);
                assert!(
                    slope > 0.0 && (slope - chord).abs() < 2e-6 * slope.max(1e-3),
                    "{law:?} at {xi}: {slope} {chord}"
                );
            }
        }
    }

    /// Moments by the midpoint rule in probability.
    #[test]
    fn laws_have_the_moments_that_they_are_given_by() {
        let moments = |law: &Marginal| {
            let values: Vec<f64> =
                (0..200_000).map(|k| law.at_centred_probability((f64::from(k) + 0.5) / 100_000.0 - 1.0)).collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            (mean, (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt())
        };
        for name in ["normal", "lognormal", "gumbel", "gamma", "beta"] {
            let mut given = vec![("mean", 2.0), ("std", 0.5)];
            if name == "beta" {
                given.extend([("lower", 1.0), ("upper", 5.0)]);
            }
            let law = Marginal::named(name, &Parameters::of(given)).unwrap();
            let (mean, std) = moments(&law);
            assert!((mean - 2.0).abs() < 1e-4 && (std - 0.5).abs() < 1e-3, "{law:?}: {mean} {std}");
        }
        let (mean, _) = moments(&Marginal::named("exponential", &Parameters::of([("mean", 3.0)])).unwrap());
        assert!((mean - 3.0).abs() < 1e-3, "{mean}");
    }

    /// Between normal scores of ∓3.668: 10^(2 · 3.668 σ/ln 10).
    #[test]
    fn orders_of_magnitude_are_those_between_two_quantiles() {
        let of = |name: &str, given: &[(&'static str, f64)], polynomials| {
            let given = Parameters::of(given.iter().copied()).with_polynomials(polynomials);
            Marginal::named(name, &given).unwrap().orders_of_magnitude()
        };
        let sigma = 2f64.ln().sqrt();
        let found = of("lognormal", &[("mean", 3.0), ("cv", 1.0)], None).unwrap();
        assert!((found - 2.0 * 3.668_329_285 * sigma / 10f64.ln()).abs() < 1e-6, "{found}");
        let weibull = of("weibull", &[("shape", 0.1), ("scale", 2.0)], None).unwrap();
        // ln(−ln(1 − p))/shape at p = 1/8192 and 8191/8192.
        let ends = [1.0f64, 8191.0].map(|k| 10.0 * (-(-k / 8192.0).ln_1p()).log10());
        assert!((weibull - (ends[1] - ends[0])).abs() < 1e-6, "{weibull} {ends:?}");
        assert!(of("gamma", &[("shape", 0.05), ("scale", 1.0)], Some(Polynomials::Hermite)) > Some(16.0));
        assert_eq!(of("gamma", &[("shape", 0.05), ("scale", 1.0)], None), None);
        assert_eq!(of("uniform", &[("lower", 0.0), ("upper", 1e300)], None), None);
    }

    #[test]
    fn values_between_levels_have_neighbours() {
        let law = |values: [f64; 3]| {
            let given = values.into_iter().flat_map(|value| [("value", value), ("weight", 1.0)]);
            Marginal::named("discrete", &Parameters::of(given)).unwrap()
        };
        let levels = law([-1.0, 2.5, 100.0]);
        assert_eq!([-1.0, 2.5, 100.0].map(|value| levels.levels_around(value)), [None; 3]);
        for (value, expected) in [(-0.9, [-1.0, 2.5]), (2.4, [-1.0, 2.5]), (2.6, [2.5, 100.0]), (99.0, [2.5, 100.0])] {
            let found = levels.levels_around(value).unwrap();
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{value}: {found:?}");
        }
        assert_eq!(law([0.1 + 0.2, 1.0, 2.0]).levels_around(0.3), None, "typed otherwise");
        assert_eq!(laws()[0].levels_around(0.3), None);
    }

    #[test]
    fn ends_of_supports_are_finite_standardized_values() {
        for law in laws() {
            for end in law.support().into_iter().filter(|end| end.is_finite()) {
                let xi = law.standardized(end);
                assert!(xi.is_finite(), "{law:?} at {end}: {xi}");
            }
        }
    }

    #[test]
    fn bounds_computed_from_a_spread_contain_the_bounds_written_out() {
        let marginal = Marginal::Uniform(Uniform::new(0.95 * 16e6, 1.05 * 16e6).unwrap());
        assert!(marginal.contains(15.2e6) && marginal.contains(16.8e6));
        assert!(!marginal.contains(15.199e6) && !marginal.contains(f64::NAN));
    }
}
