//! What is shipped under `surrogates/` and `schemas/`.

use crate::support::{built, repository};
use pcc_evaluate::artifact::{Artifact, Format, decode, encode, read};
use pcc_evaluate::surrogate::Surrogate;
use std::fmt::Write;

/// What is shipped: the clutch by the paper's method and by invariants, and systems by matrices.
fn names() -> impl Iterator<Item = String> {
    let clutches = (1..=8).flat_map(|inputs| ["-eigenvalues", ""].map(|kind| format!("clutch-r{inputs}{kind}")));
    let systems = [
        "clutch-normal-r8",
        "rotor-measured",
        "clutch-matrices",
        "mode-coupling",
        "three-modes",
        "flutter",
        "rotor",
        "block",
    ];
    clutches.chain(systems.map(str::to_owned))
}

fn shipped(name: &str, form: Format) -> Artifact {
    read(&repository(&format!("surrogates/{name}.{}", form.extension()))).unwrap()
}

#[test]
fn rebuilding_finds_what_is_shipped() {
    for name in names() {
        let shipped = shipped(&name, Format::Binary).surrogate;
        built(&name).agrees_with(&shipped).unwrap_or_else(|e| panic!("{name}: {e}"));
    }
}

#[test]
fn binary_and_json_hold_the_same_and_convert_to_each_others_bytes() {
    for name in names() {
        let (binary, json) = (shipped(&name, Format::Binary), shipped(&name, Format::Json));
        assert_eq!(binary.surrogate, json.surrogate);
        assert_eq!(binary.content_id, json.content_id);
        for form in [Format::Binary, Format::Json] {
            let path = repository(&format!("surrogates/{name}.{}", form.extension()));
            let bytes = std::fs::read(path).unwrap();
            let there = encode(&decode(&bytes).unwrap().surrogate, Format::Json).unwrap();
            let back = encode(&decode(&there).unwrap().surrogate, form).unwrap();
            assert_eq!(back, bytes, "{name}, {form:?}");
        }
    }
}

/// Every file agrees with this evaluator where it says what an evaluator must find.
#[test]
fn self_tests_hold() {
    for name in names() {
        let surrogate = shipped(&name, Format::Binary).surrogate;
        assert_eq!(surrogate.self_test.points.len(), 16);
        assert!(pcc_evaluate::evaluation::self_test_difference(&surrogate) <= surrogate.self_test.tolerance);
    }
}

/// Coefficients to six decimals, which no processor's rounding reaches.
fn portable_coefficients(surrogate: &Surrogate) -> String {
    let mut listing = String::new();
    for component in surrogate.components() {
        let expansion = &surrogate.expansions[component.id];
        let _ = writeln!(listing, "{}: degree {}, {}", component.name, expansion.degree, expansion.stop.describe());
        for (alpha, coefficient) in expansion.indices.iter().zip(&expansion.coefficients) {
            let _ = writeln!(listing, "  {:?} {coefficient:.6}", &**alpha);
        }
    }
    listing
}

#[test]
fn fitted_coefficients() {
    for inputs in [1, 2, 4, 8] {
        insta::assert_snapshot!(
            format!("coefficients_r{inputs}"),
            portable_coefficients(built(&format!("clutch-r{inputs}-eigenvalues")))
        );
    }
}

/// The large coefficients of invariants to three digits: they are known better than that, small ones depend on which of
/// several equally good settings the search ends at.
#[test]
fn fitted_coefficients_of_invariants() {
    let surrogate = built("clutch-r2");
    let mut listing = String::new();
    for component in surrogate.components() {
        let expansion = &surrogate.expansions[component.id];
        let _ = writeln!(listing, "{}: scale {}", component.name, component.scale);
        let largest = expansion.variance().sqrt();
        let terms = expansion.indices.iter().zip(&expansion.coefficients);
        for (alpha, coefficient) in terms.filter(|(_, coefficient)| coefficient.abs() > 0.02 * largest) {
            let _ = writeln!(listing, "  {:?} {coefficient:.2e}", &**alpha);
        }
    }
    insta::assert_snapshot!("coefficients_r2_invariants", listing);
}
