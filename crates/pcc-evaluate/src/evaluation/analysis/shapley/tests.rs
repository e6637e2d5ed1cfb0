//! Effects are those of closed forms and of brute force over subsets.

use super::*;
use crate::evaluation::test_surrogates::{XI, expansion, on_threads, surrogate};
use crate::foundation::Silent;
use crate::probability::inputs::{Input, InputSpace, Marginal, Parameters, Uniform};

/// Inputs that are all normal, or all uniform on [−1, 1].
fn space(dimension: usize, is_normal: bool, correlations: &[(usize, usize, f64)]) -> InputSpace {
    let law = || match is_normal {
        true => Marginal::named("normal", &Parameters::of([("mean", 0.0), ("std", 1.0)])).unwrap(),
        false => Marginal::Uniform(Uniform::new(-1.0, 1.0).unwrap()),
    };
    let inputs = (0..dimension).map(|j| Input::new(format!("x{j}"), law())).collect();
    let copula = GaussianCopula::new(dimension, correlations.iter().copied()).unwrap();
    InputSpace::new(inputs).unwrap().with_dependence(copula).unwrap()
}

/// max Re λ = c + β·ξ.
fn linear(inputs: InputSpace, constant: f64, slopes: &[f64]) -> Surrogate {
    let dimension = slopes.len();
    let scale = if inputs.inputs()[0].marginal.is_divisible() { XI } else { 1.0 };
    let unit = |j: usize| (0..dimension).map(|k| u16::from(k == j)).collect::<Vec<u16>>();
    let alphas: Vec<Vec<u16>> = (0..dimension).map(unit).collect();
    let zero = vec![0; dimension];
    let terms = alphas.iter().zip(slopes).map(|(alpha, slope)| (alpha.as_slice(), scale * slope));
    let terms: Vec<(&[u16], f64)> = std::iter::once((zero.as_slice(), constant)).chain(terms).collect();
    surrogate(inputs, vec![expansion(&terms)])
}

/// Var E\[β·x | x_S\] of normal inputs: the variance that a linear regression on x_S explains, by elimination.
fn explained(copula: &GaussianCopula, slopes: &[f64], known: &[usize]) -> f64 {
    let with_all = |i: usize| (0..slopes.len()).map(|k| copula.correlation(i, k) * slopes[k]).sum::<f64>();
    let mut rows: Vec<Vec<f64>> =
        known.iter().map(|&i| known.iter().map(|&k| copula.correlation(i, k)).chain([with_all(i)]).collect()).collect();
    for pivot in 0..rows.len() {
        let of_pivot = rows[pivot].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(k, _)| *k != pivot) {
            let factor = row[pivot] / of_pivot[pivot];
            row.iter_mut().zip(&of_pivot).for_each(|(entry, other)| *entry -= factor * other);
        }
    }
    let coefficient = |k: usize| rows[k][known.len()] / rows[k][k];
    known.iter().enumerate().map(|(k, &i)| coefficient(k) * with_all(i)).sum()
}

/// Shapley effects from their definition, over all subsets.
fn by_subsets(copula: &GaussianCopula, slopes: &[f64]) -> Vec<f64> {
    let inputs = slopes.len();
    let all: Vec<usize> = (0..inputs).collect();
    let variance = explained(copula, slopes, &all);
    let factorial = |n: usize| (1..=n).product::<usize>() as f64;
    let effect = |i: usize| {
        let subsets = (0..1usize << inputs).filter(|subset| subset >> i & 1 == 0);
        let gain = |subset: usize| {
            let known: Vec<usize> = all.iter().copied().filter(|k| subset >> k & 1 == 1).collect();
            let with: Vec<usize> = known.iter().copied().chain([i]).collect();
            let weight = factorial(known.len()) * factorial(inputs - known.len() - 1) / factorial(inputs);
            weight * (explained(copula, slopes, &with) - explained(copula, slopes, &known))
        };
        subsets.map(gain).sum::<f64>() / variance
    };
    (0..inputs).map(effect).collect()
}

/// For every input, the share of seeds whose interval holds the exact effect.
fn coverage(
    surrogate: &Surrogate,
    samples: u64,
    output: fn(ShapleyEffects) -> Option<Vec<Estimate>>,
    exact: &[f64],
) -> Vec<f64> {
    const SEEDS: u64 = 400;
    let mut covered = vec![0.0; exact.len()];
    for seed in 0..SEEDS {
        let found = output(shapley_effects(surrogate, samples, seed, &Silent).unwrap()).unwrap();
        for ((share, estimate), exact) in covered.iter_mut().zip(found).zip(exact) {
            let holds = estimate.lower <= exact + 1e-12 && exact - 1e-12 <= estimate.upper;
            *share += f64::from(holds);
        }
    }
    covered.into_iter().map(|count| count / SEEDS as f64).collect()
}

/// 0.92 is nearly three standard errors of 400 seeds below 0.95.
const LOWEST_COVERAGE: f64 = 0.92;

/// Owen and Prieur (2017): (β₁² (1 − ρ²/2) + ρ β₁ β₂ + β₂² ρ²/2)/σ² for the first of two inputs of unit variance.
#[test]
fn effects_of_two_normal_inputs_are_those_of_owen_and_prieur() {
    let (first, second) = (1.0, -0.7);
    for rho in [-0.8, 0.3, 0.9] {
        let correlations = [(0, 1, rho)];
        let surrogate = linear(space(2, true, &correlations), 2.0, &[first, second]);
        let half = 0.5 * rho * rho;
        let variance = first * first + second * second + 2.0 * rho * first * second;
        let effect =
            |own: f64, other: f64| (own * own * (1.0 - half) + rho * own * other + other * other * half) / variance;
        let exact = [effect(first, second), effect(second, first)];
        let copula = GaussianCopula::new(2, correlations).unwrap();
        for (found, exact) in by_subsets(&copula, &[first, second]).iter().zip(exact) {
            assert!((found - exact).abs() < 1e-14, "the brute force of these tests");
        }
        let covered = coverage(&surrogate, 500, |found| found.max_re, &exact);
        assert!(covered.iter().all(|&share| share >= LOWEST_COVERAGE), "{rho}: {covered:?}");
        let found = shapley_effects(&surrogate, 100_000, 1, &Silent).unwrap().max_re.unwrap();
        assert!((found.iter().map(|effect| effect.value).sum::<f64>() - 1.0).abs() < 1e-12);
        for (found, exact) in found.iter().zip(exact) {
            assert!((found.value - exact).abs() < 0.01 && found.upper - found.lower < 0.02, "{found:?} {exact}");
        }
    }
}

#[test]
fn effects_of_more_inputs_are_those_of_all_subsets() {
    // The third input acts by others alone, the last one is independent.
    let correlations = [(0, 1, 0.5), (0, 2, 0.7), (1, 2, -0.2), (1, 3, 0.3)];
    let slopes = [1.0, 2.0, 0.0, -0.5, 0.8];
    let copula = GaussianCopula::new(5, correlations).unwrap();
    let exact = by_subsets(&copula, &slopes);
    assert!((exact.iter().sum::<f64>() - 1.0).abs() < 1e-14 && exact[2] > 0.05, "{exact:?}");
    let surrogate = linear(space(5, true, &correlations), -0.3, &slopes);
    let covered = coverage(&surrogate, 2000, |found| found.max_re, &exact);
    assert!(covered.iter().all(|&share| share >= LOWEST_COVERAGE), "{covered:?}");
}

/// x₁ + x₂/2 + 0.4 ≤ 0 with ρ = 0.6, by a Gauss rule over SciPy's normal law.
#[test]
fn effects_on_the_indicator_are_those_of_a_half_plane() {
    let surrogate = linear(space(2, true, &[(0, 1, 0.6)]), 0.4, &[1.0, 0.5]);
    let exact = [0.6406569510275103, 0.35934304897248964];
    for samples in [300, 2000] {
        let covered = coverage(&surrogate, samples, |found| found.stability, &exact);
        assert!(covered.iter().all(|&share| share >= LOWEST_COVERAGE), "{samples} samples: {covered:?}");
    }
}

/// u₁ + 2u₂ with scores of correlation 0.6, by the same rule: E\[u₂ | z₁\] = 2Φ(ρ z₁/√(2 − ρ²)) − 1.
#[test]
fn effects_of_uniform_inputs_are_those_of_a_quadrature() {
    let surrogate = linear(space(2, false, &[(0, 1, 0.6)]), 0.0, &[1.0, 2.0]);
    let covered = coverage(&surrogate, 500, |found| found.max_re, &[0.36605420079231055, 0.6339457992076895]);
    assert!(covered.iter().all(|&share| share >= LOWEST_COVERAGE), "{covered:?}");
}

/// Given x₃ the others have the covariances of Schur's complement.
#[test]
fn effects_where_an_input_is_fixed_are_those_of_the_conditional_law() {
    let correlations = [(0, 1, 0.5), (0, 2, 0.6), (1, 2, -0.2)];
    let surrogate = linear(space(3, true, &correlations), 0.0, &[1.0, 1.0, 3.0]);
    let region = Region::with_fixed(&surrogate.inputs, 2, 0.5);
    let [one, two, shared] = [1.0 - 0.36, 1.0 - 0.04, 0.5 + 0.12];
    let rho: f64 = shared / f64::sqrt(one * two);
    let left = GaussianCopula::new(2, [(0, 1, rho)]).unwrap();
    let exact = by_subsets(&left, &[f64::sqrt(one), f64::sqrt(two)]);
    let found = shapley_effects_in(&surrogate, &region, 100_000, 1, &Silent).unwrap().max_re.unwrap();
    assert_eq!((found[2].value, found[2].upper), (0.0, 0.0));
    for (found, exact) in found.iter().zip(exact) {
        assert!(found.lower <= exact && exact <= found.upper && found.upper - found.lower < 0.02, "{found:?} {exact}");
    }
}

#[test]
fn independent_inputs_have_effects_between_their_indices() {
    let slopes = [1.0, 2.0, 0.0];
    let surrogate = linear(space(3, false, &[]), 0.0, &slopes);
    let found = shapley_effects(&surrogate, 50_000, 1, &Silent).unwrap().max_re.unwrap();
    for (found, exact) in found.iter().zip([0.2, 0.8, 0.0]) {
        assert!((found.value - exact).abs() < 0.01, "{found:?} {exact}");
    }
    assert!(found[2].upper < 1e-12, "no influence");
}

#[test]
fn effects_do_not_depend_on_threads_and_their_absence_is_said() {
    let dependent = space(3, true, &[(0, 2, 0.5)]);
    let surrogate = linear(dependent.clone(), 0.1, &[1.0, 0.5, 0.25]);
    let on = |threads| on_threads(threads, || shapley_effects(&surrogate, 20_000, 4, &Silent).unwrap());
    assert!(on(1) == on(2) && on(1) == on(8));
    let constant = linear(dependent.clone(), 0.1, &[0.0; 3]);
    let found = shapley_effects(&constant, 1000, 1, &Silent).unwrap();
    assert_eq!((found.max_re, found.stability), (None, None));
    let always_stable = linear(dependent, -100.0, &[1.0, 0.5, 0.25]);
    let found = shapley_effects(&always_stable, 1000, 1, &Silent).unwrap();
    assert!(found.max_re.is_some() && found.stability.is_none());
    let refused = super::super::sensitivity::sensitivities(&surrogate, 100, 1, &Silent);
    assert_eq!(refused, Err(EvalError::Dependent { input: "x0".to_owned() }));
}
