//! Laws of measured values: smoothed, or as they are.
//!
//! Smoothed, every value stands for a normal law around it (a kernel density; Silverman 1986, *Density Estimation*,
//! section 3.4.2) of standard deviation h = 0.9 min(s, q/1.34) n^(−1/5), where s is the standard deviation of all and q
//! the width of their middle half. Values are drawn together by √(1 + h²/s²), so that mean and standard deviation stay
//! those that were measured.

use super::density::{Density, Place};
use super::law::Source;
use super::levels::{MOST_LEVELS, gathered, of_levels};
use super::marginal::{Marginal, Polynomials};
use super::marginal_error::MarginalError;
use super::shaped::Draft;

/// Fewer measured values say next to nothing of their law.
pub const LEAST_VALUES: usize = 10;

/// Values closer than this share of h become one in the sums, with its weight.
const CLOSE: f64 = 0.1;

/// A kernel of which the square of the distance is so many squared standard deviations above that of the nearest adds
/// nothing: e^−45 of what that does.
const FAR: f64 = 9.5;

/// Whether and how measured values are smoothed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Smoothing {
    /// By normal kernels.
    Kernel,
    /// Not at all: nothing but these values is drawn, equally likely.
    None,
}

impl Smoothing {
    /// All, with their names in study files.
    pub const ALL: [(&'static str, Self); 2] = [("kernel", Self::Kernel), ("none", Self::None)];
}

/// A sum of normal densities between bounds, if there are any.
#[derive(Debug)]
struct Kernels {
    /// In ascending order, with weights that sum to one.
    centers: Vec<f64>,
    weights: Vec<f64>,
    /// Standard deviation of each.
    width: f64,
    typical: [f64; 2],
    support: [f64; 2],
}

impl Marginal {
    /// The law of measured values, in the input's own unit. Bounds cut a smoothed law off.
    ///
    /// # Errors
    ///
    /// At least ten finite values are needed, not all equal, and bounds that hold them.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::probability::inputs::{Marginal, Smoothing};
    /// let values: Vec<f64> = (0..20).map(|k| 100.0 + f64::from(k * k % 7)).collect();
    /// let law = Marginal::measured(&values, [None, None], Smoothing::Kernel, None)?;
    /// assert!((law.at_centred_probability(0.0) - 102.0).abs() < 1.0);
    /// assert!(Marginal::measured(&values[..5], [None, None], Smoothing::Kernel, None).is_err());
    /// # Ok::<(), pcc_evaluate::probability::inputs::MarginalError>(())
    /// ```
    pub fn measured(
        values: &[f64],
        [lower, upper]: [Option<f64>; 2],
        smoothing: Smoothing,
        source: Option<Source>,
    ) -> Result<Self, MarginalError> {
        if values.len() < LEAST_VALUES {
            return Err(MarginalError::FewValues { found: values.len(), least: LEAST_VALUES });
        }
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        if let Some(&value) = sorted.iter().find(|value| !value.is_finite()) {
            return Err(MarginalError::parameter("a value", value, "a finite number"));
        }
        let [least, largest] = [sorted[0], sorted[sorted.len() - 1]];
        if least == largest {
            return Err(MarginalError::OneLevel);
        }
        let support = [lower.unwrap_or(f64::NEG_INFINITY), upper.unwrap_or(f64::INFINITY)];
        if let Some(&value) = [least, largest].iter().find(|value| !(support[0]..=support[1]).contains(*value)) {
            return Err(MarginalError::BeyondBounds { value });
        }
        let [mean, std] = moments(&sorted);
        let width = if smoothing == Smoothing::Kernel { bandwidth(&sorted, std) } else { 0.0 };
        let mut parameters = vec![
            ("count", values.len() as f64),
            ("mean", mean),
            ("std", std),
            ("least", least),
            ("largest", largest),
            ("bandwidth", width),
        ];
        if smoothing == Smoothing::None {
            let (levels, shares) = gathered(&sorted, &vec![1.0; sorted.len()]).ok_or(MarginalError::OneLevel)?;
            if levels.len() > MOST_LEVELS {
                return Err(MarginalError::Levels { found: levels.len(), most: MOST_LEVELS });
            }
            return Ok(Self::of(of_levels("data", parameters, &levels, &shares)?.measured_in(source)));
        }
        parameters.extend(lower.map(|lower| ("lower", lower)));
        parameters.extend(upper.map(|upper| ("upper", upper)));
        let density = Box::new(Kernels::new(&sorted, [mean, std], width, support));
        let draft = Draft { name: "data", parameters, density, family: "own", default: Polynomials::Own };
        draft.measured(None, source)
    }
}

fn moments(values: &[f64]) -> [f64; 2] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    [mean, (square / count).sqrt()]
}

/// Silverman's rule.
fn bandwidth(sorted: &[f64], std: f64) -> f64 {
    const OF_A_NORMAL_LAW: f64 = 1.34;
    let quarter = |k: usize| sorted[(k * (sorted.len() - 1)) / 4];
    let robust = (quarter(3) - quarter(1)) / OF_A_NORMAL_LAW;
    let spread = if robust > 0.0 { robust.min(std) } else { std };
    0.9 * spread * (sorted.len() as f64).powf(-0.2)
}

impl Kernels {
    fn new(sorted: &[f64], [mean, std]: [f64; 2], bandwidth: f64, support: [f64; 2]) -> Self {
        let shrink = 1.0 / (bandwidth / std).hypot(1.0);
        let width = bandwidth * shrink;
        let (mut centers, mut weights): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        let (mut first, each) = (f64::NEG_INFINITY, 1.0 / sorted.len() as f64);
        for value in sorted {
            let center = (value - mean).mul_add(shrink, mean);
            match (centers.last_mut(), weights.last_mut()) {
                (Some(last), Some(weight)) if center - first <= CLOSE * width => {
                    *weight += each;
                    *last += (center - *last) * each / *weight;
                }
                _ => {
                    first = center;
                    centers.push(center);
                    weights.push(each);
                }
            }
        }
        Self { centers, weights, width, typical: [mean, std], support }
    }
}

impl Density for Kernels {
    fn support(&self) -> [f64; 2] {
        self.support
    }

    fn log_density(&self, place: Place) -> f64 {
        let exponent = |center: f64| -0.5 * ((place.x - center) / self.width).powi(2);
        let above = self.centers.partition_point(|center| *center < place.x);
        let neighbours = &self.centers[above.saturating_sub(1)..(above + 1).min(self.centers.len())];
        let distance = neighbours.iter().map(|center| (center - place.x).abs()).fold(f64::INFINITY, f64::min);
        let reach = distance.hypot(FAR * self.width);
        let from = self.centers.partition_point(|center| *center < place.x - reach);
        let to = self.centers.partition_point(|center| *center <= place.x + reach);
        let nearest = -0.5 * (distance / self.width).powi(2);
        let terms = self.centers[from..to].iter().zip(&self.weights[from..to]);
        let sum: f64 = terms.map(|(center, weight)| weight * (exponent(*center) - nearest).exp()).sum();
        nearest + sum.ln()
    }

    fn typical(&self) -> [f64; 2] {
        self.typical
    }

    fn finest(&self) -> f64 {
        self.width
    }

    fn reach(&self) -> [f64; 2] {
        [self.centers[0], self.centers[self.centers.len() - 1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(count: u32) -> Vec<f64> {
        (0..count).map(|k| 3.0 + ((f64::from(k) * 0.754_877_666).fract() - 0.3).powi(3)).collect()
    }

    /// By the midpoint rule in probability.
    fn moments_of(law: &Marginal) -> [f64; 2] {
        let at = |k: i32| law.at_centred_probability((f64::from(k) + 0.5) / 20_000.0 - 1.0);
        moments(&(0..40_000).map(at).collect::<Vec<f64>>())
    }

    #[test]
    fn smoothed_values_keep_mean_and_standard_deviation() {
        for count in [10, 57, 3000] {
            let values = sample(count);
            let law = Marginal::measured(&values, [None, None], Smoothing::Kernel, None).unwrap();
            let (found, expected) = (moments_of(&law), moments(&values));
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 2e-3 * expected, "{count}: {found} {expected}");
            }
        }
    }

    /// F of a sum of normal laws in closed form, also where heaps of values lie far apart.
    #[test]
    fn the_distribution_is_the_mean_of_those_of_the_kernels() {
        use super::super::normal_quantile::distribution;
        let near = |center: f64, count: u32| -> Vec<f64> {
            (0..count).map(|k| center + 0.02 * ((f64::from(k) * 0.754_877_666).fract() - 0.5)).collect()
        };
        for values in [
            sample(12),
            [near(1.0, 50), vec![11.0]].concat(),
            [near(1.0, 50), near(2.0, 50)].concat(),
            [near(1.0, 2000), vec![-40.0, 60.0]].concat(),
            (1..100).map(|k| -(1.0 - f64::from(k) / 100.0).ln()).collect(),
        ] {
            let law = Marginal::measured(&values, [None, None], Smoothing::Kernel, None).unwrap();
            let [mean, std] = moments(&values);
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            let bandwidth = bandwidth(&sorted, std);
            let shrink = 1.0 / (bandwidth / std).hypot(1.0);
            for k in 1..60 {
                let centred = f64::from(k) / 30.0 - 1.0;
                let x = law.at_centred_probability(centred);
                let below = |value: &f64| distribution((x - mean - (value - mean) * shrink) / (bandwidth * shrink));
                let expected = values.iter().map(below).sum::<f64>() / values.len() as f64;
                // Values closer than a tenth of a kernel are taken together.
                assert!((0.5 * (1.0 + centred) - expected).abs() < 2e-3, "{} values at {x}: {expected}", values.len());
            }
        }
    }

    #[test]
    fn bounds_cut_off_and_hold_all_values() {
        let values = sample(40);
        let law = Marginal::measured(&values, [Some(2.97), None], Smoothing::Kernel, None).unwrap();
        assert_eq!(law.support(), [2.97, f64::INFINITY]);
        assert!(law.at_centred_probability(-0.999_999) >= 2.97);
        let cut = Marginal::measured(&values, [Some(3.0), None], Smoothing::Kernel, None);
        assert!(matches!(cut, Err(MarginalError::BeyondBounds { .. })));
    }

    #[test]
    fn without_smoothing_the_values_alone_are_drawn() {
        let values: Vec<f64> = [1.0, 2.0, 2.0, 5.0].repeat(3);
        let law = Marginal::measured(&values, [None, None], Smoothing::None, None).unwrap();
        let at = |share: f64| law.at_centred_probability(2.0 * share - 1.0);
        assert_eq!([0.01, 0.2, 0.3, 0.7, 0.8, 0.99].map(at), [1.0, 1.0, 2.0, 2.0, 5.0, 5.0]);
        assert!(Marginal::measured(&[1.0; 20], [None, None], Smoothing::None, None).is_err());
    }
}
