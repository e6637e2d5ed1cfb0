//! The program, run as a user would.

use assert_cmd::Command;
use std::ffi::OsString;
use std::fs;
use std::path::Path;

/// Runs `pcc` in a folder.
pub fn pcc(folder: &Path, arguments: &[&str]) -> std::process::Output {
    Command::cargo_bin("pcc").unwrap().current_dir(folder).args(arguments).output().unwrap()
}

/// Standard output of a command that must succeed.
pub fn output(folder: &Path, arguments: &[&str]) -> String {
    let output = pcc(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Names of the files in a folder, sorted.
pub fn files(folder: &Path) -> Vec<OsString> {
    let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    names
}

/// The message of a command that must end with exit code 2, write nothing to standard output and leave no file behind.
pub fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let before = files(folder);
    let output = pcc(folder, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    assert!(output.stdout.is_empty(), "{arguments:?} printed {}", String::from_utf8_lossy(&output.stdout));
    assert_eq!(files(folder), before, "{arguments:?} left something behind");
    String::from_utf8(output.stderr).unwrap()
}
