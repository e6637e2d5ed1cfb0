//! The README's example and study are real: run them and compare.

use crate::support::{repository, text};
use assert_cmd::Command;
use pcc_compile::study::Study;
use std::fs;

/// Blocks fenced with ```language.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let fence = format!("```{language}\n");
    page.split(&fence).skip(1).map(|rest| rest.split("```").next().unwrap().to_owned()).collect()
}

/// A chapter of the README.
fn chapter(title: &str) -> String {
    let readme = text("README.md");
    let found = readme.split("\n## ").find(|chapter| chapter.starts_with(title));
    found.unwrap_or_else(|| panic!("no chapter {title}")).to_owned()
}

/// The study of the user's own model.
fn belt() -> String {
    blocks(&chapter("Your model in five minutes"), "toml").remove(0)
}

/// Without what changes from run to run.
fn without_times(text: &str) -> String {
    let mut kept = String::new();
    for line in text.trim().lines() {
        let stable: Vec<&str> =
            line.split(", ").flat_map(|part| part.split(" in ")).filter(|part| !part.contains(" s")).collect();
        let is_headline = line.contains(", seed ") || line.ends_with(" s");
        kept.push_str(&if is_headline { stable.join(", ") } else { line.to_owned() });
        kept.push('\n');
    }
    kept
}

/// Other processors round otherwise, and the search for a fit can end at another that is as good: decimals agree to a
/// part in a thousand. What depends on the fit itself, its terms, degrees, bytes and residuals, only keeps its form.
/// All else, counts of runs and samples among it, is the same.
fn says_the_same(found: &str, expected: &str) -> bool {
    let depends_on_fit =
        ["re_", "im_", "written to", "  error of max Re"].iter().any(|start| expected.starts_with(start))
            || expected.contains("estimated error");
    let words = |line: &'_ str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let number = |word: &str| word.trim_start_matches('(').parse::<f64>().ok();
    let agree = |(found, expected): (&String, &String)| match (number(found), number(expected)) {
        (Some(a), Some(b)) if depends_on_fit => a.is_finite() && b.is_finite(),
        (Some(a), Some(b)) if expected.contains('.') => (a - b).abs() <= 1e-3 * b.abs(),
        _ => found == expected,
    };
    let (found, expected) = (words(found), words(expected));
    found.len() == expected.len() && found.iter().zip(&expected).all(agree)
}

#[test]
fn the_worked_example_prints_what_it_prints() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("surrogates")).unwrap();
    for file in ["surrogates/clutch-r3.toml", "surrogates/clutch-r8.pcc"] {
        fs::copy(repository(file), folder.path().join(file)).unwrap();
    }
    fs::write(folder.path().join("belt.toml"), belt()).unwrap();
    let example: Vec<String> =
        blocks(&text("README.md"), "console").into_iter().filter(|block| block.starts_with("$ pcc ")).collect();
    assert_eq!(example.len(), 9, "build, eval, compare, certify; build, eval, compare; two sweeps");
    for block in example {
        let (command, expected) = block.split_once('\n').unwrap();
        let output = Command::cargo_bin("pcc")
            .unwrap()
            .current_dir(folder.path())
            .args(command.split_whitespace().skip(2))
            .output()
            .unwrap();
        let found = String::from_utf8(output.stdout).unwrap();
        let (found, expected) = (without_times(&found), without_times(expected));
        assert_eq!(found.lines().count(), expected.lines().count(), "{command}");
        for (found, expected) in found.lines().zip(expected.lines()) {
            assert!(says_the_same(found, expected), "{command}: {found:?} against {expected:?}");
        }
    }
}

#[test]
fn the_explained_study_is_valid_and_shows_the_defaults() {
    for (explained, target) in blocks(&chapter("The study file"), "toml").iter().zip(["invariants", "eigenvalues"]) {
        shows_the_defaults(explained, target);
    }
}

/// The fits of full expansions, each beside the same study without them.
#[test]
fn the_explained_full_expansions_show_the_defaults() {
    let toml = blocks(&chapter("The study file"), "toml");
    assert_eq!(toml.len(), 5, "two studies, three fits");
    let study = toml[1].split("[design]").next().unwrap();
    let bare = ["method = \"gpc\"", "method = \"gpc\"\nsolver = \"least-squares\"", "method = \"me-gpc\""];
    for (explained, bare) in toml[2..].iter().zip(bare) {
        let explained = Study::from_toml(&format!("{study}{explained}")).unwrap();
        assert_eq!(Study::from_toml(&format!("{study}[fit]\n{bare}\n")).unwrap(), explained);
    }
}

/// Studies of models of the user's, in the README and on their own page, are read as they stand there.
#[test]
fn explained_models_are_valid() {
    let five_minutes = blocks(&chapter("Your model in five minutes"), "toml");
    let (before, rest) = five_minutes[0].split_once("[model]").unwrap();
    let inputs = rest.split_once("[inputs]").unwrap().1;
    let program = Study::from_toml(&format!("{before}{}[inputs]{inputs}", five_minutes[1])).unwrap();
    assert_eq!(program.model.kind(), "command");
    let (mut whole, mut parts) = (Vec::new(), 0);
    for block in blocks(&text("docs/MODELS.md"), "toml") {
        if block.starts_with("format = 1") {
            let study = Study::from_toml(&block).unwrap_or_else(|error| panic!("{block}: {error}"));
            whole.push(study.model.kind());
            if study.model.kind() == "matrices" {
                pcc_compile::compilation::build(&study, &pcc_evaluate::foundation::Silent).unwrap();
            }
        } else {
            parts += 1;
        }
    }
    assert_eq!((whole, parts), (vec!["matrices", "command", "table"], 1));
    for block in blocks(&text("docs/CLUSTERS.md"), "toml") {
        assert_eq!(Study::from_toml(&block).unwrap().model.kind(), "command");
    }
}

/// Both come from one run of `pcc reproduce`.
#[test]
fn the_reproduced_table_is_that_of_the_documentation() {
    let (readme, table) = (text("README.md"), text("docs/table2.md"));
    let head = table.lines().find(|line| line.starts_with("| r | method |")).unwrap();
    let rows: Vec<&str> = readme.lines().skip_while(|line| *line != head).take_while(|line| !line.is_empty()).collect();
    assert_eq!(rows.len(), 30, "28 rows below the head");
    assert!(table.contains(&rows.join("\n")));
}

fn shows_the_defaults(explained: &str, target: &str) {
    let study = Study::from_toml(explained).unwrap();
    let bare = Study::from_toml(&format!(
        r#"
        format = 1
        name = "clutch-r2"
        [model]
        kind = "clutch"
        [inputs]
        mu  = {{ distribution = "uniform", lower = 0.0, upper = 0.5 }}
        k_p = {{ distribution = "uniform", nominal = 16e6, spread = 0.05 }}
        [spectrum]
        target = "{target}"
        "#
    ))
    .unwrap();
    assert_eq!(study.seed, bare.seed);
    assert_eq!(study.design, bare.design);
    assert_eq!(study.fit, bare.fit);
    assert_eq!(study.inputs, bare.inputs);
}
