//! Correlated inputs from independent numbers, on conditions.
//!
//! Numbers u, uniform on (0, 1), give independent normal numbers w = Φ⁻¹(u), the Cholesky factor L of the correlations
//! gives normal scores z = L w, and each input lies at its score. On conditions, the order of the inputs of a block is
//! another: those that are fixed come first, so that their w are known; then at most one that is confined to an
//! interval, whose w lies in an interval, too; then all others. So every point has exactly the conditional law.

use super::germ::{Germ, OUTERMOST};
use super::normal_quantile::{at_centred, normal_at, normal_at_lanes};
use super::normal_tail::tails;
use super::space::Input;
use crate::probability::dependence::GaussianCopula;

/// An interval of a conditional law that is less probable than this is as good as impossible.
const LEAST_PROBABILITY: f64 = 1e-250;

/// Numbers of many points at once: a lane each.
pub(crate) trait Column<const LANES: usize> {
    /// To read.
    fn lanes(&self) -> &[f64; LANES];
    /// To replace.
    fn lanes_mut(&mut self) -> &mut [f64; LANES];
}

impl<const LANES: usize> Column<LANES> for [f64; LANES] {
    #[inline(always)]
    fn lanes(&self) -> &[f64; LANES] {
        self
    }

    #[inline(always)]
    fn lanes_mut(&mut self) -> &mut [f64; LANES] {
        self
    }
}

/// What an input is confined to: an interval of its centred probability η = 2F − 1 from `lower` on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Confinement {
    pub lower: f64,
    pub width: f64,
}

impl Confinement {
    /// All of the law.
    pub const NONE: Self = Self { lower: -1.0, width: 2.0 };

    pub fn is_none(self) -> bool {
        self == Self::NONE
    }

    /// Whether it is one value.
    pub fn is_fixed(self) -> bool {
        self.width == 0.0
    }

    /// The normal scores at its ends, infinite where it has none.
    fn scores(self) -> [f64; 2] {
        let score = |end: f64| match end {
            end if end <= -1.0 => f64::NEG_INFINITY,
            end if end >= 1.0 => f64::INFINITY,
            end => normal_at(end),
        };
        [score(self.lower), score(self.lower + self.width)]
    }
}

/// Why correlated inputs cannot be confined so. Inputs by their positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Conflict {
    /// Two intervals along inputs that depend on each other.
    Intervals(usize, usize),
    /// An interval where the fixed inputs leave no probability.
    Improbable(usize),
}

/// How the inputs of a copula that are not fixed follow from uniform numbers.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Correlated {
    /// In an order in which each depends on those before it.
    steps: Vec<Step>,
    /// Which inputs the steps are of.
    is_placed: Vec<bool>,
    /// The normal scores of fixed inputs that others depend on.
    fixed: Vec<(usize, f64)>,
}

#[derive(Debug, Clone, PartialEq)]
struct Step {
    input: usize,
    germ: Germ,
    /// What fixed inputs add to its score.
    mean: f64,
    /// What the independent numbers of inputs add, its own last.
    weights: Vec<(usize, f64)>,
    interval: Option<Between>,
}

impl Correlated {
    /// For a copula of `inputs` that are confined so.
    ///
    /// # Errors
    ///
    /// [`Conflict`].
    pub fn new(copula: &GaussianCopula, inputs: &[Input], confined: &[Confinement]) -> Result<Self, Conflict> {
        let mut correlated = Self { is_placed: vec![false; inputs.len()], ..Self::default() };
        for block in copula.blocks() {
            correlated.add(copula, block, inputs, confined)?;
        }
        Ok(correlated)
    }

    fn add(
        &mut self,
        copula: &GaussianCopula,
        block: &[usize],
        inputs: &[Input],
        confined: &[Confinement],
    ) -> Result<(), Conflict> {
        let is_fixed = |input: &usize| confined[*input].is_fixed();
        let is_free = |input: &usize| confined[*input].is_none();
        let intervals: Vec<usize> = block.iter().copied().filter(|input| !is_fixed(input) && !is_free(input)).collect();
        if let [one, other, ..] = intervals[..] {
            return Err(Conflict::Intervals(one, other));
        }
        let fixed: Vec<usize> = block.iter().copied().filter(is_fixed).collect();
        let free = block.iter().copied().filter(is_free);
        let order: Vec<usize> = fixed.iter().copied().chain(intervals).chain(free).collect();
        let factor = copula.factor(&order);
        let mut known: Vec<f64> = Vec::with_capacity(fixed.len());
        for (k, &input) in order.iter().enumerate() {
            let row = factor.row(k);
            let mean: f64 = row.iter().zip(&known).map(|(entry, w)| entry * w).sum();
            if k < fixed.len() {
                let score = normal_at(confined[input].lower.clamp(-OUTERMOST, OUTERMOST));
                known.push((score - mean) / row[k]);
                self.fixed.push((input, score));
                continue;
            }
            let between = |[lower, upper]: [f64; 2]| {
                Between::new((lower - mean) / row[k], (upper - mean) / row[k]).ok_or(Conflict::Improbable(input))
            };
            self.is_placed[input] = true;
            let is_interval = !confined[input].is_none();
            self.steps.push(Step {
                input,
                germ: inputs[input].marginal.germ().clone(),
                mean,
                weights: order[fixed.len()..=k].iter().copied().zip(row[fixed.len()..].iter().copied()).collect(),
                interval: is_interval.then(|| between(confined[input].scores())).transpose()?,
            });
        }
        Ok(())
    }

    /// Whether an input is not fixed and depends on others.
    pub fn places(&self, input: usize) -> bool {
        self.is_placed.get(input).is_some_and(|&is_placed| is_placed)
    }

    /// The first input that is confined to an interval, if one is.
    pub fn interval(&self) -> Option<usize> {
        self.steps.iter().find(|step| step.interval.is_some()).map(|step| step.input)
    }

    /// Mean and standard deviation of the normal score of an input that is not fixed, where fixed inputs leave it
    /// independent of all others.
    pub fn alone(&self, input: usize) -> Option<[f64; 2]> {
        /// Covariances of independent scores, relative to their standard deviations.
        const ROUNDING: f64 = 1e-12;
        let step = self.steps.iter().find(|step| step.input == input)?;
        let deviation = |of: &Step| of.weights.iter().map(|(_, weight)| weight * weight).sum::<f64>().sqrt();
        let covariance = |other: &Step| -> f64 {
            let same =
                |number: usize| other.weights.iter().find(|(input, _)| *input == number).map_or(0.0, |(_, w)| *w);
            step.weights.iter().map(|(number, weight)| weight * same(*number)).sum()
        };
        let own = deviation(step);
        let is_independent =
            |other: &Step| other.input == input || covariance(other).abs() <= ROUNDING * own * deviation(other);
        self.steps.iter().all(is_independent).then_some([step.mean, own])
    }

    /// The normal scores of fixed inputs that others depend on.
    pub fn fixed(&self) -> &[(usize, f64)] {
        &self.fixed
    }

    /// Replaces uniform numbers, a column per input, by standardized coordinates where inputs are not fixed and depend
    /// on others.
    #[inline(always)]
    pub fn place<const LANES: usize, C: Column<LANES>>(&self, columns: &mut [C]) {
        for step in &self.steps {
            let numbers = columns[step.input].lanes_mut();
            match &step.interval {
                None => {
                    for number in numbers.iter_mut() {
                        *number = 2.0f64.mul_add(*number, -1.0);
                    }
                    normal_at_lanes(numbers);
                }
                Some(between) => {
                    for number in numbers {
                        *number = between.at(*number);
                    }
                }
            }
        }
        // From the last to the first, so that the numbers of those before are still there.
        for step in self.steps.iter().rev() {
            let mut scores = [step.mean; LANES];
            for (input, weight) in &step.weights {
                let numbers = columns[*input].lanes();
                for lane in 0..LANES {
                    scores[lane] = weight.mul_add(numbers[lane], scores[lane]);
                }
            }
            step.germ.at_scores(&mut scores);
            *columns[step.input].lanes_mut() = scores;
        }
    }
}

/// A standard normal variable on condition that it lies between bounds, which may both be far out on one side.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Between {
    /// Whether bounds and values are those of −w, of which the lower bound is the farther one.
    is_mirrored: bool,
    lower: f64,
    upper: f64,
    /// Probability below the lower bound, and between both.
    below: f64,
    share: f64,
}

impl Between {
    /// `None` where there is no probability to speak of.
    fn new(lower: f64, upper: f64) -> Option<Self> {
        let is_mirrored = lower + upper > 0.0;
        let (lower, upper) = if is_mirrored { (-upper, -lower) } else { (lower, upper) };
        let below = tails(lower)[0];
        let share = tails(upper)[0] - below;
        (share >= LEAST_PROBABILITY).then_some(Self { is_mirrored, lower, upper, below, share })
    }

    /// The value with this share of the probability below it.
    #[inline(always)]
    fn at(&self, unit: f64) -> f64 {
        let share = if self.is_mirrored { 1.0 - unit } else { unit };
        let below = share.mul_add(self.share, self.below);
        let tail = below.min(1.0 - below).max(f64::MIN_POSITIVE);
        let value = at_centred(2.0f64.mul_add(below, -1.0), tail).max(self.lower).min(self.upper);
        if self.is_mirrored { -value } else { value }
    }
}

#[cfg(test)]
mod tests {
    use super::super::marginal::Marginal;
    use super::super::parameters::Parameters;
    use super::super::uniform::Uniform;
    use super::*;

    fn inputs() -> Vec<Input> {
        let normal = || Marginal::named("normal", &Parameters::of([("mean", 0.0), ("std", 1.0)])).unwrap();
        let uniform = Marginal::Uniform(Uniform::new(-1.0, 1.0).unwrap());
        [normal(), uniform, normal(), normal()].map(|law| Input::new("x", law)).to_vec()
    }

    fn copula() -> GaussianCopula {
        GaussianCopula::new(4, [(0, 1, 0.6), (1, 3, -0.5), (0, 3, 0.2)]).unwrap()
    }

    fn fixed_at(score: f64) -> Confinement {
        Confinement { lower: Germ::Uniform.at_score(score), width: 0.0 }
    }

    /// Uniform numbers along each side of the grid.
    const EACH: u32 = 60;

    fn unit(k: u32) -> f64 {
        (f64::from(k) + 0.5) / f64::from(EACH)
    }

    /// The variance of normal numbers on the grid.
    fn of_grid() -> f64 {
        (0..EACH).map(|k| normal_at(2.0 * unit(k) - 1.0).powi(2)).sum::<f64>() / f64::from(EACH)
    }

    /// Means and covariances of the scores of inputs 0, 1 and 3 over a grid of uniform numbers.
    fn moments(correlated: &Correlated) -> ([f64; 3], [[f64; 3]; 3]) {
        let (mut sums, mut products, mut count) = ([0.0; 3], [[0.0; 3]; 3], 0.0);
        for number in 0..EACH.pow(3) {
            let mut point = [[unit(number % EACH)], [unit(number / EACH % EACH)], [0.5], [unit(number / EACH / EACH)]];
            correlated.place(&mut point);
            let scores = [point[0][0], Germ::Uniform.score(point[1][0]), point[3][0]];
            count += 1.0;
            for i in 0..3 {
                sums[i] += scores[i];
                (0..3).for_each(|k| products[i][k] += scores[i] * scores[k]);
            }
        }
        let mean = sums.map(|sum| sum / count);
        let covariance = |i: usize, k: usize| products[i][k] / count - mean[i] * mean[k];
        (mean, [0, 1, 2].map(|i| [0, 1, 2].map(|k| covariance(i, k))))
    }

    #[test]
    fn scores_have_the_correlations_of_the_copula() {
        let correlated = Correlated::new(&copula(), &inputs(), &[Confinement::NONE; 4]).unwrap();
        let (mean, covariance) = moments(&correlated);
        let expected = [[1.0, 0.6, 0.2], [0.6, 1.0, -0.5], [0.2, -0.5, 1.0]];
        for i in 0..3 {
            assert!(mean[i].abs() < 1e-12, "{mean:?}");
            for k in 0..3 {
                assert!((covariance[i][k] - of_grid() * expected[i][k]).abs() < 1e-10, "{covariance:?}");
            }
        }
        assert!([0, 1, 3].into_iter().all(|input| correlated.places(input)) && !correlated.places(2));
    }

    /// Given z1 = 1.2: means ρ 1.2, covariances of the rest by Schur's complement.
    #[test]
    fn fixed_inputs_leave_the_others_their_conditional_law() {
        let mut confined = [Confinement::NONE; 4];
        confined[1] = fixed_at(1.2);
        let correlated = Correlated::new(&copula(), &inputs(), &confined).unwrap();
        assert!(!correlated.places(1) && correlated.fixed().len() == 1);
        assert!((correlated.fixed()[0].1 - 1.2).abs() < 1e-14);
        let (mean, covariance) = moments(&correlated);
        assert!((mean[0] - 0.72).abs() < 1e-12 && (mean[2] + 0.6).abs() < 1e-12, "{mean:?}");
        for (i, k, expected) in [(0, 0, 1.0 - 0.36), (2, 2, 1.0 - 0.25), (0, 2, 0.2 + 0.3)] {
            assert!((covariance[i][k] - of_grid() * expected).abs() < 1e-10, "{i} {k}: {covariance:?}");
        }
    }

    /// Mean and variance of 0.72 + 0.8 w between 0 and 1, by SciPy.
    const INTERVAL: (f64, f64) = (0.5271339174415395, 0.07865428530634007);

    /// Given z1 = 1.2 and z0 between 0 and 1, the law of z3 follows by regression.
    #[test]
    fn intervals_leave_the_others_their_conditional_law() {
        let mut confined = [Confinement::NONE; 4];
        confined[1] = fixed_at(1.2);
        confined[0] = Confinement { lower: 0.0, width: Germ::Uniform.at_score(1.0) };
        let correlated = Correlated::new(&copula(), &inputs(), &confined).unwrap();
        assert!(correlated.interval() == Some(0));
        let (mean, covariance) = moments(&correlated);
        let (mean_0, variance_0) = INTERVAL;
        assert!((mean[0] - mean_0).abs() < 1e-4, "{mean:?}");
        assert!((covariance[0][0] - variance_0).abs() < 1e-4, "{covariance:?}");
        // z3 given z1 and z0: -0.6 + 0.5/0.64 (z0 − 0.72), with the variance 0.75 − 0.25/0.64 left.
        let slope = 0.5 / 0.64;
        assert!((mean[2] - (-0.6 + slope * (mean_0 - 0.72))).abs() < 1e-3, "{mean:?}");
        assert!((covariance[0][2] - slope * variance_0).abs() < 1e-3, "{covariance:?}");
        let left = 0.75 - 0.25 / 0.64;
        assert!((covariance[2][2] - (slope * slope * variance_0 + of_grid() * left)).abs() < 1e-4, "{covariance:?}");
    }

    /// Of a chain a value in the middle leaves nothing between its ends; two causes depend where their effect is known.
    #[test]
    fn inputs_are_alone_where_what_is_fixed_leaves_them_so() {
        let alone = |pairs: &[(usize, usize, f64)], fixed: &[usize], input: usize| {
            let mut confined = [Confinement::NONE; 3];
            fixed.iter().for_each(|&at| confined[at] = fixed_at(1.2));
            let copula = GaussianCopula::new(3, pairs.iter().copied()).unwrap();
            Correlated::new(&copula, &inputs()[..3], &confined).unwrap().alone(input)
        };
        let (chain, effect) = ([(0, 1, 0.5), (1, 2, 0.5), (0, 2, 0.25)], [(0, 1, 0.5), (1, 2, 0.5)]);
        let close = |found: Option<[f64; 2]>, expected: [f64; 2]| {
            found.is_some_and(|found| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14))
        };
        assert!(close(alone(&chain, &[1], 0), [0.6, 0.75f64.sqrt()]));
        assert_eq!((alone(&chain, &[], 0), alone(&chain, &[2], 0)), (None, None));
        assert_eq!((alone(&effect, &[], 0), alone(&effect, &[1], 0), alone(&effect, &[1], 1)), (None, None, None));
        // By the inverse of the correlations of the fixed ones: 0.5/(1 − 0.25) (1.2 − 0.5 · 0), and so on.
        let both = 0.5 * 1.2 / 0.75 - 0.5 * 0.5 * 1.2 / 0.75;
        assert!(close(alone(&effect, &[1, 2], 0), [both, (1.0f64 - 0.25 / 0.75).sqrt()]));
    }

    #[test]
    fn what_cannot_be_conditioned_exactly_is_a_conflict() {
        let half = Confinement { lower: 0.0, width: 1.0 };
        let conflict = |confined: &[Confinement]| Correlated::new(&copula(), &inputs(), confined).unwrap_err();
        let none = Confinement::NONE;
        assert_eq!(conflict(&[half, half, none, none]), Conflict::Intervals(0, 1));
        assert!(Correlated::new(&copula(), &inputs(), &[half, none, half, none]).is_ok());
        let strong = GaussianCopula::new(2, [(0, 1, 0.9999)]).unwrap();
        let apart = [fixed_at(-3.0), Confinement { lower: 0.9, width: 0.1 }];
        assert_eq!(Correlated::new(&strong, &inputs()[..2], &apart), Err(Conflict::Improbable(1)));
    }

    #[test]
    fn values_between_bounds_have_their_shares_also_far_out() {
        for (lower, upper) in [(-1.0, 2.0), (3.0, 4.0), (-21.0, -20.0), (20.0, 21.0), (f64::NEG_INFINITY, -30.0)] {
            let between = Between::new(lower, upper).unwrap();
            let mass = |a: f64, b: f64| match a + b > 0.0 {
                true => tails(a)[1] - tails(b)[1],
                false => tails(b)[0] - tails(a)[0],
            };
            for k in 1..100 {
                let unit = f64::from(k) / 100.0;
                let value = between.at(unit);
                assert!(lower <= value && value <= upper, "{lower} {upper} {unit}: {value}");
                assert!((mass(lower, value) / mass(lower, upper) - unit).abs() < 1e-11, "{lower} {upper} {unit}");
            }
        }
        assert_eq!(Between::new(40.0, 41.0), None);
        assert_eq!(Between::new(1.0, 1.0), None);
    }
}
