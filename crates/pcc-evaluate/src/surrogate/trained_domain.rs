//! The box that the model runs of a surrogate spanned.
//!
//! Expansions are polynomials in the standardized variables ξ. Runs fill the interval of a uniform ξ up to half a
//! stratum at either end. Of other variables they leave out the tails: there the surrogate extrapolates.

use super::Surrogate;
use crate::probability::inputs::{Input, InputSpace};

/// Most of the samples: a larger share of extrapolation is never foreseen.
const MOST: f64 = 0.5;

/// What is foreseen where no run was left out: what hardly moves a share.
const LITTLE: f64 = 0.01;

/// For every input whose standardized variable is not uniform, the smallest and the largest value at a model run.
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

/// Whether runs leave out the tails of an input.
fn has_tails(input: &Input) -> bool {
    !input.marginal.is_divisible()
}

impl TrainedDomain {
    /// The box of `runs`, standardized points; `None` without runs, and if all standardized variables are uniform.
    pub fn of<'r>(inputs: &InputSpace, runs: impl IntoIterator<Item = &'r [f64]>) -> Option<Self> {
        let mut spanned = vec![[f64::INFINITY, f64::NEG_INFINITY]; inputs.dimension()];
        for point in runs {
            for ([lower, upper], &xi) in spanned.iter_mut().zip(point) {
                (*lower, *upper) = (lower.min(xi), upper.max(xi));
            }
        }
        let sides = inputs.inputs().iter().zip(spanned).map(|(input, side)| has_tails(input).then_some(side));
        Self::new(inputs, sides.collect())
    }

    /// The box with these sides, one per input; `None` unless those of inputs with tails, and no others, are intervals
    /// between finite values, and there is one.
    pub fn new(inputs: &InputSpace, sides: Vec<Option<[f64; 2]>>) -> Option<Self> {
        let fits = |(input, side): (&Input, &Option<[f64; 2]>)| match side {
            Some([lower, upper]) => {
                let ends = [*lower, *upper, input.marginal.physical(*lower), input.marginal.physical(*upper)];
                has_tails(input) && lower <= upper && ends.iter().all(|end| end.is_finite())
            }
            None => !has_tails(input),
        };
        let is_box = sides.len() == inputs.dimension() && inputs.inputs().iter().zip(&sides).all(fits);
        (is_box && sides.iter().any(Option::is_some)).then_some(Self { sides })
    }

    /// The interval of each input's ξ; `None` where ξ is uniform.
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
    /// runs left out, up to two per such input are errors of extrapolation. Quadratures leave none out: there it is
    /// one percent.
    pub fn foreseen_extrapolation(&self) -> f64 {
        if self.expansions.iter().all(|expansion| expansion.s2.is_none()) {
            return LITTLE;
        }
        let tails = self.inputs.inputs().iter().filter(|input| has_tails(input)).count();
        (2.0 * tails as f64 / self.training.counts.final_mesh.max(1) as f64).min(MOST)
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
    fn sides_that_do_not_fit_the_inputs_are_none() {
        let inputs = inputs();
        let [free, side] = [None, Some([-1.0, 1.0])];
        assert!(TrainedDomain::new(&inputs, vec![free, free, side, side]).is_some());
        for wrong in [
            vec![free, free, side],
            vec![free, free, side, free],
            vec![side, free, side, side],
            vec![free, free, Some([1.0, -1.0]), side],
            vec![free, free, Some([f64::NEG_INFINITY, 1.0]), side],
            // exp overflows.
            vec![free, free, Some([-1.0, 1e300]), side],
        ] {
            assert_eq!(TrainedDomain::new(&inputs, wrong.clone()), None, "{wrong:?}");
        }
    }
}
