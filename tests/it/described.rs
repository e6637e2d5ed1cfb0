//! Units and labels of inputs: from the study to the file, to texts and to pictures, without changing a number.

use crate::support::build;
use crate::support::command::{output, refusal};
use pcc_compile::study::Study;
use pcc_evaluate::artifact::{Format, decode, encode};
use pcc_evaluate::surrogate::Surrogate;
use serde_json::{Value, json};
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
fn inspect_and_pages_show_them() {
    let folder = workplace();
    let text = output(folder.path(), &["inspect", "described.pcc"]);
    let table = "\
input  distribution    lower     upper  unit  polynomials  label
mu     uniform             0  0.500000        legendre     friction coefficient
k_n    uniform       1800.00   2400.00  N/m   legendre     contact stiffness
";
    assert!(text.contains(table), "{text}");
    assert!(!output(folder.path(), &["inspect", "plain.pcc"]).contains("unit  "));
    let inputs = |name: &str| {
        let text = output(folder.path(), &["inspect", name, "--json"]);
        let inputs = serde_json::from_str::<Value>(&text).unwrap()["inputs"].take();
        json!([[inputs[0]["unit"], inputs[0]["label"]], [inputs[1]["unit"], inputs[1]["label"]]])
    };
    assert_eq!(inputs("plain.pcc"), json!([[null, null], [null, null]]));
    assert_eq!(inputs("described.pcc"), json!([[null, "friction coefficient"], ["N/m", "contact stiffness"]]));
    output(folder.path(), &["report", "described.pcc", "-n", "1000", "-o", "page.html"]);
    let page = fs::read_to_string(folder.path().join("page.html")).unwrap();
    for shown in [">contact stiffness, N/m<", ">friction coefficient<", "Growth rates over k_n"] {
        assert!(page.contains(shown), "{shown}");
    }
}

#[test]
fn answers_have_units() {
    let folder = workplace();
    let eval =
        |question: &[&str]| output(folder.path(), &[&["eval", "described.pcc", "-n", "1000"][..], question].concat());
    let confined = eval(&["--where", "k_n=1900..2000"]);
    assert!(confined.contains("k_n from 1900 to 2000 N/m"), "{confined}");
    assert!(eval(&["--where", "k_n=1900"]).contains("k_n = 1900 N/m"));
    assert!(eval(&["--where", "mu=0.1..0.2"]).contains("mu from 0.1 to 0.2\n"));
    let critical = eval(&["--critical", "k_n"]);
    assert!(
        critical.contains("critical k_n, N/m: the smallest value") && critical.contains("\nk_n, N/m "),
        "{critical}"
    );
    assert!(critical.contains("\nwhat decides") && critical.contains("\nmu  "), "{critical}");
}

#[test]
fn sweeps_have_units_and_axes_have_labels() {
    let folder = workplace();
    let sweep = |surrogate: &str, question: &[&str]| {
        let table = ["--table", "sweep.csv", "--chart", "sweep.svg"];
        let text = output(folder.path(), &[&["eval", surrogate, "-n", "1000"][..], question, &table].concat());
        let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
        let found = (text, read("sweep.csv"), read("sweep.svg"));
        fs::remove_file(folder.path().join("sweep.csv")).unwrap();
        fs::remove_file(folder.path().join("sweep.svg")).unwrap();
        found
    };
    let one = ["--sweep", "k_n=1800..2400:3", "--where", "mu=0.1..0.2"];
    let (text, table, chart) = sweep("described.pcc", &one);
    assert!(text.contains("\nk_n, N/m  stable"), "{text}");
    assert!(chart.contains(">contact stiffness, N/m<"), "{chart}");
    assert_eq!(table, sweep("plain.pcc", &one).1, "columns and numbers stay");
    let (map, _, chart) = sweep("described.pcc", &["--sweep", "k_n=1800..2400:5", "--sweep", "mu=0..0.5:9"]);
    assert!(map.contains("\nk_n, N/m   stable: 0 to 9 tenths"), "{map}");
    assert!(chart.contains(">contact stiffness, N/m<") && chart.contains(">friction coefficient<"), "{chart}");
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
