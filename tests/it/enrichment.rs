//! Runs near the boundary: the same bytes on any number of threads, whoever runs the model, and whatever is killed.

use crate::rare::{CORNER, one_mode};
use crate::support::build;
use pcc_evaluate::artifact::{Format, encode};
use pcc_evaluate::surrogate::{SettingValue, Surrogate};

fn runs_near_boundary(surrogate: &Surrogate) -> u64 {
    let setting = surrogate.training.settings.iter().find(|setting| setting.key == "runs_near_boundary");
    match setting.map(|setting| &setting.value) {
        Some(SettingValue::Integer(count)) => *count,
        other => panic!("{other:?}"),
    }
}

#[test]
fn builds_with_runs_near_the_boundary_have_the_same_bytes_on_1_2_and_8_threads() {
    let study = one_mode(&format!("exp(x^2 + y^2) - exp({CORNER:?})"));
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let surrogate = pool.install(|| build(&study));
        assert!(runs_near_boundary(&surrogate) >= 3);
        encode(&surrogate, Format::Binary).unwrap()
    };
    let one = on(1);
    assert!(one == on(2) && one == on(8));
}

#[cfg(unix)]
mod of_programs {
    use super::*;
    use crate::support::command::output;
    use pcc_compile::campaign::journal::Journal;
    use std::fs;
    use std::path::Path;
    use std::process::{Command, Stdio};
    use std::thread::sleep;
    use std::time::Duration;

    /// One mode that grows in a corner of the square. Products and sums alone: the same bits in any language.
    const MODEL: &str = r#"#!/bin/sh
[ -f "$PCC_STUDY_DIR/slow" ] && sleep 0.1
awk '
    { gsub(/[{}" ]/, ""); n = split($0, parts, ","); for (i = 1; i <= n; i++) { split(parts[i], pair, ":"); value[pair[1]] = pair[2] } }
    END { x = value["x"]; y = value["y"]; printf "{\"eigenvalues\": [[%.17g, 10]]}\n", x*x + y*y - 1.75 }
' params.json > results.json
"#;

    const STUDY: &str = r#"
format = 1
name = "corner"
[model]
kind = "command"
command = ["sh", "{study}/model.sh"]
eigenvalues = 1
jobs = 4
[inputs]
x = { distribution = "uniform", lower = 0.0, upper = 1.0 }
y = { distribution = "uniform", lower = 0.0, upper = 1.0 }
"#;

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("study.toml"), STUDY).unwrap();
        fs::write(folder.path().join("model.sh"), MODEL).unwrap();
        folder
    }

    /// The surrogate of an undisturbed build, and its runs before those near the boundary.
    fn undisturbed() -> (Vec<u8>, usize) {
        let folder = folder();
        output(folder.path(), &["build", "study.toml", "--no-journal"]);
        let file = folder.path().join("corner.pcc");
        let surrogate = pcc_evaluate::artifact::read(&file).unwrap().surrogate;
        let before = surrogate.training.counts.direct_computations - runs_near_boundary(&surrogate);
        (fs::read(file).unwrap(), before as usize)
    }

    /// Answers a table of points as the program would.
    fn answers(rows: &str) -> String {
        let header: Vec<&str> = rows.lines().next().unwrap().split(',').collect();
        let at = |name: &str| header.iter().position(|&column| column == name).unwrap();
        let answer = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            let [x, y] = ["x", "y"].map(|name| cells[at(name)].parse::<f64>().unwrap());
            format!("{},{x:?},{y:?},{:?},10.0\n", cells[at("run")], x * x + y * y - 1.75)
        };
        "run,x,y,re_1,im_1\n".to_owned() + &rows.lines().skip(1).map(answer).collect::<String>()
    }

    fn recorded(path: &Path) -> usize {
        let journal = path.join("corner.journal");
        if journal.exists() { Journal::read(&journal).unwrap().records.len() } else { 0 }
    }

    #[test]
    fn runs_near_the_boundary_are_asked_for_and_told() {
        let (expected, _) = undisturbed();
        let folder = folder();
        let path = folder.path();
        fs::remove_file(path.join("model.sh")).unwrap();
        let mut steps = 0;
        while !output(path, &["design", "study.toml", "--emit", "rows.csv", "--json"]).contains("\"complete\": true") {
            steps += 1;
            assert!(steps < 20, "it ends");
            let asked = fs::read_to_string(path.join("rows.csv")).unwrap();
            fs::write(path.join("answers.csv"), answers(&asked)).unwrap();
            output(path, &["ingest", "study.toml", "answers.csv"]);
        }
        assert!(steps >= 3, "two levels and a batch: {steps}");
        output(path, &["build", "study.toml", "--resume"]);
        assert!(fs::read(path.join("corner.pcc")).unwrap() == expected);
    }

    #[test]
    fn a_build_that_is_killed_near_the_boundary_goes_on_to_the_same_bytes() {
        let (expected, before) = undisturbed();
        let folder = folder();
        let path = folder.path();
        // The levels of the design, then slowly a part of what follows.
        let start = || {
            let mut command = Command::new(assert_cmd::cargo::cargo_bin("pcc"));
            command.current_dir(path).args(["build", "study.toml", "--resume"]);
            command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
        };
        let mut build = start();
        while recorded(path) < before {
            assert!(build.try_wait().unwrap().is_none(), "the build ended before it was killed");
            sleep(Duration::from_millis(2));
        }
        fs::write(path.join("slow"), "").unwrap();
        while recorded(path) <= before && build.try_wait().unwrap().is_none() {
            sleep(Duration::from_millis(2));
        }
        build.kill().unwrap();
        build.wait().unwrap();
        let known = recorded(path);
        println!("{known} runs recorded, {before} before those near the boundary");
        assert!(known > before && !path.join("corner.pcc").exists());
        fs::remove_file(path.join("slow")).unwrap();
        output(path, &["build", "study.toml", "--resume"]);
        assert!(fs::read(path.join("corner.pcc")).unwrap() == expected);
        assert!(recorded(path) > known, "the rest of the batches");
    }
}
