//! Models that are programs: answers, failures, journals, tables, and names that try to be more than names.
#![cfg(unix)]

use crate::support::command::{output, pcc, refusal};
use crate::support::in_one_line;
use pcc_compile::campaign::journal::{Journal, RunOutcome};
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Two modes, one of which grows from mu = 0.3 on. Every run leaves its point in a log beside the study.
const MODEL: &str = r#"#!/bin/sh
echo "$(tr -d '\n' < params.json)" >> "$PCC_STUDY_DIR/log"
[ -f "$PCC_STUDY_DIR/before.sh" ] && . "$PCC_STUDY_DIR/before.sh"
awk '
    { gsub(/[{}" ]/, ""); n = split($0, parts, ","); for (i = 1; i <= n; i++) { split(parts[i], pair, ":"); value[pair[1]] = pair[2] } }
    END {
        mu = value["mu"]; k = value["k"]
        printf "{\"eigenvalues\": [[%.17g, %.17g], [%.17g, %.17g]]}\n", -0.1*k*mu - 0.1, sqrt(k), mu - 0.3, 3*sqrt(k) + mu*mu
    }' params.json > results.json
"#;

const STUDY: &str = r#"
format = 1
name = "program"
[model]
kind = "command"
command = ["sh", "{study}/model.sh"]
eigenvalues = 2
jobs = 8
[inputs]
mu = { distribution = "uniform", lower = 0.0, upper = 0.5 }
k = { distribution = "uniform", lower = 1.0, upper = 2.0 }
"#;

/// A folder with a study and its program.
fn folder(study: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("study.toml"), study).unwrap();
    fs::write(folder.path().join("model.sh"), MODEL).unwrap();
    folder
}

/// The points that the program was started at, as it was given them.
fn started(folder: &Path) -> Vec<String> {
    let log = fs::read_to_string(folder.join("log")).unwrap_or_default();
    log.lines().filter(|line| !line.is_empty()).map(str::to_owned).collect()
}

fn stderr(output: &std::process::Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// The surrogate of an undisturbed build.
fn undisturbed() -> Vec<u8> {
    let folder = folder(STUDY);
    output(folder.path(), &["build", "study.toml", "--no-journal"]);
    fs::read(folder.path().join("program.pcc")).unwrap()
}

#[test]
fn programs_are_built_evaluated_and_certified() {
    let folder = folder(STUDY);
    let said = output(folder.path(), &["build", "study.toml"]);
    assert!(said.starts_with("program: 18 model runs (design levels 18)") || said.contains("model runs"), "{said}");
    let runs = started(folder.path()).len();
    let evaluated = output(folder.path(), &["eval", "program.pcc", "-n", "1e5"]);
    let stable: f64 = evaluated
        .lines()
        .find(|line| line.starts_with("  stable"))
        .unwrap()
        .split_whitespace()
        .nth(1)
        .unwrap()
        .parse()
        .unwrap();
    assert!((stable - 60.0).abs() < 0.5, "{evaluated}");
    // No folders are left of runs that went well, and the journal has them all.
    assert!(!folder.path().join("runs").exists());
    let recorded = Journal::read(&folder.path().join("program.journal")).unwrap().records;
    assert_eq!(recorded.len(), runs);
    assert!(recorded.iter().all(|record| record.seconds > 0.0));

    // Runs of a certificate are recorded, too, and used again.
    output(folder.path(), &["certify", "program.pcc", "--study", "study.toml", "-n", "20"]);
    // 20 outside the rare set, 7 in the layer, 50 inside.
    assert_eq!(started(folder.path()).len(), runs + 77);
    output(
        folder.path(),
        &["certify", "program.pcc", "--study", "study.toml", "-n", "20", "-o", "twice.pcc", "--seed", "2"],
    );
    assert_eq!(started(folder.path()).len(), runs + 2 * 77);
    let compared = output(folder.path(), &["compare", "program.pcc", "--study", "study.toml", "-n", "30"]);
    assert!(in_one_line(&compared).contains("misclassified 0 %"), "{compared}");
    output(folder.path(), &["compare", "program.pcc", "--study", "study.toml", "-n", "30", "--resume"]);
    assert_eq!(started(folder.path()).len(), runs + 2 * 77 + 30, "the second comparison ran nothing");
}

#[test]
fn bytes_do_not_depend_on_how_programs_are_run() {
    let expected = undisturbed();
    let batch = MODEL.replace("< params.json", "< points.csv").split("awk '").next().unwrap().to_owned()
        + r#"awk -F, '
    NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; print "im_2,re_2,im_1,re_1,run" }
    NR > 1 {
        mu = $column["mu"]; k = $column["k"]
        rows[NR] = sprintf("%.17g,%.17g,%.17g,%.17g,%d", 3*sqrt(k) + mu*mu, mu - 0.3, sqrt(k), -0.1*k*mu - 0.1, $column["run"])
    }
    END { for (i = NR; i > 1; i--) print rows[i] }' points.csv > results.csv
"#;
    let batched = folder(&STUDY.replace("jobs = 8", "mode = \"batch\""));
    fs::write(batched.path().join("model.sh"), batch).unwrap();
    let one_by_one = folder(&STUDY.replace("jobs = 8", "jobs = 1"));
    for folder in [batched, one_by_one] {
        output(folder.path(), &["build", "study.toml", "--threads", "1"]);
        assert_eq!(fs::read(folder.path().join("program.pcc")).unwrap(), expected);
    }
}

/// What the program does instead of answering at points with mu above 0.25, and keys of the study for it.
const FAILURES: [(&str, &str, &str); 8] = [
    ("NaN", "echo '{\"eigenvalues\": [[NaN, 1], [0, 2]]}' > results.json; exit 0", ""),
    ("too few numbers", "echo '{\"eigenvalues\": [[-0.5, 1]]}' > results.json; exit 0", ""),
    ("a pair cut short", "echo '{\"eigenvalues\": [[-0.5, 1], [2]]}' > results.json; exit 0", ""),
    ("text", "echo 'Solution converged.' > results.json; exit 0", ""),
    ("status", "echo 'license server not found' >&2; exit 3", ""),
    ("nothing", "echo 'nothing to see'; exit 0", ""),
    ("hang", "echo 'iterating …'; sleep 60", "timeout = 0.3"),
    ("signal", "kill -9 $$", "retries = 1"),
];

#[test]
fn failures_are_reported_recorded_and_resumed() {
    let expected = undisturbed();
    let mut reports = Vec::new();
    for (name, instead, keys) in FAILURES {
        let folder = folder(&STUDY.replace("jobs = 8", &format!("jobs = 1\n{keys}")));
        let fails = format!("grep -q '\"mu\": *0\\.[34]' params.json && {{ {instead}; }}\n");
        fs::write(folder.path().join("before.sh"), fails).unwrap();
        let output = pcc(folder.path(), &["build", "study.toml"]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert!(!folder.path().join("program.pcc").exists(), "{name}: nothing is imputed");
        let message = stderr(&output);
        assert!(message.contains("the model run at mu = 0."), "{name}: {message}");
        reports.push(format!("── {name}\n{message}"));

        // The failed run is in the journal with its point, and so are those before it.
        let records = Journal::read(&folder.path().join("program.journal")).unwrap().records;
        let (failed, answered): (Vec<_>, Vec<_>) =
            records.iter().partition(|record| matches!(record.outcome, RunOutcome::Failed { .. }));
        assert_eq!(failed.len(), 1, "{name}");
        assert!(failed[0].point[0] >= 0.3 && !answered.is_empty(), "{name}");

        // Once the program is mended the build goes on, and runs nothing again that was answered.
        fs::remove_file(folder.path().join("before.sh")).unwrap();
        fs::remove_file(folder.path().join("log")).unwrap();
        let resumed = pcc(folder.path(), &["build", "study.toml", "--resume"]);
        assert!(resumed.status.success(), "{name}: {}", stderr(&resumed));
        assert_eq!(fs::read(folder.path().join("program.pcc")).unwrap(), expected, "{name}");
        let all = Journal::read(&folder.path().join("program.journal")).unwrap().records.len();
        assert_eq!(started(folder.path()).len(), all - records.len(), "{name}");
    }
    insta::with_settings!({filters => vec![
        (r"/tmp/[^ ]*/runs|[^ ]*/runs", "[work]/runs"),
        (r"run-[0-9a-f]{16}", "run-[hash]"),
        (r"mu = [0-9.]+, k = [0-9.]+", "mu = [mu], k = [k]"),
    ]}, { insta::assert_snapshot!(reports.join("\n")); });
}

#[test]
fn runs_that_fail_can_be_skipped_and_are_reported() {
    let folder = folder(&STUDY.replace("jobs = 8", "jobs = 8\non_failure = \"skip\"\nkeep = \"never\""));
    let fails = "grep -q '\"mu\": *0\\.4[89]' params.json && { echo 'no convergence' >&2; exit 1; }\n";
    fs::write(folder.path().join("before.sh"), fails).unwrap();
    let said = output(folder.path(), &["build", "study.toml", "--json"]);
    let report: serde_json::Value = serde_json::from_str(&said).unwrap();
    let failed = report["failed_runs"].as_array().unwrap();
    assert!(!failed.is_empty());
    assert!(failed[0]["cause"].as_str().unwrap().contains("no convergence"), "{said}");
    assert!(failed[0]["point"].as_str().unwrap().starts_with("mu = 0.4"), "{said}");
    assert!(report["warnings"].to_string().contains("no convergence"), "{said}");
    let bytes = fs::read(folder.path().join("program.pcc")).unwrap();
    let surrogate = pcc_evaluate::artifact::decode(&bytes).unwrap().surrogate;
    let counts = surrogate.training.counts;
    assert_eq!(counts.failed, failed.len() as u64);
    assert_eq!(counts.direct_computations, counts.values + counts.failed);

    // Resumed, recorded failures are not tried again, and the bytes are the same.
    let runs = started(folder.path()).len();
    output(folder.path(), &["build", "study.toml", "--resume", "-o", "again.pcc"]);
    assert_eq!(started(folder.path()).len(), runs);
    assert_eq!(fs::read(folder.path().join("again.pcc")).unwrap(), bytes);
}

#[test]
fn what_ends_a_build_that_skips_is_not_left_in_the_way() {
    let folder = folder(&STUDY.replace("jobs = 8", "jobs = 8\non_failure = \"skip\"\nkeep = \"never\""));
    fs::write(folder.path().join("before.sh"), "exit 7\n").unwrap();
    let message = stderr(&pcc(folder.path(), &["build", "study.toml"]));
    assert!(message.contains("all of 18 model runs failed: the program ended with status 7"), "{message}");

    // The program was at fault. Its failures are recorded, and tried again on request.
    fs::remove_file(folder.path().join("before.sh")).unwrap();
    let message = stderr(&pcc(folder.path(), &["build", "study.toml", "--resume"]));
    assert!(message.contains("all of 18 model runs failed") && message.contains("--retry-failed"), "{message}");
    output(folder.path(), &["build", "study.toml", "--resume", "--retry-failed"]);
    let skipping = fs::read(folder.path().join("program.pcc")).unwrap();
    assert_eq!(skipping, undisturbed(), "nothing was skipped in the end");

    // An answer stands above a failure that was recorded later, when the build was begun anew by mistake.
    fs::write(folder.path().join("before.sh"), "exit 7\n").unwrap();
    assert!(!pcc(folder.path(), &["build", "study.toml"]).status.success());
    output(folder.path(), &["build", "study.toml", "--resume"]);
    assert_eq!(fs::read(folder.path().join("program.pcc")).unwrap(), skipping);
}

#[test]
fn circumstances_are_no_failures_of_the_model() {
    let skipping = STUDY.replace("jobs = 8", "jobs = 2\non_failure = \"skip\"");
    // Programs that were stopped from outside are tried again by the next build, also where failures are skipped.
    let stopped = folder(&skipping);
    fs::write(stopped.path().join("before.sh"), "grep -q '\"mu\": *0\\.4' params.json && kill -TERM $$\n").unwrap();
    output(stopped.path(), &["build", "study.toml"]);
    fs::remove_file(stopped.path().join("before.sh")).unwrap();
    output(stopped.path(), &["build", "study.toml", "--resume"]);
    assert_eq!(fs::read(stopped.path().join("program.pcc")).unwrap(), undisturbed());

    // A program that cannot even be started ends the build, and is no run.
    let missing = folder(&skipping.replace("[\"sh\"", "[\"no-such-program\""));
    let message = stderr(&pcc(missing.path(), &["build", "study.toml"]));
    assert!(message.contains("no-such-program is not found"), "{message}");
    assert!(!missing.path().join("program.journal").exists());
}

#[test]
fn journals_that_somebody_wanted_stay() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("clutch.toml"), crate::support::text("surrogates/clutch-r1.toml")).unwrap();
    let journal = folder.path().join("clutch-r1.journal");
    output(folder.path(), &["build", "clutch.toml"]);
    assert!(!journal.exists(), "nobody asked for it");
    output(folder.path(), &["build", "clutch.toml", "--journal", "clutch-r1.journal"]);
    let (recorded, bytes) = (fs::read(&journal).unwrap(), fs::read(folder.path().join("clutch-r1.pcc")).unwrap());
    output(folder.path(), &["build", "clutch.toml"]);
    assert!(fs::read(&journal).unwrap().starts_with(&recorded));
    let said = output(folder.path(), &["build", "clutch.toml", "--resume", "--json"]);
    let said: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(said["reused_runs"], said["direct_computations"]);
    assert_eq!(fs::read(folder.path().join("clutch-r1.pcc")).unwrap(), bytes);
    assert!(journal.exists());
}

/// A build in the background, killed when dropped.
struct Background(Child);

impl Background {
    fn start(folder: &Path, arguments: &[&str]) -> Self {
        let program = assert_cmd::cargo::cargo_bin("pcc");
        let mut command = Command::new(program);
        command.current_dir(folder).args(arguments).stdout(Stdio::null()).stderr(Stdio::null());
        Self(command.spawn().unwrap())
    }
}

impl Drop for Background {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn a_journal_belongs_to_one_build_until_that_ends_however_it_ends() {
    let folder = folder(STUDY);
    fs::write(folder.path().join("before.sh"), "sleep 0.5\n").unwrap();
    let first = Background::start(folder.path(), &["build", "study.toml"]);
    while started(folder.path()).is_empty() {
        std::thread::sleep(Duration::from_millis(20));
    }
    let refused = pcc(folder.path(), &["build", "study.toml", "--resume"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("program.journal: is in use by another pcc"), "{}", stderr(&refused));
    // Killed, not asked: the lock must not stay.
    drop(first);
    fs::remove_file(folder.path().join("before.sh")).unwrap();
    output(folder.path(), &["build", "study.toml", "--resume"]);
    assert_eq!(fs::read(folder.path().join("program.pcc")).unwrap(), undisturbed());
}

/// Answers a table of points as the program would.
fn answer(rows: &str, choose: impl Fn(usize) -> bool) -> String {
    let mut lines = rows.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = |name: &str| header.iter().position(|&column| column == name).unwrap();
    let mut answers = vec!["run,mu,k,re_1,im_1,re_2,im_2".to_owned()];
    for (number, line) in lines.enumerate().filter(|(number, _)| choose(*number)) {
        let cells: Vec<&str> = line.split(',').collect();
        let _ = number;
        let (mu, k): (f64, f64) = (cells[at("mu")].parse().unwrap(), cells[at("k")].parse().unwrap());
        let parts = [-0.1 * k * mu - 0.1, k.sqrt(), mu - 0.3, 3.0 * k.sqrt() + mu * mu];
        let parts: Vec<String> = parts.iter().map(|part| format!("{part:?}")).collect();
        // The inputs with six digits: the number of the run says which it is.
        answers.push(format!("{},{mu:.6},{k:.6},{}", cells[at("run")], parts.join(",")));
    }
    answers.join("\n") + "\n"
}

#[test]
fn ask_and_tell_builds_the_bytes_of_a_direct_build() {
    let expected = undisturbed();
    let asking = folder(STUDY);
    let (path, rows) = (asking.path(), asking.path().join("rows.csv"));
    let write = |name: &str, text: String| fs::write(path.join(name), text).unwrap();
    let mut steps = 0;
    loop {
        let said: serde_json::Value =
            serde_json::from_str(&output(path, &["design", "study.toml", "--emit", "rows.csv", "--json"])).unwrap();
        if said["complete"] == true {
            break;
        }
        steps += 1;
        let asked = fs::read_to_string(&rows).unwrap();
        assert_eq!(said["points"].as_u64().unwrap() as usize, asked.lines().count() - 1);
        // In parts, in another order, and more than once.
        write("even.csv", answer(&asked, |i| i % 2 == 0));
        let odd = answer(&asked, |i| i % 2 == 1);
        let (header, body) = odd.split_once('\n').unwrap();
        let reversed: Vec<&str> = body.lines().rev().collect();
        write("odd.csv", format!("{header}\n{}\n", reversed.join("\n")));
        let said = output(path, &["ingest", "study.toml", "even.csv"]);
        assert!(said.contains("points wait for an answer"), "{said}");
        output(path, &["ingest", "study.toml", "even.csv"]);
        output(path, &["ingest", "study.toml", "odd.csv"]);
        let again = output(path, &["ingest", "study.toml", "odd.csv", "--json"]);
        let again: serde_json::Value = serde_json::from_str(&again).unwrap();
        assert_eq!((&again["answered"], &again["repeated"]), (&0.into(), &again["rows"]));
    }
    assert!(steps >= 1);
    output(path, &["build", "study.toml", "--resume"]);
    assert_eq!(fs::read(path.join("program.pcc")).unwrap(), expected);
    assert!(started(path).is_empty(), "pcc ran nothing");
}

#[test]
fn rows_that_cannot_be_right_are_refused_and_nothing_is_taken() {
    let asking = folder(STUDY);
    let path = asking.path();
    output(path, &["design", "study.toml", "--emit", "rows.csv"]);
    let asked = fs::read_to_string(path.join("rows.csv")).unwrap();
    let good = answer(&asked, |i| i < 4);
    fs::write(path.join("good.csv"), &good).unwrap();
    output(path, &["ingest", "study.toml", "good.csv"]);
    let before = fs::read(path.join("program.journal")).unwrap();

    let first_point: Vec<&str> = asked.lines().nth(1).unwrap().split(',').collect();
    let (mu, k) = (first_point[1], first_point[2]);
    let numbers = "-0.1,1.0,-0.2,3.0";
    let header = "run,mu,k,re_1,im_1,re_2,im_2";
    let at = |run: usize| asked.lines().nth(run).unwrap();
    let cases = [
        ("another answer", format!("{header}\n{},{numbers}\n{},{numbers}\n", at(5), at(1))),
        ("two answers in one file", format!("{header}\n{},{numbers}\n{},-0.1,1.0,-0.25,3.0\n", at(5), at(5))),
        ("no such run", format!("{header}\n99,{mu},{k},{numbers}\n0,{mu},{k},{numbers}\n")),
        ("another point", format!("{header}\n5,{mu},{k},{numbers}\n")),
        ("a number alone", format!("run,re_1,im_1,re_2,im_2\n5,{numbers}\n")),
        ("no modes", format!("{header}\n{},0,0,0,0\n", at(5))),
        ("fewer modes than elsewhere", format!("{header}\n{},-0.1,1.0,-0.2,-3.0\n", at(5))),
        ("no point of the design", format!("mu,k,re_1,im_1,re_2,im_2\n0.25,1.5,{numbers}\n")),
        ("not a number", format!("{header}\n{},-0.1,1.0,bad,3.0\n", at(5))),
        ("NaN", format!("{header}\n{},-0.1,1.0,NaN,3.0\n", at(5))),
        ("a column is missing", format!("run,mu,k,re_1,im_1,re_2\n{},-0.1,1.0,-0.2\n", at(5))),
        ("neither run nor inputs", format!("re_1,im_1,re_2,im_2\n{numbers}\n")),
        ("empty", String::new()),
    ];
    let mut said = Vec::new();
    for (name, table) in cases {
        fs::write(path.join("bad.csv"), table).unwrap();
        said.push(format!("{name}\n{}", refusal(path, &["ingest", "study.toml", "bad.csv"])));
        assert_eq!(fs::read(path.join("program.journal")).unwrap(), before, "{name}");
    }
    insta::with_settings!({filters => vec![(r"mu = [0-9.]+, k = [0-9.]+", "mu = [mu], k = [k]")]}, {
        insta::assert_snapshot!(said.join("\n"));
    });

    // A wrong answer can be replaced, by a row that is right.
    let wrong = format!("{header}\n{},-0.1,1.0,-0.2,3.0\n", at(1));
    fs::write(path.join("wrong.csv"), wrong).unwrap();
    let replaced = output(path, &["ingest", "study.toml", "wrong.csv", "--replace"]);
    assert!(replaced.contains("1 new answers"), "{replaced}");
    output(path, &["ingest", "study.toml", "good.csv", "--replace"]);

    // Failures are taken, and asked for again; an answer replaces them.
    let failed = format!("{header},error\n{},,,,,diverged\n{},,,,,\n", at(5), at(6));
    fs::write(path.join("failed.csv"), failed).unwrap();
    let ingested = output(path, &["ingest", "study.toml", "failed.csv"]);
    assert!(ingested.contains("1 rows: 0 new answers, 1 failed runs"), "{ingested}");
    let points = |path: &Path| {
        output(path, &["design", "study.toml", "--emit", "rows.csv"]);
        fs::read_to_string(path.join("rows.csv")).unwrap()
    };
    assert!(points(path).lines().any(|line| line.starts_with("5,")));
    let rest = answer(&points(path), |i| i == 0);
    fs::write(path.join("rest.csv"), rest).unwrap();
    output(path, &["ingest", "study.toml", "rest.csv"]);
    assert!(!points(path).lines().any(|line| line.starts_with("5,")));
}

#[test]
fn models_that_answer_in_tables_are_not_run() {
    let table = folder(
        &STUDY
            .replace("kind = \"command\"\ncommand = [\"sh\", \"{study}/model.sh\"]", "kind = \"table\"")
            .replace("jobs = 8", ""),
    );
    let path = table.path();
    let message = stderr(&pcc(path, &["build", "study.toml"]));
    assert!(message.contains("pcc design"), "{message}");
    loop {
        let said = output(path, &["design", "study.toml", "--emit", "rows.csv"]);
        let asked = fs::read_to_string(path.join("rows.csv")).unwrap();
        if asked.lines().count() == 1 {
            assert!(said.contains("pcc build study.toml --resume"), "{said}");
            break;
        }
        fs::write(path.join("answers.csv"), answer(&asked, |_| true)).unwrap();
        output(path, &["ingest", "study.toml", "answers.csv"]);
    }
    output(path, &["build", "study.toml", "--resume"]);
    let table = pcc_evaluate::artifact::read(&path.join("program.pcc")).unwrap().surrogate;
    let program = pcc_evaluate::artifact::decode(&undisturbed()).unwrap().surrogate;
    assert_eq!(table.expansions, program.expansions);
}

#[test]
fn journals_are_exported_for_audit() {
    let folder = folder(STUDY);
    output(folder.path(), &["build", "study.toml"]);
    let said = output(folder.path(), &["journal", "program.journal", "--study", "study.toml", "--csv", "audit.csv"]);
    assert!(said.contains("model runs"), "{said}");
    let table = fs::read_to_string(folder.path().join("audit.csv")).unwrap();
    let header = table.lines().next().unwrap();
    assert_eq!(header, "record,model,status,attempts,seconds,mu,k,re_1,im_1,re_2,im_2,error");
    let row: Vec<&str> = table.lines().nth(1).unwrap().split(',').collect();
    let number = |at: usize| row[at].parse::<f64>().unwrap();
    assert_eq!((row[2], number(9)), ("answered", number(5) - 0.3));
    assert_eq!(table.lines().count() - 1, started(folder.path()).len());
    // Neither a study nor a surrogate is a journal, and none of them is replaced by the table.
    refusal(folder.path(), &["journal", "study.toml"]);
    refusal(folder.path(), &["journal", "missing.journal"]);
    refusal(folder.path(), &["journal", "program.journal", "--csv", "program.journal"]);
    refusal(folder.path(), &["journal", "program.journal", "--csv", "program.pcc"]);
    refusal(folder.path(), &["design", "study.toml", "--emit", "study.toml"]);
}

#[test]
fn hostile_names_are_inert() {
    let parent = tempfile::tempdir().unwrap();
    let hostile = ["$(touch pwned)", "; touch pwned", "-rf", "a\nb", "`touch pwned`", "--output=pwned", "'\"&|<>*?"];
    for (number, name) in hostile.iter().enumerate() {
        let path = parent.path().join(name);
        fs::create_dir(&path).unwrap();
        let arguments: Vec<String> = hostile.iter().map(|argument| format!("{argument:?}")).collect();
        let command = format!("command = [\"sh\", \"{{study}}/model.sh\", \"../pwned\", {}]", arguments.join(", "));
        let study = STUDY.replace("command = [\"sh\", \"{study}/model.sh\"]", &command);
        let keys = format!("work = {name:?}\nkeep = \"always\"");
        let study = study.replace("jobs = 8", &format!("jobs = 8\n{keys}"));
        fs::write(path.join("study.toml"), study).unwrap();
        let script = MODEL.replace("awk '", "printf '%s\\0' \"$@\" > arguments\nawk '");
        fs::write(path.join("model.sh"), script).unwrap();
        output(&path, &["build", "study.toml", "-o", &format!("./{name}.pcc")]);
        // Every argument arrived as it was written.
        let run = fs::read_dir(path.join(name)).unwrap().next().unwrap().unwrap().path();
        let arrived = fs::read_to_string(run.join("arguments")).unwrap();
        let expected: Vec<&str> = std::iter::once("../pwned").chain(hostile).collect();
        assert_eq!(arrived.trim_end_matches('\0').split('\0').collect::<Vec<_>>(), expected, "{number}");
        let mut open = vec![parent.path().to_owned()];
        while let Some(folder) = open.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let entry = entry.unwrap();
                assert_ne!(entry.file_name(), "pwned");
                if entry.file_type().unwrap().is_dir() {
                    open.push(entry.path());
                }
            }
        }
    }
}

#[test]
fn studies_of_programs_are_checked_before_anything_runs() {
    let folder = folder(STUDY);
    let with = |from: &str, to: &str| {
        fs::write(folder.path().join("bad.toml"), STUDY.replace(from, to)).unwrap();
        refusal(folder.path(), &["build", "bad.toml"])
    };
    let said = [
        with("eigenvalues = 2\n", ""),
        with("eigenvalues = 2", "eigenvalues = 0"),
        with("command = [\"sh\", \"{study}/model.sh\"]\n", ""),
        with("[\"sh\", \"{study}/model.sh\"]", "[]"),
        with("[\"sh\", \"{study}/model.sh\"]", "\"sh model.sh\""),
        with("[\"sh\", \"{study}/model.sh\"]", "7"),
        with("[\"sh\", \"{study}/model.sh\"]", "[\"sh\", \"model.sh\"]"),
        with("[\"sh\", \"{study}/model.sh\"]", "[\"sh\", \"a\\u0000b\"]"),
        with("jobs = 8", "jobs = 0"),
        with("jobs = 8", "timeout = -1.0"),
        with("jobs = 8", "shell = true"),
        with("jobs = 8", "on_failure = \"guess\""),
        with("jobs = 8", "mode = \"parallel\""),
        with("jobs = 8", "keep = \"some\""),
        with("jobs = 8", "K = [[1]]"),
        with("jobs = 8", "on_failure = \"skip\"\n[fit]\nmethod = \"gpc\""),
        with("[inputs]", "[fit]\nderivatives = true\n[inputs]"),
        with("mu = {", "\"; rm -rf ~\" = {"),
        with("mu = {", "\"../mu\" = {"),
        with("mu = {", "re_1 = {"),
        with("kind = \"command\"", "kind = \"table\""),
    ];
    insta::assert_snapshot!(said.join("\n"));
    fs::write(folder.path().join("bad.toml"), STUDY.replace("[\"sh\",", "[\"no-such-program\",")).unwrap();
    let missing = stderr(&pcc(folder.path(), &["build", "bad.toml"]));
    assert!(missing.contains("no-such-program"), "{missing}");
}

/// With derivatives, which are recorded as well.
#[test]
fn builds_from_a_journal_cut_anywhere_have_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("clutch.toml"), crate::support::text("surrogates/clutch-r2.toml")).unwrap();
    output(folder.path(), &["build", "clutch.toml", "-o", "whole.pcc", "--journal", "whole.journal"]);
    let (expected, journal) = (fs::read(path("whole.pcc")).unwrap(), fs::read(path("whole.journal")).unwrap());
    let runs = Journal::read(&path("whole.journal")).unwrap().records.len();
    for part in 0..=8 {
        fs::write(path("cut.journal"), &journal[..journal.len() * part / 8]).unwrap();
        let known = Journal::read(&path("cut.journal")).unwrap().records.len();
        let arguments = ["build", "clutch.toml", "-o", "cut.pcc", "--journal", "cut.journal", "--resume", "--json"];
        let said: serde_json::Value = serde_json::from_str(&output(folder.path(), &arguments)).unwrap();
        assert_eq!(said["reused_runs"], known);
        assert_eq!(fs::read(path("cut.pcc")).unwrap(), expected, "{known} of {runs} runs known");
        assert_eq!(Journal::read(&path("cut.journal")).unwrap().records.len(), runs);
    }
}

/// With failures in a part of the domain, the model's word is asked for all the same, at a price.
#[test]
fn failures_count_as_disagreement_both_ways_if_asked_for() {
    let folder = folder(&STUDY.replace("jobs = 8", "jobs = 8\non_failure = \"skip\""));
    let fails = r#"
        awk '
            { gsub(/[{}" ]/, ""); n = split($0, parts, ","); for (i = 1; i <= n; i++) { split(parts[i], pair, ":"); value[pair[1]] = pair[2] } }
            END { exit value["mu"] > 0.4 ? 1 : 0 }' params.json || exit 3
    "#;
    fs::write(folder.path().join("before.sh"), fails).unwrap();
    let said = output(folder.path(), &["build", "study.toml"]);
    assert!(said.contains("did not answer in"), "{said}");
    fs::write(folder.path().join("in.csv"), "mu,k\n0.1,1.5\n0.49,1.5\n").unwrap();
    let said = output(folder.path(), &["eval", "program.pcc", "--points", "in.csv", "--out", "out.csv"]);
    assert!(said.contains("warning: the model did not answer near 1 of them"), "{said}");
    let certify = ["certify", "program.pcc", "--study", "study.toml", "-n", "40"];
    let ends_at_the_first = |arguments: &[&str]| {
        let ended = pcc(folder.path(), arguments);
        assert!(ended.status.code() == Some(2) && stderr(&ended).contains("failed"), "{}", stderr(&ended));
    };
    ends_at_the_first(&certify);
    let said = output(folder.path(), &[&certify[..], &["--failures", "count", "--seed", "2"]].concat());
    assert!(said.contains("counted as disagreement both ways"), "{said}");
    assert!(crate::support::in_one_line(&said).contains("if errors fall off withheld: runs failed"), "{said}");
    let compare = ["compare", "program.pcc", "--study", "study.toml", "-n", "40"];
    ends_at_the_first(&compare);
    let said = output(folder.path(), &[&compare[..], &["--failures", "count"]].concat());
    assert!(said.contains("counted as disagreement") && !said.contains("misclassified          0 %"), "{said}");
    let checked = pcc(folder.path(), &["inspect", "program.pcc", "--check"]);
    assert_eq!(checked.status.code(), Some(1), "{}", stderr(&checked));
}

/// The build may skip runs that fail, so `run` ends with an answer, and counts them against the surrogate.
#[test]
fn a_program_that_fails_in_places_is_run_to_the_end() {
    let folder = folder(&STUDY.replace("jobs = 8", "jobs = 8\non_failure = \"skip\"\nkeep = \"never\""));
    let fails = "grep -q '\"mu\": *0\\.4[89]' params.json && exit 1\n";
    fs::write(folder.path().join("before.sh"), fails).unwrap();
    let said = output(folder.path(), &["run", "study.toml"]);
    assert!(said.contains("── answer") && said.contains("did not answer"), "{said}");
}
