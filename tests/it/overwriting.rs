//! What commands write, where, and what they leave alone.

use crate::support::command::{files, output, pcc, refusal};
use crate::support::{repository, text};
use std::fs;
use std::path::Path;

/// A folder with the r = 2 study by invariants, its surrogate and two points.
fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(repository("surrogates/clutch-r2.toml"), folder.path().join("clutch-r2.toml")).unwrap();
    fs::copy(repository("surrogates/clutch-r2.pcc"), folder.path().join("s.pcc")).unwrap();
    fs::write(folder.path().join("points.csv"), "mu,k_p\n0.25,16e6\n0.0,15.2e6\n").unwrap();
    folder
}

fn said(folder: &Path, arguments: &[&str]) -> String {
    let found = pcc(folder, arguments);
    let message = String::from_utf8(found.stderr).unwrap();
    assert!(found.status.success(), "{arguments:?}: {message}");
    message
}

#[test]
fn a_run_writes_into_a_folder_of_its_own() {
    let folder = workplace();
    let before = files(folder.path());
    let message = said(folder.path(), &["run", "clutch-r2.toml"]);
    assert!(message.starts_with("pcc: results go to the folder clutch-r2-run\n"), "{message}");
    let mut after = files(folder.path());
    after.retain(|name| !before.contains(name));
    assert_eq!(after, ["clutch-r2-run"]);
    assert_eq!(files(&folder.path().join("clutch-r2-run")), ["clutch-r2.pcc"]);
}

/// Tables and pictures are renewed, but nothing else is replaced by them.
#[test]
fn tables_and_pictures_replace_their_own_kind_only() {
    let folder = workplace();
    let sweep = ["eval", "s.pcc", "-n", "100", "--sweep", "mu=0..0.2:3"];
    let points = ["--points", "points.csv", "--out"];
    let commands = [
        [&sweep[..], &["--table"]].concat(),
        [&sweep[..], &["--chart"]].concat(),
        [&["eval", "s.pcc"], &points[..]].concat(),
        [&["reference", "clutch-r2.toml"], &points[..]].concat(),
    ];
    fs::write(folder.path().join("mine.csv"), "time,force\n0,1\n").unwrap();
    fs::write(folder.path().join("mine.svg"), "<svg xmlns=\"http://www.w3.org/2000/svg\"></svg>").unwrap();
    fs::write(folder.path().join("empty.svg"), "").unwrap();
    let of = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let before = ["mine.csv", "mine.svg", "s.pcc", "clutch-r2.toml"].map(of);
    let mut messages = String::new();
    for command in &commands {
        for name in ["mine.csv", "mine.svg", "s.pcc", "clutch-r2.toml"] {
            if command.contains(&"--chart") == name.ends_with(".svg") {
                messages.push_str(&refusal(folder.path(), &[&command[..], &[name]].concat()));
            }
        }
        let own = if command.contains(&"--chart") { "own.svg" } else { "own.csv" };
        for name in [own, own, "empty.svg"] {
            output(folder.path(), &[&command[..], &[name]].concat());
        }
        fs::remove_file(folder.path().join(own)).unwrap();
        fs::write(folder.path().join("empty.svg"), "").unwrap();
    }
    assert_eq!(["mine.csv", "mine.svg", "s.pcc", "clutch-r2.toml"].map(of), before);
    insta::assert_snapshot!("not_replaced", messages);
}

/// Points that somebody has filled answers in are not replaced by points without.
#[test]
fn a_design_replaces_no_answers() {
    let folder = workplace();
    let study = text("surrogates/clutch-r2.toml");
    let inputs = study.split_once("[inputs]").unwrap().1.split("\n[").next().unwrap();
    let table = format!(
        "format = 1\nname = \"t\"\n[model]\nkind = \"table\"\nversion = \"1\"\neigenvalues = 4\n[inputs]{inputs}"
    );
    fs::write(folder.path().join("t.toml"), table).unwrap();
    for _ in 0..2 {
        output(folder.path(), &["design", "t.toml", "--emit", "rows.csv"]);
    }
    let rows = fs::read_to_string(folder.path().join("rows.csv")).unwrap();
    let filled = rows.replacen("run,mu,k_p", "run,mu,k_p,re_1,im_1", 1);
    assert_ne!(filled, rows);
    fs::write(folder.path().join("rows.csv"), &filled).unwrap();
    let message = refusal(folder.path(), &["design", "t.toml", "--emit", "rows.csv"]);
    assert!(message.contains("rows.csv: exists and is no table of run,mu,k_p; name another output"), "{message}");
    assert_eq!(fs::read_to_string(folder.path().join("rows.csv")).unwrap(), filled);
}

#[test]
fn builds_replace_no_certificates_unless_told_to() {
    let folder = workplace();
    let build = ["build", "clutch-r2.toml", "-o", "c.pcc"];
    output(folder.path(), &build);
    output(folder.path(), &build); // nothing is lost: it has none
    output(folder.path(), &["certify", "c.pcc", "-n", "20"]);
    let certified = fs::read(folder.path().join("c.pcc")).unwrap();
    let message = refusal(folder.path(), &build);
    assert_eq!(
        message,
        "pcc: c.pcc: has 1 certificate, which will be lost if the build gives another surrogate; name another output, or \
         pass --replace\n"
    );
    let message = said(folder.path(), &[&build[..], &["--replace"]].concat());
    assert!(message.contains("c.pcc is the same surrogate as before and keeps its certificates"), "{message}");
    assert_eq!(fs::read(folder.path().join("c.pcc")).unwrap(), certified);

    let message = said(folder.path(), &[&build[..], &["--seed", "7", "--replace"]].concat());
    assert!(message.contains("c.pcc is another surrogate than before; its certificates are gone"), "{message}");
    output(folder.path(), &build);

    fs::create_dir(folder.path().join("out")).unwrap();
    fs::write(folder.path().join("out/clutch-r2.pcc"), &certified).unwrap();
    let message = refusal(folder.path(), &["run", "clutch-r2.toml", "-o", "out"]);
    assert!(message.contains("out/clutch-r2.pcc: has 1 certificate"), "{message}");
}
