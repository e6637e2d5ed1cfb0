//! The fields of JSON that the reference lists are there.

use super::pages::Page;
use crate::support::repository;
use assert_cmd::Command;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

/// Words in code on the page that are no fields.
const NO_FIELDS: [&str; 5] = ["false", "true", "null", "reference", "certify"];

/// They are there only where model runs failed.
const ONLY_AFTER_FAILURES: [&str; 3] = ["unanswered_proportion", "bounds", "withheld"];

/// Headings of the page, each with commands whose documents together have its fields.
const COMMANDS: [(&str, &[&str]); 6] = [
    (
        "build",
        &[
            "build surrogates/clutch-r3.toml -o clutch.pcc",
            "build dependent.toml -o dependent.pcc",
            "build table.toml --data runs.csv --holdout 0.2 -o table.pcc",
        ],
    ),
    (
        "eval and reference",
        &[
            "eval clutch.pcc -n 1e4 --critical mu --events flutter --quantiles --histogram",
            "eval clutch.pcc -n 1e4 --sweep mu=0:0.5:2",
            "build normal.toml -o normal.pcc",
            "eval normal.pcc -n 1e4",
            "eval normal.pcc --points points.csv --out results.csv --interval 0.9",
            "eval dependent.pcc -n 1e4",
        ],
    ),
    ("compare", &["compare dependent.pcc --study dependent.toml -n 1e3"]),
    (
        "certify",
        &["certify clutch.pcc --study surrogates/clutch-r3.toml -m 100", "certify clutch.pcc --target-width 0.01"],
    ),
    ("inspect", &["inspect clutch.pcc", "inspect dependent.pcc"]),
    ("design", &["design table.toml --emit rows.csv"]),
];

/// Makes inputs of the clutch depend on each other.
const DEPENDENCE: &str = r#"
[dependence]
kind = "gaussian-copula"
spearman = [["mu", "k_p", 0.5]]
"#;

/// `design` is for models that something else runs.
const TABLE: &str = r#"
format = 1
name = "table"
[model]
kind = "table"
eigenvalues = 2
[inputs]
speed = { distribution = "uniform", lower = 1.0, upper = 12.0 }
"#;

/// Samples of a normal input lie beyond all runs.
const NORMAL: &str = r#"
format = 1
name = "normal"
[model]
kind = "clutch"
[inputs]
k_p = { distribution = "normal", mean = 16e6, cv = 0.03 }
"#;

fn collect(value: &Value, fields: &mut BTreeSet<String>) {
    match value {
        Value::Object(entries) => {
            for (name, value) in entries {
                fields.insert(name.clone());
                collect(value, fields);
            }
        }
        Value::Array(values) => values.iter().for_each(|value| collect(value, fields)),
        _ => {}
    }
}

fn fields(command: &str, folder: &Path) -> BTreeSet<String> {
    let output = Command::cargo_bin("pcc").unwrap().current_dir(folder).args(command.split(' ')).arg("--json").output();
    let output = output.unwrap();
    let value = serde_json::from_slice(&output.stdout);
    let value = value.unwrap_or_else(|error| panic!("{command}: {error}: {}", String::from_utf8_lossy(&output.stderr)));
    let mut fields = BTreeSet::new();
    collect(&value, &mut fields);
    fields
}

#[test]
fn listed_fields_are_printed() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("surrogates")).unwrap();
    let study = "surrogates/clutch-r3.toml";
    std::fs::copy(repository(study), folder.path().join(study)).unwrap();
    let run = |i: i32| format!("{i},{},30,-2,50\n", f64::from(i) - 6.5);
    let runs = "speed,re_1,im_1,re_2,im_2\n".to_owned() + &(1..=12).map(run).collect::<String>();
    let files = [("table.toml", TABLE), ("normal.toml", NORMAL), ("points.csv", "k_p\n16e6\n"), ("runs.csv", &runs)];
    for (name, content) in files {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    let dependent = std::fs::read_to_string(repository(study)).unwrap() + DEPENDENCE;
    std::fs::write(folder.path().join("dependent.toml"), dependent).unwrap();
    let page = Page::read("docs/reference/json.md").lines.join("\n");
    for (title, commands) in COMMANDS {
        let section = page.split("\n## ").find(|section| section.lines().next() == Some(title)).unwrap();
        // Names in code; a pipe or a space makes it something else.
        let is_name =
            |name: &&str| !name.is_empty() && name.chars().all(|c| c.is_ascii_lowercase() || "_0123456789".contains(c));
        let listed: BTreeSet<&str> = section.split('`').skip(1).step_by(2).filter(is_name).collect();
        assert!(!listed.is_empty(), "{title}");
        let found: BTreeSet<String> = commands.iter().flat_map(|command| fields(command, folder.path())).collect();
        for name in listed.into_iter().filter(|name| !NO_FIELDS.contains(name)) {
            assert!(found.contains(name) || ONLY_AFTER_FAILURES.contains(&name), "{title}: no field {name} is printed");
        }
    }
}
