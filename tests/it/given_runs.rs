//! Runs that somebody has made already: tables with any points become surrogates, and say how good those are.

use crate::support::command::{output, pcc, refusal};
use crate::support::{built, in_one_line, invariants_study};
use num_complex::Complex;
use pcc::report::FitReport;
use pcc::{DataOptions, Study};
use pcc_compile::campaign::{Campaign, Ledger};
use pcc_compile::compilation::build;
use pcc_compile::mechanics::spectrum::nearest;
use pcc_evaluate::evaluation::monte_carlo;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::probability::inputs::random_points;
use pcc_evaluate::probability::random::Purpose;
use pcc_evaluate::surrogate::Surrogate;
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Points of a share: its sampling error is that of all surrogates of these inputs alike.
const SAMPLES: u64 = 50_000;

/// The clutch with so many inputs as a table.
fn study_text(inputs: usize) -> String {
    let text = crate::support::text(&format!("surrogates/clutch-r{inputs}.toml"));
    text.replace("kind = \"clutch\"", "kind = \"table\"").replace(&format!("clutch-r{inputs}"), "rig")
}

/// Physical points of the clutch's inputs, of which `hold`.
fn points(inputs: usize, count: usize, hold: impl Fn(&[f64]) -> bool) -> Vec<Vec<f64>> {
    let space = invariants_study(inputs).inputs;
    let random = random_points(&space, 5, Purpose::Evaluation, 0..50 * count as u64);
    random.into_iter().map(|point| space.physical(&point)).filter(|point| hold(point)).take(count).collect()
}

/// The clutch's eigenvalues with Im λ > 0 at a point, by frequency.
fn answer(inputs: usize, point: &[f64]) -> Vec<Complex<f64>> {
    let found = invariants_study(inputs).model().unwrap().eigenvalues(point).unwrap();
    let mut upper: Vec<Complex<f64>> = found.into_iter().filter(|lambda| lambda.im > 1.0).collect();
    upper.sort_by(|a, b| a.im.total_cmp(&b.im));
    upper
}

/// Derivatives of these by an input, by central differences.
fn slopes(inputs: usize, point: &[f64], input: usize) -> Vec<Complex<f64>> {
    let step = 1e-6 * point[input].abs().max(1e-2);
    let moved = |by: f64| {
        let mut point = point.to_vec();
        point[input] += by;
        answer(inputs, &point)
    };
    let (here, below, above) = (answer(inputs, point), moved(-step), moved(step));
    let [below, above] =
        [below, above].map(|list| nearest(&here, &list).into_iter().map(|k| list[k]).collect::<Vec<_>>());
    above.iter().zip(&below).map(|(above, below)| (above - below) / (2.0 * step)).collect()
}

/// The table of the clutch's runs at these points.
fn table(inputs: usize, points: &[Vec<f64>], with_slopes: bool) -> String {
    let study = invariants_study(inputs);
    let names: Vec<&str> = study.inputs.names().collect();
    let parts = |k: usize| [format!("re_{k}"), format!("im_{k}")];
    let mut header: Vec<String> = names.iter().map(|name| (*name).to_owned()).chain((1..=4).flat_map(parts)).collect();
    if with_slopes {
        header.extend(
            names.iter().flat_map(|name| (1..=4).flat_map(parts).map(move |part| format!("d_{part}_d_{name}"))),
        );
    }
    let mut text = header.join(",");
    for point in points {
        let slopes = (0..inputs).filter(|_| with_slopes).flat_map(|j| slopes(inputs, point, j));
        let lambdas = answer(inputs, point).into_iter().chain(slopes);
        let cells = point.iter().copied().chain(lambdas.flat_map(|lambda| [lambda.re, lambda.im]));
        let cells: Vec<String> = cells.map(|cell| format!("{cell:?}")).collect();
        let _ = write!(text, "\n{}", cells.join(","));
    }
    text + "\n"
}

/// The study in a folder with this table.
fn study(inputs: usize, table: &str, more: &str) -> Study {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("runs.csv");
    fs::write(&file, table).unwrap();
    let options = DataOptions { files: vec![file], ..DataOptions::default() };
    Study::from_toml_with(&(study_text(inputs) + more), Path::new("."), &options).unwrap()
}

fn share(surrogate: &Surrogate) -> f64 {
    let found = monte_carlo(surrogate, SAMPLES, 1, &Silent).unwrap();
    found.stable as f64 / SAMPLES as f64
}

fn setting(surrogate: &Surrogate, key: &str) -> String {
    let found = surrogate.training.settings.iter().find(|setting| setting.key == key);
    found.map_or_else(String::new, |setting| format!("{:?}", setting.value))
}

#[test]
fn random_runs_give_the_share_of_the_model_within_the_estimate() {
    let true_share = share(built("clutch-r3"));
    let mut misses = Vec::new();
    for count in [20, 30, 60] {
        let surrogate = build(&study(3, &table(3, &points(3, count, |_| true), false), ""), &Silent).unwrap();
        let found = share(&surrogate);
        let error = (found - true_share).abs();
        let estimate = surrogate.decision.proportion_error.unwrap() * found;
        assert!(error <= 3.0 * estimate + 1.0 / SAMPLES as f64, "{count}: {error} {estimate}");
        assert_eq!(surrogate.training.counts.values, count as u64);
        misses.push(error);
    }
    assert!(misses[2] < 1e-3, "{misses:?}");
}

#[test]
fn derivatives_do_the_work_of_runs() {
    let runs = points(3, 12, |_| true);
    let true_share = share(built("clutch-r3"));
    let error = |with_slopes: bool| {
        let surrogate = build(&study(3, &table(3, &runs, with_slopes), ""), &Silent).unwrap();
        assert_eq!(surrogate.training.counts.gradients, if with_slopes { 12 } else { 0 });
        (share(&surrogate) - true_share).abs()
    };
    let [with, without] = [true, false].map(error);
    assert!(with < 1e-3 && without > 5.0 * with, "{with} {without}");
}

#[test]
fn runs_that_are_held_out_show_the_true_error() {
    let study = study(3, &table(3, &points(3, 45, |_| true), false), "").clone();
    let held_out =
        Study { data: study.data.map(|data| pcc_compile::study::GivenData { holdout: 0.4, ..data }), ..study };
    let surrogate = build(&held_out, &Silent).unwrap();
    assert_eq!(
        (surrogate.training.counts.values, setting(&surrogate, "validating_runs")),
        (27, "Integer(18)".to_owned())
    );
    let shown: f64 =
        setting(&surrogate, "validating_rms_error")["Number(".len()..].trim_end_matches(')').parse().unwrap();
    let fresh = points(3, 400, |_| true).split_off(100);
    let square = |point: &Vec<f64>| {
        let exact = answer(3, point).iter().map(|lambda| lambda.re).fold(f64::NEG_INFINITY, f64::max);
        let xi = surrogate.inputs.standardized(point);
        (surrogate.top(&surrogate.evaluate(&xi)).max_re - exact).powi(2)
    };
    let true_error = (fresh.iter().map(square).sum::<f64>() / fresh.len() as f64).sqrt();
    assert!(shown < 4.0 * true_error && true_error < 4.0 * shown, "{shown} {true_error}");
}

#[test]
fn runs_that_leave_out_a_part_of_the_laws_say_so() {
    let partial = build(&study(3, &table(3, &points(3, 60, |point| point[0] < 0.3), false), ""), &Silent).unwrap();
    let warnings = FitReport::warnings_of(&partial).join("\n");
    assert!(warnings.contains("no run is near 25.890 % of the cases, mu 0.373 to 0.500"), "{warnings}");
    let whole = build(&study(3, &table(3, &points(3, 60, |_| true), false), ""), &Silent).unwrap();
    assert!(!FitReport::warnings_of(&whole).join("\n").contains("no run is near"));
    assert!(setting(&whole, "uncovered_share").starts_with("Number(0"));
}

#[test]
fn of_a_long_table_the_fit_takes_what_a_design_would_and_the_rest_validates_it() {
    // Nine of ten runs lie in a tenth of the box.
    let mut runs = points(1, 270, |point| point[0] < 0.05);
    runs.extend(points(1, 30, |point| point[0] >= 0.05));
    let surrogate = build(&study(1, &table(1, &runs, false), "\n[design]\nmaximum = 20\n"), &Silent).unwrap();
    assert_eq!(surrogate.training.counts.values, 20);
    assert_eq!(setting(&surrogate, "validating_runs"), "Integer(280)");
    assert!(setting(&surrogate, "uncovered_share").starts_with("Number(0"));
    // About one in ten of those that are fitted lies in the heap, and the box is that of the runs.
    let [lower, upper] = surrogate.trained_interval(0).unwrap();
    assert!(lower < 0.03 && upper > 0.45, "{lower} {upper}");
    assert!((share(&surrogate) - share(built("clutch-r1"))).abs() < 1e-3);
}

#[test]
fn designs_continue_from_a_table() {
    let folder = folder(12, "data = \"runs.csv\"");
    let emit = ["design", "rig.toml", "--emit", "rows.csv", "--json"];
    let asked: Value = serde_json::from_str(&output(folder.path(), &emit)).unwrap();
    let count = asked["points"].as_u64().unwrap();
    assert!(count > 2 && asked["complete"] == false, "{asked}");
    let rows = fs::read_to_string(folder.path().join("rows.csv")).unwrap();
    let mut answers = "run,mu,k_p,k_f,re_1,im_1,re_2,im_2,re_3,im_3,re_4,im_4\n".to_owned();
    for row in rows.lines().skip(1) {
        let point: Vec<f64> = row.split(',').skip(1).map(|cell| cell.parse().unwrap()).collect();
        let cells: Vec<String> =
            answer(3, &point).iter().map(|lambda| format!("{:?},{:?}", lambda.re, lambda.im)).collect();
        let _ = writeln!(answers, "{row},{}", cells.join(","));
    }
    fs::write(folder.path().join("answers.csv"), answers).unwrap();
    output(folder.path(), &["ingest", "rig.toml", "answers.csv"]);
    let built: Value = serde_json::from_str(&output(folder.path(), &["build", "rig.toml", "--json"])).unwrap();
    assert_eq!(built["direct_computations"].as_u64(), Some(12 + count), "{built}");
    assert_eq!((&built["data"]["fitted"], built["reused_runs"].as_u64()), (&12.into(), Some(count)));
}

#[test]
fn estimates_are_those_of_the_laws_where_runs_lie_in_a_heap() {
    // Forty runs in a tenth of the box, and ten elsewhere: their residuals alone say what happens there.
    let mut runs = points(3, 40, |point| point[0] < 0.05);
    runs.extend(points(3, 10, |point| point[0] >= 0.05));
    let surrogate = build(&study(3, &table(3, &runs, false), ""), &Silent).unwrap();
    let found = share(&surrogate);
    let error = (found - share(built("clutch-r3"))).abs();
    let estimate = surrogate.decision.proportion_error.unwrap() * found;
    assert!(error <= 3.0 * estimate + 1.0 / SAMPLES as f64, "{error} {estimate}");
    // Effectively there are about as many as lie apart.
    assert!(surrogate.left_out.unwrap().runs().len() < 25);
}

#[test]
fn a_model_that_can_be_run_goes_on_from_given_runs() {
    let table = table(3, &points(3, 8, |_| true), false);
    let text = study_text(3).replace("kind = \"table\"", "kind = \"clutch\"");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("runs.csv");
    fs::write(&file, &table).unwrap();
    let options = DataOptions { files: vec![file], ..DataOptions::default() };
    let study = Study::from_toml_with(&text, Path::new("."), &options).unwrap();
    let surrogate = build(&study, &Silent).unwrap();
    let counts = surrogate.training.counts;
    assert!(counts.values > 8 && counts.gradients == counts.values - 8, "{counts:?}");
    assert_eq!(surrogate.training.levels[0], 8);
    assert!((share(&surrogate) - share(built("clutch-r3"))).abs() < 2e-4);
    let ledger = Ledger::blank(&study);
    let again = build(Campaign { study: &study, ledger: Some(&ledger), counts_failures: false }, &Silent).unwrap();
    assert_eq!(again, surrogate);
}

/// A folder with a study of a table with three inputs and a table with so many runs.
fn folder(runs: usize, more: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("rig.toml"),
        study_text(3).replace("kind = \"table\"", &format!("kind = \"table\"\n{more}")),
    )
    .unwrap();
    fs::write(folder.path().join("runs.csv"), table(3, &points(3, runs, |_| true), false)).unwrap();
    folder
}

#[test]
fn the_command_line_builds_from_a_table_and_says_what_became_of_it() {
    let folder = folder(40, "");
    let csv = fs::read_to_string(folder.path().join("runs.csv")).unwrap();
    let mut lines: Vec<String> = csv.lines().map(|line| format!("{line},me")).collect();
    lines[0] = lines[0].replace(",me", ",operator");
    lines.push(lines[1].clone());
    fs::write(folder.path().join("runs.csv"), lines.join("\n")).unwrap();
    let text = output(folder.path(), &["build", "rig.toml", "--data", "runs.csv", "--holdout", "0.25"]);
    insta::with_settings!({filters => vec![
        (r"\([0-9 ]+ bytes\), after [0-9.]+ s", "([bytes], after [time]"),
        (r"[0-9.]+(·10⁻\S+)? (1/s|% of)", "[number] $2"),
        (r"(S²|Q²) [0-9.−·⁻⁰-⁹¹²³ ]+", "$1 [number] "),
    ]}, { insta::assert_snapshot!(text); });
    assert!(!folder.path().join("rig.journal").exists(), "there is nothing to record");
    let json = output(folder.path(), &["build", "rig.toml", "--data", "runs.csv", "--holdout", "0.25", "--json"]);
    let json: Value = serde_json::from_str(&json).unwrap();
    let data = &json["data"];
    assert_eq!((&data["points"], &data["fitted"], &data["held_out"]), (&40.into(), &30.into(), &10.into()));
    assert_eq!((&data["repeated_rows"], &data["repeated"][0]), (&1.into(), &"runs.csv, line 42".into()));
    assert_eq!((&data["ignored_columns"][0], &data["validation"]["runs"]), (&"operator".into(), &10.into()));
    assert_eq!(json["direct_computations"], 30);
    output(folder.path(), &["eval", "rig.pcc", "-n", "1000"]);
}

#[test]
fn a_study_may_name_its_tables_itself() {
    let folder = folder(30, "data = [\"runs.csv\", \"more.csv\"]\nholdout = 0.2\ndecimal = \"comma\"");
    let csv = fs::read_to_string(folder.path().join("runs.csv")).unwrap();
    let local = |csv: &str| csv.replace(',', ";").replace('.', ",");
    fs::write(folder.path().join("runs.csv"), local(&csv)).unwrap();
    let others = table(3, &points(3, 50, |_| true).split_off(30), false);
    fs::write(folder.path().join("more.csv"), local(&others)).unwrap();
    let shown = output(folder.path(), &["build", "rig.toml", "--show-study"]);
    assert!(
        in_one_line(&shown).contains("data = [\"runs.csv\", \"more.csv\"]") && shown.contains("eigenvalues = 4"),
        "{shown}"
    );
    let json = output(folder.path(), &["build", "rig.toml", "--json"]);
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&json["data"]["fitted"], &json["data"]["held_out"]), (&40.into(), &10.into()));
    // The same from another folder, with tables that the command line names in their place.
    let elsewhere = tempfile::tempdir().unwrap();
    fs::write(elsewhere.path().join("own.csv"), &csv).unwrap();
    let study = folder.path().join("rig.toml").display().to_string();
    let json = output(
        elsewhere.path(),
        &["build", &study, "--data", "own.csv", "--decimal", "point", "--holdout", "0", "--json"],
    );
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&json["data"]["fitted"], &json["data"]["files"][0]), (&30.into(), &"own.csv".into()));
}

#[test]
fn wrong_tables_and_options_are_refused_with_what_to_do() {
    let folder = folder(20, "");
    let refuse = |table: &str, options: &[&str]| {
        fs::write(folder.path().join("wrong.csv"), table).unwrap();
        let arguments = [&["build", "rig.toml", "--data", "wrong.csv"][..], options].concat();
        in_one_line(&refusal(folder.path(), &arguments))
    };
    let csv = fs::read_to_string(folder.path().join("runs.csv")).unwrap();
    let outside = refuse(&csv.replacen("\n0.", "\n1.", 1), &[]);
    assert!(outside.contains("1 row cannot be taken, so none was: wrong.csv, line 2: mu = 1."), "{outside}");
    let constant: Vec<String> = csv
        .lines()
        .enumerate()
        .map(|(i, line)| match i {
            0 => line.to_owned(),
            _ => format!("0.25,{}", line.split_once(',').unwrap().1),
        })
        .collect();
    let constant = refuse(&constant.join("\n"), &[]);
    assert!(constant.contains("mu is 0.25 in every row, so that nothing is known of its influence"), "{constant}");
    let commas = refuse(&csv.replace(',', ";").replace('.', ","), &[]);
    assert!(commas.contains("with a decimal comma; say --decimal comma"), "{commas}");
    assert!(refuse(&csv, &["--delimiter", "tab"]).contains("has no column mu"));
    assert!(refuse(&csv, &["--delimiter", "0"]).contains("use comma, semicolon, tab, space or bar"));
    assert!(refuse(&csv, &["--holdout", "1"]).contains("a share of the runs from 0 to 0.9"));
    fs::remove_file(folder.path().join("wrong.csv")).unwrap();
    let nothing = refusal(folder.path(), &["build", "rig.toml", "--holdout", "0.2"]);
    assert!(nothing.contains("none is named; add --data FILE, or data in [model]"), "{nothing}");
    let missing = refusal(folder.path(), &["build", "rig.toml", "--data", "none.csv"]);
    assert!(missing.contains("none.csv cannot be read"), "{missing}");
    let key = refusal(folder.path(), &["build", "rig.toml"]);
    assert!(key.contains("eigenvalues"), "{key}");
}

#[test]
fn a_table_that_is_not_enough_gives_what_it_has_and_says_so() {
    let folder = folder(14, "data = \"runs.csv\"");
    let output = pcc(folder.path(), &["build", "rig.toml"]);
    assert!(output.status.success());
    let text = in_one_line(&String::from_utf8(output.stdout).unwrap());
    assert!(text.contains("the build ended after 14 model runs because no other runs were given"), "{text}");
}

/// One mode over two inputs, in a table of 6 by 6 rows: λ = −1 + x ± (10 + y)i.
fn one_mode(header: &str, cells: impl Fn(f64, f64) -> String) -> (tempfile::TempDir, String) {
    let folder = crate::support::studies::folder_with(
        "format = 1\nname = \"one\"\n[model]\nkind = \"table\"\n[inputs]\n\
         x = { distribution = \"uniform\", lower = 0.0, upper = 2.0 }\n\
         y = { distribution = \"uniform\", lower = 0.0, upper = 1.0 }\n",
    );
    let mut table = format!("{header}\n");
    for (i, j) in (0..36).map(|k| (f64::from(k % 6), f64::from(k / 6))) {
        let (x, y) = ((2.0 * i + 1.0 + 0.1 * j) / 6.5, (j + 0.5) / 6.0);
        writeln!(table, "{x},{y},{}", cells(x, y)).unwrap();
    }
    fs::write(folder.path().join("runs.csv"), &table).unwrap();
    (folder, table)
}

/// Solvers of complex matrices give conjugates but for rounding: they are no modes of their own.
#[test]
fn conjugates_that_are_rounded_are_those_of_their_modes() {
    let pair = |off: f64| {
        move |x: f64, y: f64| {
            format!("{},{},{},{}", x - 1.0, 10.0 + y, (x - 1.0) * (1.0 + off), -(10.0 + y) * (1.0 + off))
        }
    };
    for off in [0.0, 2e-16, 1e-12] {
        let (folder, _) = one_mode("x,y,re_1,im_1,re_2,im_2", pair(off));
        let report = output(folder.path(), &["build", "study.toml", "--data", "runs.csv", "--json"]);
        let report: Value = serde_json::from_str(&report).unwrap();
        assert_eq!(report["components"].as_array().unwrap().len(), 2, "{off}: {report}");
        let inspected = output(folder.path(), &["inspect", "one.pcc", "--json"]);
        assert!(!inspected.contains("inf"), "a place without a run where there is none: {inspected}");
        let found: Value =
            serde_json::from_str(&output(folder.path(), &["eval", "one.pcc", "-n", "20000", "--json"])).unwrap();
        assert!((found["unstable_proportion"].as_f64().unwrap() - 0.5).abs() < 0.02, "{found}");
    }
}

#[test]
fn columns_that_nobody_has_named_are_no_eigenvalues() {
    let (folder, _) = one_mode("x,y,real_01,real_02", |x, _| format!("{},{}", -1.0 - x, -2.0));
    let error = refusal(folder.path(), &["build", "study.toml", "--data", "runs.csv"]);
    assert!(error.contains("real_01") && error.contains("re_"), "{error}");
}

#[test]
fn too_few_runs_are_counted_and_causes_of_failures_are_told() {
    let (folder, table) = one_mode("x,y,re_1,im_1", |x, y| format!("{},{}", x - 1.0, 10.0 + y));
    let two: Vec<&str> = table.lines().take(2).chain(table.lines().last()).collect();
    fs::write(folder.path().join("two.csv"), two.join("\n") + "\n").unwrap();
    let error = refusal(folder.path(), &["build", "study.toml", "--data", "two.csv", "--holdout", "0.5"]);
    assert!(error.contains("at least 2 model runs, and here are 1"), "{error}");
    let (folder, _) = one_mode("x,y,re_1,im_1,error", |_, _| ",,diverged".to_owned());
    let study = fs::read_to_string(folder.path().join("study.toml")).unwrap();
    let study = study.replace("kind = \"table\"", "kind = \"table\"\non_failure = \"skip\"");
    fs::write(folder.path().join("study.toml"), study).unwrap();
    let error = in_one_line(&refusal(folder.path(), &["build", "study.toml", "--data", "runs.csv"]));
    assert!(error.contains("36 model runs failed") && error.contains("diverged"), "{error}");
}
