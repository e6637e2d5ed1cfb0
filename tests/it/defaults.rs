//! What need not be typed: numbers of samples and runs, and the study where it lies beside the surrogate. What was
//! spelled otherwise in earlier versions is understood.

use crate::support::command::{output, pcc, refusal};
use crate::support::{repository, text};
use std::fs;

/// A folder with the r = 2 surrogate by invariants, and its study under its own name.
fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(repository("surrogates/clutch-r2.toml"), folder.path().join("clutch-r2.toml")).unwrap();
    fs::copy(repository("surrogates/clutch-r2.pcc"), folder.path().join("s.pcc")).unwrap();
    folder
}

fn json(folder: &tempfile::TempDir, arguments: &[&str]) -> serde_json::Value {
    serde_json::from_str(&output(folder.path(), &[arguments, &["--json"]].concat())).unwrap()
}

#[test]
fn numbers_and_studies_have_defaults() {
    let folder = workplace();
    assert_eq!(json(&folder, &["eval", "s.pcc"])["samples"], 1_000_000);
    assert_eq!(json(&folder, &["compare", "s.pcc"])["samples"], 10_000);
    assert_eq!(json(&folder, &["reference", "clutch-r2.toml"])["samples"], 10_000);
    let certificate = &json(&folder, &["certify", "s.pcc", "-o", "c.pcc"])["certificates"][0];
    let runs = |name: &str| certificate[name]["runs"].as_u64().unwrap();
    assert_eq!([runs("outside"), runs("layer"), runs("inside")], [300, 100, 50]);
    assert_eq!(certificate["samples"], 450);
    assert_eq!(json(&folder, &["report", "s.pcc", "-n", "1000"])["compare"], serde_json::Value::Null);
    assert_eq!(json(&folder, &["report", "s.pcc", "-n", "1000", "--runs", "50"])["compare"]["samples"], 50);
}

#[test]
fn the_study_that_was_taken_is_said_unless_all_is_quiet() {
    let folder = workplace();
    let said = |more: &[&str]| {
        let found = pcc(folder.path(), &[&["compare", "s.pcc", "-n", "20"], more].concat());
        assert!(found.status.success());
        String::from_utf8(found.stderr).unwrap()
    };
    let line = "pcc: the study is clutch-r2.toml, of the same problem as s.pcc\n";
    assert_eq!((said(&[]).as_str(), said(&["--json"]).as_str()), (line, line));
    assert_eq!((said(&["--quiet"]), said(&["--study", "clutch-r2.toml"])), (String::new(), String::new()));
}

#[test]
fn a_study_beside_the_surrogate_is_taken_only_if_it_is_the_right_one() {
    let folder = workplace();
    let study = folder.path().join("clutch-r2.toml");
    let mut messages = String::new();
    let other = text("surrogates/clutch-r2.toml").replace("upper = 0.5", "upper = 0.4");
    for content in [Some(other.as_str()), Some("format = 1\n"), None] {
        match content {
            Some(content) => fs::write(&study, content).unwrap(),
            None => fs::remove_file(&study).unwrap(),
        }
        for command in ["certify", "compare"] {
            let message = refusal(folder.path(), &[command, "s.pcc"]);
            messages.push_str(if command == "compare" { &message } else { "" });
        }
    }
    insta::assert_snapshot!("studies_not_taken", messages);
}

#[test]
fn old_spellings_are_understood_and_the_new_one_is_said() {
    let folder = workplace();
    for (arguments, line) in [
        (&["certify", "s.pcc", "-m", "20", "-o", "c.pcc", "--study", "clutch-r2.toml"][..], "-m is now -n"),
        (&["compare", "s.pcc", "--samples", "20", "--study", "clutch-r2.toml"], "--samples is now --runs"),
        (&["reference", "clutch-r2.toml", "--samples=20"], "--samples is now --runs"),
        (&["eval", "s.pcc", "-n", "20", "--sweep", "mu=0:0.2:3"], "mu=0:0.2:3 is now mu=0..0.2:3"),
        (&["eval", "s.pcc", "-n", "20", "--histogram=max_re=-9:9:3"], "max_re=-9:9:3 is now max_re=-9..9:3"),
    ] {
        let found = pcc(folder.path(), arguments);
        assert!(found.status.success(), "{arguments:?}");
        assert_eq!(String::from_utf8(found.stderr).unwrap(), format!("pcc: {line}\n"));
        let quiet = pcc(folder.path(), &[arguments, &["--quiet", "--seed", "2"]].concat());
        assert!(quiet.status.success() && quiet.stderr.is_empty(), "{arguments:?}");
    }
}
