//! Fits by values and derivatives: exact where there is something exact to find, and little worse for bad derivatives.

use nalgebra::{DMatrix, DVector};
use pcc_compile::fitting::design::{NestedLatinHypercube, Samples};
use pcc_compile::fitting::fit::Fitted;
use pcc_compile::fitting::fit::Smooth;
use pcc_compile::fitting::fit::minimum_norm::{self, Previous};
use pcc_compile::fitting::fit::omp::{self, Candidates};
use pcc_compile::fitting::fit::stepwise::Stepwise;
use pcc_compile::fitting::fit::stepwise::{self, Outcome};
use pcc_compile::fitting::regression::{ActiveBasis, BasisTables, Equations, Gradients, Response};
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::polynomials::{Family, Hyperbolic, MultiIndex, Recurrence};
use pcc_evaluate::probability::random::{Purpose, Stream};
use proptest::prelude::*;

/// Coefficients of order one from well-determined equations.
const EXACT: f64 = 1e-8;

fn samples(inputs: usize, size: usize, seed: u64) -> Samples {
    let mut design = NestedLatinHypercube::new(inputs, seed);
    design.grow_to(size);
    design.samples(|_, u| 2.0 * u - 1.0)
}

fn recurrences(inputs: usize, degree: u16) -> Vec<Recurrence> {
    vec![Family::Legendre.recurrence(degree.into()); inputs]
}

fn candidates(inputs: usize, degree: u16, q_norm: f64) -> Vec<MultiIndex> {
    Hyperbolic { inputs, q_norm }.shells(degree).unwrap().concat()
}

fn all_points(samples: &Samples) -> Equations {
    Equations::with_derivatives(samples.len(), samples.dimension(), (0..samples.len()).collect())
}

fn rank(matrix: &DMatrix<f64>) -> usize {
    let singular = matrix.singular_values();
    singular.iter().filter(|&&value| value > 1e-9 * singular.max()).count()
}

/// What a model with these coefficients answers.
struct Answers {
    values: Vec<f64>,
    gradients: Gradients,
}

impl Answers {
    fn of(tables: &BasisTables, equations: &Equations, terms: &[MultiIndex], coefficients: &[f64]) -> Self {
        let all = tables.stacked(terms, equations) * DVector::from_column_slice(coefficients);
        let (values, slopes) = all.as_slice().split_at(equations.samples());
        let points = equations.points_with_derivatives().to_vec();
        Self { values: values.to_vec(), gradients: Gradients { points, slopes: slopes.to_vec() } }
    }

    fn response(&self) -> Response<'_> {
        Response { gradients: Some(&self.gradients), ..Response::of(&self.values, 1e-14) }
    }
}

/// The largest difference from the polynomial with these coefficients, coefficient by coefficient.
fn largest_difference(terms: &[MultiIndex], coefficients: &[f64], indices: &[MultiIndex], found: &[f64]) -> f64 {
    let expected = |alpha: &MultiIndex| terms.iter().position(|term| term == alpha).map_or(0.0, |k| coefficients[k]);
    let missing = terms.iter().zip(coefficients).filter(|(term, _)| !indices.contains(term));
    let missing = missing.map(|(_, c)| c.abs()).fold(0.0, f64::max);
    indices.iter().zip(found).map(|(alpha, c)| (c - expected(alpha)).abs()).fold(missing, f64::max)
}

/// Random coefficients of order one.
fn coefficients(count: usize, seed: u64) -> Vec<f64> {
    let mut stream = Stream::new(seed, Purpose::Evaluation, 0);
    (0..count).map(|_| 0.5 + stream.next_unit()).collect()
}

/// The fewest runs whose equations determine all terms, with their tables; with `spare`, also without any one of them.
fn fewest_runs(inputs: usize, degree: u16, terms: &[MultiIndex], seed: u64, spare: bool) -> (Samples, BasisTables) {
    (1..)
        .map(|size| samples(inputs, size, seed))
        .map(|samples| {
            let tables = BasisTables::with_slopes(&samples, &recurrences(inputs, degree), degree.into());
            (samples, tables)
        })
        .find(|(samples, tables)| {
            let (equations, matrix) = (all_points(samples), tables.stacked(terms, &all_points(samples)));
            let without = |i: usize| {
                let left: Vec<usize> = (0..equations.rows()).filter(|row| !equations.block(i).contains(row)).collect();
                matrix.select_rows(&left)
            };
            let is_determined = |matrix: &DMatrix<f64>| matrix.nrows() > 0 && rank(matrix) == terms.len();
            is_determined(&matrix) && (!spare || (0..samples.len()).all(|i| is_determined(&without(i))))
        })
        .unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// By plain least squares, by pursuit among the candidates and by the minimum norm.
    #[test]
    fn random_polynomials_are_found_exactly_from_the_fewest_runs_that_determine_them(
        inputs in 1..=4usize,
        degree in 1..=3u16,
        seed in 0..1000u64,
    ) {
        let terms = candidates(inputs, degree, 1.0);
        let (samples, tables) = fewest_runs(inputs, degree, &terms, seed, false);
        prop_assume!(samples.len() > 1);
        let coefficients = coefficients(terms.len(), seed);
        let answers = Answers::of(&tables, &all_points(&samples), &terms, &coefficients);
        let variance = answers.response().variance().unwrap();

        let mut basis = ActiveBasis::constant(&tables, answers.response(), variance, 1.0, &Silent).unwrap();
        basis.extend(terms[1..].to_vec()).unwrap();
        prop_assert_eq!(basis.indices().len(), terms.len());
        let by_least_squares = largest_difference(&terms, &coefficients, basis.indices(), &basis.coefficients());
        prop_assert!(by_least_squares < EXACT, "least squares: {}", by_least_squares);

        // One equation more than terms shows that the candidates suffice.
        if all_points(&samples).rows() > terms.len() {
            let settings = Smooth { max_degree: degree, s2_target: 0.999 };
            let set = Candidates::new(inputs, degree, samples.len(), inputs).unwrap();
            let fitted = omp::fit(&tables, answers.response(), &set, &settings, &Silent).unwrap();
            let by_pursuit = largest_difference(&terms, &coefficients, &fitted.indices, &fitted.coefficients);
            prop_assert!(by_pursuit < EXACT, "pursuit with {} runs: {}", samples.len(), by_pursuit);
        }
    }

    /// The minimum norm has all products of powers up to its degree as candidates.
    #[test]
    fn the_minimum_norm_finds_what_its_equations_determine_with_a_run_to_spare(
        inputs in 1..=3usize,
        degree in 1..=2u16,
        seed in 0..1000u64,
    ) {
        let powers = usize::from(degree) + 1;
        let term = |k: usize| MultiIndex::new((0..inputs).map(|j| (k / powers.pow(j as u32) % powers) as u16).collect());
        let terms: Vec<MultiIndex> = (0..powers.pow(inputs as u32)).map(term).collect();
        let (samples, tables) = fewest_runs(inputs, degree, &terms, seed, true);
        prop_assume!(samples.len() > 1);
        let coefficients = coefficients(terms.len(), seed);
        let answers = Answers::of(&tables, &all_points(&samples), &terms, &coefficients);
        let settings = Smooth { max_degree: degree, s2_target: 0.999 };
        let (fitted, _) = minimum_norm::fit(&tables, answers.response(), &settings, &Previous::nothing(inputs), &Silent).unwrap();
        let difference = largest_difference(&terms, &coefficients, &fitted.indices, &fitted.coefficients);
        // ν keeps the equations from being met exactly.
        prop_assert!(difference < 1e-4, "{}", difference);
    }
}

/// Alexander and Hirschowitz: values and derivatives at 5 points of 8 inputs are 45 equations for 45 quadratic terms,
/// but determine only 35 of them.
#[test]
fn counting_equations_says_little_of_what_they_determine() {
    let terms = candidates(8, 2, 1.0);
    assert_eq!(terms.len(), 45);
    for (size, expected) in [(5, 35), (8, 44), (9, 45)] {
        let samples = samples(8, size, 3);
        let tables = BasisTables::with_slopes(&samples, &recurrences(8, 2), 2);
        assert_eq!(rank(&tables.stacked(&terms, &all_points(&samples))), expected, "{size} points");
        let answers = Answers::of(&tables, &all_points(&samples), &terms, &coefficients(45, 1));
        let variance = answers.response().variance().unwrap();
        let mut basis = ActiveBasis::constant(&tables, answers.response(), variance, 1.0, &Silent).unwrap();
        basis.extend(terms[1..].to_vec()).unwrap();
        assert_eq!(basis.indices().len(), expected);
        // The last run is needed: leaving it out leaves something undetermined.
        assert_eq!((basis.s2(), basis.mean_leverage()), (None, 1.0));
    }
}

/// A smooth function with its derivatives.
fn smooth(x: &[f64]) -> (f64, Vec<f64>) {
    let (a, b, c) = (x[0], x[1], x[2]);
    let (exponential, root) = ((0.5 * a + 0.3 * b).exp(), (2.0 + 0.5 * b * c).sqrt());
    let gradient = vec![0.5 * exponential + root, 0.3 * exponential + a * 0.25 * c / root, a * 0.25 * b / root];
    (exponential + a * root, gradient)
}

/// Answers of [`smooth`] with relative noise in the derivatives.
fn noisy(samples: &Samples, noise: f64) -> Answers {
    let exact: Vec<(f64, Vec<f64>)> = samples.points().map(smooth).collect();
    let mut stream = Stream::new(7, Purpose::Evaluation, 0);
    let mut slopes = Vec::new();
    for j in 0..samples.dimension() {
        let square: f64 = exact.iter().map(|(_, gradient)| gradient[j] * gradient[j]).sum();
        let size = (square / exact.len() as f64).sqrt();
        // Uniform noise of unit variance.
        slopes.extend(
            exact.iter().map(|(_, gradient)| gradient[j] + noise * size * 12f64.sqrt() * (stream.next_unit() - 0.5)),
        );
    }
    Answers {
        values: exact.into_iter().map(|(value, _)| value).collect(),
        gradients: Gradients { points: (0..samples.len()).collect(), slopes },
    }
}

/// Root mean square error at points of another design, relative to the standard deviation.
fn error(fitted: &Fitted) -> f64 {
    let fresh = samples(3, 500, 99);
    let tables = BasisTables::new(&fresh, &recurrences(3, 8), 8);
    let predicted = tables.columns(&fitted.indices) * DVector::from_column_slice(&fitted.coefficients);
    let truth = DVector::from_iterator(500, fresh.points().map(|x| smooth(x).0));
    let centered = truth.add_scalar(-truth.mean());
    (predicted - truth).norm() / centered.norm()
}

const SETTINGS: Smooth = Smooth { max_degree: 8, s2_target: 0.999 };

fn by_minimum_norm(tables: &BasisTables, response: Response<'_>) -> Fitted {
    minimum_norm::fit(tables, response, &SETTINGS, &Previous::nothing(3), &Silent).unwrap().0
}

fn by_pursuit(tables: &BasisTables, response: Response<'_>) -> Fitted {
    let candidates = Candidates::new(3, 8, response.values.len(), 3).unwrap();
    omp::fit(tables, response, &candidates, &SETTINGS, &Silent).unwrap()
}

/// Good derivatives are worth many runs; bad ones lose their weight and do no harm.
#[test]
fn noise_in_the_derivatives_lowers_their_weight_and_degrades_the_fit_gracefully() {
    let samples = samples(3, 30, 5);
    let tables = BasisTables::with_slopes(&samples, &recurrences(3, 8), 8);
    for (name, fit) in
        [("minimum norm", by_minimum_norm as fn(&BasisTables, Response<'_>) -> Fitted), ("pursuit", by_pursuit)]
    {
        let clean = noisy(&samples, 0.0);
        let alone = error(&fit(&tables, Response::of(&clean.values, 1e-14)));
        let (mut before, mut weight_before) = (0.0, 1.0);
        for noise in [0.0, 0.01, 0.3, 10.0] {
            let answers = noisy(&samples, noise);
            let fitted = fit(&tables, answers.response());
            let (found, weight) = (error(&fitted), fitted.derivative_weight.unwrap());
            assert!(weight <= weight_before, "{name}, noise {noise}: weight {weight}");
            assert!(
                found >= 0.5 * before && found <= 2.0 * alone,
                "{name}, noise {noise}: {found:e} against {alone:e}"
            );
            if noise == 0.01 {
                assert!(weight < 1.0 && found < alone, "{name}: weight {weight}, {found:e} against {alone:e}");
            }
            (before, weight_before) = (found, weight);
        }
        let exact = fit(&tables, clean.response());
        assert!(exact.derivative_weight == Some(1.0) && error(&exact) < 0.5 * alone, "{name}");
        assert!(weight_before < 1.0, "{name} trusts noise");
    }
}

/// Runs without derivatives are values alone.
#[test]
fn some_runs_may_lack_derivatives() {
    let samples = samples(3, 24, 5);
    let tables = BasisTables::with_slopes(&samples, &recurrences(3, 8), 8);
    let full = noisy(&samples, 0.0);
    let points: Vec<usize> = (0..24).filter(|i| i % 3 != 1).collect();
    let slopes =
        (0..3).flat_map(|j| points.iter().map(move |&i| (i, j))).map(|(i, j)| full.gradients.slopes[j * 24 + i]);
    let gradients = Gradients { slopes: slopes.collect(), points: points.clone() };
    let response = Response { gradients: Some(&gradients), ..Response::of(&full.values, 1e-14) };
    for fit in [by_minimum_norm as fn(&BasisTables, Response<'_>) -> Fitted, by_pursuit] {
        let (some, none) = (error(&fit(&tables, response)), error(&fit(&tables, Response::of(&full.values, 1e-14))));
        let all = error(&fit(&tables, full.response()));
        assert!(all < 1.2 * some && some < none, "all {all:e}, some {some:e}, none {none:e}");
    }
}

/// The paper's search with derivatives: fewer runs for the same terms, and asked for by leverage.
#[test]
fn stepwise_regression_needs_fewer_runs_with_derivatives() {
    let terms = [vec![0, 0, 0], vec![1, 0, 0], vec![0, 2, 0], vec![1, 1, 0], vec![0, 0, 3]].map(MultiIndex::new);
    let coefficients = [1.0, 2.0, -1.0, 0.5, 0.3];
    let settings =
        Stepwise { max_degree: 4, q_norm: 1.0, s2_target: 1.0 - 1e-9, epsilon_forward: 1e-9, epsilon_backward: 1e-9 };
    let shells = Hyperbolic { inputs: 3, q_norm: 1.0 }.shells(4).unwrap();
    let smallest = |with_derivatives: bool| {
        (2..60).find(|&size| {
            let samples = samples(3, size, 2);
            let tables = BasisTables::with_slopes(&samples, &recurrences(3, 4), 4);
            let answers = Answers::of(&tables, &all_points(&samples), &terms, &coefficients);
            let response = if with_derivatives { answers.response() } else { Response::of(&answers.values, 1e-14) };
            match stepwise::fit(&tables, response, &shells, &settings, &Silent).unwrap() {
                Outcome::Fitted(fitted) => {
                    largest_difference(&terms, &coefficients, &fitted.indices, &fitted.coefficients) < EXACT
                }
                Outcome::TooFewSamples { .. } => false,
            }
        })
    };
    let (with, without) = (smallest(true).unwrap(), smallest(false).unwrap());
    assert!(2 * with <= without, "{with} runs with derivatives, {without} without");
}
