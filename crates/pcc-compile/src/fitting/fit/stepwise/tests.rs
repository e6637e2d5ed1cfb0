//! Stepwise regression against its definition.

use super::*;
use crate::fitting::design::{NestedLatinHypercube, Samples};
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::polynomials::{Family, Hyperbolic};

const DEGREE: u16 = 8;

struct Case {
    samples: Samples,
    tables: BasisTables,
    shells: Vec<Vec<MultiIndex>>,
}

fn problem(points: usize, q_norm: f64) -> Case {
    let mut design = NestedLatinHypercube::new(2, 3);
    design.grow_to(points);
    let samples = design.samples(|_, u| 2.0 * u - 1.0);
    let recurrences = vec![Family::Legendre.recurrence(DEGREE.into()); 2];
    let tables = BasisTables::new(&samples, &recurrences, DEGREE.into());
    Case { samples, tables, shells: Hyperbolic { inputs: 2, q_norm }.shells(DEGREE).unwrap() }
}

impl Case {
    /// Values of an expansion with these terms.
    fn values(&self, terms: &[([u16; 2], f64)]) -> Vec<f64> {
        let indices: Vec<MultiIndex> = terms.iter().map(|(alpha, _)| MultiIndex::new(alpha.to_vec())).collect();
        let columns = self.tables.columns(&indices);
        (0..self.samples.len()).map(|i| terms.iter().enumerate().map(|(k, (_, c))| c * columns[(i, k)]).sum()).collect()
    }

    fn fit(&self, values: &[f64], settings: &Stepwise) -> Outcome {
        fit(&self.tables, Response::of(values, 1e-13), &self.shells, settings, &Silent).unwrap()
    }
}

fn settings(q_norm: f64, s2_target: f64) -> Stepwise {
    Stepwise { max_degree: DEGREE, q_norm, s2_target, epsilon_forward: 1e-6, epsilon_backward: 1e-6 }
}

fn fitted(outcome: Outcome) -> Fitted {
    match outcome {
        Outcome::Fitted(fitted) => fitted,
        Outcome::TooFewSamples { .. } => panic!("the design suffices"),
    }
}

#[test]
fn a_sparse_polynomial_is_found_exactly_and_the_search_ends_at_its_degree() {
    let problem = problem(60, 1.0);
    let terms = [([0, 0], 3.0), ([1, 0], 2.0), ([0, 2], -1.0), ([2, 1], 0.5)];
    let found = fitted(problem.fit(&problem.values(&terms), &settings(1.0, 0.999_999)));
    assert_eq!((found.degree, found.stop), (3, StopReason::Accurate));
    for (alpha, coefficient) in terms {
        let at = found.indices.iter().position(|index| **index == alpha).unwrap();
        assert!((found.coefficients[at] - coefficient).abs() < 1e-12);
    }
}

#[test]
fn candidates_of_a_shell_are_tested_against_the_set_before_it() {
    // On a finite design terms of one shell correlate; each is still judged alone, so their order plays no part.
    let problem = problem(40, 1.0);
    let values = problem.values(&[([0, 0], 1.0), ([3, 0], 1.0), ([2, 1], 1.0)]);
    let one_degree = Stepwise { max_degree: 3, epsilon_forward: 1e-3, epsilon_backward: 0.0, ..settings(1.0, 1.0) };
    let found = fitted(problem.fit(&values, &one_degree));
    let mut basis = {
        let response = Response::of(&values, 0.0);
        ActiveBasis::constant(&problem.tables, response, response.variance().unwrap(), 1.0, &Silent)
    }
    .unwrap();
    for shell in &problem.shells[1..=3] {
        let gains = basis.gains(shell).unwrap();
        let kept: Vec<_> =
            shell.iter().zip(gains).filter(|&(_, gain)| gain >= 1e-3).map(|(alpha, _)| alpha.clone()).collect();
        basis.extend(kept).unwrap();
    }
    let mut expected = basis.indices().to_vec();
    expected.sort();
    assert_eq!(found.indices[..], expected);
}

#[test]
fn backward_step_drops_lower_degrees_only_and_never_the_constant() {
    let problem = problem(40, 1.0);
    let values = problem.values(&[([2, 0], 1.0)]);
    let variance = Response::of(&values, 0.0).variance().unwrap();
    let mut basis = ActiveBasis::constant(&problem.tables, Response::of(&values, 0.0), variance, 1.0, &Silent).unwrap();
    basis.extend([problem.shells[1].clone(), problem.shells[2].clone()].concat()).unwrap();
    backward_step(&mut basis, &problem.shells[2], 1e-6).unwrap();
    let expected = [problem.shells[0].clone(), problem.shells[2].clone()].concat();
    assert_eq!(basis.indices(), expected, "degree 1 is useless and goes, degree 2 stays, useful or not");
    backward_step(&mut basis, &problem.shells[3], 1e-6).unwrap();
    assert_eq!(basis.indices(), [MultiIndex::constant(2), MultiIndex::new(vec![2, 0])]);
}

/// Degree 2 in two inputs has six terms, four of which make up the values. On few points the other two correlate
/// with the residual and join as well: fewer than 8 points never suffice, 12 always do.
#[test]
fn two_points_per_term_are_required_and_suffice() {
    let terms = [([0, 0], 1.0), ([1, 0], 1.0), ([0, 1], 1.0), ([1, 1], 1.0)];
    let quadratic = Stepwise { max_degree: 2, epsilon_forward: 1e-9, epsilon_backward: 1e-9, ..settings(1.0, 1.0) };
    for points in 4..30 {
        let problem = problem(points, 1.0);
        match problem.fit(&problem.values(&terms), &quadratic) {
            Outcome::Fitted(found) => assert!(points >= 2 * found.indices.len() && found.indices.len() >= 4),
            Outcome::TooFewSamples { .. } => assert!(points < 12, "{points} points suffice"),
        }
    }
}

#[test]
fn a_design_that_is_too_small_asks_for_more_and_settles_for_the_last_degree_that_passed() {
    let problem = problem(12, 1.0);
    let values: Vec<f64> = problem.samples.points().map(|x| (3.0 * x[0]).sin() * (2.0 * x[1]).exp()).collect();
    let Outcome::TooFewSamples { indices, degree } = problem.fit(&values, &settings(1.0, 1.0)) else {
        panic!("12 points do not carry this function");
    };
    assert!(12 >= 2 * indices.len() && indices[0].is_constant());
    let response = Response::of(&values, 1e-13);
    let settled = settle(&problem.tables, response, &indices, degree, &Silent).unwrap();
    assert_eq!((settled.degree, settled.stop), (degree, StopReason::DesignExhausted));
    assert_eq!(settled.indices.len(), indices.len());
}

#[test]
fn as_many_significant_terms_as_points_are_not_even_added() {
    let problem = problem(6, 1.0);
    let values: Vec<f64> = problem.samples.points().map(|x| (3.0 * x[0] + x[1]).sin()).collect();
    let variance = Response::of(&values, 0.0).variance().unwrap();
    let mut basis = ActiveBasis::constant(&problem.tables, Response::of(&values, 0.0), variance, 1.0, &Silent).unwrap();
    let five = [problem.shells[1].clone(), problem.shells[2].clone()].concat();
    assert_eq!(forward_step(&mut basis, &five, 0.0), Ok(false), "with {{0}}, six terms on six points");
    assert_eq!(basis.indices(), [MultiIndex::constant(2)]);
    assert_eq!(forward_step(&mut basis, &five[..4], 0.0), Ok(true));
    assert_eq!(basis.indices().len(), 5);
}

#[test]
fn values_that_do_not_vary_are_their_mean() {
    let problem = problem(10, 1.0);
    let values: Vec<f64> = (0..10).map(|i| 7.0 + 1e-15 * f64::from(i)).collect();
    let found = fitted(problem.fit(&values, &settings(1.0, 0.999)));
    assert_eq!((found.indices.len(), found.stop, found.errors), (1, StopReason::Constant, None));
    assert!((found.coefficients[0] - 7.0).abs() < 1e-13);
}

#[test]
fn an_interruption_ends_the_search() {
    struct Stopped;
    impl Observer for Stopped {
        fn begin(&self, _: &str, _: u64) {}
        fn advance(&self, _: u64) {}
        fn finish(&self) {}
        fn interrupted(&self) -> bool {
            true
        }
    }
    let problem = problem(10, 1.0);
    let values: Vec<f64> = problem.samples.points().map(|x| x[0]).collect();
    let response = Response::of(&values, 0.0);
    let outcome = fit(&problem.tables, response, &problem.shells, &settings(1.0, 0.999), &Stopped);
    assert_eq!(outcome, Err(Interrupted));
}
