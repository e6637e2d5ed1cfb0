//! Runs of which the surrogate without them does not know whether they are stable.
//!
//! Residuals of max Re alone are blind to an eigenvalue that is on top at no run: it may be predicted badly, and come
//! out on top elsewhere. So every eigenvalue counts. A run is *undecided* if one of its eigenvalues is predicted, by
//! the fit without the run, with an error of Re λ that is larger than |Re λ|, and so large that it might be the one
//! with the largest Re λ. Some runs lie that near to the boundary by chance; more of them are a doubt.
//!
//! A run is *misjudged* if the fit without it calls it stable where it is not, or the other way round; or if the model
//! calls it marginal and the fit does not, as where a stiffness is zero in a part of the cases.

use super::trials::is_not_unstable;
use crate::campaign::Run;
use crate::mechanics::spectrum::nearest;
use nalgebra::Complex;
use pcc_evaluate::components::Output;
use pcc_evaluate::surrogate::{Surrogate, VerdictBasis};

/// What happens less often is no chance.
const RARE: f64 = 1e-3;

/// Number of undecided runs, of which the components have these `values`, and `residuals` where each run is left out:
/// one list per run.
pub(super) fn undecided(surrogate: &Surrogate, values: &[Vec<f64>], residuals: &[Vec<f64>], runs: &[Run]) -> usize {
    let is_undecided = |(i, run): &(usize, &Run)| {
        let exact: Vec<f64> = values.iter().map(|value| value[*i]).collect();
        let predicted: Vec<f64> = exact.iter().zip(&residuals[*i]).map(|(value, rest)| value - rest).collect();
        surrogate
            .outputs
            .iter()
            .any(|output| is_unknown(output, &exact, &predicted, &surrogate.verdict, run.spectrum.top().excess))
    };
    runs.iter().enumerate().filter(is_undecided).count()
}

/// The misjudged runs among `chosen`, with values and residuals as of [`undecided`].
pub(super) fn misjudged(
    surrogate: &Surrogate,
    values: &[Vec<f64>],
    residuals: &[Vec<f64>],
    runs: &[Run],
    chosen: &[usize],
) -> Vec<usize> {
    let is_misjudged = |&&i: &&usize| {
        let predicted: Vec<f64> = values.iter().zip(&residuals[i]).map(|(value, rest)| value[i] - rest).collect();
        is_not_unstable(surrogate.top(&predicted).excess) != is_not_unstable(runs[i].spectrum.top().excess)
    };
    chosen.iter().filter(is_misjudged).copied().collect()
}

/// What the surrogate makes of runs that the model calls marginal, each left out: the excess that is not zero then, of
/// those among `chosen`, with values and residuals as of [`undecided`].
pub(super) fn excess_of_marginal(
    surrogate: &Surrogate,
    values: &[Vec<f64>],
    residuals: &[Vec<f64>],
    runs: &[Run],
    chosen: &[usize],
) -> Vec<f64> {
    let predicted = |&i: &usize| {
        let predicted: Vec<f64> = values.iter().zip(&residuals[i]).map(|(value, rest)| value[i] - rest).collect();
        surrogate.top(&predicted).excess
    };
    let marginal = chosen.iter().filter(|&&i| runs[i].spectrum.top().excess == 0.0);
    marginal.map(predicted).filter(|excess| *excess != 0.0).collect()
}

/// Whether so many undecided runs are no wonder where so many are `expected`: P(X ≥ count) is not below [`RARE`] for a
/// Poisson variable X.
pub(super) fn is_chance(count: usize, expected: f64) -> bool {
    let mut term = (-expected).exp();
    let mut below = 0.0;
    for k in 0..count {
        below += term;
        term *= expected / (k + 1) as f64;
    }
    1.0 - below >= RARE
}

/// Whether an eigenvalue of an output may be the largest and is predicted worse than its distance from zero.
fn is_unknown(output: &Output, exact: &[f64], predicted: &[f64], verdict: &VerdictBasis, largest: f64) -> bool {
    let eigenvalues = |components: &[f64]| {
        let mut found: Vec<Complex<f64>> = Vec::with_capacity(output.eigenvalue_count());
        output.recombine(components, &mut found);
        found.into_iter().map(|lambda| verdict.settled(lambda)).collect::<Vec<_>>()
    };
    let (exact, predicted) = (eigenvalues(exact), eigenvalues(predicted));
    exact.iter().zip(nearest(&exact, &predicted)).any(|(lambda, j)| {
        let excess = verdict.margin.excess(*lambda);
        let error = (verdict.margin.excess(predicted[j]) - excess).abs();
        let is_known = error <= excess.abs() || excess + error < largest;
        // An error that is no number is not known.
        !is_known
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::spectrum::{Numbers, output, with_ids};
    use pcc_evaluate::components::OutputKind;

    /// Re λ = −1, predicted as `predicted`, where the largest Re λ is `max_re`.
    fn is_unknown_at(predicted: f64, max_re: f64) -> bool {
        let lambda = Complex::new(-1.0, 10.0);
        let numbers = Numbers { modes: vec![1], reals: Vec::new() };
        let outputs = with_ids(vec![output(OutputKind::Eigenvalue, &numbers, &[vec![lambda]])]);
        is_unknown(&outputs[0], &[lambda.re, lambda.im], &[predicted, lambda.im], &VerdictBasis::default(), max_re)
    }

    #[test]
    fn an_eigenvalue_is_unknown_if_its_error_exceeds_its_distances_from_zero_and_from_the_largest() {
        assert!(!is_unknown_at(-1.5, -0.9), "its sign is known");
        assert!(!is_unknown_at(0.5, 4.0), "another is larger by far");
        assert!(is_unknown_at(0.5, -0.9) && is_unknown_at(-2.5, 0.1), "it may be the largest, on either side of zero");
        assert!(is_unknown_at(f64::NAN, 4.0), "what is no number is not known");
    }

    #[test]
    fn one_undecided_run_is_chance_where_one_in_a_hundred_is_expected_and_a_doubt_where_none_is() {
        assert!(is_chance(0, 0.0) && is_chance(1, 0.01) && is_chance(4, 1.0));
        assert!(!is_chance(1, 1e-4) && !is_chance(2, 0.01) && !is_chance(7, 1.0));
    }
}
