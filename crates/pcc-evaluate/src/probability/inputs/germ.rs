//! Standardized variables: what the polynomials of an expansion are functions of.

use super::normal_quantile::{at_centred, distribution, normal_at, normal_at_lanes};
use super::normal_tail::tails;
use super::own_variable::OwnVariable;
use super::pieces;
use crate::polynomials::Family;
use std::sync::Arc;

/// The law of a standardized variable ξ. Inputs are functions of it, affine ones where their law is of the same kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Germ {
    /// Uniform on [−1, 1].
    Uniform,
    /// Standard normal.
    Normal,
    /// Of a law of its own.
    Own(Arc<OwnVariable>),
}

/// The largest |2F − 1| at which a search along an unbounded input looks: a normal score of 3.7.
const REACH: f64 = 1.0 - 1.0 / 4096.0;

/// The largest |2F − 1| of random values.
pub(crate) const OUTERMOST: f64 = 1.0 - f64::EPSILON / 2.0;

impl Germ {
    /// The polynomials that are orthonormal in it.
    pub fn family(&self) -> Family {
        match self {
            Self::Uniform => Family::Legendre,
            Self::Normal => Family::Hermite,
            Self::Own(own) => Family::Own(own.polynomials.clone()),
        }
    }

    /// ξ at the centred probability η = 2F(ξ) − 1 ∈ (−1, 1), F being its distribution function.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::inputs::Germ;
    /// assert_eq!(Germ::Uniform.at(0.5), 0.5);
    /// assert!((Germ::Normal.at(0.5) - 0.6744897501960817).abs() < 1e-15);
    /// ```
    #[inline(always)]
    pub fn at(&self, centred: f64) -> f64 {
        match self {
            Self::Uniform => centred,
            Self::Normal => normal_at(centred),
            Self::Own(own) => own.at_score(normal_at(centred)),
        }
    }

    /// [`Self::at`] in all lanes.
    #[inline(always)]
    pub(crate) fn at_lanes<const LANES: usize>(&self, numbers: &mut [f64; LANES]) {
        if !matches!(self, Self::Uniform) {
            normal_at_lanes(numbers);
            // The pieces of laws of their own are looked up one by one.
            self.at_scores(numbers);
        }
    }

    /// ξ at a normal score z: with the same probability to be undercut as a standard normal variable has at z. A
    /// monotone function, the same bits on every machine.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::inputs::Germ;
    /// assert_eq!(Germ::Normal.at_score(1.5), 1.5);
    /// assert!((Germ::Uniform.at_score(1.0) - 0.6826894921370859).abs() < 1e-15);
    /// assert!((Germ::Uniform.score(0.6826894921370859) - 1.0).abs() < 1e-14);
    /// ```
    #[inline(always)]
    pub fn at_score(&self, score: f64) -> f64 {
        let mut lane = [score];
        self.at_scores(&mut lane);
        lane[0]
    }

    /// [`Self::at_score`] in all lanes.
    #[inline(always)]
    pub(crate) fn at_scores<const LANES: usize>(&self, scores: &mut [f64; LANES]) {
        match self {
            Self::Uniform => {
                for score in scores {
                    let [below, above] = tails(*score);
                    *score = below - above;
                }
            }
            Self::Normal => {}
            Self::Own(own) => {
                for score in scores {
                    *score = own.at_score(*score);
                }
            }
        }
    }

    /// The normal score of ξ, no farther out than random values come.
    pub fn score(&self, xi: f64) -> f64 {
        let [below, above] = match self {
            Self::Normal => return xi,
            Self::Uniform => [0.5 * (1.0 + xi), 0.5 * (1.0 - xi)],
            Self::Own(own) => return own.score(xi),
        };
        let centred = if below <= above { 2.0f64.mul_add(below, -1.0) } else { (-2.0f64).mul_add(above, 1.0) };
        at_centred(centred.clamp(-OUTERMOST, OUTERMOST), below.min(above).max(0.5 * (1.0 - OUTERMOST)))
    }

    /// η = 2F(ξ) − 1.
    pub fn centred_probability(&self, xi: f64) -> f64 {
        match self {
            Self::Uniform => xi.clamp(-1.0, 1.0),
            Self::Normal => centred_probability_of_score(xi),
            Self::Own(own) => centred_probability_of_score(own.score(xi)),
        }
    }

    /// The largest |η| at which values of an input are looked for.
    pub fn reach(&self) -> f64 {
        match self {
            Self::Uniform => 1.0,
            Self::Own(own) if own.is_bounded == [true; 2] => 1.0,
            Self::Normal | Self::Own(_) => REACH,
        }
    }

    /// ξ at a place of the range in which values of an input are looked for, from −1 to 1. Equal steps are steps of ξ
    /// where it is uniform, else of the normal score, so that tails have places, too. What has no bounds is looked for
    /// where a normal score of this mean and standard deviation is: 0 and 1, unless other inputs are fixed.
    #[inline(always)]
    pub fn along(&self, place: f64, [mean, deviation]: [f64; 2]) -> f64 {
        match self {
            Self::Uniform => place,
            Self::Normal | Self::Own(_) if self.reach() < 1.0 => {
                self.at_score(deviation.mul_add(normal_at(REACH) * place, mean))
            }
            Self::Normal | Self::Own(_) => self.at_score(pieces::REACH * place),
        }
    }
}

/// 2Φ(z) − 1. The smaller tail keeps its digits.
pub(super) fn centred_probability_of_score(z: f64) -> f64 {
    if z > 0.0 { 1.0 - 2.0 * distribution(-z) } else { 2.0 * distribution(z) - 1.0 }
}

#[cfg(test)]
mod tests {
    use super::super::marginal::Marginal;
    use super::super::parameters::Parameters;
    use super::*;

    #[test]
    fn centred_probabilities_are_undone() {
        for germ in [Germ::Uniform, Germ::Normal] {
            for k in -99..100 {
                let centred = f64::from(k) / 100.0;
                assert!((germ.centred_probability(germ.at(centred)) - centred).abs() < 1e-14, "{germ:?} {centred}");
            }
        }
    }

    /// From mpmath: z, Φ⁻¹(Φ(a) + (Φ(b) − Φ(a)) Φ(z)) between a = −1 and b = 2.
    const TRUNCATED: [(f64, f64); 6] = [
        (-5.0, -0.9999990302491363),
        (-2.0, -0.925786818351658),
        (-0.5, -0.224401578203223),
        (0.0, 0.17116391801782477),
        (0.7, 0.7694258479399603),
        (3.0, 1.9799397210132639),
    ];

    #[test]
    fn scores_have_the_probabilities_of_a_normal_variable() {
        let cut = |bounds: &[(&'static str, f64)]| {
            let given = [("mean", 0.0), ("std", 1.0)].into_iter().chain(bounds.iter().copied());
            Marginal::named("normal", &Parameters::of(given)).unwrap()
        };
        let law = cut(&[("lower", -1.0), ("upper", 2.0)]);
        let truncated = law.germ().clone();
        for (score, expected) in TRUNCATED {
            let found = law.physical(truncated.at_score(score));
            assert!((found - expected).abs() < 1e-13, "{score}: {found}");
        }
        let one_sided = [cut(&[("lower", -1.7)]), cut(&[("upper", 0.3)])].map(|law| law.germ().clone());
        let germs = [Germ::Uniform, Germ::Normal, truncated.clone()].into_iter().chain(one_sided);
        for germ in germs {
            for k in -60..=60 {
                let score = f64::from(k) / 10.0;
                let xi = germ.at_score(score);
                let back = germ.score(xi);
                // Near a bound ξ has only digits of the bound.
                let resolution = 1e-13 + 1e-15 * (0.5 * score * score).exp();
                assert!((back - score).abs() < resolution, "{germ:?} {score}: {back}");
                if score.abs() <= 2.0 {
                    let by_probability = germ.at(2.0f64.mul_add(distribution(score), -1.0));
                    assert!((xi - by_probability).abs() < 1e-13, "{germ:?} {score}");
                }
            }
            assert!(germ.at_score(-50.0).is_finite() || germ == Germ::Normal);
            assert!(germ.score(germ.at(-1.0 + f64::EPSILON)).is_finite());
        }
        let end = 8.3;
        assert!(Germ::Uniform.score(1.0) < end && Germ::Uniform.score(-1.0) > -end);
        assert!(truncated.score(law.standardized(2.0)) <= 8.5 && truncated.score(law.standardized(-1.0)) >= -8.5);
    }
}
