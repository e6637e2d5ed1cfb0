//! Samples beyond all model runs: counted, reported with what they mean, and the same however they are divided.

use crate::laws::{NORMAL, UNIFORM, built, oscillator};
use crate::support::command::{output, refusal};
use crate::support::in_one_line;
use crate::support::studies::{built_from, json, number};
use pcc_evaluate::foundation::{InstructionSet, Silent};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// λ = u + x − 1.1 ± ≈10i, u uniform and x of this law.
fn with_law(law: &str) -> String {
    oscillator(&[("u", UNIFORM), ("x", law)], 1.1, "")
}

fn folder_with(law: &str) -> TempDir {
    built_from(&with_law(law))
}

/// Where the model was run, along x.
fn trained(folder: &Path) -> [f64; 2] {
    let report = json(folder, &["inspect", "built.pcc"]);
    assert!(report["inputs"][0]["trained"].is_null(), "{report}");
    ["lower", "upper"].map(|end| number(&report, &format!("/inputs/1/trained/{end}")))
}

#[test]
fn shares_are_those_of_the_tails() {
    // A law, its distribution function, and its end.
    type Law = (&'static str, fn(f64) -> f64, f64);
    let laws: [Law; 4] = [
        ("\"exponential\", mean = 0.5", |x| 1.0 - (-x / 0.5).exp(), f64::INFINITY),
        ("\"weibull\", shape = 1.5, scale = 1.0", |x| 1.0 - (-x.powf(1.5)).exp(), f64::INFINITY),
        ("\"gumbel\", location = 1.0, scale = 0.2", |x| (-(-(x - 1.0) / 0.2).exp()).exp(), f64::INFINITY),
        // Between its bounds the density of a very wide normal law is level.
        ("\"normal\", mean = 1.0, std = 1e4, lower = 0.5, upper = 1.5", |x| x - 0.5, 1.5),
    ];
    for (law, below, last) in laws {
        let folder = folder_with(law);
        let [from, to] = trained(folder.path());
        let eval = ["eval", "built.pcc", "-n", "1000000"];
        let report = json(folder.path(), &eval);
        let found = number(&report, "/extrapolated_proportion");
        let expected = below(from) + 1.0 - below(to);
        let error = (expected * (1.0 - expected) / 1e6).sqrt();
        assert!(expected > 1e-4 && (found - expected).abs() < 4.5 * error, "{law}: {found} for {expected}");
        // On condition that x lies above the middle of the interval.
        let start = 0.5 * (from + to);
        let end = last.min(to + 0.5 * (to - from));
        let inside = format!("x={start}..{end}");
        let report = json(folder.path(), &[&eval[..], &["--where", &inside]].concat());
        let expected = (below(end) - below(to)) / (below(end) - below(start));
        let found = number(&report, "/extrapolated_proportion");
        let error = (expected * (1.0 - expected) / 1e6).sqrt();
        assert!(expected > 1e-4 && (found - expected).abs() < 4.5 * error, "{law}, {inside}: {found} for {expected}");
        // All of it, and nothing.
        let fixed = |at: f64| {
            let report = json(folder.path(), &["eval", "built.pcc", "-n", "1000", "--where", &format!("x={at}")]);
            number(&report, "/extrapolated_proportion")
        };
        assert_eq!((fixed(start), fixed(to + 1e-6 * (to - from))), (0.0, 1.0), "{law}");
    }
}

/// With x alone λ is negative below 1.1: all below the runs is stable, all above unstable.
#[test]
fn bounds_are_what_is_left_without_the_tails() {
    let folder = folder_with(NORMAL);
    let [from, to] = trained(folder.path());
    let eval = ["eval", "built.pcc", "-n", "1000000", "--where", "u=0"];
    let report = json(folder.path(), &eval);
    let stable = number(&report, "/stable_proportion");
    let inside = json(folder.path(), &[&eval[..], &["--where", &format!("x={from}..{to}")]].concat());
    assert_eq!(number(&inside, "/extrapolated_proportion"), 0.0);
    let outside = number(&report, "/extrapolated_proportion");
    // Φ(1/2) of the whole is stable, and the same number less that below `from` inside.
    let below = 0.691_462_461_274_013_2 - number(&inside, "/stable_proportion") * (1.0 - outside);
    let bounds = |end: &str| number(&report, &format!("/extrapolated_bounds/stable/{end}"));
    assert!((stable - below - bounds("lower")).abs() < 0.003, "{stable} − {below}: {report}");
    assert!((stable + outside - below - bounds("upper")).abs() < 0.003, "{stable} + {outside} − {below}: {report}");
    assert!(bounds("lower") < stable && stable < bounds("upper"));
    let unstable = ["lower", "upper"].map(|end| number(&report, &format!("/extrapolated_bounds/unstable/{end}")));
    assert!(
        (unstable[0] - (1.0 - bounds("upper"))).abs() < 1e-12 && (unstable[1] - (1.0 - bounds("lower"))).abs() < 1e-12
    );
}

#[test]
fn texts_warn_of_more_than_errors_speak_for() {
    let folder = folder_with(NORMAL);
    let shown = |arguments: &[&str]| in_one_line(&output(folder.path(), arguments));
    let whole = shown(&["eval", "built.pcc", "-n", "10000"]);
    assert!(!whole.contains("beyond all model runs"), "{whole}");
    let details = shown(&["eval", "built.pcc", "-n", "10000", "--details"]);
    assert!(details.contains("are stable, whatever the model would say there"), "{details}");
    assert!(details.contains("beyond all model runs in some input; "), "{details}");
    let tail = shown(&["eval", "built.pcc", "-n", "10000", "--where", "x=1.5..2.5"]);
    assert!(tail.starts_with("warning: 100 % of the samples lie beyond all model runs in some input"), "{tail}");
    assert!(tail.contains("0 to 100 % are stable, whatever the model would say there"), "{tail}");
    let sweep = shown(&["eval", "built.pcc", "-n", "1000", "--sweep", "x=1..2:11"]);
    assert!(sweep.contains("of 11 points of the sweep"), "{sweep}");
    let sweep = json(folder.path(), &["eval", "built.pcc", "-n", "1000", "--sweep", "x=1..2:11"]);
    assert_eq!(
        (number(&sweep, "/points/0/extrapolated_proportion"), number(&sweep, "/points/10/extrapolated_proportion")),
        (0.0, 1.0)
    );
    let inspect = shown(&["inspect", "built.pcc"]);
    assert!(inspect.contains("law from to model run from to u 0 0.2 everywhere x −∞ ∞ 0."), "{inspect}");
}

#[test]
fn counts_depend_on_no_division() {
    let folder = folder_with(NORMAL);
    let without_time = |mut report: Value| {
        report["elapsed_seconds"] = Value::Null;
        report
    };
    for sampler in ["monte-carlo", "sobol", "latin-hypercube"] {
        let eval = ["eval", "built.pcc", "-n", "65536", "--sampler", sampler];
        let whole = without_time(json(folder.path(), &eval));
        assert!(number(&whole, "/extrapolated_proportion") > 0.0);
        for threads in ["1", "2", "8"] {
            let again = json(folder.path(), &[&eval[..], &["--threads", threads]].concat());
            assert_eq!(without_time(again), whole, "{threads} threads");
        }
        for set in InstructionSet::available() {
            let again = json(folder.path(), &[&eval[..], &["--instructions", set.name()]].concat());
            assert_eq!(without_time(again), whole, "{set:?}");
        }
        for shard in ["0/3", "1/3", "2/3"] {
            let part = format!("{}.part", &shard[..1]);
            output(folder.path(), &[&eval[..], &["--shard", shard, "--part", &part]].concat());
        }
        let merged = json(folder.path(), &["merge", "2.part", "0.part", "1.part"]);
        assert_eq!(without_time(merged), whole, "merged");
    }
}

/// What is counted is what a look at every point says.
#[test]
fn counts_are_those_of_single_points() {
    use pcc_evaluate::evaluation::{Question, Survey, Surveyed};
    use pcc_evaluate::probability::inputs::random_points;
    use pcc_evaluate::probability::random::Purpose;
    let surrogate = built();
    let domain = surrogate.trained_domain.clone().unwrap();
    let points = random_points(&surrogate.inputs, 3, Purpose::Evaluation, 0..10_001);
    let question = Question::plain(points.len() as u64, 3);
    let survey = Survey::new(&surrogate, &question, InstructionSet::best()).unwrap();
    let Surveyed::Complete(found) = survey.run(0..survey.division().chunks(), &Silent).unwrap() else { panic!() };
    let found = found.total().unwrap().extrapolated.unwrap();
    let outside: Vec<&Vec<f64>> = points.iter().filter(|point| !domain.holds(point)).collect();
    let is_stable = |point: &Vec<f64>| {
        let lambdas = surrogate.eigenvalues(&surrogate.evaluate(point));
        lambdas.iter().all(|lambda| lambda.re < 0.0)
    };
    let stable = outside.iter().filter(|point| is_stable(point)).count() as u64;
    assert_eq!((found.samples, found.stable), (outside.len() as u64, stable));
    assert!(found.samples > 0 && found.unstable == found.samples - found.stable);
}

#[test]
fn uniform_inputs_are_not_counted() {
    let folder = folder_with("\"log-uniform\", lower = 0.5, upper = 1.5");
    let report = json(folder.path(), &["eval", "built.pcc", "-n", "1000"]);
    assert!(report.get("extrapolated_proportion").is_none() && report.get("extrapolated_bounds").is_none());
    let shown = in_one_line(&output(folder.path(), &["eval", "built.pcc", "-n", "1000", "--details"]));
    assert!(!shown.contains("extrapolated"), "{shown}");
    output(folder.path(), &["convert", "built.pcc", "built.json"]);
    assert!(!fs::read_to_string(folder.path().join("built.json")).unwrap().contains("\"domain\""));
    assert!(!output(folder.path(), &["inspect", "built.pcc"]).contains("model run from"));
}

#[test]
fn points_beyond_all_runs_are_counted_and_those_at_infinity_refused() {
    let at = |law: &str, rows: &str| {
        let folder = folder_with(law);
        fs::write(folder.path().join("points.csv"), format!("u,x\n{rows}")).unwrap();
        folder
    };
    let points = ["eval", "built.pcc", "--points", "points.csv", "--out", "out.csv"];
    let folder = at(NORMAL, "0.1,1.0\n0.0,1.9\n0.2,-3\n");
    let said = in_one_line(&output(folder.path(), &points));
    assert!(said.contains("warning: 2 of them lie beyond all model runs in some input"), "{said}");
    assert_eq!(json(folder.path(), &points)["extrapolated_points"], 2);
    // The end of an exponential law is as far out as samples come; that of a lognormal one by its logarithm
    // is at infinity.
    let folder = at("\"exponential\", mean = 0.5", "0.1,0.0\n");
    let said = in_one_line(&output(folder.path(), &points));
    assert!(said.contains("warning: 1 of them lie"), "{said}");
    let folder = at("\"lognormal\", mean = 1.0, std = 0.2, polynomials = \"hermite\"", "0.1,1.0\n0.1,0.0\n");
    let said = in_one_line(&refusal(folder.path(), &points));
    assert!(
        said.contains("row 2: x = 0.0 lies where its lognormal law ends, infinitely far from all model runs"),
        "{said}"
    );
    assert!(!folder.path().join("out.csv").exists());
}
