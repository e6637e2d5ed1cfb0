//! The answer comes first and fits a terminal, and shares near 0 and 1 keep their digits in every face.

use crate::support::command::{output, pcc};
use crate::support::{in_one_line, repository, text};
use std::fs;
use std::path::Path;

/// A folder with the shipped clutch of eight inputs.
fn clutch() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["clutch-r8.pcc", "clutch-r8.toml"] {
        fs::copy(repository("surrogates").join(name), folder.path().join(name)).unwrap();
    }
    folder
}

/// One oscillator with Re λ = x − 1.9999955, x from 0 to 2: unstable in 2.25·10⁻⁶ of all cases on one side.
fn rare() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let study = r#"
        format = 1
        name = "rare"
        [model]
        kind = "matrices"
        A = [["x - 1.9999955", 20], [-20, "x - 1.9999955"]]
        [inputs]
        x = { distribution = "uniform", lower = 0.0, upper = 2.0 }
    "#;
    fs::write(folder.path().join("rare.toml"), study).unwrap();
    output(folder.path(), &["build", "rare.toml"]);
    folder
}

fn widest(text: &str) -> usize {
    text.lines().map(|line| line.chars().count()).max().unwrap_or(0)
}

#[test]
fn the_answer_is_a_sentence_and_takes_twenty_lines() {
    let folder = clutch();
    let text = output(folder.path(), &["eval", "clutch-r8.pcc", "-n", "1e6"]);
    assert!(text.starts_with("clutch-r8 is unstable in 80.0"), "{text}");
    let sentence = text.split("\n\n").next().unwrap().replace('\n', " ");
    for part in ["mode 4 flutters", "Hz", "mu decides"] {
        assert!(sentence.contains(part), "{sentence}");
    }
    assert!(text.lines().count() <= 20 && widest(&text) <= 80, "{text}");
    let sure = text.lines().position(|line| line.contains("verified bound")).unwrap();
    assert!(sure < 15, "{text}");
    assert!(!text.contains("re_c0"), "components are details");
    let report = output(folder.path(), &["eval", "clutch-r8.pcc", "-n", "1e6", "--json"]);
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["verdict"], sentence);
}

#[test]
fn no_line_of_a_report_is_wider_than_eighty_columns() {
    let folder = clutch();
    let commands: [&[&str]; 9] = [
        &["eval", "clutch-r8.pcc", "-n", "1e5", "--details"],
        &[
            "eval",
            "clutch-r8.pcc",
            "-n",
            "1e5",
            "--critical",
            "mu",
            "--quantiles",
            "--histogram",
            "--events",
            "max_re<-1",
        ],
        &["eval", "clutch-r8.pcc", "-n", "1e4", "--sweep", "mu=0:0.5:9"],
        &["eval", "clutch-r8.pcc", "-n", "1e3", "--sweep", "mu=0:0.5:20", "--sweep", "k_p=15.2e6:16.8e6:101"],
        &["inspect", "clutch-r8.pcc", "--details"],
        &["compare", "clutch-r8.pcc", "--study", "clutch-r8.toml", "-n", "500", "--details"],
        &["certify", "clutch-r8.pcc", "--study", "clutch-r8.toml", "--runs", "50", "-o", "certified.pcc"],
        &["reference", "clutch-r8.toml", "-n", "500", "--details"],
        &["build", "few.toml", "-o", "built.pcc", "--details"],
    ];
    let few = format!("{}[design]\nmaximum = 27\n", text("surrogates/clutch-r8.toml"));
    fs::write(folder.path().join("few.toml"), few).unwrap();
    for command in commands {
        let printed = output(folder.path(), command);
        assert!(widest(&printed) <= 80, "{command:?}: {printed}");
    }
    let inspected = output(folder.path(), &["inspect", "certified.pcc"]);
    assert!(widest(&inspected) <= 80, "{inspected}");
}

#[test]
fn a_rare_share_is_told_from_none_in_every_face() {
    let folder = rare();
    let path = folder.path();
    let arguments = ["eval", "rare.pcc", "-n", "2e7", "--events", "flutter"];
    let report: serde_json::Value =
        serde_json::from_str(&output(path, &[&arguments[..], &["--json"]].concat())).unwrap();
    let unstable = report["unstable_proportion"].as_f64().unwrap();
    assert!(unstable > 1e-6 && unstable < 4e-6, "{unstable}");
    let verdict = report["verdict"].as_str().unwrap();
    assert!(verdict.starts_with("rare is unstable in ") && verdict.contains("·10⁻⁶"), "{verdict}");
    let text = output(path, &arguments);
    let facts: Vec<&str> = text.lines().filter(|line| line.starts_with("  ")).collect();
    for name in ["unstable", "sampling interval"] {
        let line = facts.iter().find(|line| line.trim_start().starts_with(name)).unwrap();
        assert!(line.contains("·10⁻"), "{text}");
    }
    assert!(facts.iter().filter(|line| line.trim_start().starts_with("flutter")).all(|line| line.contains("·10⁻")));
    assert!(!text.contains("100.000") && !text.contains(" 0.000 %"), "{text}");
    table_and_chart(path);
    let made = output(path, &["report", "rare.pcc", "-n", "2e7", "-o", "rare.html"]);
    assert!(made.contains("rare.html"), "{made}");
    let page = fs::read_to_string(path.join("rare.html")).unwrap();
    assert!(page.contains("·10⁻⁶") && !page.contains("100.000 %"), "the page tells it from none");
}

/// The points of a sweep, as a table and as a picture.
fn table_and_chart(path: &Path) {
    let sweep = ["eval", "rare.pcc", "-n", "1000", "--sweep", "x=1:1.9:4", "--table", "t.csv", "--chart", "c.svg"];
    let text = output(path, &sweep);
    // 1000 of 1000 are stable, but no more than that is known.
    assert!(text.contains("1 − ") || text.contains("99."), "{text}");
    let chart = fs::read_to_string(path.join("c.svg")).unwrap();
    assert!(chart.contains("unstable, %"), "beside 100 % nothing would be seen");
}

#[test]
fn what_never_happened_is_bounded() {
    let folder = rare();
    let text = output(folder.path(), &["eval", "rare.pcc", "-n", "1000"]);
    let text = in_one_line(&text);
    assert!(text.contains(" rare is never unstable in 1 000 samples (unstable: 0 to 0."), "{text}");
    assert!(text.contains("How often it is unstable is not known; none of "), "{text}");
    let failed = pcc(folder.path(), &["eval", "rare.pcc", "-n", "0"]);
    assert_eq!(failed.status.code(), Some(2));
}

/// A study of this model and these inputs, built in a folder of its own.
fn built(name: &str, model: &str, inputs: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let study = format!("format = 1\nname = \"{name}\"\n[model]\nkind = \"matrices\"\n{model}\n[inputs]\n{inputs}\n");
    fs::write(folder.path().join(format!("{name}.toml")), study).unwrap();
    output(folder.path(), &["build", &format!("{name}.toml")]);
    folder
}

fn eval(folder: &Path, name: &str) -> serde_json::Value {
    serde_json::from_str(&output(folder, &["eval", &format!("{name}.pcc"), "-n", "1e5", "--json"])).unwrap()
}

/// Mode 1 has the frequency k/2π and is unstable below k = 50: at 10 to 50 rad/s, 4.78 Hz on average.
#[test]
fn frequencies_are_those_at_which_modes_flutter() {
    let input = "k = { distribution = \"uniform\", lower = 10.0, upper = 400.0 }";
    let model =
        "A = [[\"0.01*(50 - k)\", \"k\", 0, 0], [\"-k\", \"0.01*(50 - k)\", 0, 0], [0, 0, -1, 900], [0, 0, -900, -1]]";
    let folder = built("trap", model, input);
    let report = eval(folder.path(), "trap");
    let verdict = report["verdict"].as_str().unwrap();
    assert!(verdict.contains("flutters at about 4.7"), "{verdict}");
    let frequency = &report["modes"][0]["flutter_frequency_hz"];
    let largest = frequency["maximum"].as_f64().unwrap();
    assert!((largest - 50.0 / std::f64::consts::TAU).abs() < 0.01, "{frequency}");
    assert!(report["modes"][1]["flutter_frequency_hz"].is_null(), "mode 2 never flutters");
}

/// Where hardly a sample is unstable, nothing is known of what decides: no input is named.
#[test]
fn inputs_are_named_only_where_it_is_known_that_they_decide() {
    let inputs = "a = { distribution = \"uniform\", lower = 0.0, upper = 10.0 }\nb = { distribution = \"uniform\", lower = 0.0, upper = 1.0 }";
    let model = "A = [[\"-10.1 - a\", 10, 0, 0], [-10, \"-10.1 - a\", 0, 0], [0, 0, \"b - 0.99999\", 60], [0, 0, -60, \"b - 0.99999\"]]";
    let rare = built("rare", model, inputs);
    let report = eval(rare.path(), "rare");
    let verdict = report["verdict"].as_str().unwrap();
    assert!(!verdict.contains("decide") || verdict.contains("b decides"), "{verdict}");
    let always = built("always", "A = [[\"1 + a\", 30], [-30, \"1 + a\"]]", inputs.lines().next().unwrap());
    let report = eval(always.path(), "always");
    let verdict = report["verdict"].as_str().unwrap();
    assert!(
        verdict.starts_with("always is unstable everywhere: smallest max Re λ 1.00 1/s, error at most"),
        "{verdict}"
    );
    assert!(!verdict.contains("decide"), "nothing does: {verdict}");
}

/// Marginal below k = 2, where two modes meet: a sweep shows where it is not unstable, as it is never stable.
#[test]
fn sweeps_of_undamped_systems_show_what_is_not_unstable() {
    let inputs = "k = { distribution = \"uniform\", lower = 0.0, upper = 4.0 }";
    let model = "M = [[1, 0], [0, 1]]\nK = [[100, \"k\"], [\"-k\", 104]]";
    let folder = built("undamped", model, inputs);
    let text = output(folder.path(), &["eval", "undamped.pcc", "-n", "1000", "--sweep", "k=0..4:9"]);
    assert!(in_one_line(&text).contains("between 0 % and 100 % of cases are stable or marginal."), "{text}");
}

/// Im λ = √(10¹² − c²/4) differs in its last digits alone, which no number of runs makes a function of.
#[test]
fn what_is_constant_to_rounding_is_no_noise() {
    let inputs = "c = { distribution = \"uniform\", lower = 1.0, upper = 2.0 }\n\
                  g = { distribution = \"uniform\", lower = 0.0, upper = 1.0 }";
    for stiffness in ["1e12", "3e11", "7e12"] {
        let study = format!(
            "format = 1\nname = \"stiff\"\n[model]\nkind = \"matrices\"\nM = [[1, 0], [0, 1]]\n\
             C = [[\"c\", 0], [0, \"2 * (0.3 - g)\"]]\nK = [[{stiffness}, 0], [0, 100]]\n[inputs]\n{inputs}\n"
        );
        let folder = crate::support::studies::folder_with(&study);
        let report =
            crate::support::studies::json(folder.path(), &["build", "study.toml", "-o", "built.pcc", "--quiet"]);
        assert_eq!(report["warnings"], serde_json::json!([]), "{stiffness}");
        assert!(
            report["direct_computations"].as_u64().unwrap() <= 20,
            "{stiffness}: {}",
            report["direct_computations"]
        );
    }
}
