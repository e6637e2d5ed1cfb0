//! Nothing that was recorded is lost or run again, whatever is killed and when.
#![cfg(unix)]

use crate::support::command::output;
use pcc_compile::campaign::journal::{Contents, Journal, RunOutcome};
use std::collections::HashSet;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// Twenty between one kill and the next, more than are at work at once: no build ends before it is killed.
const RUNS: usize = 1000;
const JOBS: usize = 12;
const KILLS: usize = 50;

/// A slow program: it says where it was started, waits, and answers. The inputs are the eigenvalue, so that the shell
/// needs no other program but to wait: starting programs is most of what this test costs. Values are taken with the
/// comma that follows.
const MODEL: &str = r#"#!/bin/sh
{ read -r _; read -r _ mu; read -r _ k; } < params.json
echo "{\"mu\": $mu \"k\": $k}" >> "$PCC_STUDY_DIR/log"
sleep 0.04
echo "{\"eigenvalues\": [[$mu $k]]}" > results.json
"#;

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let study = format!(
        r#"
        format = 1
        name = "killed"
        [model]
        kind = "command"
        command = ["sh", "{{study}}/model.sh"]
        eigenvalues = 1
        jobs = {JOBS}
        [inputs]
        mu = {{ distribution = "uniform", lower = -0.3, upper = 0.2 }}
        k = {{ distribution = "uniform", lower = 1.0, upper = 2.0 }}
        [design]
        kind = "nested-lhs"
        initial = {RUNS}
        maximum = {RUNS}
        [spectrum]
        target = "eigenvalues"
        [fit]
        max_degree = 3
        "#
    );
    fs::write(folder.path().join("study.toml"), study).unwrap();
    fs::write(folder.path().join("model.sh"), MODEL).unwrap();
    folder
}

fn start(folder: &Path) -> Child {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("pcc"));
    command.current_dir(folder).args(["build", "study.toml", "--resume"]);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// Points whose answers are recorded, by the text in which the program is given them.
fn acknowledged(contents: &Contents) -> HashSet<String> {
    let answered = contents.records.iter().filter(|record| matches!(record.outcome, RunOutcome::Answered(_)));
    answered.map(|record| key(record.point[0], record.point[1])).collect()
}

fn key(mu: f64, k: f64) -> String {
    format!("{mu:?} {k:?}")
}

/// Where the program was started, in order; the last line may not be whole.
fn started(folder: &Path) -> Vec<String> {
    let log = fs::read_to_string(folder.join("log")).unwrap_or_default();
    let point = |line: &str| {
        let value: serde_json::Value = serde_json::from_str(line).ok()?;
        Some(key(value["mu"].as_f64()?, value["k"].as_f64()?))
    };
    log.lines().filter_map(point).collect()
}

/// A child of the build, if it has one just now.
fn child_of(build: &Child) -> Option<String> {
    let found = Command::new("pgrep").args(["-n", "-P", &build.id().to_string()]).output().unwrap();
    String::from_utf8(found.stdout).unwrap().lines().next().map(str::to_owned)
}

#[test]
fn killed_builds_and_programs_lose_and_repeat_nothing() {
    let undisturbed = folder();
    output(undisturbed.path(), &["build", "study.toml"]);
    let expected = fs::read(undisturbed.path().join("killed.pcc")).unwrap();

    let folder = folder();
    let (path, journal) = (folder.path(), folder.path().join("killed.journal"));
    let read = || if journal.exists() { Journal::read(&journal).unwrap() } else { Contents::default() };
    // Before each start: how many runs the program had begun, and which were acknowledged.
    let mut starts: Vec<(usize, HashSet<String>)> = Vec::new();
    let (mut killed_builds, mut killed_programs) = (0, 0);
    for kill in 0..KILLS {
        starts.push((started(path).len(), acknowledged(&read())));
        let mut build = start(path);
        // Somewhere in the middle of its share of the runs.
        while acknowledged(&read()).len() < RUNS * kill / KILLS + 1 {
            assert!(build.try_wait().unwrap().is_none(), "the build ended before it was killed");
            sleep(Duration::from_millis(7));
        }
        if kill % 3 == 2 {
            // The run fails, and with it the build; unless it had just ended.
            while build.try_wait().unwrap().is_none() {
                if let Some(program) = child_of(&build) {
                    Command::new("kill").args(["-9", &program]).stderr(Stdio::null()).status().unwrap();
                }
                sleep(Duration::from_millis(20));
            }
            killed_programs += 1;
        } else {
            build.kill().unwrap();
            build.wait().unwrap();
            killed_builds += 1;
        }
        // Programs of a killed build go on; they have begun, and end, before the next build is judged.
        sleep(Duration::from_millis(30));
    }
    let failures = read().records.iter().filter(|record| matches!(record.outcome, RunOutcome::Failed { .. })).count();
    println!("{killed_builds} builds and {killed_programs} programs killed, {failures} failures recorded");
    assert!(failures >= killed_programs && killed_programs >= 10);
    starts.push((started(path).len(), acknowledged(&read())));
    output(path, &["build", "study.toml", "--resume"]);
    assert!(fs::read(path.join("killed.pcc")).unwrap() == expected, "other bytes than those of the undisturbed build");

    let (begun, finally) = (started(path), acknowledged(&read()));
    assert_eq!(finally.len(), RUNS);
    for (first, known) in &starts {
        assert!(known.is_subset(&finally), "an acknowledged run was lost");
        let repeated = begun[*first..].iter().filter(|point| known.contains(*point)).count();
        assert_eq!(repeated, 0, "an acknowledged run was run again");
    }
    let progress: Vec<usize> = starts.iter().map(|(_, known)| known.len()).collect();
    println!("runs acknowledged before each start: {progress:?}; begun in all: {}", begun.len());
    // Each acknowledged run was begun, and those that were killed once more at least.
    assert!(begun.len() >= RUNS && progress.is_sorted());
}
