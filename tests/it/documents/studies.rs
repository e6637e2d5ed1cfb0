//! Studies that the documents print are valid, and say the defaults where they claim to.

use super::pages::{self, Block, Page};
use pcc_compile::study::Study;
use std::collections::BTreeSet;
use tempfile::TempDir;

const REFERENCE: &str = "docs/reference/study-file.md";

/// The block of the reference with this comment above it.
fn explained(comment: &str) -> String {
    let found = Page::read(REFERENCE).blocks().into_iter().find(|block| block.comments == [comment]);
    found.unwrap_or_else(|| panic!("{REFERENCE} has no block with the comment {comment}")).text
}

fn bare(target: &str) -> Study {
    Study::from_toml(&format!(
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
    .unwrap()
}

#[test]
fn the_explained_studies_show_the_defaults() {
    for target in ["invariants", "eigenvalues"] {
        let explained = Study::from_toml(&explained(&format!("shows the defaults: {target}"))).unwrap();
        let bare = bare(target);
        assert_eq!(explained.seed, bare.seed);
        assert_eq!(explained.design, bare.design);
        assert_eq!(explained.fit, bare.fit);
        assert_eq!(explained.inputs, bare.inputs);
    }
}

/// The fits of full expansions, each beside the same study with what chooses it alone.
#[test]
fn the_explained_full_expansions_show_the_defaults() {
    let study = explained("shows the defaults: eigenvalues");
    let study = study.split("[design]").next().unwrap();
    let chosen = [r#"method = "gpc""#, r#"method = "gpc", solver = "least-squares""#, r#"method = "me-gpc""#];
    for keys in chosen {
        let explained = explained(&format!("shows the defaults of: {keys}"));
        let explained = Study::from_toml(&format!("{study}{explained}")).unwrap();
        let bare = format!("{study}[fit]\n{}\n", keys.replace(", ", "\n"));
        assert_eq!(Study::from_toml(&bare).unwrap(), explained);
    }
}

/// All blocks of this language with their pages.
fn blocks(language: &str) -> Vec<(String, Block)> {
    let of = |page: Page| page.blocks().into_iter().map(move |block| (page.path.clone(), block));
    pages::all().into_iter().flat_map(of).filter(|(_, block)| block.language == language).collect()
}

/// Whole studies are read as they stand there, but for those below `<!-- not valid -->`. Matrices are built.
#[test]
fn printed_studies_are_valid() {
    let mut kinds = BTreeSet::new();
    let is_study =
        |block: &Block| block.text.starts_with("format = 1") && !block.comments.contains(&"not valid".to_owned());
    for (path, block) in blocks("toml").into_iter().filter(|(_, block)| is_study(block)) {
        let tables = tables_of(&path);
        let study = Study::from_toml_in(&block.text, tables.path());
        let study = study.unwrap_or_else(|error| panic!("{path}: {}{error}", block.text));
        kinds.insert(study.model.kind());
        if study.model.kind() == "matrices" {
            pcc_compile::compilation::build(&study, &pcc_evaluate::foundation::Silent).unwrap();
        }
    }
    assert_eq!(
        kinds.into_iter().collect::<Vec<_>>(),
        ["clutch", "command", "function", "matrices", "table", "um-bridge"]
    );
}

/// A folder with the tables that a page shows.
fn tables_of(page: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (_, block) in blocks("csv").into_iter().filter(|(path, _)| path == page) {
        if let Some(name) = block.comments.iter().find_map(|comment| comment.strip_prefix("file: ")) {
            std::fs::write(folder.path().join(name), &block.text).unwrap();
        }
    }
    folder
}

/// Tables that a page adds to a study are read behind one that has none of them.
#[test]
fn printed_tables_of_the_spectrum_are_valid() {
    let study = r#"
        format = 1
        name = "oscillators"
        [model]
        kind = "matrices"
        M = { diagonal = [1, 1, 1, 1, 1] }
        K = { diagonal = ["k", 2, 3, 4, 5] }
        [inputs]
        k = { distribution = "uniform", lower = 0.5, upper = 0.6 }
    "#;
    let parts: Vec<_> =
        blocks("toml").into_iter().filter(|(_, block)| block.text.trim_start().starts_with("[spectrum]")).collect();
    assert!(parts.len() >= 4, "margin, noise, modes, frequencies");
    for (path, block) in parts {
        Study::from_toml(&format!("{study}{}", block.text)).unwrap_or_else(|error| panic!("{path}: {error}"));
    }
}
