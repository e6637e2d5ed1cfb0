//! The value of one input at which a system loses stability.
//!
//! For every random sample of the other inputs, the critical value of input j is the smallest value of its domain at
//! which max Re λ ≥ 0. Its distribution says where a limit for this input has to lie so that, say, 99 % of all systems
//! stay stable below it.
//!
//! 1. max Re λ at the 65 ends of 64 equal cells of the input's domain, from below, until one is unstable. If it is the
//!    first, the critical value is the lower bound; if there is none, there is no critical value.
//! 2. The crossing between the last stable and the first unstable end, by interpolation with the safety of
//!    bisection, until a stable and an unstable value are less than 10⁻⁹ of the domain's width apart: the critical
//!    value is the unstable one.
//!
//! Instability that begins and ends inside one cell is missed, and among several crossings inside a cell any one can be
//! found. Polynomials of degree up to some tens do not oscillate within such a cell, but max Re λ can rise above zero
//! within one and fall again where it barely does so.
//!
//! Many samples are searched side by side, one per lane of the evaluator. Critical values are kept as counts in 10 000
//! equal bins, so memory does not depend on the number of samples.

use super::bracket::{Bracket, End};
use super::chunks::{CHUNK, in_chunks};
use super::monte_carlo::EvalError;
use super::plan::Plan;
use super::points::Evaluator;
use super::region::Region;
use crate::input::{Marginal, Uniform};
use crate::progress::Observer;
use crate::random::{Purpose, Stream};
use crate::statistics::Moments;
use crate::surrogate::Surrogate;
use std::ops::Range;

/// Cells of the grid on which instability is looked for; a power of two, so that its points are exact.
const GRID: u32 = 64;

/// Bins of the counts: the resolution of quantiles is 10⁻⁴ of the domain's width.
const BINS: usize = 10_000;

/// Levels of the quantiles that reports show.
pub const CRITICAL_LEVELS: [f64; 7] = [0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99];

/// The distribution of the critical value of one input.
#[derive(Debug, Clone, PartialEq)]
pub struct CriticalValues {
    /// Number of samples of the other inputs.
    pub samples: u64,
    /// Samples that are stable at every point of the grid: they have no critical value.
    pub never: u64,
    /// Samples that are unstable at the lower bound already: it is their critical value.
    pub unstable_from_start: u64,
    domain: Uniform,
    /// Critical values above the lower bound, per bin.
    counts: Vec<u64>,
    /// All critical values, as shares of the domain's width above the lower bound.
    shares: Moments,
}

impl CriticalValues {
    fn new(samples: u64, domain: Uniform) -> Self {
        let counts = vec![0; BINS];
        Self { samples, never: 0, unstable_from_start: 0, domain, counts, shares: Moments::default() }
    }

    /// The critical value that a share `level` ∈ \[0, 1\] of all samples does not exceed, in the input's own unit, to
    /// 10⁻⁴ of the domain's width: interpolated linearly inside its bin. Samples that never lose stability count as
    /// above the upper bound; `None` if the quantile lies among them.
    pub fn quantile(&self, level: f64) -> Option<f64> {
        let rank = level * self.samples as f64;
        let mut below = self.unstable_from_start as f64;
        if self.unstable_from_start > 0 && rank <= below {
            return Some(self.physical(0.0));
        }
        for (bin, &count) in self.counts.iter().enumerate().filter(|&(_, &count)| count > 0) {
            let count = count as f64;
            if rank <= below + count {
                let share = (bin as f64 + (rank - below) / count) / BINS as f64;
                return Some(self.physical(share.max(self.shares.minimum()).min(self.shares.maximum())));
            }
            below += count;
        }
        None
    }

    /// Mean critical value of the samples that lose stability, in the input's own unit; `None` if there are none.
    pub fn mean(&self) -> Option<f64> {
        self.of_lost(Moments::mean)
    }

    /// Smallest critical value, in the input's own unit; `None` if no sample loses stability.
    pub fn minimum(&self) -> Option<f64> {
        self.of_lost(Moments::minimum)
    }

    /// Largest critical value, in the input's own unit; `None` if no sample loses stability.
    pub fn maximum(&self) -> Option<f64> {
        self.of_lost(Moments::maximum)
    }

    fn of_lost(&self, part: fn(&Moments) -> f64) -> Option<f64> {
        (self.shares.count() > 0).then(|| self.physical(part(&self.shares)))
    }

    fn physical(&self, share: f64) -> f64 {
        let (lower, upper) = (self.domain.lower(), self.domain.upper());
        (lower + share * (upper - lower)).clamp(lower, upper)
    }

    fn add(&mut self, part: &Part) {
        self.never += part.never;
        self.unstable_from_start += part.unstable_from_start;
        for &share in &part.crossings {
            self.counts[((share * BINS as f64) as usize).min(BINS - 1)] += 1;
        }
        self.shares.merge(&Moments::of(&vec![0.0; part.unstable_from_start as usize]));
        self.shares.merge(&Moments::of(&part.crossings));
    }
}

/// The critical value of input number `input`, from 0, over samples 0 … `samples` − 1 of the others under `seed`, on
/// the current rayon thread pool.
///
/// Sample i has the coordinates that [`monte_carlo`](fn@super::monte_carlo) evaluates as sample i under this seed,
/// except that of `input`. The result is the same bits for any number of threads.
///
/// # Errors
///
/// [`EvalError`]; [`EvalError::NoSuchInput`] if there are not that many inputs.
///
/// # Examples
///
/// ```
/// use pcc::{artifact, eval::critical_values, progress::Silent};
/// let surrogate = artifact::decode(include_bytes!("../../surrogates/clutch-r2-eigenvalues.pcc"))?.surrogate;
/// assert_eq!(surrogate.inputs.names().next(), Some("mu"));
/// let friction = critical_values(&surrogate, 0, 1000, 1, &Silent)?;
/// let safe = friction.quantile(0.01).expect("more than 1 % lose stability");
/// assert!(friction.minimum() <= Some(safe) && Some(safe) <= friction.mean());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn critical_values(
    surrogate: &Surrogate,
    input: usize,
    samples: u64,
    seed: u64,
    observer: &dyn Observer,
) -> Result<CriticalValues, EvalError> {
    critical_values_in(surrogate, &Region::whole(surrogate.inputs.dimension()), input, samples, seed, observer)
}

/// The same with the other inputs confined to `region`; `input` itself is looked for in all of its domain.
///
/// # Errors
///
/// As [`critical_values`].
pub fn critical_values_in(
    surrogate: &Surrogate,
    region: &Region,
    input: usize,
    samples: u64,
    seed: u64,
    observer: &dyn Observer,
) -> Result<CriticalValues, EvalError> {
    let inputs = surrogate.inputs.inputs();
    let chosen = inputs.get(input).ok_or(EvalError::NoSuchInput { input, inputs: inputs.len() })?;
    let Marginal::Uniform(domain) = chosen.marginal;
    let plan = Plan::new(surrogate);
    let mut values = CriticalValues::new(samples, domain);
    in_chunks(
        samples,
        CHUNK,
        observer,
        || Search { surrogate, region, evaluator: Evaluator::new(surrogate, &plan), input, seed, points: Vec::new() },
        |search, range| search.run(range, observer),
        |part| values.add(&part),
    )?;
    Ok(values)
}

/// What was found in one chunk of samples.
struct Part {
    never: u64,
    unstable_from_start: u64,
    /// Critical values above the lower bound, as shares of the domain's width.
    crossings: Vec<f64>,
}

/// A sample of the chunk with the last point known to be stable.
struct Stable {
    sample: usize,
    end: End,
}

/// A sample of the chunk with the interval in which it loses stability.
struct Losing {
    sample: usize,
    bracket: Bracket,
}

/// Searches chunks of samples, with memory of its own.
struct Search<'a> {
    surrogate: &'a Surrogate,
    region: &'a Region,
    evaluator: Evaluator<'a>,
    input: usize,
    seed: u64,
    /// Standardized coordinates of every sample of the chunk.
    points: Vec<f64>,
}

impl Search<'_> {
    fn run(&mut self, range: Range<u64>, observer: &dyn Observer) -> Result<Part, EvalError> {
        let dimension = self.surrogate.inputs.dimension();
        let samples = (range.end - range.start) as usize;
        self.points.resize(samples * dimension, 0.0);
        for (index, point) in range.zip(self.points.chunks_exact_mut(dimension)) {
            let mut stream = Stream::new(self.seed, Purpose::Evaluation, index);
            for (j, coordinate) in point.iter_mut().enumerate() {
                *coordinate = self.region.place(j, stream.next_unit());
            }
        }
        let start: Vec<_> = (0..samples).map(|sample| (sample, grid_point(0))).collect();
        let ends = self.evaluate(&start)?;
        let stable: Vec<Stable> = ends
            .into_iter()
            .enumerate()
            .filter(|(_, end)| end.max_re < 0.0)
            .map(|(sample, end)| Stable { sample, end })
            .collect();
        let unstable_from_start = (samples - stable.len()) as u64;
        let (never, mut losing) = self.march(stable, observer)?;
        self.refine(&mut losing, observer)?;
        let crossings = losing.iter().map(|losing| 0.5 * (1.0 + losing.bracket.unstable.xi)).collect();
        Ok(Part { never, unstable_from_start, crossings })
    }

    /// Step 1: how many samples stay stable up to the upper bound, and the cells in which the others do not.
    fn march(&mut self, mut stable: Vec<Stable>, observer: &dyn Observer) -> Result<(u64, Vec<Losing>), EvalError> {
        let mut losing = Vec::with_capacity(stable.len());
        for k in 1..=GRID {
            observer.check()?;
            let trials: Vec<_> = stable.iter().map(|stable| (stable.sample, grid_point(k))).collect();
            let ends = self.evaluate(&trials)?;
            let mut still = Vec::with_capacity(stable.len());
            for (Stable { sample, end: before }, end) in stable.into_iter().zip(ends) {
                if end.max_re < 0.0 {
                    still.push(Stable { sample, end });
                } else {
                    losing.push(Losing { sample, bracket: Bracket::new(before, end) });
                }
            }
            stable = still;
        }
        Ok((stable.len() as u64, losing))
    }

    /// Step 2: narrows all brackets; each takes a bounded number of trials.
    fn refine(&mut self, losing: &mut [Losing], observer: &dyn Observer) -> Result<(), EvalError> {
        let mut open: Vec<&mut Losing> = losing.iter_mut().collect();
        while !open.is_empty() {
            observer.check()?;
            let trials: Vec<_> = open.iter().map(|losing| (losing.sample, losing.bracket.trial())).collect();
            for (losing, end) in open.iter_mut().zip(self.evaluate(&trials)?) {
                losing.bracket.narrow(end);
            }
            open.retain(|losing| !losing.bracket.is_narrow());
        }
        Ok(())
    }

    /// max Re λ of samples of the chunk with the input's standardized value set to that of the trial.
    fn evaluate(&mut self, trials: &[(usize, f64)]) -> Result<Vec<End>, EvalError> {
        let (points, input) = (&self.points, self.input);
        let set_point = |(sample, xi): (usize, f64), point: &mut [f64]| {
            point.copy_from_slice(&points[sample * point.len()..(sample + 1) * point.len()]);
            point[input] = xi;
        };
        let mut found = Vec::with_capacity(trials.len());
        self.evaluator.max_re(trials.len(), |number, point| set_point(trials[number], point), &mut found);
        if let Some(at) = found.iter().position(|max_re| !max_re.is_finite()) {
            let inputs = &self.surrogate.inputs;
            let mut point = vec![0.0; inputs.dimension()];
            set_point(trials[at], &mut point);
            return Err(EvalError::NotFinite { point: inputs.describe(&inputs.physical(&point)) });
        }
        Ok(trials.iter().zip(found).map(|(&(_, xi), max_re)| End { xi, max_re }).collect())
    }
}

/// Grid point number k of the standardized domain \[−1, 1\], exact.
fn grid_point(k: u32) -> f64 {
    2.0 * f64::from(k) / f64::from(GRID) - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eval::handmade::{XI, expansion, inputs, on_threads, polynomial, surrogate};
    use crate::eval::monte_carlo;
    use crate::input::random_point;
    use crate::progress::Silent;

    /// φ_2 = √5 (3ξ² − 1)/2, so ξ² = 1/3 + 2 φ_2/(3√5).
    const SQUARE: [f64; 2] = [1.0 / 3.0, 0.298_142_396_999_972];

    /// max Re λ = ξ1 + slope ξ2 with x1 on \[10, 30\].
    fn linear(slope: f64) -> Surrogate {
        let terms: [(&[u16], f64); 2] = [(&[1, 0], XI), (&[0, 1], slope * XI)];
        surrogate(inputs(&[(10.0, 30.0), (-3.0, 5.0)]), vec![expansion(&terms)])
    }

    /// The critical values of `linear` at the samples themselves, ascending; infinite where there is none.
    fn sorted_crossings(slope: f64, samples: u64, seed: u64) -> Vec<f64> {
        let surrogate = linear(slope);
        let mut point = [0.0; 2];
        let mut crossings: Vec<f64> = (0..samples)
            .map(|index| {
                random_point(&surrogate.inputs, seed, Purpose::Evaluation, index, &mut point);
                let xi = (-slope * point[1]).max(-1.0);
                if xi <= 1.0 { 20.0 + 10.0 * xi } else { f64::INFINITY }
            })
            .collect();
        crossings.sort_by(f64::total_cmp);
        crossings
    }

    #[test]
    fn values_of_a_linear_boundary_are_those_of_the_samples() {
        const SAMPLES: u64 = 5000;
        for (slope, seed) in [(0.5, 1), (2.0, 2)] {
            let found = critical_values(&linear(slope), 0, SAMPLES, seed, &Silent).unwrap();
            let exact = sorted_crossings(slope, SAMPLES, seed);
            let lost: Vec<f64> = exact.iter().copied().filter(|value| value.is_finite()).collect();
            assert_eq!(found.never, SAMPLES - lost.len() as u64);
            assert_eq!(found.unstable_from_start, exact.iter().filter(|&&value| value == 10.0).count() as u64);
            let mean = lost.iter().sum::<f64>() / lost.len() as f64;
            // 10⁻⁹ of the width.
            assert!((found.mean().unwrap() - mean).abs() < 20e-9);
            assert!((found.minimum().unwrap() - lost[0]).abs() < 20e-9);
            assert!((found.maximum().unwrap() - lost[lost.len() - 1]).abs() < 20e-9);
            for level in CRITICAL_LEVELS {
                let at = (level * SAMPLES as f64).ceil() as usize - 1;
                match found.quantile(level) {
                    Some(value) => {
                        assert!((value - exact[at]).abs() <= 20e-4 + 1e-9, "{level}: {value}, {}", exact[at])
                    }
                    None => assert_eq!(exact[at], f64::INFINITY, "{level}"),
                }
            }
        }
    }

    /// ξ1 = −ξ2/2 is uniform on \[−½, ½\]: x1 on \[15, 25\].
    #[test]
    fn quantiles_converge_to_those_of_the_known_distribution() {
        let found = critical_values(&linear(0.5), 0, 100_000, 3, &Silent).unwrap();
        assert_eq!((found.never, found.unstable_from_start), (0, 0));
        for level in CRITICAL_LEVELS {
            let standard_error = 10.0 * (level * (1.0 - level) / 100_000f64).sqrt();
            let value = found.quantile(level).unwrap();
            assert!((value - (15.0 + 10.0 * level)).abs() < 4.0 * standard_error + 20e-4, "{level}: {value}");
        }
    }

    /// With slope 2 a quarter each is unstable from the start and never.
    #[test]
    fn quantiles_count_samples_that_are_never_or_always_unstable() {
        let found = critical_values(&linear(2.0), 0, 20_000, 4, &Silent).unwrap();
        let expected = |count: u64| (count as f64 - 5000.0).abs() < 4.0 * (20_000.0f64 * 0.25 * 0.75).sqrt();
        assert!(expected(found.never) && expected(found.unstable_from_start), "{found:?}");
        assert_eq!([0.0, 0.01, 0.05].map(|level| found.quantile(level)), [Some(10.0); 3]);
        assert_eq!([0.95, 0.99, 1.0].map(|level| found.quantile(level)), [None; 3]);
        assert!((found.quantile(0.5).unwrap() - 20.0).abs() < 0.5);
    }

    #[test]
    fn systems_that_are_never_unstable_have_no_critical_value() {
        let found = critical_values(&polynomial(2, &[(&[0, 0], -3.0), (&[1, 0], XI)]), 0, 3000, 1, &Silent).unwrap();
        assert_eq!((found.samples, found.never, found.unstable_from_start), (3000, 3000, 0));
        assert_eq!((found.mean(), found.minimum(), found.maximum()), (None, None, None));
        assert_eq!(CRITICAL_LEVELS.map(|level| found.quantile(level)), [None; 7]);
    }

    #[test]
    fn systems_that_are_always_unstable_have_the_lower_bound() {
        // max Re λ = 0 is not stable.
        for growth_rate in [0.0, 3.0] {
            let always = surrogate(inputs(&[(0.1, 0.7), (0.0, 1.0)]), vec![expansion(&[(&[0, 0], growth_rate)])]);
            let found = critical_values(&always, 0, 3000, 1, &Silent).unwrap();
            assert_eq!((found.never, found.unstable_from_start), (0, 3000));
            assert_eq!((found.mean(), found.minimum(), found.maximum()), (Some(0.1), Some(0.1), Some(0.1)));
            assert_eq!(CRITICAL_LEVELS.map(|level| found.quantile(level)), [Some(0.1); 7]);
        }
    }

    #[test]
    fn the_first_of_several_crossings_counts() {
        // ¼ − ξ²: unstable between −½ and ½.
        let inside = polynomial(1, &[(&[0], 0.25 - SQUARE[0]), (&[2], -SQUARE[1])]);
        let found = critical_values(&inside, 0, 10, 1, &Silent).unwrap();
        assert!((found.minimum().unwrap() + 0.5).abs() < 2e-9 && found.minimum() == found.maximum());
        // ξ² − ¼: unstable at both ends of the domain.
        let outside = polynomial(1, &[(&[0], SQUARE[0] - 0.25), (&[2], SQUARE[1])]);
        let found = critical_values(&outside, 0, 10, 1, &Silent).unwrap();
        assert_eq!((found.unstable_from_start, found.maximum()), (10, Some(-1.0)));
    }

    #[test]
    fn the_first_mode_to_become_unstable_counts() {
        let mode = |center, slope| expansion(&[(&[0], center), (&[1], slope * XI)]);
        let both = surrogate(inputs(&[(-1.0, 1.0)]), vec![mode(-0.4, 1.0), mode(-0.3, 10.0)]);
        let found = critical_values(&both, 0, 1, 1, &Silent).unwrap();
        assert!((found.minimum().unwrap() - 0.03).abs() < 2e-9, "{found:?}");
    }

    /// What the module's documentation says is missed, and what is not.
    #[test]
    fn instability_wider_than_a_cell_is_found() {
        // w² − (ξ − 0.01)², unstable on an interval of width 2w; cells are 1/32 wide and 0 is a grid point.
        let bump = |w: f64| {
            let center = w * w - 1e-4 - SQUARE[0];
            critical_values(&polynomial(1, &[(&[0], center), (&[1], 0.02 * XI), (&[2], -SQUARE[1])]), 0, 1, 1, &Silent)
        };
        assert_eq!(bump(0.005).unwrap().never, 1);
        for w in [0.0157, 0.05] {
            assert!((bump(w).unwrap().minimum().unwrap() - (0.01 - w)).abs() < 2e-9);
        }
    }

    #[test]
    fn every_input_can_be_chosen() {
        let found = critical_values(&linear(2.0), 1, 20_000, 4, &Silent).unwrap();
        // ξ2 = −ξ1/2: x2 = 1 + 4ξ2 on [−1, 3].
        assert_eq!((found.never, found.unstable_from_start), (0, 0));
        assert!((found.minimum().unwrap() + 1.0).abs() < 1e-2 && (found.maximum().unwrap() - 3.0).abs() < 1e-2);
        let error = critical_values(&linear(2.0), 2, 10, 1, &Silent).unwrap_err();
        assert_eq!(error, EvalError::NoSuchInput { input: 2, inputs: 2 });
        assert_eq!(critical_values(&linear(2.0), 0, 0, 1, &Silent), Err(EvalError::NoSamples));
    }

    #[test]
    fn results_are_the_same_bits_on_1_and_3_threads() {
        let found = |threads| on_threads(threads, || critical_values(&linear(2.0), 0, 10_007, 5, &Silent).unwrap());
        assert_eq!(found(1), found(3));
    }

    #[test]
    fn overflow_is_refused_with_its_point() {
        let overflowing = polynomial(1, &[(&[0], -1e308), (&[30], 1e308), (&[31], 1e308)]);
        assert!(monte_carlo(&overflowing, 1000, 1, &Silent).is_err());
        let error = critical_values(&overflowing, 0, 10, 1, &Silent).unwrap_err();
        assert!(matches!(&error, EvalError::NotFinite { point } if point.starts_with("x1 = ")), "{error}");
    }

    proptest::proptest! {
        #[test]
        fn quantiles_are_ascending(levels in proptest::collection::vec(0.0..=1.0f64, 2..20), seed in 0..50u64) {
            let found = critical_values(&linear(1.5), 0, 40, seed, &Silent).unwrap();
            let mut levels = levels;
            levels.sort_by(f64::total_cmp);
            let quantiles: Vec<f64> =
                levels.iter().map(|&level| found.quantile(level).unwrap_or(f64::INFINITY)).collect();
            proptest::prop_assert!(quantiles.is_sorted(), "{:?}", quantiles);
        }
    }
}
