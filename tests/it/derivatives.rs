//! Derivatives against references: symbolic ones of the clutch's matrices, and those of invariants from eigenvalues
//! with 60 digits, at and next to exceptional points (`tests/data/derivatives.py`).

use crate::support::text;
use nalgebra::{Complex, DMatrix};
use pcc_compile::mechanics::model::{CLUTCH_PARAMETERS, Clutch, Model, SecondOrder};
use pcc_compile::mechanics::spectrum::{ReducedSystem, Slopes, Solution, Spectrum};
use pcc_evaluate::components::OutputKind;

/// Closed forms of the same derivative differ by a few roundings.
const SYMBOLIC: f64 = 1e-13;

/// Relative error of a complex derivative.
const DIFFERENTIATED: f64 = 1e-8;

const INPUTS: [&str; 8] = ["mu", "k_p", "k_f", "gamma_1", "gamma_2", "r_1", "r_2", "l"];

/// Rows of a table: the word in the first column and the numbers of the others.
fn rows(file: &str) -> Vec<(String, Vec<f64>)> {
    let text = text(&format!("tests/data/{file}.csv"));
    let row = |line: &str| {
        let (word, numbers) = line.split_once(',').unwrap();
        (word.to_owned(), numbers.split(',').map(|cell| cell.parse().unwrap()).collect())
    };
    text.lines().skip(1).map(row).collect()
}

/// The derivatives of a group's components: one list of complex parts per input.
fn slopes(state_matrix: DMatrix<f64>, derivatives: &[DMatrix<f64>], modes: &[usize]) -> Vec<Vec<Complex<f64>>> {
    let solution = Solution::new(state_matrix, None).unwrap();
    let spectrum = Spectrum::new(solution.eigenvalues()).unwrap();
    let lambdas: Vec<Complex<f64>> = modes.iter().map(|&mode| spectrum.mode(mode).unwrap()).collect();
    let system =
        ReducedSystem::new(&solution, Slopes { state_matrix: derivatives, second_order: &[] }, &lambdas).unwrap();
    let found = system.differentiate(OutputKind::Cluster, &lambdas).unwrap();
    found.iter().map(|parts| parts.chunks(2).map(|part| Complex::new(part[0], part[1])).collect()).collect()
}

/// Compares by the modulus of the expected derivative, or by what rounding leaves of a much larger one in another
/// input.
fn assert_close(found: Complex<f64>, expected: Complex<f64>, scale: f64, what: &str) {
    let error = (found - expected).norm();
    assert!(error <= DIFFERENTIATED * expected.norm().max(1e-6 * scale), "{what}: {found} is not {expected}");
}

#[test]
fn matrices_of_the_clutch_differentiate_as_symbolic_algebra_does() {
    let names = CLUTCH_PARAMETERS.map(|parameter| parameter.name);
    let table = rows("clutch_matrix_derivatives");
    assert_eq!(table.len(), 3 * names.len());
    for (by, numbers) in table {
        let (point, expected) = numbers.split_at(names.len());
        let constants: Vec<(&str, f64)> = names.iter().copied().zip(point.iter().copied()).collect();
        let at = point[names.iter().position(|name| *name == by).unwrap()];
        let clutch = Clutch::new(&constants, &[by.as_str()]).unwrap();
        let found = clutch.linearization(&[at]).unwrap().unwrap().derivatives.remove(0);
        for (k, &expected) in expected.iter().enumerate() {
            let entry = found[(6 + k / 12, k % 12)];
            assert!(
                (entry - expected).abs() <= SYMBOLIC * expected.abs(),
                "by {by}, entry {k}: {entry} is not {expected}"
            );
        }
        assert_eq!(found.rows(0, 6).amax(), 0.0);
    }
}

#[test]
fn invariants_of_the_clutch_differentiate_next_to_exceptional_points_as_elsewhere() {
    let table = rows("clutch_invariant_derivatives");
    let close = table.iter().filter(|(_, numbers)| numbers[10].hypot(numbers[11]) < 0.02).count();
    assert!(close >= 6, "{close} points next to exceptional ones");
    for (set, numbers) in table {
        let (point, rest) = numbers.split_at(8);
        let (_, rest) = rest.split_at(4);
        let (expected, dampers) = rest.split_at(32);
        let constants: Vec<(&str, f64)> =
            ["c_A", "c_B", "c_C", "c_D"].into_iter().zip(dampers.iter().copied()).collect();
        let linearization = Clutch::new(&constants, &INPUTS).unwrap().linearization(point).unwrap().unwrap();
        let found = slopes(linearization.state_matrix, &linearization.derivatives, &[3, 4]);
        // c_0 = −d. An input changes by some share of itself, so this is what one derivative can do beside another.
        let part = |j: usize, k: usize| Complex::new(expected[4 * j + 2 * k], expected[4 * j + 2 * k + 1]);
        let largest = |k: usize| (0..8).map(|j| part(j, k).norm() * point[j].abs().max(0.1)).fold(0.0, f64::max);
        for (j, input) in INPUTS.into_iter().enumerate() {
            let scale = |k: usize| largest(k) / point[j].abs().max(0.1);
            assert_close(found[j][0], part(j, 0), scale(0), &format!("{set}, s by {input}"));
            assert_close(-found[j][1], part(j, 1), scale(1), &format!("{set}, d by {input}"));
        }
    }
}

#[test]
fn invariants_of_three_modes_differentiate_where_all_three_coalesce() {
    let table = rows("three_mode_derivatives");
    assert_eq!(table.iter().filter(|(set, _)| set == "coalescence").count(), 5);
    for (set, numbers) in table {
        let (point, rest) = numbers.split_at(4);
        let (_, expected) = rest.split_at(6);
        let (system, derivatives) = three_oscillators(point);
        let linearization = system.linearization(derivatives).unwrap();
        let found = slopes(linearization.state_matrix, &linearization.derivatives, &[1, 2, 3]);
        let part = |j: usize, k: usize| Complex::new(expected[6 * j + 2 * k], expected[6 * j + 2 * k + 1]);
        for k in 0..3 {
            let largest = (0..4).map(|j| part(j, k).norm()).fold(0.0, f64::max);
            for (j, slopes) in found.iter().enumerate() {
                assert_close(slopes[k], part(j, k), largest, &format!("{set}, coefficient {k} by input {j}"));
            }
        }
    }
}

/// The chain of `tests/data/coupled_oscillators.py` with k = 3 at standardized inputs, and its derivatives by them.
fn three_oscillators(xi: &[f64]) -> (SecondOrder, Vec<SecondOrder>) {
    let stiffness = |follower: f64, detuning_1: f64, detuning_2: f64, coupling: f64, constant: f64| {
        let (lower, upper) = (300.0 * coupling, 300.0 * constant);
        let hanging = -500.0 * constant;
        DMatrix::from_row_slice(
            4,
            4,
            &[
                1e4 * (constant + detuning_1),
                -lower + follower,
                0.0,
                0.0,
                -lower - follower,
                1e4 * constant,
                -upper + follower,
                0.0,
                0.0,
                -upper - follower,
                1e4 * (constant + detuning_2),
                hanging,
                0.0,
                0.0,
                hanging,
                9e4 * (constant + 0.4 * detuning_1 - 0.2 * detuning_2),
            ],
        )
    };
    let none = || DMatrix::zeros(4, 4);
    let by = |stiffness| SecondOrder { mass: none(), damping: none(), stiffness };
    let system = SecondOrder {
        mass: DMatrix::identity(4, 4),
        damping: DMatrix::from_diagonal(&nalgebra::dvector![1.9, 1.5, 1.0, 3.0]),
        stiffness: stiffness(350.0 * (1.0 + xi[0]), 0.05 * xi[1], 0.05 * xi[2], 1.0 + 0.2 * xi[3], 1.0),
    };
    let derivatives = vec![
        by(stiffness(350.0, 0.0, 0.0, 0.0, 0.0)),
        by(stiffness(0.0, 0.05, 0.0, 0.0, 0.0)),
        by(stiffness(0.0, 0.0, 0.05, 0.0, 0.0)),
        by(stiffness(0.0, 0.0, 0.0, 0.2, 0.0)),
    ];
    (system, derivatives)
}
