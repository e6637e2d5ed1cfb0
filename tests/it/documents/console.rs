//! Sessions are real: every block ```` ```console ```` is run, and what it shows is what is printed.
//!
//! A block has one or more lines `$ pcc …`, each followed by what it prints. Below `<!-- fails -->` its commands fail,
//! and their messages are shown as well. The blocks of a page are run in order in one temporary folder, which has the
//! `surrogates/` of the repository and the files that the page shows: `<!-- file: NAME -->` above a block saves it,
//! `<!-- append: NAME -->` adds it to the end of the file. With `PCC_UPDATE_DOCUMENTS=1` the pages are given what is
//! printed now.

use super::pages::{self, Page};
use crate::support::repository;
use assert_cmd::Command;
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::thread;

/// Pages whose blocks ```` ```sh ```` have commands of pcc, and why no test of this program runs them.
const NOT_RUN: [(&str, &str); 3] = [
    ("docs/how-to/clusters.md", "need GNU parallel or Slurm; .ci/clusters runs the former"),
    ("docs/how-to/um-bridge.md", "ends at Ctrl-C; python/tests/test_umbridge.py asks it"),
    ("docs/tutorials/program.md", "need Python with NumPy"),
];

/// Commands of a block, each with what stands below it.
fn sessions(page: &Page, text: &str) -> Vec<(String, String)> {
    let mut sessions: Vec<(String, String)> = Vec::new();
    for line in text.lines() {
        if let Some(command) = line.strip_prefix("$ ") {
            sessions.push((command.to_owned(), String::new()));
        } else {
            let (_, shown) = sessions.last_mut().unwrap_or_else(|| panic!("{}: {line:?} has no command", page.path));
            shown.push_str(line);
            shown.push('\n');
        }
    }
    sessions
}

/// Words of a command; quotes, single or double, hold words together.
fn words(command: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (Vec::new(), String::new(), None);
    for c in command.chars() {
        match quote {
            Some(open) if c == open => quote = None,
            None if c == '\'' || c == '"' => quote = Some(c),
            None if c == ' ' => words.push(std::mem::take(&mut word)),
            _ => word.push(c),
        }
    }
    assert_eq!(quote, None, "{command} has an open quote");
    words.push(word);
    words.retain(|word| !word.is_empty());
    words
}

/// What a command prints in a folder, and whether it fails.
fn printed(command: &str, folder: &Path) -> (String, bool) {
    let words = words(command);
    assert_eq!(words[0], "pcc", "{command}: the test runs pcc alone; other commands go into ```sh");
    let mut program = Command::cargo_bin("pcc").unwrap();
    program.current_dir(folder).env("NO_COLOR", "1").env("COLUMNS", "100").args(&words[1..]);
    let output = program.output().unwrap();
    let mut text = String::from_utf8(output.stdout).unwrap();
    if !output.status.success() {
        text.push_str(&String::from_utf8(output.stderr).unwrap());
    }
    (text, !output.status.success())
}

/// Whether a part of a line says how long something took: `0.03 s (37 000 000 per second)`.
fn is_time(part: &str) -> bool {
    let has = |unit: &str| {
        part.match_indices(unit).any(|(at, _)| {
            let (before, after) = (part[..at].chars().last(), part[at + unit.len()..].chars().next());
            before.is_some_and(|c| c.is_ascii_digit()) && !after.is_some_and(char::is_alphabetic)
        })
    };
    part.contains(" per second") || [" ms", " s", " min"].into_iter().any(has)
}

/// Without what changes from run to run.
fn without_times(text: &str) -> String {
    let mut kept = String::new();
    for line in text.trim().lines() {
        let parts = line.split(", ").flat_map(|part| part.split(" in "));
        let stable: Vec<&str> = parts.filter(|part| !is_time(part)).collect();
        kept.push_str(&if is_time(line) { stable.join(", ") } else { line.trim_end().to_owned() });
        kept.push('\n');
    }
    kept
}

/// Other processors round otherwise, and the search for a fit can end at another that is as good: decimals agree to a
/// part in a thousand. What depends on the fit itself, its terms, degrees, bytes and residuals, only keeps its form.
/// All else, counts of runs and samples among it, is the same.
fn says_the_same(found: &str, expected: &str) -> bool {
    let depends_on_fit =
        ["re_", "im_", "written to", "  error of max Re", "  evaluation ", "  self-test ", "  content id "]
            .iter()
            .any(|start| expected.starts_with(start))
            || ["estimated error", " surrogate, format "].iter().any(|part| expected.contains(part));
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

/// What is wrong with what a page shows, if anything.
fn difference(found: &str, expected: &str) -> Option<String> {
    let (found, expected) = (without_times(found), without_times(expected));
    if found.lines().count() != expected.lines().count() {
        return Some(format!("prints\n{found}\nand the page shows\n{expected}"));
    }
    let mut lines = found.lines().zip(expected.lines());
    lines
        .find(|(found, expected)| !says_the_same(found, expected))
        .map(|(found, expected)| format!("prints {found:?}, and the page shows {expected:?}"))
}

/// The studies with their matrices and the binary surrogates, as they are shipped.
fn copy_surrogates(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let to = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy_surrogates(&entry.path(), &to);
        } else if to.extension().is_none_or(|extension| extension != "json") {
            fs::copy(entry.path(), to).unwrap();
        }
    }
}

/// Runs all blocks of a page; returns what is wrong and, for an update, the lines of the page as they should be.
fn run(page: &Page, updates: bool) -> (Vec<String>, Vec<String>) {
    let (mut wrong, mut lines, mut copied) = (Vec::new(), Vec::new(), 0);
    let folder = tempfile::tempdir().unwrap();
    copy_surrogates(&repository("surrogates"), &folder.path().join("surrogates"));
    for block in page.blocks() {
        if let Some(name) = block.comment("file") {
            fs::write(folder.path().join(name), &block.text).unwrap();
        }
        if let Some(name) = block.comment("append") {
            let mut file = OpenOptions::new().append(true).open(folder.path().join(name)).unwrap();
            file.write_all(block.text.as_bytes()).unwrap();
        }
        if block.language != "console" {
            continue;
        }
        lines.extend_from_slice(&page.lines[copied..block.lines.start]);
        copied = block.lines.end;
        let should_fail = block.comments.iter().any(|comment| comment == "fails");
        for (command, shown) in sessions(page, &block.text) {
            let (found, fails) = printed(&command, folder.path());
            if fails != should_fail {
                let what = if fails { "fails" } else { "does not fail, as the page says" };
                wrong.push(format!("{}: {command} {what}:\n{found}", page.path));
            } else if !updates && let Some(difference) = difference(&found, &shown) {
                wrong.push(format!("{}: {command} {difference}", page.path));
            }
            // What differs by times alone stays.
            let kept = if without_times(&found) == without_times(&shown) { shown } else { found };
            lines.push(format!("$ {command}"));
            lines.extend(kept.trim_end().lines().map(|line| line.trim_end().to_owned()));
        }
    }
    lines.extend_from_slice(&page.lines[copied..]);
    (wrong, lines)
}

#[test]
fn sessions_print_what_they_show() {
    let updates = std::env::var_os("PCC_UPDATE_DOCUMENTS").is_some_and(|value| value == "1");
    let pages: Vec<Page> =
        pages::all().into_iter().filter(|page| page.blocks().iter().any(|block| block.language == "console")).collect();
    assert!(pages.len() > 4, "the pages are read");
    // One after the other for an update: the times that they print are then those that a reader will see.
    let results: Vec<_> = if updates {
        pages.iter().map(|page| run(page, updates)).collect()
    } else {
        thread::scope(|scope| {
            let started: Vec<_> = pages.iter().map(|page| scope.spawn(move || run(page, updates))).collect();
            started.into_iter().map(|page| page.join().unwrap()).collect()
        })
    };
    let mut all_wrong = Vec::new();
    for (page, (wrong, lines)) in pages.iter().zip(results) {
        if updates && wrong.is_empty() && lines != page.lines {
            fs::write(repository(&page.path), lines.join("\n") + "\n").unwrap();
        }
        all_wrong.extend(wrong);
    }
    let remedy = "PCC_UPDATE_DOCUMENTS=1 cargo test --test it documents:: writes what is printed now";
    assert!(all_wrong.is_empty(), "{}\n\n{remedy}", all_wrong.join("\n\n"));
}

#[test]
fn commands_that_no_test_runs_have_a_reason() {
    let runs_pcc = |page: &Page| {
        let mut shell = page.blocks().into_iter().filter(|block| block.language == "sh");
        shell.any(|block| block.text.lines().any(|line| line.trim_start().starts_with("pcc ")))
    };
    let found: Vec<String> = pages::all().into_iter().filter(runs_pcc).map(|page| page.path).collect();
    assert_eq!(found, NOT_RUN.map(|(path, _)| path), "use ```console, or give a reason in NOT_RUN");
}
