//! The schema of surrogate files in JSON. Here, and not with the other tests, because a validator takes as long to
//! compile as the evaluator: `cargo test -p pcc-tools`, which `.ci/run` does.

use pcc_evaluate::artifact::schema;
use serde_json::Value;
use std::fs;
use std::path::Path;

#[test]
fn shipped_json_satisfies_the_schema_and_the_schema_is_up_to_date() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let committed = fs::read_to_string(root.join("schemas/surrogate.v1.schema.json")).unwrap();
    assert_eq!(committed, schema());
    let validator = jsonschema::validator_for(&serde_json::from_str(&committed).unwrap()).unwrap();
    let mut seen = 0;
    for entry in fs::read_dir(root.join("surrogates")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let mut instance: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        if let Err(error) = validator.validate(&instance) {
            panic!("{}: {error}", path.display());
        }
        instance["meta"]["surprise"] = 1.into();
        assert!(!validator.is_valid(&instance), "the schema admits no unknown keys");
        seen += 1;
    }
    assert!(seen >= 16, "the shipped surrogates are looked at: {seen}");
}
