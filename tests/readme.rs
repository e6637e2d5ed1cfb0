//! The README's example and study are real: run them and compare.

mod support;

use assert_cmd::Command;
use pcc::study::Study;
use std::fs;
use support::{repository, text};

/// Blocks of the README fenced with ```language.
fn blocks(language: &str) -> Vec<String> {
    let readme = text("README.md");
    let fence = format!("```{language}\n");
    readme.split(&fence).skip(1).map(|rest| rest.split("```").next().unwrap().to_owned()).collect()
}

/// Without what changes from run to run.
fn without_times(text: &str) -> String {
    let mut kept = String::new();
    for line in text.trim().lines() {
        let stable: Vec<&str> =
            line.split(", ").flat_map(|part| part.split(" in ")).filter(|part| !part.contains(" s")).collect();
        let is_headline = line.contains(", seed ");
        kept.push_str(&if is_headline { stable.join(", ") } else { line.to_owned() });
        kept.push('\n');
    }
    kept
}

#[test]
fn the_worked_example_prints_what_it_prints() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("surrogates")).unwrap();
    let study = "surrogates/clutch-r3-eigenvalues.toml";
    fs::copy(repository(study), folder.path().join(study)).unwrap();
    let example: Vec<String> = blocks("console").into_iter().filter(|block| block.starts_with("$ pcc ")).collect();
    assert_eq!(example.len(), 3, "build, eval, compare");
    for block in example {
        let (command, expected) = block.split_once('\n').unwrap();
        let output = Command::cargo_bin("pcc")
            .unwrap()
            .current_dir(folder.path())
            .args(command.split_whitespace().skip(2))
            .output()
            .unwrap();
        let found = String::from_utf8(output.stdout).unwrap();
        assert_eq!(without_times(&found), without_times(expected), "{command}");
    }
}

#[test]
fn the_explained_study_is_valid_and_shows_the_defaults() {
    let explained = &blocks("toml")[0];
    let study = Study::from_toml(explained).unwrap();
    let bare = Study::from_toml(
        r#"
        format = 1
        name = "clutch-r2"
        [model]
        kind = "clutch"
        [inputs]
        mu  = { distribution = "uniform", lower = 0.0, upper = 0.5 }
        k_p = { distribution = "uniform", nominal = 16e6, spread = 0.05 }
        "#,
    )
    .unwrap();
    assert_eq!(study.seed, bare.seed);
    assert_eq!(study.design, bare.design);
    assert_eq!(study.fit, bare.fit);
    assert_eq!(study.inputs, bare.inputs);
}
