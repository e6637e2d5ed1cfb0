//! Groups closed under conjugation that meet on the real axis, against eigenvalues and derivatives with 50 digits
//! (`tests/data/closed_groups.py`).

use crate::support::text;
use nalgebra::{Complex, DMatrix};
use pcc_compile::mechanics::spectrum::{ReducedSystem, Slopes, Solution, Spectrum, components_of, nearest};
use pcc_evaluate::components::{OutputKind, closed_eigenvalues};

const STATES: usize = 6;
const MOST: usize = 4;

/// Relative error of symmetric functions and of their derivatives.
const COMPONENTS: f64 = 1e-8;

/// Relative error of eigenvalues that are not about to meet.
const APART: f64 = 1e-10;

/// The same of eigenvalues that are 1e-4 apart.
const NEAR: f64 = 1e-8;

/// Rounding of symmetric functions that the root of an m-fold eigenvalue magnifies.
const ROUNDING: f64 = 1e-12;

/// Size of the group, the case, and all numbers.
type Row = (usize, String, Vec<f64>);

/// One row of the table.
struct Reference {
    matrix: DMatrix<f64>,
    derivative: DMatrix<f64>,
    symmetric: Vec<f64>,
    slopes: Vec<f64>,
    eigenvalues: Vec<Complex<f64>>,
}

impl Reference {
    fn of((size, _, numbers): &Row) -> Self {
        let mut cells = numbers.iter().copied();
        let mut take = |count: usize| -> Vec<f64> { cells.by_ref().take(count).collect() };
        let matrix = |entries: Vec<f64>| DMatrix::from_row_slice(STATES, STATES, &entries);
        let (state, derivative) = (matrix(take(STATES * STATES)), matrix(take(STATES * STATES)));
        let [symmetric, slopes] = [take(MOST), take(MOST)].map(|list| list[..*size].to_vec());
        let parts = take(2 * size);
        let eigenvalues = parts.chunks(2).map(|part| Complex::new(part[0], part[1])).collect();
        Self { matrix: state, derivative, symmetric, slopes, eigenvalues }
    }
}

fn table() -> Vec<Row> {
    let text = text("tests/data/closed_groups.csv");
    csv::Reader::from_reader(text.as_bytes()).into_deserialize().map(Result::unwrap).collect()
}

/// What pcc finds: symmetric functions, their derivatives, and the eigenvalues that follow from the former.
fn found(reference: &Reference) -> (Vec<f64>, Vec<f64>, Vec<Complex<f64>>) {
    let solution = Solution::new(reference.matrix.clone(), None).unwrap();
    let spectrum = Spectrum::new(solution.eigenvalues()).unwrap();
    let places = nearest(&reference.eigenvalues, spectrum.eigenvalues());
    let group: Vec<Complex<f64>> = places.into_iter().map(|at| spectrum.eigenvalues()[at]).collect();
    let symmetric = components_of(OutputKind::Closed, &group);
    let slopes = Slopes { state_matrix: std::slice::from_ref(&reference.derivative), second_order: &[] };
    let system = ReducedSystem::new(&solution, slopes, &group).unwrap();
    let slopes = system.differentiate(OutputKind::Closed, &group).unwrap().remove(0);
    let mut roots = vec![Complex::default(); group.len()];
    closed_eigenvalues(&symmetric, group.len() / 2, &mut roots);
    (symmetric, slopes, roots)
}

#[test]
fn symmetric_functions_and_their_derivatives_are_exact_at_and_around_the_meeting_on_the_axis() {
    let table = table();
    assert_eq!(table.len(), 24);
    for row in &table {
        let (size, case, _) = row;
        let reference = Reference::of(row);
        let (symmetric, slopes, _) = found(&reference);
        for (m, (value, exact)) in symmetric.iter().zip(&reference.symmetric).enumerate() {
            let error = (value / exact - 1.0).abs();
            assert!(error < COMPONENTS, "{case} of {size}: e{}, {error:e}", m + 1);
        }
        // A derivative of zero is as exact as the others are.
        let largest = reference.slopes.iter().fold(0.0, |largest: f64, slope| largest.max(slope.abs()));
        for (m, (value, exact)) in slopes.iter().zip(&reference.slopes).enumerate() {
            let error = (value - exact).abs() / if exact.abs() < APART * largest { largest } else { exact.abs() };
            assert!(error < COMPONENTS, "{case} of {size}: de{}, {error:e}", m + 1);
        }
    }
}

#[test]
fn eigenvalues_come_back_to_the_root_of_rounding_where_they_meet_and_exactly_where_they_do_not() {
    for row in table() {
        let (size, case, _) = &row;
        let reference = Reference::of(&row);
        let (.., roots) = found(&reference);
        let tolerance = match (&**case, *size) {
            ("pair" | "reals", _) => APART,
            ("all", size) => ROUNDING.powf(1.0 / size as f64),
            ("near", _) => NEAR,
            _ => ROUNDING.sqrt(),
        };
        for (exact, j) in reference.eigenvalues.iter().zip(nearest(&reference.eigenvalues, &roots)) {
            let error = (roots[j] - exact).norm() / exact.norm();
            assert!(error < tolerance, "{case} of {size}: {} is not {exact}, {error:e}", roots[j]);
        }
    }
}
