//! Regression against an independent implementation: OpenTURNS 1.27 and NumPy on the Ishigami function.

use pcc_compile::fitting::design::Samples;
use pcc_compile::fitting::regression::{ActiveBasis, BasisTables, Response};
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::polynomials::{Family, MultiIndex};
use pcc_evaluate::surrogate::{Expansion, LeaveOut, StopReason};
use serde_json::Value;
use std::f64::consts::PI;

/// Two double-precision solutions of the same least-squares problem.
const RELATIVE: f64 = 1e-10;

fn reference() -> Value {
    serde_json::from_str(&crate::support::text("tests/data/openturns_ishigami.json")).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|entry| entry.as_f64().unwrap()).collect()
}

fn indices(value: &Value) -> Vec<MultiIndex> {
    let index = |row: &Value| MultiIndex::new(numbers(row).into_iter().map(|degree| degree as u16).collect());
    value.as_array().unwrap().iter().map(index).collect()
}

fn tables(reference: &Value) -> (BasisTables, Vec<f64>) {
    let points = reference["x"].as_array().unwrap().iter().flat_map(numbers).map(|x| x / PI).collect();
    let samples = Samples::new(3, points);
    let recurrences = vec![Family::Legendre.recurrence(9); 3];
    (BasisTables::new(&samples, &recurrences, 9), numbers(&reference["y"]))
}

fn fitted<'a>(tables: &'a BasisTables, values: &'a [f64], terms: &[MultiIndex]) -> ActiveBasis<'a> {
    assert!(terms[0].is_constant());
    let variance = Response::of(values, 0.0).variance().unwrap();
    let mut basis = ActiveBasis::constant(tables, Response::of(values, 0.0), variance, 1.0, &Silent).unwrap();
    basis.extend(terms[1..].to_vec()).unwrap();
    assert_eq!(basis.indices(), terms, "no term depends on the others");
    basis
}

fn assert_close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= RELATIVE * b.abs(), "{a} is not {b}");
    }
}

#[test]
fn least_squares_coefficients_equal_openturns() {
    let reference = reference();
    let (tables, values) = tables(&reference);
    let expected = &reference["least_squares"];
    let basis = fitted(&tables, &values, &indices(&expected["multi_indices"]));
    assert_close(&basis.coefficients(), &numbers(&expected["coefficients"]));
}

#[test]
fn leave_one_out_errors_equal_numpy() {
    let reference = reference();
    let (tables, values) = tables(&reference);
    let expected = &reference["leave_one_out"];
    let basis = fitted(&tables, &values, &indices(&expected["multi_indices"]));
    let errors = basis.errors().unwrap();
    let relative = |name: &str| expected[name].as_f64().unwrap();
    assert_close(&[1.0 - errors.s2.unwrap()], &[relative("relative_error")]);
    assert_close(&[1.0 - errors.corrected_s2.unwrap()], &[relative("corrected_relative_error")]);
}

#[test]
fn sobol_indices_equal_numpy() {
    let reference = reference();
    let coefficients = numbers(&reference["leave_one_out"]["coefficients"]);
    let mut terms: Vec<_> =
        indices(&reference["leave_one_out"]["multi_indices"]).into_iter().zip(coefficients).collect();
    terms.sort_by(|a, b| a.0.cmp(&b.0));
    let (indices, coefficients): (Vec<_>, Vec<_>) = terms.into_iter().unzip();
    let expansion = Expansion {
        indices: pcc_evaluate::polynomials::IndexSet::from_sorted(indices).unwrap(),
        coefficients,
        r2: None,
        s2: None,
        corrected_s2: None,
        leave_out: LeaveOut::Row,
        degree: 9,
        stop: StopReason::Accurate,
    };
    let sobol = expansion.sobol_indices().unwrap();
    assert_close(&sobol.first, &numbers(&reference["sobol"]["first"]));
    assert_close(&sobol.total, &numbers(&reference["sobol"]["total"]));
    assert_close(&[expansion.variance()], &[reference["sobol"]["variance"].as_f64().unwrap()]);
}
