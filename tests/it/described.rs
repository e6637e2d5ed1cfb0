//! Units and labels of inputs: from the study to the file, to texts and to pictures, without changing a number.

use crate::support::build;
use crate::support::command::{output, refusal};
use pcc_compile::study::Study;
use pcc_evaluate::artifact::{Format, decode, encode};
use pcc_evaluate::surrogate::Surrogate;
use std::fs;

const PLAIN: &str = r#"
format = 1
name = "belt"
[model]
kind = "matrices"
M = [[2, 0], [0, 2]]
C = [[2, 0], [0, 2]]
K = [[3000, "500 - mu*k_n"], [500, "1000 + k_n"]]
[inputs]
mu = { distribution = "uniform", lower = 0.0, upper = 0.5 }
k_n = { distribution = "uniform", lower = 1800.0, upper = 2400.0 }
"#;

/// The same study with a unit and two labels.
fn described() -> String {
    PLAIN
        .replace("upper = 0.5", "upper = 0.5, label = \"friction coefficient\"")
        .replace("upper = 2400.0", "upper = 2400.0, unit = \"N/m\", label = \"contact stiffness\"")
}

pub fn surrogate() -> Surrogate {
    build(&Study::from_toml(&described()).unwrap())
}

/// A folder with both studies and their surrogates.
fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, study) in [("plain", PLAIN.to_owned()), ("described", described())] {
        let study_file = format!("{name}.toml");
        fs::write(folder.path().join(&study_file), study).unwrap();
        output(folder.path(), &["build", &study_file, "-o", &format!("{name}.pcc")]);
    }
    folder
}

#[test]
fn they_change_no_number_and_no_identity() {
    let (plain, described) = (build(&Study::from_toml(PLAIN).unwrap()), surrogate());
    assert_eq!(Surrogate { inputs: plain.inputs.clone(), ..described.clone() }, plain);
    let ids = [&plain, &described].map(|one| decode(&encode(one, Format::Binary).unwrap()).unwrap().content_id);
    assert_eq!(ids[0], ids[1]);
}

#[test]
fn surrogates_and_studies_with_and_without_them_belong_together() {
    let folder = workplace();
    let (plain, described) = (["plain.pcc", "plain.toml"], ["described.pcc", "described.toml"]);
    for (surrogate, study) in [(plain[0], described[1]), (described[0], plain[1])] {
        output(folder.path(), &["compare", surrogate, "--study", study, "-n", "100"]);
        output(folder.path(), &["certify", surrogate, "--study", study, "-n", "100"]);
    }
    output(folder.path(), &["convert", "described.pcc", "described.json"]);
    output(folder.path(), &["convert", "described.json", "again.pcc"]);
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(bytes("again.pcc"), bytes("described.pcc"));
}

#[test]
fn studies_are_shown_with_them() {
    let folder = workplace();
    let shown = output(folder.path(), &["build", "described.toml", "--show-study"]);
    let line = "k_n = { distribution = \"uniform\", lower = 1800.0, upper = 2400.0, unit = \"N/m\", label = \"contact stiffness\" }";
    assert!(shown.contains(line), "{shown}");
}

#[test]
fn texts_that_cannot_be_shown_are_refused_with_key_and_line() {
    let folder = tempfile::tempdir().unwrap();
    for (given, expected) in [
        ("unit = \"\"", "unit: is empty; write a text, or remove the key"),
        (
            "label = \"a\\nb\"",
            "label: has control characters, like line breaks and tabs; write it in one line without them",
        ),
        ("unit = \"kilogrammes per square metre and per second\"", "unit: has 43 characters; write at most 40"),
    ] {
        let study = PLAIN.replace("upper = 2400.0", &format!("upper = 2400.0, {given}"));
        fs::write(folder.path().join("study.toml"), study).unwrap();
        let message = refusal(folder.path(), &["build", "study.toml"]);
        assert_eq!(message, format!("pcc: study.toml: line 11: inputs.k_n.{expected}\n"));
    }
}
