//! What is shipped under `surrogates/` and `schemas/`.

mod support;

use pcc::artifact::{Artifact, Format, decode, encode, read, schema};
use pcc::surrogate::Surrogate;
use std::fmt::Write;
use support::{build, repository, shipped_study, text};

fn shipped(inputs: usize, form: Format) -> Artifact {
    let path = format!("surrogates/clutch-r{inputs}-eigenvalues.{}", form.extension());
    read(&repository(&path)).unwrap()
}

#[test]
fn rebuilding_finds_the_shipped_index_sets_and_coefficients() {
    for inputs in 1..=8 {
        let rebuilt = build(&shipped_study(inputs));
        rebuilt.agrees_with(&shipped(inputs, Format::Binary).surrogate).unwrap_or_else(|e| panic!("r = {inputs}: {e}"));
    }
}

#[test]
fn binary_and_json_hold_the_same_and_convert_to_each_others_bytes() {
    for inputs in 1..=8 {
        let (binary, json) = (shipped(inputs, Format::Binary), shipped(inputs, Format::Json));
        assert_eq!(binary.surrogate, json.surrogate);
        assert_eq!(binary.content_id, json.content_id);
        for form in [Format::Binary, Format::Json] {
            let path = repository(&format!("surrogates/clutch-r{inputs}-eigenvalues.{}", form.extension()));
            let bytes = std::fs::read(path).unwrap();
            let there = encode(&decode(&bytes).unwrap().surrogate, Format::Json).unwrap();
            let back = encode(&decode(&there).unwrap().surrogate, form).unwrap();
            assert_eq!(back, bytes, "r = {inputs}, {form:?}");
        }
    }
}

#[test]
fn shipped_json_satisfies_the_schema_and_the_schema_is_up_to_date() {
    let committed = text("schemas/surrogate.v1.schema.json");
    assert_eq!(committed, schema());
    let validator = jsonschema::validator_for(&serde_json::from_str(&committed).unwrap()).unwrap();
    for inputs in 1..=8 {
        let file = text(&format!("surrogates/clutch-r{inputs}-eigenvalues.json"));
        let mut instance: serde_json::Value = serde_json::from_str(&file).unwrap();
        if let Err(error) = validator.validate(&instance) {
            panic!("r = {inputs}: {error}");
        }
        instance["meta"]["surprise"] = 1.into();
        assert!(!validator.is_valid(&instance), "the schema admits no unknown keys");
    }
}

/// Every file agrees with this evaluator where it says what an evaluator must find.
#[test]
fn self_tests_hold() {
    for inputs in 1..=8 {
        let surrogate = shipped(inputs, Format::Binary).surrogate;
        assert_eq!(surrogate.self_test.points.len(), 16);
        assert!(pcc::eval::self_test_difference(&surrogate) <= surrogate.self_test.tolerance);
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
            portable_coefficients(&build(&shipped_study(inputs)))
        );
    }
}
