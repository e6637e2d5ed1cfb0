//! What an installed program says about itself: manual pages, completions, and its version. The texts of the help are
//! with the other texts, in `command_line.rs`.

use crate::support::command::{files, output, refusal};
use std::fs;

#[test]
fn manual_pages_are_written_and_renewed_but_replace_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    for _ in 0..2 {
        output(folder.path(), &["man", "pages"]);
    }
    let names = files(&folder.path().join("pages"));
    assert!(names.iter().any(|name| name == "pcc.1") && names.iter().any(|name| name == "pcc-eval.1"), "{names:?}");
    let page = fs::read_to_string(folder.path().join("pages/pcc-eval.1")).unwrap();
    for part in [".TH pcc-eval 1", "\\fBpcc eval\\fR", "--sweep", "pcc eval belt.pcc"] {
        assert!(page.replace("\\-", "-").contains(part), "{part} is missing");
    }
    fs::write(folder.path().join("pages/pcc-eval.1"), "mine").unwrap();
    let message = refusal(folder.path(), &["man", "pages"]);
    assert!(message.contains("pcc-eval.1: exists and was not made by pcc"), "{message}");
}

#[test]
fn completions_know_names_files_and_values() {
    let folder = tempfile::tempdir().unwrap();
    let script = output(folder.path(), &["completions", "zsh"]);
    for part in ["--sampler", "latin-hypercube", "_files", "_files -/", "certify"] {
        assert!(script.contains(part), "{part} is missing");
    }
}

#[test]
fn the_version_tells_what_a_report_of_a_fault_needs() {
    let folder = tempfile::tempdir().unwrap();
    let short = format!("pcc {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(output(folder.path(), &["--version"]), short);
    assert_eq!(output(folder.path(), &["version"]), short);
    for typed in [&["version", "--verbose"][..], &["--version", "--verbose"]] {
        let found = output(folder.path(), &[typed, &["--threads", "3"]].concat());
        assert!(found.starts_with(&short), "{found}");
        for line in [
            "\n  build ",
            "\n  surrogate files   format 1.",
            "portable",
            "\n  threads           3, of ",
            std::env::consts::OS,
        ] {
            assert!(found.contains(line), "{line} is missing: {found}");
        }
    }
}

/// Without a terminal there are no colours, unless they are forced; NO_COLOR wins.
#[test]
fn colours_are_for_terminals() {
    let folder = tempfile::tempdir().unwrap();
    let said = |arguments: &[&str], environment: &[(&str, &str)]| {
        let mut command = assert_cmd::Command::cargo_bin("pcc").unwrap();
        for name in ["NO_COLOR", "CLICOLOR_FORCE", "CLICOLOR"] {
            command.env_remove(name);
        }
        let found =
            command.current_dir(folder.path()).args(arguments).envs(environment.iter().copied()).output().unwrap();
        String::from_utf8([found.stdout, found.stderr].concat()).unwrap()
    };
    for arguments in [&["--help"][..], &["eval"], &["eval", "none.pcc"]] {
        assert!(!said(arguments, &[]).contains('\u{1b}'), "{arguments:?}");
        assert!(said(arguments, &[("CLICOLOR_FORCE", "1")]).contains('\u{1b}'), "{arguments:?}");
        assert!(!said(arguments, &[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")]).contains('\u{1b}'), "{arguments:?}");
    }
}
