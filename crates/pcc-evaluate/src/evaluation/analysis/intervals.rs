//! Intervals of the eigenvalues at a point, from what components miss at runs left out.
//!
//! Eigenvalues that come close react to small errors of their components, so errors are taken through the
//! recombination: the components at the point plus and minus the residuals of run i form eigenvalues, and with those
//! without any residual each quantity has a smallest and a largest value of these three, a_i and b_i. At level 1 − α,
//! with N runs, the interval is
//!
//! [ the ⌊α (N + 1)⌋-th smallest a_i, the ⌈(1 − α)(N + 1)⌉-th smallest b_i ].
//!
//! It is the jackknife+ of Barber, Candès, Ramdas and Tibshirani (2021, <https://doi.org/10.1214/20-AOS1965>) with the
//! predictions of the whole surrogate in the place of those without run i, which would take the surrogate N times the
//! space. Ranks are whole numbers: at 90 % nine runs suffice, and with fewer the interval has no ends.

use crate::components::{Block, spectral_abscissa};
use crate::foundation::{Interrupted, Observer, try_map};
use crate::surrogate::{LeftOut, Surrogate};
use num_complex::Complex;
use std::fmt;
use std::str::FromStr;

/// Levels are whole numbers of these parts.
const MILLION: u32 = 1_000_000;

/// A level of intervals, such as 0.9: above 0, below 1, with six decimals at most.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::evaluation::IntervalLevel;
/// let level: IntervalLevel = "0.9".parse()?;
/// assert_eq!((level.value(), level.least_runs()), (0.9, 9));
/// assert!("1".parse::<IntervalLevel>().is_err() && "0.9999999".parse::<IntervalLevel>().is_err());
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IntervalLevel {
    /// α in millionths.
    beyond: u32,
}

impl IntervalLevel {
    /// 1 − α.
    pub fn value(self) -> f64 {
        f64::from(MILLION - self.beyond) / f64::from(MILLION)
    }

    /// Runs from which on intervals have ends: the least N with ⌊α (N + 1)⌋ = 1.
    pub fn least_runs(self) -> usize {
        (MILLION.div_ceil(self.beyond) - 1) as usize
    }

    /// ⌊α (N + 1)⌋: the rank of the lower end among N from below, and of the upper end from above; 0 is beyond all.
    fn rank(self, runs: usize) -> usize {
        (runs + 1) * self.beyond as usize / MILLION as usize
    }
}

impl FromStr for IntervalLevel {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let millionths = text.parse::<f64>().ok().map(|level| level * f64::from(MILLION));
        let whole = millionths.map(f64::round).filter(|whole| *whole > 0.0 && *whole < f64::from(MILLION));
        // 0.9 is no binary fraction.
        match whole.zip(millionths).filter(|(whole, given)| (whole - given).abs() < 1e-6) {
            Some((whole, _)) => Ok(Self { beyond: MILLION - whole as u32 }),
            None => Err("use a level above 0 and below 1, like 0.9, with six decimals at most".to_owned()),
        }
    }
}

impl fmt::Display for IntervalLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} %", f64::from(MILLION - self.beyond) / 1e4)
    }
}

/// Lower and upper end of each quantity at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct PointIntervals {
    /// Of Re λ, in 1/s, and Im λ, in rad/s, of each eigenvalue, in the order of
    /// [`Surrogate::labels`](crate::surrogate::Surrogate::labels).
    pub eigenvalues: Vec<[[f64; 2]; 2]>,
    /// Of max Re λ, in 1/s.
    pub max_re: [f64; 2],
}

/// The intervals at the points of `block`, which `surrogate` has been evaluated at. Below
/// [`IntervalLevel::least_runs`] runs they are (−∞, ∞).
///
/// # Errors
///
/// [`Interrupted`] soon after the observer asks to stop.
pub fn point_intervals(
    surrogate: &Surrogate,
    left_out: &LeftOut,
    block: &Block,
    level: IntervalLevel,
    observer: &dyn Observer,
) -> Result<Vec<PointIntervals>, Interrupted> {
    try_map(block.max_re.len(), |i| {
        observer.check()?;
        let center: Vec<f64> = block.components.iter().map(|values| values[i]).collect();
        let rank = level.rank(left_out.runs().len());
        let mut ends = quantities(surrogate, left_out, &center).into_iter().map(|values| interval(values, rank));
        let max_re = ends.next().unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        let parts: Vec<[f64; 2]> = ends.collect();
        Ok(PointIntervals { eigenvalues: parts.chunks_exact(2).map(|part| [part[0], part[1]]).collect(), max_re })
    })
}

/// max Re λ, and Re and Im of each eigenvalue: for each run the smallest and the largest value.
fn quantities(surrogate: &Surrogate, left_out: &LeftOut, center: &[f64]) -> Vec<Vec<[f64; 2]>> {
    let at = |sign: f64, run: &[f64]| {
        let shifted: Vec<f64> = center.iter().zip(run).map(|(value, rest)| value + sign * rest).collect();
        parts(&surrogate.eigenvalues(&shifted))
    };
    let unchanged = parts(&surrogate.eigenvalues(center));
    let mut found = vec![Vec::with_capacity(left_out.runs().len()); unchanged.len()];
    for run in left_out.runs() {
        let [plus, minus] = [1.0, -1.0].map(|sign| at(sign, run));
        for (k, list) in found.iter_mut().enumerate() {
            list.push(extremes([unchanged[k], plus[k], minus[k]]));
        }
    }
    found
}

fn parts(eigenvalues: &[Complex<f64>]) -> Vec<f64> {
    let of_each = eigenvalues.iter().flat_map(|lambda| [lambda.re, lambda.im]);
    std::iter::once(spectral_abscissa(eigenvalues)).chain(of_each).collect()
}

/// What is no number may be anything.
fn extremes(values: [f64; 3]) -> [f64; 2] {
    match values.iter().any(|value| value.is_nan()) {
        true => [f64::NEG_INFINITY, f64::INFINITY],
        false => {
            [values.into_iter().fold(f64::INFINITY, f64::min), values.into_iter().fold(f64::NEG_INFINITY, f64::max)]
        }
    }
}

/// The lower end has this rank among the smallest values from below, the upper one among the largest from above.
fn interval(extremes: Vec<[f64; 2]>, rank: usize) -> [f64; 2] {
    let Some(position) = rank.checked_sub(1) else { return [f64::NEG_INFINITY, f64::INFINITY] };
    let sorted = |side: usize| {
        let mut values: Vec<f64> = extremes.iter().map(|pair| pair[side]).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let (lower, upper) = (sorted(0), sorted(1));
    [lower[position], upper[upper.len() - 1 - position]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::test_surrogates::{XI, polynomial};
    use crate::evaluation::{Plan, evaluate_points};
    use crate::foundation::Silent;

    fn level(text: &str) -> IntervalLevel {
        text.parse().unwrap()
    }

    #[test]
    fn ranks_are_exact() {
        let least = ["0.9", "0.95", "0.99", "0.5", "0.999999"].map(|text| level(text).least_runs());
        assert_eq!(least, [9, 19, 99, 1, 999_999]);
        let ranks = [8, 9, 18, 19, 28, 29, 199].map(|runs| level("0.9").rank(runs));
        assert_eq!(ranks, [0, 1, 1, 2, 2, 3, 20], "1 − 0.9 is below a tenth in double precision");
        assert_eq!(["0.9", "0.90005"].map(|text| level(text).to_string()), ["90 %", "90.005 %"]);
    }

    #[test]
    fn levels_that_are_none_are_refused() {
        for wrong in ["0", "1", "1.5", "-0.9", "nan", "inf", "", "90%", "0.12345678", "0.9999999"] {
            assert!(wrong.parse::<IntervalLevel>().is_err(), "{wrong}");
        }
        assert_eq!(
            [level("0.9"), level("0.955"), level("0.5")].map(|level| level.to_string()),
            ["90 %", "95.5 %", "50 %"]
        );
    }

    #[test]
    fn ends_are_order_statistics_and_missing_ones_infinite() {
        let extremes: Vec<[f64; 2]> = (1..=9).map(|i| [-f64::from(i), 10.0 * f64::from(i)]).collect();
        assert_eq!(interval(extremes.clone(), 1), [-9.0, 90.0]);
        assert_eq!(interval(extremes.clone(), 3), [-7.0, 70.0]);
        assert_eq!(interval(extremes, 0), [f64::NEG_INFINITY, f64::INFINITY]);
        assert_eq!(super::extremes([1.0, f64::NAN, 2.0]), [f64::NEG_INFINITY, f64::INFINITY]);
    }

    /// Re λ = ξ: the residuals themselves come back.
    #[test]
    fn intervals_of_one_mode_are_its_residuals() {
        let surrogate = polynomial(1, &[(&[1], XI)]);
        let left_out = LeftOut::new((1..=19).map(|i| vec![0.01 * f64::from(i), 0.0]).collect()).unwrap();
        let block = evaluate_points(&surrogate, &Plan::new(&surrogate), &[&[0.25]]);
        let found = point_intervals(&surrogate, &left_out, &block, level("0.9"), &Silent).unwrap();
        let center = block.max_re[0];
        let [lower, upper] = found[0].max_re;
        assert!((lower - (center - 0.18)).abs() < 1e-12 && (upper - (center + 0.18)).abs() < 1e-12, "{found:?}");
        assert_eq!(found[0].eigenvalues[0][0], found[0].max_re);
        let im = block.eigenvalues[0][0].im;
        assert_eq!(found[0].eigenvalues[0][1], [im, im]);
    }
}
