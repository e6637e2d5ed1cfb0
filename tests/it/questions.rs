//! Questions beyond plain samples, as users type them: conditions, sweeps, events, histograms, samplers, shards.

use crate::support::command::{files, output, refusal};
use crate::support::{in_one_line, repository};
use std::fs;
use std::path::Path;

/// A folder with the shipped surrogates of 3 and 8 inputs.
fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["clutch-r3.pcc", "clutch-r8.pcc"] {
        fs::copy(repository(&format!("surrogates/{name}")), folder.path().join(name)).unwrap();
    }
    folder
}

fn json(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    serde_json::from_str(&output(folder, &[arguments, &["--json"]].concat())).unwrap()
}

macro_rules! assert_output {
    ($name:literal, $text:expr) => {
        insta::with_settings!({filters => vec![
            (r"\d+\.\d+ s", "[time] s"),
            (r"\d[\d ]* per second", "[rate] per second"),
        ]}, { insta::assert_snapshot!($name, $text) });
    };
}

#[test]
fn conditions_events_quantiles_and_histograms_are_shown() {
    let folder = workplace();
    let question = ["eval", "clutch-r3.pcc", "-n", "1e5", "--where", "mu=0.05..0.15,k_p=15.8e6"];
    let asked = ["--events", "max_re<-1,re_4>0", "--quantiles", "0.01,0.5,0.999", "--histogram", "max_re=-2..6:8"];
    assert_output!("conditional", output(folder.path(), &[&question[..], &asked].concat()));
    assert_output!(
        "sobol",
        output(folder.path(), &["eval", "clutch-r3.pcc", "-n", "160000", "--sampler", "sobol"])
            .split("\nmode ")
            .next()
            .unwrap()
    );
}

#[test]
fn sweeps_are_shown_as_tables_and_maps_and_written_as_csv_and_svg() {
    let folder = workplace();
    let line = ["eval", "clutch-r3.pcc", "-n", "4096", "--sweep", "mu=0..0.2:9", "--events", "max_re<-1"];
    let files = ["--table", "line.csv", "--chart", "line.svg"];
    assert_output!("sweep", output(folder.path(), &[&line[..], &files].concat()));
    let map = ["eval", "clutch-r8.pcc", "-n", "1000", "--sweep", "mu=0..0.2:9", "--sweep", "gamma_2=0.76..0.84:33"];
    let files = ["--table", "map.csv", "--chart", "map.svg"];
    assert_output!("map", output(folder.path(), &[&map[..], &files].concat()));
    let rows = |name| csv::Reader::from_path(folder.path().join(name)).unwrap().records().map(Result::unwrap).count();
    assert_eq!((rows("line.csv"), rows("map.csv")), (9, 9 * 33));
    insta::assert_snapshot!("sweep_csv", fs::read_to_string(folder.path().join("line.csv")).unwrap());
    for (name, mark) in [("line.svg", "chart-line"), ("map.svg", "chart-level-9")] {
        let text = fs::read_to_string(folder.path().join(name)).unwrap();
        assert!(text.starts_with("<?xml") && text.contains(mark), "{name}");
    }
    let report = json(folder.path(), &map);
    assert_eq!(report["points"].as_array().unwrap().len(), 9 * 33);
    assert_eq!(report["points"][34]["values"], serde_json::json!([0.025, 0.7625]));
    assert_eq!(report["complete"], true);
}

/// Reports but for what no two runs share.
fn without_time(mut report: serde_json::Value) -> serde_json::Value {
    report["elapsed_seconds"] = serde_json::Value::Null;
    report
}

#[test]
fn merged_shards_print_what_one_evaluation_prints() {
    let folder = workplace();
    let questions: [&[&str]; 3] = [
        &["-n", "100003", "--events", "max_re<-1", "--quantiles", "0.5", "--histogram", "re_4", "--where", "mu=0..0.3"],
        &["-n", "131072", "--sampler", "sobol", "--replicates", "4", "--seed", "7"],
        &["-n", "5000", "--sweep", "mu=0..0.2:5"],
    ];
    for question in questions {
        let eval = [&["eval", "clutch-r3.pcc"], question].concat();
        let whole = json(folder.path(), &eval);
        for shards in [1, 3, 17] {
            let mut names: Vec<String> = Vec::new();
            for shard in 0..shards {
                let (number, name) = (format!("{shard}/{shards}"), format!("{shard}.part"));
                let threads = ["1", "2", "3"][shard % 3];
                let part = ["--shard", &number, "--part", &name, "--threads", threads];
                let said = output(folder.path(), &[&eval[..], &part].concat());
                assert!(said.starts_with(&format!("shard {number}: ")), "{said}");
                names.insert(0, name);
            }
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let merged = json(folder.path(), &[&["merge"], &names[..]].concat());
            assert_eq!(without_time(merged), without_time(whole.clone()), "{question:?} in {shards} shards");
            output(folder.path(), &[&["merge", "--part", "all.part"], &names[..]].concat());
            output(folder.path(), &[&eval[..], &["--part", "whole.part"]].concat());
            let bytes = |name| fs::read(folder.path().join(name)).unwrap();
            assert!(bytes("all.part") == bytes("whole.part"), "{question:?} in {shards} shards");
        }
    }
}

#[test]
fn parts_are_merged_in_stages() {
    let folder = workplace();
    for shard in 0..4 {
        let (number, name) = (format!("{shard}/4"), format!("{shard}.part"));
        output(folder.path(), &["eval", "clutch-r3.pcc", "-n", "1e5", "--shard", &number, "--part", &name]);
    }
    let said = output(folder.path(), &["merge", "2.part", "1.part", "--part", "middle.part"]);
    assert!(said.starts_with("2 parts with 49 152 of 100 000 samples"), "{said}");
    // The shards of more shards than there are chunks are empty, and do no harm.
    for shard in 0..7 {
        let (number, name) = (format!("{shard}/7"), format!("small-{shard}.part"));
        output(folder.path(), &["eval", "clutch-r3.pcc", "-n", "5000", "--shard", &number, "--part", &name]);
    }
    let names: Vec<String> = (0..7).rev().map(|shard| format!("small-{shard}.part")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let small = json(folder.path(), &[&["merge"], &names[..]].concat());
    assert_eq!(without_time(small), without_time(json(folder.path(), &["eval", "clutch-r3.pcc", "-n", "5000"])));
    let whole = json(folder.path(), &["eval", "clutch-r3.pcc", "-n", "1e5"]);
    let merged = json(folder.path(), &["merge", "3.part", "middle.part", "0.part"]);
    assert_eq!(without_time(merged), without_time(whole));
}

#[test]
fn instruction_sets_can_be_chosen_and_change_nothing() {
    let folder = workplace();
    let eval = ["eval", "clutch-r8.pcc", "-n", "20000"];
    let best = without_time(json(folder.path(), &eval));
    for set in pcc_evaluate::foundation::InstructionSet::available() {
        let chosen = json(folder.path(), &[&eval[..], &["--instructions", set.name()]].concat());
        assert_eq!(without_time(chosen), best, "{set:?}");
    }
}

#[test]
fn bad_questions_are_refused_by_name() {
    let folder = workplace();
    let eval = |asked: &[&'static str]| [&["eval", "clutch-r3.pcc", "-n", "1000"], asked].concat();
    let cases = [
        eval(&["--where", "mu=0.1..0.7"]),
        eval(&["--where", "nu=0.1"]),
        eval(&["--where", "mu=0.3..0.1"]),
        eval(&["--where", "mu=low..high"]),
        eval(&["--where", "mu=0.1,mu=0.2"]),
        eval(&["--sweep", "mu=0..0.5:0"]),
        eval(&["--sweep", "mu=0..0.5:1"]),
        eval(&["--sweep", "mu=0..0.9:5"]),
        eval(&["--sweep", "mu=0:0.5"]),
        eval(&["--sweep", "mu=0..0.5:2000", "--sweep", "k_p=15.2e6..16.8e6:2000"]),
        eval(&["--sweep", "mu=0..0.5:5", "--where", "mu=0.1"]),
        eval(&["--sweep", "mu=0..0.5:5", "--histogram", "max_re"]),
        eval(&["--events", "max_re"]),
        eval(&["--events", "re_9<0"]),
        eval(&["--histogram", "speed"]),
        eval(&["--histogram", "max_re=5..1:10"]),
        eval(&["--histogram", "max_re=0..1:0"]),
        eval(&["--quantiles", "0.5,1.5"]),
        eval(&["--replicates", "4"]),
        eval(&["--sampler", "sobol", "--replicates", "1"]),
        eval(&["--sampler", "sobol", "--replicates", "1000000"]),
        eval(&["--sampler", "sobol", "--critical", "mu"]),
        eval(&["--sampler", "sobol", "--replicates", "7"]),
        eval(&["--sampler", "halton"]),
        eval(&["--table", "x.csv"]),
        eval(&["--chart", "x.svg"]),
        eval(&["--sweep", "mu=0..0.5:3", "--chart", "clutch-r3.pcc"]),
        eval(&["--sweep", "mu=0..0.5:3", "--table", "clutch-r8.pcc"]),
        eval(&["--sweep", "mu=0..0.5:3", "--chart", "x.png"]),
        eval(&["--sweep", "mu=0..0.5:3", "--part", "x.part", "--table", "x.csv"]),
        eval(&["--sweep", "mu=0..0.5:1e9"]),
        eval(&["--sweep", "mu=0..0.5:50000", "--sampler", "sobol"]),
        eval(&["--where", "mu=0,1"]),
        eval(&["--shard", "0/3"]),
        eval(&["--shard", "3/3", "--part", "x.part"]),
        eval(&["--shard", "0/0", "--part", "x.part"]),
        eval(&["--shard", "1", "--part", "x.part"]),
        eval(&["--part", "clutch-r3.pcc"]),
        eval(&["--part", "clutch-r8.pcc"]),
        eval(&["--part", "none/x.part"]),
        eval(&["--critical", "mu", "--where", "mu=0.1..0.2"]),
        vec!["eval", "clutch-r3.pcc", "--points", "clutch-r3.pcc", "--out", "x.csv", "--where", "mu=0.1"],
    ];
    let messages: String = cases
        .iter()
        .map(|arguments| format!("── {}\n{}\n", arguments[2..].join(" "), refusal(folder.path(), arguments).trim_end()))
        .collect();
    insta::assert_snapshot!("bad_questions", messages);
    let foreign = if cfg!(target_arch = "x86_64") { "neon" } else { "avx2" };
    assert!(refusal(folder.path(), &eval(&["--instructions", foreign])).contains("this processor has"));
}

#[test]
fn bad_parts_are_refused_by_name() {
    let folder = workplace();
    let evaluate = |surrogate: &str, seed: &str, shard: &str, name: &str| {
        let part = ["-n", "50000", "--seed", seed, "--shard", shard, "--part", name];
        output(folder.path(), &[&["eval", surrogate], &part[..]].concat());
    };
    for (shard, name) in [("0/3", "0.part"), ("1/3", "1.part"), ("2/3", "2.part"), ("0/2", "half.part")] {
        evaluate("clutch-r3.pcc", "1", shard, name);
    }
    evaluate("clutch-r3.pcc", "2", "1/3", "seed.part");
    evaluate("clutch-r8.pcc", "1", "1/3", "other.part");
    output(folder.path(), &["eval", "clutch-r3.pcc", "-n", "50001", "--shard", "1/3", "--part", "more.part"]);
    let bytes = fs::read(folder.path().join("1.part")).unwrap();
    fs::write(folder.path().join("cut.part"), &bytes[..bytes.len() / 2]).unwrap();
    let text = String::from_utf8(bytes.clone()).unwrap();
    fs::write(folder.path().join("newer.part"), text.replacen("\"pcc_part\":2", "\"pcc_part\":3", 1)).unwrap();
    let mut changed = bytes;
    let last = changed.len() - 10;
    changed[last] = b'7';
    fs::write(folder.path().join("changed.part"), changed).unwrap();
    let cases: [&[&str]; 17] = [
        &["merge"],
        &["merge", "none.part"],
        &["merge", "clutch-r3.pcc"],
        &["merge", "0.part", "cut.part", "2.part"],
        &["merge", "0.part", "newer.part", "2.part"],
        &["merge", "0.part", "changed.part", "2.part"],
        &["merge", "0.part", "2.part"],
        &["merge", "0.part", "1.part"],
        &["merge", "1.part", "2.part"],
        &["merge", "0.part", "1.part", "1.part", "2.part"],
        &["merge", "half.part", "1.part", "2.part"],
        &["merge", "0.part", "seed.part", "2.part"],
        &["merge", "0.part", "other.part", "2.part"],
        &["merge", "0.part", "more.part", "2.part"],
        &["merge", "0.part", "1.part", "2.part", "--table", "x.csv"],
        &["merge", "0.part", "1.part", "2.part", "--part", "x.part", "--table", "x.csv"],
        &["inspect", "0.part"],
    ];
    let messages: String = cases
        .iter()
        .map(|arguments| format!("── {}\n{}\n", arguments.join(" "), refusal(folder.path(), arguments).trim_end()))
        .collect();
    // Lengths depend on the version and on digits of moments.
    insta::with_settings!({filters => vec![(r"has \d+ bytes after its first line instead of \d+", "has [n] bytes after its first line instead of [m]")]}, {
        insta::assert_snapshot!("bad_parts", messages);
    });
    let replaced = ["merge", "0.part", "1.part", "2.part", "--part", "0.part"];
    assert!(refusal(folder.path(), &replaced).contains("would replace the file it is made from"));
}

/// Ctrl-C prints what was counted so far, marked as incomplete.
#[cfg(unix)]
#[test]
fn an_interruption_prints_what_was_counted() {
    let folder = workplace();
    // What it prints, and nothing if it had counted nothing yet.
    let interrupt_after = |milliseconds: u64, arguments: &[&str]| {
        let child = std::process::Command::new(assert_cmd::cargo::cargo_bin("pcc"))
            .current_dir(folder.path())
            .args(arguments)
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(milliseconds));
        let sent = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        assert!(sent.success(), "{arguments:?} had ended before");
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{arguments:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    // A busy machine needs longer for the first samples than an idle one, which would count for nothing all that time.
    let interrupt = |arguments: &[&str]| {
        let waits = (0..5).map(|attempt| 400 << attempt);
        let mut printed = waits.map(|milliseconds| interrupt_after(milliseconds, arguments));
        printed.find(|text| !text.is_empty()).unwrap_or_else(|| panic!("{arguments:?} counted nothing"))
    };
    let text = interrupt(&["eval", "clutch-r8.pcc", "-n", "1e13"]);
    assert!(in_one_line(&text).contains("incomplete interrupted after "), "{text}");
    let sobol = interrupt(&["eval", "clutch-r8.pcc", "-n", "16000000000", "--sampler", "sobol"]);
    assert!(in_one_line(&sobol).contains("sobol, not two of 16 replicates of 1 000 000 000 points"), "{sobol}");
    // On an idle machine all samples are there by then, the critical values are not.
    let critical = interrupt(&["eval", "clutch-r8.pcc", "-n", "1e6", "--critical", "mu", "--json"]);
    let critical: serde_json::Value = serde_json::from_str(&critical).unwrap();
    assert!(critical["complete"] == false && critical["critical"].is_null(), "{critical}");
    if critical["samples"] == 1_000_000 {
        assert!(critical["stable_proportion"].is_f64() && critical["requested_samples"] == 1_000_000);
    }
    let report = interrupt(&["eval", "clutch-r8.pcc", "-n", "1e13", "--json", "--quantiles", "0.5"]);
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["complete"], false);
    let (samples, stable) = (report["samples"].as_u64().unwrap(), report["stable_samples"].as_u64().unwrap());
    assert!(samples > 0 && samples < 10_000_000_000_000 && stable > 0 && stable < samples, "{report}");
    let proportion = report["stable_proportion"].as_f64().unwrap();
    assert_eq!(proportion, stable as f64 / samples as f64);
    assert!((0.19..0.21).contains(&proportion));
    // Parts that are not complete are not written.
    let before = files(folder.path());
    let said = interrupt_after(400, &["eval", "clutch-r8.pcc", "-n", "1e13", "--part", "x.part"]);
    assert_eq!((said.as_str(), files(folder.path())), ("", before));
    let sweep =
        interrupt(&["eval", "clutch-r3.pcc", "-n", "1e9", "--sweep", "mu=0..0.5:1000", "--table", "x.csv", "--json"]);
    assert!(sweep.contains("\"complete\": false") && sweep.contains("\"points\": ["), "{sweep}");
    assert!(!folder.path().join("x.csv").exists());
}
