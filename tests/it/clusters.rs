//! Clusters of three and of four modes: chains of oscillators with follower forces, whose eigenvalues come from a solve
//! with 40 digits (`tests/data/coupled_oscillators.py`).

use crate::support::text;
use nalgebra::Complex;
use pcc_compile::fitting::design::Samples;
use pcc_compile::fitting::fit::Fitted;
use pcc_compile::fitting::fit::Smooth;
use pcc_compile::fitting::fit::minimum_norm::{self, Previous};
use pcc_compile::fitting::regression::{BasisTables, Response};
use pcc_compile::mechanics::spectrum::{Spectrum, Target, components};
use pcc_evaluate::components::{Output, OutputKind, spectral_abscissa};
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::polynomials::Family;

const INPUTS: usize = 4;
const DEGREE: u16 = 8;

/// Points with their spectra.
struct Set {
    points: Vec<Vec<f64>>,
    spectra: Vec<Spectrum>,
}

/// The rows of one set of a file.
fn set(file: &str, name: &str) -> Set {
    let mut set = Set { points: Vec::new(), spectra: Vec::new() };
    for line in text(&format!("tests/data/{file}.csv")).lines().skip(1) {
        let Some(row) = line.strip_prefix(&format!("{name},")) else { continue };
        let numbers: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        let lambdas: Vec<Complex<f64>> =
            numbers[INPUTS..].chunks(2).map(|part| Complex::new(part[0], part[1])).collect();
        set.points.push(numbers[..INPUTS].to_vec());
        set.spectra.push(Spectrum::new(&lambdas).unwrap());
    }
    assert!(!set.points.is_empty());
    set
}

fn fit(design: &Set, outputs: &[Output]) -> Vec<Fitted> {
    let samples = Samples::new(INPUTS, design.points.concat());
    let recurrences = vec![Family::Legendre.recurrence(DEGREE.into()); INPUTS];
    let tables = BasisTables::new(&samples, &recurrences, DEGREE.into());
    let values: Vec<Vec<f64>> = design.spectra.iter().map(|spectrum| components(outputs, spectrum).unwrap()).collect();
    let settings = Smooth { max_degree: DEGREE, s2_target: 0.999 };
    (0..values[0].len())
        .map(|id| {
            let of_component: Vec<f64> = values.iter().map(|row| row[id]).collect();
            let response = Response::of(&of_component, 0.0);
            minimum_norm::fit(&tables, response, &settings, &Previous::nothing(INPUTS), &Silent).unwrap().0
        })
        .collect()
}

fn predicted_max_re(fitted: &[Fitted], outputs: &[Output], point: &[f64]) -> f64 {
    let recurrence = Family::Legendre.recurrence(DEGREE.into());
    let mut univariate = vec![vec![0.0; usize::from(DEGREE) + 1]; INPUTS];
    univariate.iter_mut().zip(point).for_each(|(values, &xi)| recurrence.evaluate(xi, values));
    let value = |fit: &Fitted| -> f64 {
        let terms = fit.indices.iter().zip(&fit.coefficients);
        terms.map(|(alpha, c)| c * (0..INPUTS).map(|j| univariate[j][usize::from(alpha[j])]).product::<f64>()).sum()
    };
    let values: Vec<f64> = fitted.iter().map(value).collect();
    let mut eigenvalues = Vec::new();
    outputs.iter().for_each(|output| output.recombine(&values, &mut eigenvalues));
    spectral_abscissa(&eigenvalues)
}

/// Root mean square error of max Re λ, and points on whose stability surrogate and truth disagree.
fn errors(target: Target, file: &str) -> (f64, usize) {
    let (design, test) = (set(file, "design"), set(file, "test"));
    let modes: Vec<usize> = (1..=design.spectra[0].count()).collect();
    let outputs = target.outputs(&modes, &design.spectra).unwrap();
    let fitted = fit(&design, &outputs);
    let pairs: Vec<(f64, f64)> = test
        .points
        .iter()
        .zip(&test.spectra)
        .map(|(point, spectrum)| (predicted_max_re(&fitted, &outputs, point), spectrum.max_re()))
        .collect();
    let square = pairs.iter().map(|(found, truth)| (found - truth).powi(2)).sum::<f64>() / pairs.len() as f64;
    (square.sqrt(), pairs.iter().filter(|(found, truth)| (*found < 0.0) != (*truth < 0.0)).count())
}

#[test]
fn neighbours_that_coalesce_form_one_cluster_and_the_far_mode_stays_single() {
    for (file, size) in [("three_modes", 3), ("four_modes", 4)] {
        let design = set(file, "design");
        let modes: Vec<usize> = (1..=size + 1).collect();
        let outputs = Target::Invariants.outputs(&modes, &design.spectra).unwrap();
        let kinds: Vec<_> = outputs.iter().map(|output| (output.kind, output.modes.clone())).collect();
        assert_eq!(kinds, [(OutputKind::Cluster, modes[..size].to_vec()), (OutputKind::Eigenvalue, vec![size + 1])]);
    }
}

#[test]
fn invariants_of_three_and_four_modes_are_smooth_where_eigenvalues_are_not() {
    for file in ["three_modes", "four_modes"] {
        let (rough, rough_misclassified) = errors(Target::Eigenvalues, file);
        let (smooth, misclassified) = errors(Target::Invariants, file);
        assert!(smooth < 0.01 * rough, "{file}: {smooth} against {rough} 1/s");
        assert!(misclassified <= 1 && rough_misclassified > 40, "{file}: {misclassified}, {rough_misclassified}");
    }
}

/// At points within 10⁻⁴ of an exceptional point the exact invariants give max Re λ to the root of their rounding.
#[test]
fn recombination_holds_at_coalescence() {
    for (file, size) in [("three_modes", 3), ("four_modes", 4)] {
        let close = set(file, "coalescence");
        let design = set(file, "design");
        let modes: Vec<usize> = (1..=size + 1).collect();
        let outputs = Target::Invariants.outputs(&modes, &design.spectra).unwrap();
        for spectrum in &close.spectra {
            let mut eigenvalues = Vec::new();
            let values = components(&outputs, spectrum).unwrap();
            outputs.iter().for_each(|output| output.recombine(&values, &mut eigenvalues));
            // A rounding of 1e-16 × 100 rad/s in distances of the same cluster, to the power 1/size.
            let tolerance = 10.0 * (1e-14f64).powf(1.0 / size as f64);
            assert!((spectral_abscissa(&eigenvalues) - spectrum.max_re()).abs() < tolerance, "{file}");
            for (found, &exact) in eigenvalues.iter().zip(spectrum.oscillating()) {
                assert!((found - exact).norm() < tolerance, "{file}: {found} against {exact}");
            }
        }
    }
}
