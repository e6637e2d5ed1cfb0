//! Inputs of single levels and of measured values: shares against sums over them, files, and what is refused.

use crate::laws::oscillator;
use crate::support::command::{output, refusal};
use crate::support::in_one_line;
use crate::support::studies::{built_from, folder_with, json, number};
use pcc_compile::study::Study;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const LEVELS: &str = "\"discrete\", values = [1.5, 0.5, 1.0], weights = [1.0, 1.0, 2.0]";

fn stable_share(folder: &Path, more: &[&str]) -> f64 {
    number(&json(folder, &[&["eval", "built.pcc", "-n", "200000"], more].concat()), "/stable_proportion")
}

/// Within 4.5 standard errors of what is expected.
#[track_caller]
fn assert_share(found: f64, expected: f64) {
    let error = (expected * (1.0 - expected) / 2e5).sqrt();
    assert!((found - expected).abs() <= 4.5 * error, "{found} for {expected}");
}

#[test]
fn levels_come_as_often_as_they_should() {
    let folder = built_from(&oscillator(&[("x", LEVELS)], 1.1, ""));
    assert_share(stable_share(folder.path(), &[]), 0.75);
    assert_share(stable_share(folder.path(), &["--where", "x=1..1.5"]), 2.0 / 3.0);
    assert_share(stable_share(folder.path(), &["--where", "x=0.9..1.1"]), 1.0);
    assert_share(stable_share(folder.path(), &["--where", "x=1.5"]), 0.0);
    for between in ["x=1.2", "x=1.1..1.4"] {
        let message = in_one_line(&refusal(folder.path(), &["eval", "built.pcc", "-n", "10", "--where", between]));
        assert!(message.contains("x takes single values"), "{message}");
    }
}

/// With a second input that the levels divide: Σ w Φ((1.1 − x)/0.2).
#[test]
fn levels_and_other_inputs_are_judged_together() {
    let folder = built_from(&oscillator(&[("x", LEVELS), ("y", "\"normal\", mean = 0.0, std = 0.2")], 1.1, ""));
    // From scipy.stats.norm.cdf at 3, 0.5 and −2, weighted by 1, 2 and 1.
    assert_share(
        stable_share(folder.path(), &[]),
        0.25 * 0.998650101968 + 0.5 * 0.691462461274 + 0.25 * 0.022750131948,
    );
    let report = json(folder.path(), &["eval", "built.pcc", "-n", "200000"]);
    // Variances 0.125 and 0.04.
    let first = number(&report, "/sensitivity/inputs/0/max_re/first/value");
    assert!((first - 0.125 / 0.165).abs() < 0.01, "{first}");
}

/// A rare variant at which the design has no point: x exp(−x) is above 0.3 at 0.6 and 0.9, and below at 4.
#[test]
fn values_at_the_ends_are_run_however_rare() {
    let levels = "\"discrete\", values = [0.2, 0.4, 0.6, 0.9, 4.0], weights = [10, 10, 10, 10, 1]";
    let upper = "\"discrete\", values = [0.2, 0.4, 0.6, 4.0], weights = [1, 1, 1, 0.16]";
    let lower = "\"discrete\", values = [-0.5, 0.2, 0.4, 0.6, 0.9], weights = [1, 10, 10, 10, 10]";
    for (law, seed, expected) in
        [(levels, 1, 21.0 / 41.0), (levels, 5, 21.0 / 41.0), (upper, 1, 2.16 / 3.16), (lower, 1, 21.0 / 41.0)]
    {
        let study = oscillator(&[("x", law)], 0.3, "").replace("- x", "- x * exp(-x)");
        let folder = built_from(&study.replace("format = 1", &format!("format = 1\nseed = {seed}")));
        assert_share(stable_share(folder.path(), &[]), expected);
        let built = json(folder.path(), &["inspect", "built.pcc"]);
        assert!(number(&built, "/direct_computations") <= 40.0, "{law}");
    }
    let (folder, _) = measured(", column = \"x\", smoothing = \"none\"");
    let rows: String = values().into_iter().chain([6.0]).map(|value| format!("0,{value:?}\n")).collect();
    fs::write(folder.path().join("measured.csv"), format!("part,x\n{rows}")).unwrap();
    output(folder.path(), &["build", "study.toml", "-o", "built.pcc", "--quiet"]);
    let below = values().iter().filter(|value| **value < 1.1).count();
    assert_share(stable_share(folder.path(), &[]), below as f64 / 41.0);
}

/// Values between 0.6 and 1.6, more at the lower end.
fn values() -> Vec<f64> {
    (0..40).map(|k| 0.6 + (f64::from(k) / 39.0).powi(2)).collect()
}

fn measured(keys: &str) -> (TempDir, String) {
    let study = oscillator(&[("x", &format!("\"data\", file = \"measured.csv\"{keys}"))], 1.1, "");
    let folder = folder_with(&study);
    let rows: String = values().iter().enumerate().map(|(at, value)| format!("{at},{value:?}\n")).collect();
    fs::write(folder.path().join("measured.csv"), format!("part,x\n{rows}")).unwrap();
    (folder, study)
}

fn built_from_measured(keys: &str) -> (TempDir, String) {
    let (folder, study) = measured(keys);
    output(folder.path(), &["build", "study.toml", "-o", "built.pcc", "--quiet"]);
    (folder, study)
}

#[test]
fn measured_values_are_drawn_as_they_are() {
    let (folder, _) = built_from_measured(", column = \"x\", smoothing = \"none\"");
    let below = values().iter().filter(|value| **value < 1.1).count();
    assert_share(stable_share(folder.path(), &[]), below as f64 / 40.0);
}

/// The mean of Φ((1.1 − m − (x − m) c)/(h c)), h by Silverman's rule and c = 1/√(1 + h²/s²); from SciPy.
#[test]
fn smoothed_values_have_the_share_of_their_kernels() {
    let (folder, _) = built_from_measured(", column = \"x\"");
    assert_share(stable_share(folder.path(), &[]), SMOOTHED);
    let (folder, _) = built_from_measured(", column = \"x\", lower = 0.5");
    assert!(stable_share(folder.path(), &[]) < SMOOTHED, "what was below the bound has gone");
}

const SMOOTHED: f64 = 0.7056019977352472;

#[test]
fn files_and_printed_studies_keep_levels_and_measured_values() {
    for (keys, law) in [(", column = \"x\"", "data"), (", column = \"x\", smoothing = \"none\", upper = 9.0", "data")] {
        let (folder, study) = built_from_measured(keys);
        let path = folder.path();
        output(path, &["convert", "built.pcc", "there.json"]);
        output(path, &["convert", "there.json", "back.pcc"]);
        assert_eq!(fs::read(path.join("built.pcc")).unwrap(), fs::read(path.join("back.pcc")).unwrap());
        let shown = in_one_line(&output(path, &["inspect", "built.pcc"]));
        assert!(shown.contains(law) && shown.contains("count 40"), "{shown}");
        // What decides can be asked without the table.
        fs::remove_file(path.join("measured.csv")).unwrap();
        stable_share(path, &[]);
        let message = in_one_line(&refusal(path, &["build", "study.toml"]));
        assert!(message.contains("inputs.x.file: measured.csv cannot be read"), "{message}");
        let (folder, _) = measured(keys);
        let first = Study::from_toml_in(&study, folder.path()).unwrap();
        let again = Study::from_toml_in(&first.to_toml(), folder.path()).unwrap();
        assert_eq!((again.problem_hash(), again.study_hash()), (first.problem_hash(), first.study_hash()));
        let text = fs::read_to_string(path.join("there.json")).unwrap();
        for (from, to) in [("\"count\"", "\"number\""), ("8.5,", "8.4,"), ("\"own\"", "\"hermite\"")] {
            let changed = text.replacen(from, to, 1);
            assert_ne!(changed, text, "{from}");
            fs::write(path.join("bad.json"), changed).unwrap();
            refusal(path, &["inspect", "bad.json"]);
        }
    }
    let study = oscillator(&[("x", LEVELS)], 1.1, "");
    let first = Study::from_toml(&study).unwrap();
    let again = Study::from_toml(&first.to_toml()).unwrap();
    assert_eq!((again.problem_hash(), again.study_hash()), (first.problem_hash(), first.study_hash()));
    let folder = built_from(&study);
    output(folder.path(), &["convert", "built.pcc", "there.json"]);
    output(folder.path(), &["convert", "there.json", "back.pcc"]);
    let levels = json(folder.path(), &["inspect", "built.pcc"])["inputs"][0]["levels"].clone();
    let level = |value: f64, proportion: f64| serde_json::json!({ "value": value, "proportion": proportion });
    assert_eq!(levels, serde_json::json!([level(0.5, 0.25), level(1.0, 0.5), level(1.5, 0.25)]));
    let shown = in_one_line(&output(folder.path(), &["inspect", "built.pcc"]));
    assert!(shown.contains("0.5 in 25") && shown.contains("1 in 50"), "{shown}");
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(bytes("built.pcc"), bytes("back.pcc"));
}

/// Files of levels of any weights and of values with outliers are read again.
#[test]
fn what_is_built_is_read_again() {
    for law in [
        "\"discrete\", values = [0.2, 0.5, 1.0], weights = [1.0, 2.0, 5.0]",
        "\"discrete\", values = [1.0, 2.0, 3.0, 4.0], weights = [0.1, 0.2, 0.3, 0.4]",
        "\"discrete\", values = [1.0, 2.0]",
        "\"discrete\", values = [0.2, 1.0], weights = [1.0, 99.0]",
        "\"gamma\", shape = 0.05, scale = 1.0",
        "\"beta\", alpha = 0.05, beta = 0.05",
    ] {
        let folder = built_from(&oscillator(&[("x", law)], 1.1, ""));
        output(folder.path(), &["inspect", "built.pcc", "--check"]);
    }
    let narrow = folder_with(&oscillator(&[("x", "\"gumbel\", location = 1e6, scale = 0.01")], 1.1, ""));
    let message = in_one_line(&refusal(narrow.path(), &["build", "study.toml"]));
    assert!(message.contains("of this gumbel law is 1.3e-8 of the mean, less than double precision"), "{message}");
    let outlier: String =
        (0..50).map(|k| format!("{:?}\n", 1.0 + 0.01 * f64::from(k % 10))).collect::<String>() + "11.0\n";
    let long: String = (1..100).map(|k| format!("{:?}\n", -(1.0 - f64::from(k) / 100.0).ln())).collect();
    for rows in [outlier, long] {
        let folder = folder_with(&oscillator(&[("x", "\"data\", file = \"m.csv\"")], 1.1, ""));
        fs::write(folder.path().join("m.csv"), rows).unwrap();
        output(folder.path(), &["build", "study.toml", "-o", "built.pcc", "--quiet"]);
        output(folder.path(), &["inspect", "built.pcc", "--check"]);
    }
}

#[test]
fn tables_and_levels_that_make_no_sense_are_refused() {
    for (law, expected) in [
        ("\"discrete\", values = [1.0]", "all values are equal"),
        ("\"discrete\", values = [1.0, 1.0]", "all values are equal"),
        ("\"discrete\", values = [1.0, nan]", "must be finite numbers"),
        ("\"discrete\", values = [1.0, 2.0], weights = [1.0]", "2 values and 1 weights"),
        ("\"discrete\", values = [1.0, 2.0], weights = [1.0, 0.0]", "must be positive numbers"),
        ("\"discrete\"", "a discrete law has values"),
        ("\"normal\", mean = 1.0, std = 0.1, file = \"measured.csv\"", "a normal law has mean and std"),
        ("\"data\"", "a data law has file"),
        ("\"data\", lower = 0.0", "cut it off; file is missing"),
        ("\"data\", file = \"measured.csv\", values = [1.0, 2.0]", "values does not belong to it"),
        ("\"data\", file = \"measured.csv\", column = \"x\", weights = [1.0]", "weights does not belong to it"),
        ("\"data\", file = \"measured.csv\"", "has 2 columns; add column = \"part\""),
        ("\"data\", file = \"measured.csv\", column = \"y\"", "no column \"y\"; it has part, x"),
        ("\"data\", file = \"commas.csv\"", "line 2: 1,5 has a decimal comma; write 1.5"),
        ("\"data\", file = \"latin.csv\"", "latin.csv is not UTF-8 text; convert it, as with iconv -f LATIN1"),
        ("\"data\", file = \"words.csv\"", "line 2: \"two\" is no finite number"),
        ("\"data\", file = \"few.csv\"", "there are 9 values, but a law takes at least 10"),
        ("\"data\", file = \"measured.csv\", column = \"x\", lower = 0.7", "0.6 was measured"),
        ("\"data\", file = \"measured.csv\", column = \"x\", smoothing = \"some\"", "choose \"kernel\" or \"none\""),
        ("\"data\", file = \"measured.csv\", column = \"x\", mean = 1.0", "a data law has file"),
    ] {
        let (folder, _) = measured("");
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write("study.toml", &oscillator(&[("x", law)], 1.1, ""));
        write("words.csv", "1.0\ntwo\n");
        write("commas.csv", "x\n1,5\n2,5\n");
        fs::write(folder.path().join("latin.csv"), b"\xfcber\n1.0\n").unwrap();
        write("few.csv", &"x\n".to_owned().chars().chain("1\n2\n3\n4\n5\n6\n7\n8\n9\n".chars()).collect::<String>());
        let message = in_one_line(&refusal(folder.path(), &["build", "study.toml"]));
        assert!(message.contains(expected) && message.contains("inputs.x"), "{law}: {message}");
    }
}

/// Between levels a surrogate is nothing but a polynomial, and the model was asked of something else.
#[test]
fn points_between_levels_are_refused_with_their_neighbours() {
    let folder = built_from(&oscillator(&[("x", LEVELS), ("y", "\"normal\", mean = 0.0, std = 0.2")], 1.1, ""));
    let (smooth, _) = built_from_measured(", column = \"x\"");
    let (single, _) = built_from_measured(", column = \"x\", smoothing = \"none\"");
    let ask = |folder: &Path, points: &[u8], arguments: &[&str]| {
        fs::write(folder.join("in.csv"), points).unwrap();
        in_one_line(&refusal(folder, &[arguments, &["--points", "in.csv", "--out", "out.csv"]].concat()))
    };
    for command in [["eval", "built.pcc"], ["reference", "study.toml"]] {
        let message = ask(folder.path(), b"x,y\n1.5,0.1\n1.2,0.1\n", &command);
        assert!(message.contains("row 2: x = 1.2 is none of its values; next to it are 1.0 and 1.5"), "{message}");
        let message = ask(folder.path(), b"x,y\n0.4,0.1\n", &command);
        assert!(message.contains("row 1: x = 0.4 lies outside [0.5, 1.5]"), "{message}");
        let message = ask(single.path(), b"x\n0.9\n", &command);
        assert!(message.contains("row 1: x = 0.9 is none of its values; next to it are 0.8"), "{message}");
        let message = ask(folder.path(), b"x,y\n1.5,0.1\n1.\xa05,0.1\n", &command);
        assert!(message.contains("in.csv: is not UTF-8 text; convert it"), "{message}");
    }
    let accept = |folder: &Path, points: &str, more: &[&str]| {
        fs::write(folder.join("in.csv"), points).unwrap();
        output(folder, &[&["eval", "built.pcc", "--points", "in.csv", "--out", "out.csv"], more].concat());
    };
    accept(folder.path(), "x,y\n1.5,0.1\n0.5,3\n", &[]);
    accept(folder.path(), "x,y\n1.2,0.1\n", &["--extrapolate"]);
    accept(smooth.path(), "x\n0.9\n", &[]);
}
