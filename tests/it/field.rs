//! Systems in the manner of those that people bring: real, overdamped and crossing eigenvalues.
//!
//! The studies are in `tests/data/field`, built with their defaults. What is right comes from `truth.py` there, which
//! shares no code with pcc.

use crate::support::command::{output, refusal};
use crate::support::{in_one_line, repository, text};
use pcc_compile::compilation::build;
use pcc_compile::reference::ModelSample;
use pcc_compile::study::Study;
use pcc_evaluate::components::Verdict;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::surrogate::Surrogate;
use std::fs;

/// Points on which surrogate and model are compared.
const POINTS: u64 = 20_000;

/// Names, most model runs, and points in a hundred that may be misclassified.
const BARS: [(&str, u64, f64); 12] = [
    ("cap", 20, 0.005),
    ("overdamped", 20, 0.005),
    ("count", 20, 0.005),
    ("bike", 20, 0.01),
    ("bike-from-standstill", 20, 0.01),
    ("rayleigh", 40, 0.01),
    ("beam", 40, 0.01),
    ("wing", 40, 0.01),
    ("driveline", 30, 0.01),
    ("axi", 40, 0.01),
    ("blades", 60, 0.01),
    ("bearings", 120, 0.3),
];

fn study(name: &str) -> Study {
    Study::from_toml(&text(&format!("tests/data/field/{name}.toml"))).unwrap()
}

/// The surrogate of a study, with its defaults.
pub fn built(name: &str) -> Surrogate {
    build(&study(name), &Silent).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Stable, flutter and divergence shares by NumPy.
fn truth(name: &str) -> [f64; 3] {
    let table = text("tests/data/field/truth.csv");
    let row = table.lines().find(|line| line.split(',').next() == Some(name)).unwrap();
    let cells: Vec<f64> = row.split(',').skip(2).take(3).map(|cell| cell.parse().unwrap()).collect();
    cells.try_into().unwrap()
}

#[test]
fn surrogates_of_systems_from_the_field_agree_with_their_models_and_with_numpy() {
    for (name, most_runs, most_misclassified) in BARS {
        let (study, surrogate) = (study(name), built(name));
        let sample = ModelSample::new(&study, POINTS, 7, &Silent).unwrap();
        let comparison = sample.compare(&surrogate).unwrap();
        let runs = surrogate.training.counts.direct_computations;
        assert!(runs <= most_runs, "{name}: {runs} runs");
        let misclassified = comparison.misclassified_percent();
        assert!(misclassified <= most_misclassified, "{name}: {misclassified} %");

        let block = sample.surrogate_at(&surrogate, POINTS as usize).unwrap();
        let verdicts: Vec<Verdict> = (0..POINTS as usize).map(|sample| block.top(sample).verdict()).collect();
        let kinds = [Verdict::Stable, Verdict::Flutter, Verdict::Divergence];
        for (kind, expected) in kinds.into_iter().zip(truth(name)) {
            let share = verdicts.iter().filter(|verdict| **verdict == kind).count() as f64 / POINTS as f64;
            // Four standard errors of a share, and what is misclassified.
            let tolerance = 4.0 * (expected * (1.0 - expected) / POINTS as f64).sqrt() + 0.01 * most_misclassified;
            assert!((share - expected).abs() <= tolerance, "{name}: {kind:?} {share}, not {expected}");
        }
    }
}

/// The benchmark bicycle: weave is stable from 4.2924 m/s on, capsize until 6.0243 m/s.
#[test]
fn a_window_of_stability_has_two_crossings() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::copy(repository("tests/data/field/bike.toml"), path.join("bike.toml")).unwrap();
    output(path, &["build", "bike.toml"]);
    let said = output(path, &["eval", "bike.pcc", "-n", "20000", "--critical", "v", "--json"]);
    let report: serde_json::Value = serde_json::from_str(&said).unwrap();
    let crossings = report["critical"]["crossings"].as_array().unwrap();
    let expected = [(1, "regained", "flutter", 4.29238253634), (2, "lost", "divergence", 6.02426201539)];
    assert_eq!(crossings.len(), expected.len(), "{crossings:?}");
    for (crossing, (order, stability, kind, value)) in crossings.iter().zip(expected) {
        assert_eq!(
            (&crossing["order"], &crossing["stability"], &crossing["kind"]),
            (&order.into(), &stability.into(), &kind.into())
        );
        assert!((crossing["mean"].as_f64().unwrap() - value).abs() < 1e-3, "{crossing}");
    }
    assert!((report["stable_proportion"].as_f64().unwrap() - 0.34638).abs() < 0.015);
    let share = |name: &str| report[name].as_f64().unwrap();
    assert!(
        (share("flutter_proportion") + share("divergence_proportion") - share("unstable_proportion")).abs() < 1e-12
    );
    let text = output(path, &["eval", "bike.pcc", "-n", "20000", "--critical", "v", "--events", "flutter,divergence"]);
    insta::with_settings!({filters => vec![(r"in [0-9.]+ s \([0-9 ]+ per second\)", "in [time]")]}, {
        insta::assert_snapshot!(text);
    });

    // Eigenvalues at v = 5 m/s, where the windows are.
    fs::write(path.join("points.csv"), "v\n5\n").unwrap();
    for (command, name) in [("eval", "bike.pcc"), ("reference", "bike.toml")] {
        output(path, &[command, name, "--points", "points.csv", "--out", "out.csv"]);
        let out = fs::read_to_string(path.join("out.csv")).unwrap();
        let (header, row) = out.trim_end().split_once('\n').unwrap();
        assert_eq!(header, "v,re_1,im_1,re_1_b,real_1,real_2,max_re,stable,verdict", "{command}");
        assert!(row.ends_with(",1,stable"), "{command}: {row}");
        let cells: Vec<f64> = row.split(',').take(7).map(|cell| cell.parse().unwrap()).collect();
        for (cell, expected) in cells[1..].iter().zip([-0.7753, 4.4649, -0.7753, -0.3229, -14.078, -0.3229]) {
            assert!((cell - expected).abs() < 1e-3, "{command}: {row}");
        }
    }
}

/// At p = 50 the slow eigenvalue is zero: it is no rigid-body motion for that, in the middle of the inputs least of
/// all.
#[test]
fn a_slow_eigenvalue_that_passes_zero_in_the_middle_keeps_its_column() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::copy(repository("tests/data/field/cap.toml"), path.join("cap.toml")).unwrap();
    fs::write(path.join("points.csv"), "p\n45\n50\n55\n").unwrap();
    output(path, &["build", "cap.toml"]);
    for (command, name) in [("eval", "cap.pcc"), ("reference", "cap.toml")] {
        output(path, &[command, name, "--points", "points.csv", "--out", "out.csv"]);
        let out = fs::read_to_string(path.join("out.csv")).unwrap();
        let mut lines = out.lines();
        let header: Vec<&str> = lines.next().unwrap().split(',').collect();
        let at = |name: &str| header.iter().position(|column| *column == name).unwrap();
        for (line, p) in lines.zip([45.0f64, 50.0, 55.0]) {
            let cells: Vec<&str> = line.split(',').collect();
            let number = |name: &str| cells[at(name)].parse::<f64>().unwrap();
            // λ² + 30 λ + 50 − p = 0
            let root = (225.0 - (50.0 - p)).sqrt();
            assert!((number("real_1") - (root - 15.0)).abs() < 1e-6, "{command}: {line}");
            assert!((number("real_2") - (-root - 15.0)).abs() < 1e-6, "{command}: {line}");
            assert!((number("im_1") - 9.9994999875).abs() < 1e-6, "{command}: {line}");
        }
    }
}

/// What 0.1.0 refused because modes stop oscillating.
#[test]
fn a_clutch_whose_modes_stop_oscillating_is_built() {
    let text = text("surrogates/clutch-r2.toml")
        .replace("mu      = {", "c_f = {")
        .replace("upper = 0.5", "upper = 4e3")
        .replace("[inputs]", "[model.constants]\nk_f = 2e4\n[inputs]");
    let study = Study::from_toml(&text).unwrap();
    let surrogate = build(&study, &Silent).unwrap();
    let comparison = ModelSample::new(&study, POINTS, 7, &Silent).unwrap().compare(&surrogate).unwrap();
    assert!(comparison.misclassified_percent() <= 0.01, "{}", comparison.misclassified_percent());
}

#[test]
fn the_paper_s_target_refuses_a_changing_number_of_modes_and_names_the_other() {
    let folder = tempfile::tempdir().unwrap();
    let study = text("tests/data/field/bike-from-standstill.toml") + "\n[spectrum]\ntarget = \"eigenvalues\"\n";
    fs::write(folder.path().join("bike.toml"), study).unwrap();
    let message = refusal(folder.path(), &["build", "bike.toml"]);
    assert!(message.contains("modes oscillate at") && message.contains("\"invariants\""), "{message}");
}

#[test]
fn inputs_named_like_columns_of_results_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["max_re", "stable", "verdict", "re_1", "im_2", "re_1_b", "real_1"] {
        let study = text("tests/data/field/cap.toml")
            .replace("50 - p", &format!("50 - {name}"))
            .replace("p = {", &format!("{name} = {{"));
        fs::write(folder.path().join("named.toml"), study).unwrap();
        let message = refusal(folder.path(), &["build", "named.toml"]);
        assert!(message.contains(&format!("results have a column {name}")), "{message}");
    }
}

/// In every seed the mode that no run may have seen flutter does so in a thousandth of the box.
#[test]
fn a_rare_flutter_is_never_reported_as_none() {
    let study = Study::from_toml(&text("surrogates/clutch-r4.toml").replace("upper = 0.5", "upper = 0.0723")).unwrap();
    for seed in 1..=4 {
        let surrogate = build(&Study { seed, ..study.clone() }, &Silent).unwrap();
        let summary = pcc_evaluate::evaluation::monte_carlo(&surrogate, 400_000, 1, &Silent).unwrap();
        let share = summary.unstable as f64 / 400_000.0;
        assert!((8.5e-4..1.1e-3).contains(&share) && summary.divergent == 0, "seed {seed}: {share}");
    }
}

#[test]
fn lists_that_split_a_group_are_answered_with_the_smallest_that_works() {
    let folder = tempfile::tempdir().unwrap();
    let blades = text("tests/data/field/blades.toml");
    fs::write(folder.path().join("blades.toml"), blades + "\n[spectrum]\nmodes = [2]\n").unwrap();
    let message = refusal(folder.path(), &["build", "blades.toml"]);
    assert!(message.contains("use modes = ["), "{message}");
}

/// Four nearly equal modes: a small design takes them for pairs. The first answer is the last one.
#[test]
fn the_smallest_list_that_is_named_works() {
    let ring = |modes: &str| {
        format!(
            r#"
            format = 1
            name = "ring"
            [model]
            kind = "matrices"
            M = {{ diagonal = [1, 1, 1, 1] }}
            C = {{ diagonal = ["c", "c", "c", "c"] }}
            K = [["1000 + e1", -5, 0, -5], [-5, "1000 + e2", -5, 0], [0, -5, "1000 - e1", -5], [-5, 0, -5, "1000 - e2"]]
            N = {{ size = 4, form = "skew-symmetric", entries = [[2, 1, "f"], [3, 2, "f"], [4, 3, "f"], [4, 1, "-f"]] }}
            [inputs]
            e1 = {{ distribution = "uniform", lower = -8.0, upper = 8.0 }}
            e2 = {{ distribution = "uniform", lower = -8.0, upper = 8.0 }}
            f = {{ distribution = "uniform", lower = 0.0, upper = 6.0 }}
            c = {{ distribution = "uniform", lower = 0.0, upper = 0.3 }}
            [spectrum]
            target = "invariants"
            modes = {modes}
            "#
        )
    };
    let built = |modes: &str| build(&Study::from_toml(&ring(modes)).unwrap(), &Silent);
    for modes in ["[2]", "[2, 3]", "[1, 3]"] {
        let message = built(modes).unwrap_err().to_string();
        assert!(message.ends_with("use modes = [1, 2, 3, 4]"), "{modes}: {message}");
    }
    assert_eq!(built("[1, 2, 3, 4]").unwrap().modes(), [1, 2, 3, 4]);
}

/// The capsize of the bicycle diverges whatever its weave does.
#[test]
fn an_eigenvalue_that_is_not_listed_and_decides_is_said_by_every_face() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("bike.toml"), text("tests/data/field/bike.toml") + "\n[spectrum]\nmodes = [1]\n").unwrap();
    let warning = "an eigenvalue that the surrogate does not hold decides";
    for arguments in [
        &["build", "bike.toml"][..],
        &["eval", "bike.pcc", "-n", "1000"],
        &["eval", "bike.pcc", "-n", "1000", "--json"],
        &["inspect", "bike.pcc"],
    ] {
        let said = in_one_line(&output(path, arguments));
        assert!(said.contains(warning), "{arguments:?}: {said}");
    }
}

/// A certificate that excludes the share is said before it.
#[test]
fn a_certificate_that_contradicts_the_surrogate_is_said_first() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::copy(repository("tests/data/field/cap.toml"), path.join("cap.toml")).unwrap();
    output(path, &["build", "cap.toml", "-o", "cap.json", "--format", "json"]);
    // A surrogate that says that nothing diverges: its slow eigenvalue is moved away.
    let mut surrogate = pcc_evaluate::artifact::read(&path.join("cap.json")).unwrap().surrogate;
    let slow = surrogate.components().into_iter().find(|component| component.name == "real_1").unwrap().id;
    surrogate.expansions[slow].coefficients[0] -= 10.0;
    surrogate.self_test = surrogate.make_self_test(surrogate.self_test.points.clone());
    let bytes = pcc_evaluate::artifact::encode(&surrogate, pcc_evaluate::artifact::Format::Binary).unwrap();
    fs::write(path.join("wrong.pcc"), bytes).unwrap();
    let said = output(path, &["certify", "wrong.pcc", "--study", "cap.toml", "--runs", "200", "-o", "wrong.pcc"]);
    assert!(said.contains("contradict the surrogate"), "{said}");
    let said = output(path, &["eval", "wrong.pcc", "-n", "1000"]);
    let (warning, headline) =
        (said.find("a certificate contradicts").unwrap(), said.find("wrong is").or(said.find("cap is")).unwrap());
    assert!(warning < headline, "{said}");
}

/// A mass, a time constant that vanish inside the ranges, and a mass that does so at their edge.
#[test]
fn an_eigenvalue_that_goes_to_infinity_is_an_error_that_names_the_place() {
    let mass = r#"
        kind = "matrices"
        M = { diagonal = ["x", 1] }
        C = { diagonal = [2, "c"] }
        K = [[50, -5], [-5, 100]]"#;
    let lag = r#"
        kind = "matrices"
        A = [["-1/x", "1/x", 0], [0, 0, 1], [-5, -30, "-c"]]"#;
    for (model, lower, upper) in [(mass, -0.5, 1.0), (mass, 0.0, 1.0), (lag, -0.01, 0.03)] {
        let study = format!(
            r#"
            format = 1
            name = "infinite"
            [model]{model}
            [inputs]
            x = {{ distribution = "uniform", lower = {lower}, upper = {upper} }}
            c = {{ distribution = "uniform", lower = -1.0, upper = 2.0 }}
            [spectrum]
            target = "invariants"
            "#
        );
        let study = Study::from_toml(&study).unwrap();
        let message = build(&study, &Silent).unwrap_err().to_string();
        let place = message.split("near x = ").nth(1).and_then(|rest| rest.split(',').next()).unwrap_or_default();
        assert!(message.starts_with("an eigenvalue goes to infinity"), "{message}");
        assert!(place.parse::<f64>().unwrap().abs() < 1e-3 * (upper - lower), "{message}");
    }
}

/// A column that buckles only where its spring is soft and its load is high, in a corner that the runs of most designs
/// do not reach: 3.1, 0.9 and 0.2 % of the box.
#[test]
fn divergence_that_no_run_has_seen_is_found() {
    let column = |most_load: f64| {
        format!(
            r#"
            format = 1
            name = "column"
            [model]
            kind = "matrices"
            M = {{ diagonal = [1, 2] }}
            C = {{ diagonal = ["c", "c"] }}
            K = {{ form = "symmetric", rows = [["2*k - p"], ["-k", "2*k - p"]] }}
            [inputs]
            k = {{ distribution = "uniform", lower = 80.0, upper = 120.0 }}
            p = {{ distribution = "uniform", lower = 0.0, upper = {most_load} }}
            c = {{ distribution = "uniform", lower = 0.5, upper = 3.0 }}
            [spectrum]
            target = "invariants"
            "#
        )
    };
    for most_load in [95.0, 88.0, 84.0] {
        let study = Study::from_toml(&column(most_load)).unwrap();
        let sample = ModelSample::new(&study, POINTS, 7, &Silent).unwrap();
        for seed in 1..=5 {
            let surrogate = build(&Study { seed, ..study.clone() }, &Silent).unwrap();
            let comparison = sample.compare(&surrogate).unwrap();
            assert!(comparison.proportion_model() < 1.0, "load to {most_load}");
            assert!(comparison.misclassified_percent() <= 0.01, "load to {most_load}, seed {seed}: {comparison:?}");
        }
    }
}

/// Slow eigenvalues beside fast ones: a heavy mass on a soft mount, an integrator beside a current loop, a mode beside
/// a stiff one. They lie below a millionth of the largest, and alone decide.
#[test]
fn slow_eigenvalues_are_no_rigid_body_motion() {
    let wide = r#"
        M = { diagonal = [1200, 0.05] }
        C = { diagonal = ["b - a", 2.0] }
        K = { diagonal = ["1200*(2*pi*f)^2", 7.1e9] }
        [inputs]
        f = { distribution = "uniform", lower = 0.04, upper = 0.05 }
        b = { distribution = "uniform", lower = 20.0, upper = 30.0 }
        a = { distribution = "uniform", lower = 20.0, upper = 30.0 }"#;
    let drift = r#"
        A = [["-R/1e-6", 0.1, 0], [0, "p", 0.1], [0, -0.1, "-20"]]
        [inputs]
        R = { distribution = "uniform", lower = 2.0, upper = 5.0 }
        p = { distribution = "uniform", lower = -0.9, upper = 0.9 }"#;
    let stiff = r#"
        M = { diagonal = [1, 1] }
        C = { diagonal = [1e4, "c"] }
        K = { diagonal = ["k", 100] }
        [inputs]
        k = { distribution = "uniform", lower = 1.0e15, upper = 2.0e15 }
        c = { distribution = "uniform", lower = -0.5, upper = 0.2 }"#;
    // c > g in half of the box; p < 0 but for the 5e-4 of the other mode; c > 0 in two sevenths.
    for (name, model, stable) in [("wide", wide, 0.5), ("drift", drift, 0.5), ("stiff", stiff, 2.0 / 7.0)] {
        let text = format!(
            "format = 1\nname = \"{name}\"\n[model]\nkind = \"matrices\"{model}\n[spectrum]\ntarget = \"invariants\"\n"
        );
        let study = Study::from_toml(&text).unwrap();
        let sample = ModelSample::new(&study, POINTS, 7, &Silent).unwrap();
        let surrogate = build(&study, &Silent).unwrap();
        let comparison = sample.compare(&surrogate).unwrap();
        let share = comparison.proportion_model();
        assert!((share - stable).abs() < 0.01, "{name}: {share}");
        assert!(comparison.misclassified_percent() <= 0.02, "{name}: {comparison:?}");
    }
}

/// Frequencies cross in a strip of flutter between the runs: 4.026 % by the roots of max Re λ. Vectors seem to pass
/// through it, and three of twelve seeds once found nothing, one of them "stable everywhere".
#[test]
fn a_narrow_strip_of_flutter_between_crossing_modes_is_found() {
    let text = "format = 1\nname = \"strip\"\n[model]\nkind = \"matrices\"\nM = { diagonal = [1, 1] }\n\
         C = { diagonal = [0.5, 0.5] }\nK = [[\"k1\", COUPLING], [\"-COUPLING\", 4000]]\n[inputs]\n\
         k1 = { distribution = \"uniform\", lower = 500.0, upper = 12000.0 }\n";
    for (coupling, seed) in [(120, 8), (120, 9), (120, 12), (60, 2), (200, 5), (35, 3)] {
        let text = text.replace("\"-COUPLING\"", &format!("-{coupling}")).replace("COUPLING", &coupling.to_string());
        let study = Study { seed, ..Study::from_toml(&text).unwrap() };
        let surrogate = build(&study, &Silent).unwrap();
        let compared = ModelSample::new(&study, POINTS, 7, &Silent).unwrap().compare(&surrogate).unwrap();
        let [model, found] = compared.unstable();
        // What is not found is not claimed to be known.
        let is_unknown = surrogate.decision.proportion_error.is_none();
        let is_right = (found - model).abs() <= 0.002 && compared.misclassified_percent() < 0.2;
        assert!(model > 0.0 && (is_right || is_unknown), "{coupling}, {seed}: {found} for {model}");
        assert!(coupling != 120 || seed == 12 || is_right, "{coupling}, {seed}: {found} for {model}");
    }
}

/// The boundary of a single input is some points: errors there are those of one place, whatever the number of runs.
#[test]
fn errors_at_the_boundary_of_a_single_input_do_not_average_out() {
    let text = "format = 1\nname = \"strip\"\n[model]\nkind = \"matrices\"\nM = { diagonal = [1, 1] }\n\
         C = { diagonal = [0.5, 0.5] }\nK = [[\"k1\", 120], [-120, 4000]]\n[inputs]\n\
         k1 = { distribution = \"uniform\", lower = 500.0, upper = 12000.0 }\n";
    for seed in [3, 4, 6] {
        let study = Study { seed, ..Study::from_toml(text).unwrap() };
        let surrogate = build(&study, &Silent).unwrap();
        let compared = ModelSample::new(&study, 100_000, 7, &Silent).unwrap().compare(&surrogate).unwrap();
        let [model, found] = compared.unstable();
        let estimated = surrogate.decision.proportion_error.unwrap() * (1.0 - found);
        assert!((found - model).abs() <= 2.0 * estimated + 3e-5, "seed {seed}: {found} for {model} ± {estimated}");
    }
}

/// A spring that is not there in a quarter of the cases: the mass is marginal then, if its damper is positive.
#[test]
fn a_stiffness_that_vanishes_in_a_part_of_the_cases_is_marginal_there() {
    let text = "format = 1\nname = \"loose\"\n[model]\nkind = \"matrices\"\nM = [[1]]\nC = [[\"c\"]]\nK = [[\"k\"]]\n\
         [inputs]\nc = { distribution = \"uniform\", lower = -0.1, upper = 0.9 }\n\
         k = { distribution = \"discrete\", values = [0, 50], weights = [1, 3] }\n";
    for seed in 1..=3 {
        let study = Study { seed, ..Study::from_toml(text).unwrap() };
        let surrogate = build(&study, &Silent).unwrap();
        let compared = ModelSample::new(&study, POINTS, 7, &Silent).unwrap().compare(&surrogate).unwrap();
        let [marginal, found] = compared.marginal();
        assert!((marginal - 0.225).abs() < 0.03, "the model itself: {marginal}");
        // Where the damper vanishes as well, errors of both eigenvalues grow.
        assert!((found - marginal).abs() <= 0.01, "seed {seed}: {found} for {marginal}");
        assert!(compared.misclassified_percent() < 1.0, "seed {seed}: {}", compared.misclassified_percent());
    }
}

/// In tails beyond all runs the reciprocal of a product of eigenvalues that grow comes as near to zero as can be.
#[test]
fn eigenvalues_that_grow_in_tails_are_not_taken_for_infinite() {
    let text = "format = 1\nname = \"tails\"\n[model]\nkind = \"matrices\"\nM = [[1, 0], [0, 1]]\n\
         C = [[0.5, 0], [0, 0.5]]\nK = [[\"k\", 10], [10, 90]]\n[inputs]\nk = { distribution = LAW }\n";
    for (law, seed) in [
        ("\"normal\", mean = 90.0, std = 20.0", 1),
        ("\"normal\", mean = 90.0, std = 20.0", 3),
        ("\"weibull\", shape = 5.0, scale = 100.0", 1),
        ("\"gumbel\", location = 80.0, scale = 12.0", 2),
    ] {
        let study = Study { seed, ..Study::from_toml(&text.replace("LAW", law)).unwrap() };
        let compared =
            ModelSample::new(&study, POINTS, 7, &Silent).unwrap().compare(&build(&study, &Silent).unwrap()).unwrap();
        assert!(compared.misclassified_percent() < 0.1, "{law}: {}", compared.misclassified_percent());
    }
}
