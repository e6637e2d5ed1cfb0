//! A look at the modes of a model: at one point, and along an input.

use crate::support::command::{output, refusal};
use crate::support::studies::{folder_with, json};
use crate::support::{in_one_line, repository, text};
use serde_json::Value;
use std::fs;

/// Two masses of 1 kg that know nothing of each other: 10 rad/s with damping c, and √k rad/s with −0.2 1/s.
const TWO: &str = "format = 1\nname = \"two\"\n[model]\nkind = \"matrices\"\nM = [[1, 0], [0, 1]]\n\
     C = [[\"c\", 0], [0, -0.4]]\nK = [[100, 0], [0, \"k\"]]\n[inputs]\n\
     c = { distribution = \"uniform\", lower = 0.0, upper = 40.0 }\n\
     k = { distribution = \"uniform\", lower = 25.0, upper = 375.0 }\n";

fn number(value: &Value, pointer: &str) -> f64 {
    value.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} of {value}"))
}

#[test]
fn modes_at_a_point_are_those_of_the_closed_form() {
    let folder = folder_with(TWO);
    let report = json(folder.path(), &["modes", "study.toml", "--at", "c=0.4,k=400"]);
    for (number_of, (re, omega)) in [(-0.2_f64, 10.0_f64), (0.2, 20.0)].into_iter().enumerate() {
        let mode = |field: &str| number(&report, &format!("/modes/{number_of}/{field}"));
        let im = (omega * omega - re * re).sqrt();
        let error = mode("error");
        assert!(error > 0.0 && error < 1e-12, "{error:e}");
        assert!((mode("re") - re).abs() <= error && (mode("im") - im).abs() <= error, "{report}");
        assert!((mode("damping_ratio") + re / omega).abs() < 1e-13);
        assert!((mode("frequency_hz") - im / std::f64::consts::TAU).abs() < 1e-13);
    }
    assert_eq!([&report["modes"][0]["verdict"], &report["modes"][1]["verdict"]], ["stable", "flutter"]);
    let said = "two flutters here with 3.183 Hz: max Re λ 0.2000 1/s.";
    assert_eq!(report["verdict"], said);
    // k leaves its law; the medians are c = 20 and k = 200: the first mode does not oscillate.
    assert_eq!(report["warnings"][0], "k leaves its law here; the model was run all the same");
    let at_medians = json(folder.path(), &["modes", "study.toml"]);
    assert_eq!((number(&at_medians, "/at/0/value"), number(&at_medians, "/at/1/value")), (20.0, 200.0));
    assert!(at_medians.get("warnings").is_none());
    let names: Vec<&str> =
        at_medians["modes"].as_array().unwrap().iter().map(|mode| mode["name"].as_str().unwrap()).collect();
    assert_eq!(names.len(), 3, "a mode, and a double real eigenvalue at −10 1/s: {at_medians}");
}

/// The second frequency passes the first: numbers stay with the masses.
#[test]
fn modes_keep_their_numbers_where_frequencies_cross() {
    let folder = folder_with(TWO);
    let arguments = ["modes", "study.toml", "--at", "c=0.4", "--over", "k=36..324:37", "--table", "modes.csv"];
    let report = json(folder.path(), &arguments);
    for point in report["along"]["points"].as_array().unwrap() {
        let k = number(point, "/value");
        assert!((number(point, "/modes/0/im") - (k - 0.04).sqrt()).abs() < 1e-10, "{point}");
        assert!((number(point, "/modes/1/im") - (100.0_f64 - 0.04).sqrt()).abs() < 1e-10, "{point}");
        assert_eq!(
            (&point["modes"][0]["verdict"], &point["modes"][1]["verdict"]),
            (&"flutter".into(), &"stable".into())
        );
    }
    assert_eq!(report["verdict"], "two over k: flutter at all 37 values.");
    let table = fs::read_to_string(folder.path().join("modes.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("k,re_1,im_1,re_2,im_2,max_re,verdict"));
    assert_eq!((lines.next().unwrap().split(',').next(), table.lines().count()), (Some("36"), 38));
}

#[test]
fn a_mode_that_stops_to_oscillate_has_two_growth_rates() {
    let folder = folder_with(&TWO.replace("-0.4", "0.4"));
    let arguments = ["modes", "study.toml", "--over", "c=0..40:21", "--table", "modes.csv", "--chart", "modes.svg"];
    let text = in_one_line(&output(folder.path(), &arguments));
    assert!(text.contains("two over c: marginal at first, stable from between 0 and 2."), "{text}");
    assert!(text.contains("written to modes.csv written to modes.svg"), "{text}");
    let table = fs::read_to_string(folder.path().join("modes.csv")).unwrap();
    assert!(table.starts_with("c,re_1,im_1,re_1_b,re_2,im_2,max_re,verdict\n"), "{table}");
    for line in table.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let c: f64 = cells[0].parse().unwrap();
        match c > 20.0 {
            false => assert!(cells[3].is_empty() || c == 20.0, "{line}"),
            true => {
                let found = [1, 3].map(|k| cells[k].parse::<f64>().unwrap());
                let root = (c * c / 4.0 - 100.0).sqrt();
                let expected = [-c / 2.0 + root, -c / 2.0 - root];
                assert!(found.iter().zip(expected).all(|(one, other)| (one - other).abs() < 1e-10), "{line}");
            }
        }
    }
    let picture = fs::read_to_string(folder.path().join("modes.svg")).unwrap();
    assert!(picture.contains("Frequencies over c") && picture.contains("Growth rates over c"));
}

/// What `reference` finds at the same points.
#[test]
fn modes_of_shipped_studies_are_those_of_the_reference() {
    for name in ["clutch-r3", "flutter", "rotor"] {
        let study = repository("surrogates").join(format!("{name}.toml"));
        let study = study.to_str().unwrap();
        let folder = folder_with(&text("surrogates/clutch-r2.toml"));
        let report = json(folder.path(), &["modes", study]);
        let inputs = report["at"].as_array().unwrap();
        let names: Vec<&str> = inputs.iter().map(|input| input["name"].as_str().unwrap()).collect();
        let values: Vec<String> = inputs.iter().map(|input| input["value"].as_f64().unwrap().to_string()).collect();
        let points = format!("{}\n{}\n", names.join(","), values.join(","));
        fs::write(folder.path().join("points.csv"), points).unwrap();
        output(folder.path(), &["reference", study, "--points", "points.csv", "--out", "out.csv"]);
        let table = fs::read_to_string(folder.path().join("out.csv")).unwrap();
        let [header, row] = [0, 1].map(|k| table.lines().nth(k).unwrap().split(',').collect::<Vec<_>>());
        let cell = |column: &str| row[header.iter().position(|name| *name == column).unwrap()].parse::<f64>().unwrap();
        let mut compared = 0;
        for mode in report["modes"].as_array().unwrap() {
            let name = mode["name"].as_str().unwrap();
            if header.contains(&format!("im_{name}").as_str()) {
                assert_eq!(number(mode, "/re"), cell(&format!("re_{name}")), "{name} of {report}");
                assert_eq!(number(mode, "/im"), cell(&format!("im_{name}")));
                compared += 1;
            }
        }
        assert!(compared >= 2, "{header:?}");
    }
}

#[test]
fn points_that_are_none_are_refused() {
    let folder = folder_with(TWO);
    for (arguments, expected) in [
        (&["--at", "x=1"][..], "there is no input x: c, k"),
        (&["--at", "c=1..2"], "a point has one value"),
        (&["--at", "c=1,c=2"], "given twice"),
        (&["--at", "c=1", "--over", "c=0..1:3"], "leave one of them out"),
        (&["--over", "x=0..1:3"], "there is no input x"),
        (&["--over", "c=0..1:1"], "at least 2 points"),
        (&["--over", "c=0..1:1000000"], "more than 5000"),
        (&["--chart", "m.svg"], "--over"),
        (&["--over", "c=0..1:3", "--table", "study.toml"], "would replace"),
    ] {
        let error = refusal(folder.path(), &[&["modes", "study.toml"], arguments].concat());
        assert!(error.contains(expected), "{arguments:?}: {error}");
    }
}
