//! What stability is judged by, as people ask for it and read it: margins, bands of frequencies, rigid-body motion,
//! marginal points.

use crate::support::command::{output, refusal};
use crate::support::studies::{built_from, folder_with, json};
use crate::support::{in_one_line, text};
use pcc_compile::reference::monte_carlo;
use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use std::f64::consts::TAU;
use std::fs;

/// Two oscillators of 10 and 30 rad/s. The damping of the first is uniform between 0 and 0.2 1/s, that of the second is
/// one.
fn oscillators(spectrum: &str) -> String {
    format!(
        "format = 1\nname = \"two\"\n[model]\nkind = \"matrices\"\nM = [[1, 0], [0, 1]]\nC = [[\"c\", 0], [0, 1]]\n\
         K = [[100, 0], [0, 900]]\n[inputs]\nc = {{ distribution = \"uniform\", lower = 0.0, upper = 0.2 }}\n\
         [spectrum]\n{spectrum}\n"
    )
}

fn share(report: &serde_json::Value, name: &str) -> f64 {
    report[name].as_f64().unwrap_or_else(|| panic!("{name} of {report}"))
}

/// Re λ = −c/2: a margin asks for a larger c.
#[test]
fn margins_in_each_unit_ask_for_as_much_damping_as_they_say() {
    // ζ = c/2ω, δ = 2πζ/√(1 − ζ²).
    let ratio: f64 = 0.005;
    let decrement = TAU * ratio / (1.0 - ratio * ratio).sqrt();
    for (margin, needed) in [
        ("0.05".to_owned(), 0.1),
        ("{ damping_ratio = 0.005 }".to_owned(), 0.1),
        (format!("{{ log_decrement = {decrement:?} }}"), 0.1),
        ("{ damping_ratio = 0.0075 }".to_owned(), 0.15),
        ("0".to_owned(), 0.0),
    ] {
        let folder = built_from(&oscillators(&format!("margin = {margin}")));
        let path = folder.path();
        let report = json(path, &["eval", "built.pcc", "-n", "100000"]);
        let stable = share(&report, "stable_proportion");
        assert!((stable - (1.0 - needed / 0.2)).abs() < 0.01, "{margin}: {stable}");
        assert_eq!(report["margin"].is_null(), margin == "0", "{margin}");
        assert!(share(&report["max_re"], "maximum") <= 0.0, "{margin}: max Re λ has no margin");
        let compared = json(path, &["compare", "built.pcc", "--study", "study.toml", "-n", "2000"]);
        assert_eq!(share(&compared, "misclassified_percent"), 0.0, "{margin}");
        assert!((share(&compared, "proportion_model") - stable).abs() < 0.05, "{margin}");
        let model = json(path, &["reference", "study.toml", "-n", "2000"]);
        assert!((share(&model, "stable_proportion") - stable).abs() < 0.05, "{margin}");
        fs::write(path.join("points.csv"), format!("c\n{}\n{}\n", needed + 0.01, needed - 0.01)).unwrap();
        if needed > 0.0 {
            for (command, name) in [("eval", "built.pcc"), ("reference", "study.toml")] {
                output(path, &[command, name, "--points", "points.csv", "--out", "out.csv"]);
                let rows = fs::read_to_string(path.join("out.csv")).unwrap();
                let verdicts: Vec<&str> = rows.lines().skip(1).map(|row| row.rsplit_once(',').unwrap().1).collect();
                assert_eq!(verdicts, ["stable", "flutter"], "{margin}: {command}");
            }
        }
    }
}

#[test]
fn margins_that_make_no_sense_are_refused() {
    for (margin, expected) in [
        ("-1.0", "a growth rate in 1/s that is not negative"),
        ("nan", "a growth rate in 1/s that is not negative"),
        ("{ damping_ratio = 1.0 }", "a damping ratio from 0, below 1"),
        ("{ damping_ratio = -0.1 }", "a damping ratio from 0, below 1"),
        ("{ log_decrement = inf }", "a logarithmic decrement"),
        ("{ damping_ratio = 0.01, log_decrement = 0.1 }", "one of them"),
        ("\"much\"", "a margin is a growth rate in 1/s"),
    ] {
        let folder = folder_with(&oscillators(&format!("margin = {margin}")));
        let error = refusal(folder.path(), &["build", "study.toml"]);
        assert!(error.contains(expected), "{margin}: {error}");
    }
}

/// The mode at 10 rad/s is unstable for half of the box, that at 30 rad/s never.
#[test]
fn bands_of_frequencies_choose_modes_and_name_what_lies_outside() {
    let study =
        oscillators("frequencies = [4.0, 6.0]").replace("lower = 0.0, upper = 0.2", "lower = -0.1, upper = 0.1");
    let folder = built_from(&study);
    let report = json(folder.path(), &["eval", "built.pcc", "-n", "10000"]);
    assert_eq!(share(&report, "stable_proportion"), 1.0);
    assert_eq!(report["judged_by"], "mode 2");
    assert_eq!(report["band"], "4 to 6 Hz; outside and not judged: mode 1");
    let warnings = report["warnings"].to_string();
    assert!(warnings.contains("decides whether the system is stable"), "{warnings}");
    let text = output(folder.path(), &["eval", "built.pcc", "-n", "1000"]);
    assert!(text.contains("outside and not judged: mode 1"), "{text}");
    let inspected = output(folder.path(), &["inspect", "built.pcc"]);
    assert!(inspected.contains("outside and not judged: mode 1"), "{inspected}");

    let whole = built_from(&oscillators("frequencies = [0.0, 100.0]"));
    let report = json(whole.path(), &["eval", "built.pcc", "-n", "1000"]);
    assert_eq!(report["band"], "0 to 100 Hz, which holds all modes");

    let shown = output(whole.path(), &["build", "study.toml", "--show-study"]);
    assert!(shown.contains("frequencies = [0.0, 100.0]"), "{shown}");
}

#[test]
fn bands_that_choose_nothing_are_refused() {
    for (spectrum, expected) in [
        ("frequencies = [10.0, 20.0]", "there are modes at 1.5915, 4.7"),
        ("frequencies = [5.0, 2.0]", "a lower and a higher frequency in Hz"),
        ("frequencies = [1.0]", "a lower and a higher frequency in Hz"),
        ("frequencies = [-1.0, 2.0]", "a lower and a higher frequency in Hz"),
        ("frequencies = [1.0, 2.0]\nmodes = [1]", "remove one of them"),
        ("frequencies = [1.0, 2.0]\ntarget = \"eigenvalues\"", "frequency ranks"),
    ] {
        let folder = folder_with(&oscillators(spectrum));
        let error = refusal(folder.path(), &["build", "study.toml"]);
        assert!(error.contains(expected), "{spectrum}: {error}");
    }
}

/// Two masses that hang together and are free to move.
fn free(spectrum: &str, stiffness: &str) -> String {
    format!(
        "format = 1\nname = \"free\"\n[model]\nkind = \"matrices\"\nM = [[1, 0], [0, 2]]\n\
         C = [[\"c\", \"-c\"], [\"-c\", \"c\"]]\nK = [[\"{stiffness}\", -1e4], [-1e4, 1e4]]\n\
         [inputs]\nc = {{ distribution = \"uniform\", lower = -1.0, upper = 1.0 }}\n[spectrum]\n{spectrum}\n"
    )
}

#[test]
fn rigid_body_motion_is_counted_and_can_be_said() {
    for spectrum in ["", "rigid_body_modes = 2"] {
        let folder = folder_with(&free(spectrum, "1e4"));
        let report = json(folder.path(), &["build", "study.toml", "-o", "built.pcc"]);
        assert_eq!(report["rigid_body_modes"], 2, "{spectrum}");
        let model = json(folder.path(), &["reference", "study.toml", "-n", "1000"]);
        assert_eq!(model["rigid_body_modes"], 2, "{spectrum}");
        assert!((share(&model, "stable_proportion") - 0.5).abs() < 0.06);
        let compared = json(folder.path(), &["compare", "built.pcc", "--study", "study.toml", "-n", "1000"]);
        assert_eq!((&compared["rigid_body_modes"], share(&compared, "misclassified_percent")), (&2.into(), 0.0));
    }
    // A spring so soft that digits of the input are all that is left of it.
    let folder = folder_with(&free("", "1e4 + 1e-6"));
    assert_eq!(json(folder.path(), &["build", "study.toml", "-o", "built.pcc"])["rigid_body_modes"], 0);
}

/// With little friction a second motion of the clutch is nearly free at some points, and hides the first on one side.
#[test]
fn rigid_body_motion_is_found_beside_motion_that_is_nearly_free() {
    for (inputs, upper) in [(1, 0.0701), (2, 0.1), (4, 0.0723), (8, 0.0435)] {
        let friction = format!("lower = 0.0, upper = {upper} ");
        let text = text(&format!("surrogates/clutch-r{inputs}.toml"));
        let mut study = Study::from_toml(&text.replace("lower = 0.0, upper = 0.5 ", &friction)).unwrap();
        for seed in 1..=12 {
            study.seed = seed;
            let found = monte_carlo(&study, 8, seed, &Silent).unwrap().rigid_body_modes;
            assert_eq!(found, 4, "{inputs} inputs, seed {seed}");
        }
    }
}

#[test]
fn rigid_body_motion_that_contradicts_the_spectrum_is_refused() {
    for (spectrum, stiffness, expected) in [
        ("rigid_body_modes = 3", "1e4", "the next is"),
        ("rigid_body_modes = 9", "1e4", "there are only 4 eigenvalues"),
        ("rigid_body_modes = 0", "1e4", "makes 2 eigenvalues zero"),
        ("rigid_body_modes = 2", "2e4", "the eigenvalues with the smallest"),
        ("rigid_body_modes = -1", "1e4", "at most"),
    ] {
        let folder = folder_with(&free(spectrum, stiffness));
        for command in [&["build", "study.toml"][..], &["reference", "study.toml", "-n", "10"]] {
            let error = refusal(folder.path(), command);
            assert!(error.contains("rigid_body_modes") && error.contains(expected), "{spectrum}: {error}");
        }
    }
}

/// Marginal for k > 1/3, else it diverges: every face says so.
#[test]
fn undamped_systems_are_called_so_by_every_face() {
    let folder = built_from(&text("tests/data/wide/undiv.toml"));
    let path = folder.path();
    let report = json(path, &["eval", "built.pcc", "-n", "100000", "--events", "marginal,divergence"]);
    let (stable, marginal) = (share(&report, "stable_proportion"), share(&report, "marginal_proportion"));
    let [flutter, divergence, unstable] =
        ["flutter_proportion", "divergence_proportion", "unstable_proportion"].map(|name| share(&report, name));
    assert!(stable == 0.0 && flutter == 0.0 && divergence == unstable && (marginal + unstable - 1.0).abs() < 1e-12);
    assert!((marginal - 0.70833).abs() < 0.006, "{marginal}");
    assert_eq!(report["undamped"], true);
    let interval = &report["intervals"]["marginal"];
    assert!(share(interval, "lower") < marginal && marginal < share(interval, "upper"));
    assert_eq!(share(&report["events"][0], "proportion"), marginal);

    let eval = output(path, &["eval", "built.pcc", "-n", "1000"]);
    assert!(eval.lines().next().unwrap().contains("is undamped: marginal in"), "{eval}");
    assert!(eval.contains("  marginal  ") && !eval.contains("warning"), "{eval}");
    let build = output(path, &["build", "study.toml", "-o", "again.pcc"]);
    assert!(build.contains("come as λ and −λ") && !build.contains("warning"), "{build}");
    assert!(output(path, &["inspect", "built.pcc"]).contains("come as λ and −λ"));
    let reference = output(path, &["reference", "study.toml", "-n", "500"]);
    assert!(reference.lines().next().unwrap().contains("is undamped: marginal in"), "{reference}");
    let compare = output(path, &["compare", "built.pcc", "--study", "study.toml", "-n", "500"]);
    assert!(compare.contains("  marginal  ") && in_one_line(&compare).contains("misclassified 0 %"), "{compare}");
    let certified = output(path, &["certify", "built.pcc", "--study", "study.toml", "--runs", "300"]);
    assert!(certified.contains("marginal, ") && certified.contains("unstable"), "{certified}");
    let certificate = &json(path, &["inspect", "built.pcc"])["certificates"][0];
    assert!(certificate["unstable"][0].as_f64().unwrap() > 0.2, "{certificate}");

    output(path, &["eval", "built.pcc", "-n", "1000", "--sweep", "k=-2..6:9", "--table", "sweep.csv"]);
    let sweep = fs::read_to_string(path.join("sweep.csv")).unwrap();
    assert!(sweep.lines().next().unwrap().contains("marginal_proportion"), "{sweep}");

    fs::write(path.join("points.csv"), "k\n-1\n5\n").unwrap();
    for (command, name) in [("eval", "built.pcc"), ("reference", "study.toml")] {
        output(path, &[command, name, "--points", "points.csv", "--out", "out.csv"]);
        let rows = fs::read_to_string(path.join("out.csv")).unwrap();
        let ends: Vec<&str> = rows.lines().skip(1).map(|row| row.splitn(2, "0,").last().unwrap()).collect();
        assert!(rows.lines().nth(1).unwrap().ends_with(",0,divergence"), "{command}: {ends:?}");
        assert!(rows.lines().nth(2).unwrap().ends_with(",0.0,0,marginal"), "{command}: {ends:?}");
    }
    let critical = json(path, &["eval", "built.pcc", "-n", "1000", "--critical", "k"]);
    let crossing = &critical["critical"]["crossings"][0];
    assert_eq!((&crossing["stability"], &crossing["kind"]), (&"regained".into(), &"divergence".into()));
    assert!((share(crossing, "mean") - 1.0 / 3.0).abs() < 1e-3, "{crossing}");
}

/// Parts of an evaluation put together say what the whole says.
#[test]
fn parts_hold_all_three_shares() {
    let folder = built_from(&text("tests/data/wide/undamped2.toml"));
    let path = folder.path();
    for part in ["0", "1"] {
        let (shard, file) = (format!("{part}/2"), format!("{part}.part"));
        output(path, &["eval", "built.pcc", "-n", "20000", "--shard", &shard, "--part", &file]);
    }
    let merged = json(path, &["merge", "0.part", "1.part"]);
    let whole = json(path, &["eval", "built.pcc", "-n", "20000"]);
    for name in ["stable_proportion", "marginal_proportion", "unstable_proportion", "flutter_proportion"] {
        assert_eq!(merged[name], whole[name], "{name}");
    }
}
