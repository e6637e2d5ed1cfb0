//! Intervals at points: how often they hold what the model answers, and what the program makes of them.

use crate::support::command::{output, refusal};
use crate::support::studies::{built_from, json};
use crate::support::{built, in_one_line, repository, text};
use pcc_compile::reference::PointReference;
use pcc_compile::study::Study;
use pcc_evaluate::evaluation::{Plan, evaluate_points, point_intervals};
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::probability::inputs::random_points;
use pcc_evaluate::probability::random::Purpose;
use serde_json::{Value, json as value};
use std::fs;

/// Fresh points: a share of them is known to 0.01, of a tenth of them to 0.04.
const POINTS: u64 = 1000;

fn share(held: &[bool]) -> f64 {
    held.iter().filter(|held| **held).count() as f64 / held.len() as f64
}

#[test]
fn intervals_at_90_percent_hold_fresh_answers_in_the_box_and_near_the_boundary() {
    for name in ["clutch-r3", "flutter", "rotor"] {
        let surrogate = built(name);
        let study = Study::from_toml(&text(&format!("surrogates/{name}.toml"))).unwrap();
        let points = random_points(&surrogate.inputs, 77, Purpose::Evaluation, 0..POINTS);
        let physical: Vec<Vec<f64>> = points.iter().map(|point| study.inputs.physical(point)).collect();
        let answers = PointReference::new(&study).unwrap().run(&physical, &Silent).unwrap();
        let references: Vec<&[f64]> = points.iter().map(Vec::as_slice).collect();
        let block = evaluate_points(surrogate, &Plan::new(surrogate), &references);
        let left_out = surrogate.left_out.as_ref().unwrap();
        let found = point_intervals(surrogate, left_out, &block, "0.9".parse().unwrap(), &Silent).unwrap();
        let model: Vec<f64> = answers.iter().map(|answer| answer.top.max_re).collect();
        let holds = |i: usize| found[i].max_re[0] <= model[i] && model[i] <= found[i].max_re[1];
        let mut nearest: Vec<usize> = (0..model.len()).collect();
        let all = share(&nearest.iter().map(|&i| holds(i)).collect::<Vec<_>>());
        nearest.sort_by(|&a, &b| model[a].abs().total_cmp(&model[b].abs()));
        let near = share(&nearest[..model.len() / 10].iter().map(|&i| holds(i)).collect::<Vec<_>>());
        println!("{name}: {all} in the box, {near} near the boundary");
        assert!(all >= 0.85 && near >= 0.8, "{name}: {all} in the box, {near} near the boundary");
        let half_width = |i: usize| (found[i].max_re[1] - found[i].max_re[0]) / 2.0;
        let spread = model.iter().map(|re| re.abs()).sum::<f64>() / model.len() as f64;
        let width = (0..model.len()).map(half_width).sum::<f64>() / model.len() as f64;
        assert!(width < 0.01 * spread, "{name}: {width} of {spread} says nothing");
    }
}

const CLUTCH: &str = "format = 1\nname = \"c\"\n[model]\nkind = \"clutch\"\n[inputs]\nmu = { distribution = \"uniform\", \
                      lower = 0.0, upper = 0.5 }\n[spectrum]\ntarget = \"invariants\"\n";

const AT_POINTS: [&str; 6] = ["eval", "built.pcc", "--points", "in.csv", "--out", "out.csv"];

/// Rows of a table by the names of its columns.
fn rows(table: &str) -> Vec<Vec<(String, String)>> {
    let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let header = cells(table.lines().next().unwrap());
    table.lines().skip(1).map(|line| header.iter().cloned().zip(cells(line)).collect()).collect()
}

#[test]
fn every_number_of_a_result_has_two_ends_around_it() {
    let folder = built_from(&format!("{CLUTCH}[design]\ninitial = 12\nmaximum = 12\n"));
    let path = folder.path();
    fs::write(path.join("in.csv"), "mu\n0.05\n0.3\n0.4999\n").unwrap();
    output(path, &AT_POINTS);
    let plain = fs::read_to_string(path.join("out.csv")).unwrap();
    let report = json(path, &[&AT_POINTS[..], &["--interval", "0.9"]].concat());
    assert_eq!(report["interval"], value!({ "level": 0.9, "runs": 12, "least_runs": 9, "is_infinite": false }));
    let table = fs::read_to_string(path.join("out.csv")).unwrap();
    assert!(table.starts_with("mu,re_1,re_1_lower,re_1_upper,im_1,im_1_lower,im_1_upper,re_2,"), "{table}");
    assert!(table.lines().next().unwrap().ends_with("max_re,max_re_lower,max_re_upper,stable,verdict"), "{table}");
    for (with, without) in rows(&table).iter().zip(rows(&plain)) {
        let is_end = |name: &str| name.ends_with("_lower") || name.ends_with("_upper");
        let others: Vec<_> = with.iter().filter(|(name, _)| !is_end(name)).cloned().collect();
        assert_eq!(others, without, "nothing else changes");
        let number = |name: &str| with.iter().find(|(own, _)| own == name).unwrap().1.parse::<f64>().unwrap();
        for name in ["re_1", "im_1", "re_4", "im_4", "max_re"] {
            let [lower, upper] = ["lower", "upper"].map(|end| number(&format!("{name}_{end}")));
            assert!(
                lower <= number(name) && number(name) <= upper && lower.is_finite() && upper.is_finite(),
                "{with:?}"
            );
        }
    }
    let printed = in_one_line(&output(path, &[&AT_POINTS[..], &["--interval", "0.9"]].concat()));
    assert!(printed.ends_with("intervals at level 0.9, from what was missed at 12 model runs left out"), "{printed}");
    let plain_again = output(path, &AT_POINTS);
    assert!(!plain_again.contains("interval"), "a table with intervals gives way to one without: {plain_again}");
}

#[test]
fn with_fewer_runs_than_the_level_needs_intervals_are_infinite_and_that_is_said() {
    let folder = built_from(&format!("{CLUTCH}[design]\ninitial = 8\nmaximum = 8\n"));
    let path = folder.path();
    fs::write(path.join("in.csv"), "mu\n0.05\n").unwrap();
    for (level, least, is_infinite) in [("0.9", 9, true), ("0.95", 19, true), ("0.8", 4, false), ("0.88", 8, false)] {
        let report: Value = json(path, &[&AT_POINTS[..], &["--interval", level]].concat());
        assert_eq!(report["interval"]["least_runs"], least, "{level}");
        assert_eq!(report["interval"]["is_infinite"], is_infinite, "{level}");
        let printed = in_one_line(&output(path, &[&AT_POINTS[..], &["--interval", level]].concat()));
        let table = fs::read_to_string(path.join("out.csv")).unwrap();
        assert_eq!(table.contains(",-inf,inf,"), is_infinite, "{table}");
        let warning =
            format!("warning: intervals at level {level} need {least} model runs left out, and the surrogate keeps 8");
        assert_eq!(printed.contains(&warning), is_infinite, "{printed}");
    }
}

#[test]
fn surrogates_that_leave_nothing_out_and_levels_that_are_none_are_refused() {
    let gpc = format!("{CLUTCH}[design]\nkind = \"tensor-gauss\"\n[fit]\nmethod = \"gpc\"\nmax_degree = 4\n");
    let folder = built_from(&gpc);
    let path = folder.path();
    fs::copy(repository("tests/data/golden.v1.pcc"), path.join("old.pcc")).unwrap();
    fs::write(path.join("in.csv"), "mu\n0.05\n").unwrap();
    for file in ["built.pcc", "old.pcc"] {
        let message = refusal(path, &["eval", file, "--points", "in.csv", "--out", "out.csv", "--interval", "0.9"]);
        let message = in_one_line(&message);
        assert!(message.contains(&format!("--interval: {file} does not say what the surrogate missed")), "{message}");
    }
    for level in ["0", "1", "90", "-0.5", "nan", "0.99999999", "often"] {
        let message = refusal(path, &[&AT_POINTS[..], &[&format!("--interval={level}")]].concat());
        assert!(in_one_line(&message).contains("use a level above 0 and below 1, like 0.9"), "{level}: {message}");
    }
    let message = refusal(path, &["eval", "built.pcc", "--interval", "0.9"]);
    assert!(message.contains("--points"), "{message}");
}
