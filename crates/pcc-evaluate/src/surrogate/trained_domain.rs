//! The box that the model runs of a surrogate spanned.
//!
//! Expansions are polynomials in the standardized variables ξ. Runs of a design fill the interval of a uniform ξ up to
//! half a stratum at either end. Of other variables they leave out the tails: there the surrogate extrapolates. Runs
//! that somebody gave fill nothing but what they span.

use super::Surrogate;
use crate::probability::inputs::{Input, InputSpace};

/// Most of the samples: a larger share of extrapolation is never foreseen.
const MOST: f64 = 0.5;

/// What is foreseen where no run was left out: what hardly moves a share.
const LITTLE: f64 = 0.01;

/// For every input whose standardized variable is not uniform, and for every input of runs that were given, the
/// smallest and the largest value at a model run.
///
/// Intervals are of ξ, in which polynomials are: a sample is compared without rounding.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::inputs::{Input, InputSpace, Marginal, Parameters, Uniform};
/// use pcc_evaluate::surrogate::TrainedDomain;
/// let friction = Input::new("mu", Marginal::Uniform(Uniform::new(0.0, 0.5)?));
/// let normal = Marginal::named("normal", &Parameters::of([("mean", 2e6), ("std", 1e5)]))?;
/// let stiffness = Input::new("k", normal);
/// let inputs = InputSpace::new(vec![friction, stiffness])?;
/// let runs: [&[f64]; 3] = [&[0.9, -1.5], &[-0.9, 2.0], &[0.0, 0.1]];
/// let domain = TrainedDomain::of(&inputs, runs).expect("one input is normal");
/// assert_eq!(domain.sides(), [None, Some([-1.5, 2.0])]);
/// assert!(domain.holds(&[1.0, 2.0]) && !domain.holds(&[0.0, -1.6]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TrainedDomain {
    sides: Vec<Option<[f64; 2]>>,
}

/// Values at the ends of a law may be off by rounding.
const ROUNDED_ONE: f64 = 1.0 + 1e-6;

/// The smallest and the largest value of each coordinate.
fn spanned<'r>(inputs: &InputSpace, runs: impl IntoIterator<Item = &'r [f64]>) -> Vec<[f64; 2]> {
    let mut spanned = vec![[f64::INFINITY, f64::NEG_INFINITY]; inputs.dimension()];
    for point in runs {
        for ([lower, upper], &xi) in spanned.iter_mut().zip(point) {
            (*lower, *upper) = (lower.min(xi), upper.max(xi));
        }
    }
    spanned
}

/// Whether runs of a design leave out the tails of an input.
fn has_tails(input: &Input) -> bool {
    !input.marginal.is_divisible()
}

impl TrainedDomain {
    /// The box of `runs` of a design, standardized points; `None` without runs, and if all standardized variables are
    /// uniform.
    pub fn of<'r>(inputs: &InputSpace, runs: impl IntoIterator<Item = &'r [f64]>) -> Option<Self> {
        let sides = inputs.inputs().iter().zip(spanned(inputs, runs));
        Self::new(inputs, sides.map(|(input, side)| has_tails(input).then_some(side)).collect())
    }

    /// The box of `runs` that were given, standardized points: it has all sides. `None` without runs.
    pub fn of_given<'r>(inputs: &InputSpace, runs: impl IntoIterator<Item = &'r [f64]>) -> Option<Self> {
        Self::new(inputs, spanned(inputs, runs).into_iter().map(Some).collect())
    }

    /// The box with these sides, one per input; `None` unless they are intervals between finite values, inside [−1, 1]
    /// where the variable is uniform, of all inputs with tails, and there is one.
    pub fn new(inputs: &InputSpace, sides: Vec<Option<[f64; 2]>>) -> Option<Self> {
        let fits = |(input, side): (&Input, &Option<[f64; 2]>)| match side {
            Some([lower, upper]) => {
                let ends = [*lower, *upper, input.marginal.physical(*lower), input.marginal.physical(*upper)];
                let is_inside = has_tails(input) || (*lower >= -ROUNDED_ONE && *upper <= ROUNDED_ONE);
                is_inside && lower <= upper && ends.iter().all(|end| end.is_finite())
            }
            None => !has_tails(input),
        };
        let is_box = sides.len() == inputs.dimension() && inputs.inputs().iter().zip(&sides).all(fits);
        (is_box && sides.iter().any(Option::is_some)).then_some(Self { sides })
    }

    /// The interval of each input's ξ; `None` where runs fill it.
    pub fn sides(&self) -> &[Option<[f64; 2]>] {
        &self.sides
    }

    /// Whether a standardized point lies in the box.
    pub fn holds(&self, point: &[f64]) -> bool {
        let is_inside = |(side, &xi): (&Option<[f64; 2]>, &f64)| side.is_none_or(|[a, b]| a <= xi && xi <= b);
        self.sides.iter().zip(point).all(is_inside)
    }
}

impl Surrogate {
    /// Between which physical values of input number `input` the model was run; `None` where runs fill its law, and if
    /// the file does not say.
    pub fn trained_interval(&self, input: usize) -> Option<[f64; 2]> {
        let side = (*self.trained_domain.as_ref()?.sides.get(input)?)?;
        let marginal = &self.inputs.inputs().get(input)?.marginal;
        Some(side.map(|xi| marginal.physical(xi)))
    }

    /// The share of extrapolated samples that errors of runs left out hold already.
    ///
    /// Each input with tails has two outermost runs. A fit without one of these extrapolates to it: of the N errors of
    /// runs left out, up to two per such input are errors of extrapolation. Runs that were given have outermost ones in
    /// every input, and where these lie is a matter of chance, up to three standard deviations of so many gaps.
    /// Quadratures leave none out: there it is one percent.
    pub fn foreseen_extrapolation(&self) -> f64 {
        if self.expansions.iter().all(|expansion| expansion.s2.is_none()) {
            return LITTLE;
        }
        let inputs = self.inputs.inputs();
        let tails = inputs.iter().filter(|input| has_tails(input)).count();
        let sides = self.trained_domain.as_ref().map_or(&[][..], |domain| &domain.sides);
        let sides = sides.iter().flatten().count();
        let outermost = 2.0 * tails.max(sides) as f64;
        let chance = if sides > tails { 3.0 * outermost.sqrt() } else { 0.0 };
        ((outermost + chance) / self.training.counts.final_mesh.max(1) as f64).min(MOST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probability::inputs::{Marginal, Parameters, Polynomials};

    fn inputs() -> InputSpace {
        let law = |name, given: &[(&'static str, f64)], polynomials| {
            let given = Parameters::of(given.iter().copied()).with_polynomials(polynomials);
            Marginal::named(name, &given).unwrap()
        };
        let laws = [
            law("uniform", &[("lower", 0.0), ("upper", 1.0)], None),
            law("log-uniform", &[("lower", 0.1), ("upper", 1.0)], None),
            law("lognormal", &[("mean", 1.0), ("std", 0.5)], Some(Polynomials::Hermite)),
            law("normal", &[("mean", 1.0), ("std", 0.5), ("lower", 0.0), ("upper", 2.0)], None),
        ];
        InputSpace::new((0..).zip(laws).map(|(k, law)| Input::new(format!("x{k}"), law)).collect()).unwrap()
    }

    #[test]
    fn boxes_have_sides_where_variables_are_not_uniform() {
        let inputs = inputs();
        let runs: [&[f64]; 2] = [&[0.1, 0.2, -1.0, 0.4], &[-0.3, 0.1, 0.5, -0.2]];
        let domain = TrainedDomain::of(&inputs, runs).unwrap();
        assert_eq!(domain.sides(), [None, None, Some([-1.0, 0.5]), Some([-0.2, 0.4])]);
        assert!(domain.holds(&[1.0, -1.0, 0.5, -0.2]));
        assert!(!domain.holds(&[0.0, 0.0, 0.6, 0.0]) && !domain.holds(&[0.0, 0.0, 0.0, -0.3]));
        let uniform = InputSpace::new(inputs.inputs()[..2].to_vec()).unwrap();
        let runs: [&[f64]; 1] = [&[0.1, 0.2]];
        assert_eq!(TrainedDomain::of(&uniform, runs), None);
        assert_eq!(TrainedDomain::of(&inputs, []), None);
    }

    #[test]
    fn boxes_of_given_runs_have_all_sides() {
        let inputs = inputs();
        let runs: [&[f64]; 2] = [&[0.1, 0.2, -1.0, 0.4], &[-0.3, 0.1, 0.5, -0.2]];
        let domain = TrainedDomain::of_given(&inputs, runs).unwrap();
        assert_eq!(domain.sides(), [[-0.3, 0.1], [0.1, 0.2], [-1.0, 0.5], [-0.2, 0.4]].map(Some));
        assert!(domain.holds(&[0.0, 0.15, 0.0, 0.0]) && !domain.holds(&[0.2, 0.15, 0.0, 0.0]));
        assert_eq!(TrainedDomain::of_given(&inputs, []), None);
    }

    #[test]
    fn sides_that_do_not_fit_the_inputs_are_none() {
        let inputs = inputs();
        let [free, side] = [None, Some([-1.0, 1.0])];
        assert!(TrainedDomain::new(&inputs, vec![free, free, side, side]).is_some());
        for wrong in [
            vec![free, free, side],
            vec![free, free, side, free],
            vec![Some([-1.1, 1.0]), free, side, side],
            vec![free, free, Some([1.0, -1.0]), side],
            vec![free, free, Some([f64::NEG_INFINITY, 1.0]), side],
            // exp overflows.
            vec![free, free, Some([-1.0, 1e300]), side],
        ] {
            assert_eq!(TrainedDomain::new(&inputs, wrong.clone()), None, "{wrong:?}");
        }
    }
}
