//! Shares that a study names: what the build, its report and comparisons make of them.

use crate::support::command::{output, pcc, refusal};
use crate::support::in_one_line;
use crate::support::studies::{folder_with, json, number};
use pcc_compile::study::Study;
use serde_json::Value;
use std::fs;

/// λ² + (0.2 − f) λ + 100 − k: it flutters for f > 0.2, in a fifth of all cases, and diverges for k > 100, in 2 %.
fn study(fit: &str) -> String {
    format!(
        "format = 1\nname = \"both\"\n[model]\nkind = \"matrices\"\nM = [[1]]\nC = [[\"0.2 - f\"]]\nK = [[\"100 - k\"]]\n\
         [inputs]\nf = {{ distribution = \"uniform\", lower = 0.0, upper = 0.25 }}\nk = {{ distribution = \"uniform\", \
         lower = 51.0, upper = 101.0 }}\n[fit]\n{fit}\n"
    )
}

#[test]
fn the_share_that_is_named_is_minded_and_told() {
    let folder = folder_with(&study("shares = [\"divergence\"]"));
    let path = folder.path();
    let built = json(path, &["build", "study.toml", "-o", "built.pcc", "--quiet"]);
    println!("{} {}", built["smallest_share"], built["direct_computations"]);
    assert_eq!(built["smallest_share"]["name"], "divergence");
    assert!((number(&built, "/smallest_share/share") - 0.02).abs() < 0.002, "{built}");
    assert!(number(&built, "/smallest_share/estimated_error_percent") < 2.0, "{built}");
    assert_eq!(built["warnings"], Value::Array(Vec::new()));
    let eval = json(path, &["eval", "built.pcc", "-n", "100000"]);
    assert_eq!(eval["smallest_share"]["name"], "divergence");
    assert!((number(&eval, "/divergence_proportion") - 0.02).abs() < 0.002);
    let compared = json(path, &["compare", "built.pcc", "--study", "study.toml", "-n", "20000"]);
    let smallest = &compared["smallest_share"];
    assert_eq!(smallest["name"], "divergence");
    assert!((number(smallest, "/model") - 0.02).abs() < 0.005 && number(smallest, "/relative_error_percent") < 2.0);
    // Without a name it is the unstable share, as before.
    fs::write(path.join("plain.toml"), study("")).unwrap();
    let plain = json(path, &["build", "plain.toml", "-o", "plain.pcc", "--quiet"]);
    assert_eq!(plain["smallest_share"]["name"], "unstable");
}

/// The surrogate is that of other inputs' ranges: of its divergence nothing is right.
#[test]
fn max_error_tests_the_share_that_is_named() {
    let folder = folder_with(&study("shares = [\"divergence\"]"));
    let path = folder.path();
    output(path, &["build", "study.toml", "-o", "built.pcc", "--quiet"]);
    let mut surrogate = pcc_evaluate::artifact::read(&path.join("built.pcc")).unwrap().surrogate;
    // e₂ = 100 − k is 0.3 larger.
    let last = surrogate.component_count() - 1;
    let scale = surrogate.components()[last].scale;
    surrogate.expansions[last].coefficients[0] += 0.3 / scale;
    surrogate.self_test = surrogate.make_self_test(surrogate.self_test.points.clone());
    surrogate.save(path.join("wrong.pcc")).unwrap();
    let arguments = ["compare", "wrong.pcc", "--study", "study.toml", "-n", "20000", "--max-error", "5"];
    let compared = pcc(path, &arguments);
    let said = in_one_line(&String::from_utf8(compared.stderr).unwrap());
    assert_eq!(compared.status.code(), Some(1), "{said}");
    assert!(said.contains("the divergence share is off by"), "{said}");
    let right = ["compare", "built.pcc", "--study", "study.toml", "-n", "20000", "--max-error", "5"];
    assert!(pcc(path, &right).status.success());
}

#[test]
fn a_share_of_which_hardly_a_run_is_is_not_known() {
    let folder = folder_with(&(study("shares = [\"flutter\", \"divergence\"]") + "[design]\nmaximum = 11\n"));
    let built = json(folder.path(), &["build", "study.toml", "-o", "built.pcc", "--quiet"]);
    let warnings = built["warnings"].to_string();
    assert!(warnings.contains("the divergence share, 1.9"), "{warnings}");
    assert!(warnings.contains("of 11 model runs were of it; fewer than 3 on either side"), "{warnings}");
    assert_eq!(built["smallest_share"]["estimated_error_percent"], Value::Null);
}

#[test]
fn a_share_that_never_occurs_asks_for_nothing() {
    let rigid = |fit: &str| study(fit).replace("upper = 101.0", "upper = 90.0");
    let folder = folder_with(&rigid("shares = [\"divergence\", \"marginal\"]"));
    fs::write(folder.path().join("plain.toml"), rigid("")).unwrap();
    let named = json(folder.path(), &["build", "study.toml", "-o", "named.pcc", "--quiet"]);
    let plain = json(folder.path(), &["build", "plain.toml", "-o", "plain.pcc", "--quiet"]);
    assert_eq!(named["direct_computations"], plain["direct_computations"]);
    assert_eq!(named["smallest_share"]["name"], "unstable");
    assert_eq!(named["warnings"], plain["warnings"]);
}

#[test]
fn names_that_are_no_shares_are_refused_with_those_that_are() {
    for wrong in ["\"stable\"", "\"unstable\"", "\"Divergence\"", "\"fluttering\""] {
        let folder = folder_with(&study(&format!("shares = [{wrong}]")));
        let said = in_one_line(&refusal(folder.path(), &["build", "study.toml"]));
        assert!(said.contains("fit.shares") && said.contains("\"marginal\", \"flutter\" or \"divergence\""), "{said}");
    }
    for wrong in ["\"divergence\"", "1", "true"] {
        let folder = folder_with(&study(&format!("shares = {wrong}")));
        let said = in_one_line(&refusal(folder.path(), &["build", "study.toml"]));
        assert!(said.contains("shares") && !said.contains("panicked"), "{said}");
    }
    let folder = folder_with(&study("method = \"gpc\"\nshares = [\"divergence\"]"));
    let said = in_one_line(&refusal(folder.path(), &["build", "study.toml"]));
    assert!(said.contains("fit.shares"), "{said}");
}

#[test]
fn named_shares_are_part_of_the_study_and_none_of_the_problem() {
    let [plain, named, twice] = ["", "shares = [\"divergence\"]", "shares = [\"divergence\", \"divergence\"]"]
        .map(|fit| Study::from_toml(&study(fit)).unwrap());
    assert_eq!(plain.problem_hash(), named.problem_hash());
    assert_ne!(plain.study_hash(), named.study_hash());
    assert_eq!(named.study_hash(), twice.study_hash());
    let empty = Study::from_toml(&study("shares = []")).unwrap();
    assert_eq!(empty.study_hash(), plain.study_hash());
}
