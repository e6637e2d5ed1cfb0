//! What users type and see: outputs, error messages, exit codes, and that errors leave nothing behind.

use crate::support::command::{files, output, pcc, refusal};
use crate::support::reproduction::TABLE_2;
use crate::support::{repository, text};
use std::fs;

/// A folder with the r = 2 study, its surrogate and three points.
fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("study.toml"), text("surrogates/clutch-r2-eigenvalues.toml")).unwrap();
    fs::copy(repository("tests/data/golden.v1.pcc"), folder.path().join("surrogate.pcc")).unwrap();
    fs::write(folder.path().join("points.csv"), "mu,k_p\n0.25,16e6\n0.0,15.2e6\n0.5,16.8e6\n").unwrap();
    folder
}

/// Snapshots without what changes from run to run: times, rates and digits beyond what is portable.
macro_rules! assert_output {
    ($name:literal, $text:expr) => {
        insta::with_settings!({filters => vec![
            (r"\d+\.\d+ s", "[time] s"),
            (r"\d[\d ]* per second", "[rate] per second"),
            (r#""elapsed_seconds": [\d.e-]+"#, r#""elapsed_seconds": "[time]""#),
            (r"(\d\.\d{6})\d+", "$1"),
            (r"self-test          holds  largest difference \S+", "self-test          holds  largest difference [tiny]"),
            (r", by pcc \S+", ", by pcc [version]"),
        ]}, { insta::assert_snapshot!($name, $text) });
    };
}

#[test]
fn help_of_every_command() {
    let folder = workplace();
    let mut text = output(folder.path(), &["--help"]);
    let commands = commands(&text);
    assert!(commands.contains(&"build".to_owned()) && !commands.contains(&"help".to_owned()), "{commands:?}");
    for command in commands {
        text.push_str(&format!("\n=== {command} ===\n{}", output(folder.path(), &["help", &command])));
    }
    assert_output!("help", text);
}

/// The commands that the help of the program lists, but for `help` itself: each begins a line that is indented by two
/// spaces.
fn commands(help: &str) -> Vec<String> {
    let (_, from_commands) = help.split_once("\nCommands:\n").unwrap();
    let (list, _) = from_commands.split_once("\n\n").unwrap();
    let begins_a_command = |line: &&str| line.starts_with("  ") && !line.starts_with("   ");
    let names = list.lines().filter(begins_a_command).map(|line| line.split_whitespace().next().unwrap().to_owned());
    names.filter(|name| name != "help").collect()
}

#[test]
fn reports_for_people() {
    let folder = workplace();
    let study = ["build", "study.toml", "-o", "built.pcc"];
    assert_output!("build", output(folder.path(), &study));
    assert_output!("eval", output(folder.path(), &["eval", "surrogate.pcc", "-n", "1e5"]));
    assert_output!("reference", output(folder.path(), &["reference", "study.toml", "-n", "2000"]));
    let compare = ["compare", "surrogate.pcc", "--study", "study.toml", "-n", "2000"];
    assert_output!("compare", output(folder.path(), &compare));
    assert_output!("inspect", output(folder.path(), &["inspect", "surrogate.pcc", "--check"]));
    assert_output!("convert", output(folder.path(), &["convert", "surrogate.pcc", "converted.json"]));
    let points = ["eval", "surrogate.pcc", "--points", "points.csv", "--out", "out.csv"];
    assert_output!("points", output(folder.path(), &points));
    assert_output!("show_study", output(folder.path(), &["build", "study.toml", "--show-study"]));
}

#[test]
fn full_expansions_and_elements_are_built_shown_and_inspected() {
    let folder = workplace();
    let good = text("surrogates/clutch-r2-eigenvalues.toml");
    let mut text = String::new();
    for (name, fit) in [
        ("quadrature", "method = \"gpc\""),
        ("least-squares", "method = \"gpc\"\nsolver = \"least-squares\""),
        ("elements", "method = \"me-gpc\"\nelements = 5"),
    ] {
        fs::write(folder.path().join("full.toml"), format!("{good}\n[fit]\n{fit}\n")).unwrap();
        let shown = output(folder.path(), &["build", "full.toml", "--show-study"]);
        let tables = shown.split("\n[design]").nth(1).unwrap();
        let built = output(folder.path(), &["build", "full.toml", "-o", "full.pcc"]);
        let evaluated = output(folder.path(), &["eval", "full.pcc", "-n", "1e4"]);
        let answer = evaluated.split("\nmode ").next().unwrap();
        text.push_str(&format!("=== {name}\n[design]{tables}\n{built}\n{answer}"));
    }
    text.push_str(&format!("=== inspect\n{}", output(folder.path(), &["inspect", "full.pcc", "--check"])));
    // A hash of coefficients, whose last bits depend on the processor, and the version of the program.
    let is_portable = |line: &&str| !(line.starts_with("  content id") || line.starts_with("  built by"));
    assert_output!("full_expansions", text.lines().filter(is_portable).collect::<Vec<_>>().join("\n"));
}

#[test]
fn a_report_is_a_page_that_replaces_pages_only() {
    let folder = workplace();
    fs::copy(repository("surrogates/clutch-r2-eigenvalues.pcc"), folder.path().join("surrogate.pcc")).unwrap();
    let arguments = ["report", "surrogate.pcc", "--study", "study.toml", "-n", "1e4", "--runs", "500"];
    output(folder.path(), &arguments);
    let html = fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(html.starts_with("<!DOCTYPE html>") && html.ends_with("</html>\n"));
    for part in
        ["is unstable in", "Surrogate against model", "Density of max Re", "Coefficients by degree", "Data as CSV"]
    {
        assert!(html.contains(part), "{part} is missing");
    }
    // The density of each input, too.
    assert_eq!(html.matches("class=\"chart chart-sparkline").count(), 2);
    assert_eq!(html.matches("<svg").count(), html.matches("<figcaption>").count() + 2);
    for loaded in ["<script", "<img", "<link", "<iframe", " src=", "@import", "url(h"] {
        assert!(!html.contains(loaded), "{loaded}");
    }
    output(folder.path(), &arguments);
    assert_eq!(fs::read_to_string(folder.path().join("report.html")).unwrap(), html, "the same page again");
    let json: serde_json::Value =
        serde_json::from_str(&output(folder.path(), &["report", "surrogate.pcc", "-n", "100", "--json"])).unwrap();
    assert!(json["file"] == "report.html" && json["stable_proportion"].as_f64().unwrap() > 0.1);

    fs::write(folder.path().join("mine.html"), "<p>not by pcc</p>").unwrap();
    let mut messages = refusal(folder.path(), &["report", "surrogate.pcc", "-o", "mine.html"]);
    messages.push_str(&refusal(folder.path(), &["report", "surrogate.pcc", "-o", "surrogate.pcc"]));
    messages.push_str(&refusal(folder.path(), &["report", "surrogate.pcc", "-o", "no/such/folder.html"]));
    messages.push_str(&refusal(folder.path(), &["report", "study.toml"]));
    messages.push_str(&refusal(folder.path(), &["report", "surrogate.pcc", "--study", "study.toml", "--runs", "1e9"]));
    fs::write(folder.path().join("other.toml"), text("surrogates/clutch-r3-eigenvalues.toml")).unwrap();
    messages.push_str(&refusal(folder.path(), &["report", "surrogate.pcc", "--study", "other.toml"]));
    assert_eq!(fs::read_to_string(folder.path().join("mine.html")).unwrap(), "<p>not by pcc</p>");
    assert_output!("bad_reports", messages);
}

#[test]
fn names_that_try_to_be_markup_are_text_on_the_page() {
    let folder = workplace();
    let mut surrogate = pcc_evaluate::artifact::read(&repository("surrogates/clutch-r2.pcc")).unwrap().surrogate;
    let hostile = "</script><img src=x onerror=alert(1)>";
    surrogate.provenance.study_name = hostile.to_owned();
    let mut inputs = surrogate.inputs.inputs().to_vec();
    inputs.iter_mut().for_each(|input| input.name = format!("{hostile}{}", input.name));
    surrogate.inputs = pcc_evaluate::probability::inputs::InputSpace::new(inputs).unwrap();
    for output in &mut surrogate.outputs {
        output.components.iter_mut().for_each(|component| component.name.push_str(hostile));
    }
    let bytes = pcc_evaluate::artifact::encode(&surrogate, pcc_evaluate::artifact::Format::Json).unwrap();
    fs::write(folder.path().join("hostile.json"), bytes).unwrap();
    output(folder.path(), &["report", "hostile.json", "-n", "1000"]);
    let html = fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(!html.contains("<img") && !html.contains("</script"));
    assert!(html.matches("&lt;img src=x onerror=alert(1)&gt;").count() > 20);
}

#[test]
fn the_paper_is_reproduced_into_a_folder() {
    let folder = workplace();
    // Figure 3 alone is made where it is also made again: see `a_reproduction_replaces_its_own_files_only`.
    output(folder.path(), &["reproduce", "--only", "figure4", "-o", "figure4", "--runs", "300"]);
    assert_eq!(files(&folder.path().join("figure4")), ["figure4.svg", "report.html"]);
    let page = fs::read_to_string(folder.path().join("figure4/report.html")).unwrap();
    assert_eq!(page.matches("<figure ").count(), 12, "six by the paper's method, six by invariants");

    let table_2 = &*TABLE_2;
    assert_eq!(table_2.files, ["errors.svg", "report.html", "table2.csv", "table2.md"]);
    let mut rows = csv::Reader::from_reader(table_2.csv.as_bytes());
    let reference = fs::read_to_string(repository("tests/data/table2.csv")).unwrap();
    let added = "target,derivatives,seed,final_mesh_computations,misclassified_percent,seconds";
    let expected = format!("{},{added}", reference.lines().next().unwrap());
    assert_eq!(rows.headers().unwrap().iter().collect::<Vec<_>>().join(","), expected);
    let rows: Vec<csv::StringRecord> = rows.records().map(Result::unwrap).collect();
    for line in reference.lines().skip(1) {
        let of_paper: Vec<&str> = line.split(',').collect();
        let same = |row: &&csv::StringRecord| {
            let is_method = row[0] == *of_paper[0] && row[1] == *of_paper[1] && row[7] == *"eigenvalues";
            is_method && (of_paper[1] == "sparse" || row[10] == *of_paper[3])
        };
        let found = rows.iter().filter(same).count();
        assert_eq!(found, if of_paper[1] == "sparse" { 5 } else { 1 }, "{line}");
    }
    assert!(rows.iter().any(|row| row[7] == *"invariants" && row[8] == *"true"));
    for line in ["table 2: the paper's methods, with", "the same methods on invariants", "table2/report.html"] {
        assert!(table_2.printed.contains(line), "{line} is missing");
    }
}

#[test]
fn json_is_one_document_with_the_promised_fields() {
    let folder = workplace();
    let json = |arguments: &[&str]| -> serde_json::Value {
        serde_json::from_str(&output(folder.path(), &[arguments, &["--json"]].concat())).unwrap()
    };
    let has = |value: &serde_json::Value, keys: &[&str]| {
        for key in keys {
            assert!(value.pointer(key).is_some_and(|found| !found.is_null()), "{key} is missing");
        }
    };
    const EVAL: [&str; 6] =
        ["/samples", "/stable_proportion", "/interval/lower", "/interval/upper", "/interval/level", "/elapsed_seconds"];
    const COMPARE: [&str; 7] = [
        "/samples",
        "/proportion_model",
        "/proportion_surrogate",
        "/relative_error_percent",
        "/misclassified_percent",
        "/components/0/mean_error_percent",
        "/components/0/variance_error_percent",
    ];
    has(&json(&["eval", "surrogate.pcc", "-n", "1000"]), &EVAL);
    has(&json(&["reference", "study.toml", "-n", "100"]), &EVAL);
    has(&json(&["build", "study.toml"]), &["/direct_computations", "/components/0/s2", "/file"]);
    has(&json(&["inspect", "surrogate.pcc"]), &["/direct_computations", "/problem_hash", "/content_id"]);
    has(&json(&["compare", "surrogate.pcc", "--study", "study.toml", "-n", "100"]), &COMPARE);
    has(&json(&["convert", "surrogate.pcc", "out.json"]), &["/file"]);
    let run = json(&["run", "study.toml", "-o", "results"]);
    for (part, keys) in [("eval", &EVAL[..]), ("compare", &COMPARE[..]), ("build", &["/direct_computations"])] {
        has(&run[part], keys);
    }
    assert_eq!(run["eval"]["samples"], 1_000_000);
    assert_eq!(run["compare"]["samples"], 10_000);
    assert!(folder.path().join("results/clutch-r2-eigenvalues.pcc").exists());
}

#[test]
fn eval_and_reference_write_the_promised_columns() {
    let folder = workplace();
    for (source, name) in [("eval", "surrogate.pcc"), ("reference", "study.toml")] {
        output(folder.path(), &[source, name, "--points", "points.csv", "--out", "out.csv"]);
        let out = fs::read_to_string(folder.path().join("out.csv")).unwrap();
        let mut lines = out.lines();
        assert_eq!(lines.next(), Some("mu,k_p,re_3,im_3,re_4,im_4,max_re,stable,verdict"));
        let rows: Vec<Vec<f64>> =
            lines.map(|line| line.split(',').take(8).map(|cell| cell.parse().unwrap()).collect()).collect();
        assert_eq!(rows.len(), 3);
        assert_eq!(rows.iter().map(|row| row[7]).collect::<Vec<_>>(), [0.0, 1.0, 0.0], "stable at μ = 0 only");
        assert!(rows.iter().all(|row| (row[7] == 1.0) == (row[6] < 0.0)));
    }
}

#[test]
fn eval_and_reference_take_the_same_points() {
    let folder = workplace();
    let compared: serde_json::Value = serde_json::from_str(&output(
        folder.path(),
        &["compare", "surrogate.pcc", "--study", "study.toml", "-n", "3000", "--seed", "5", "--json"],
    ))
    .unwrap();
    for (command, key) in [("eval surrogate.pcc", "proportion_surrogate"), ("reference study.toml", "proportion_model")]
    {
        let mut arguments: Vec<&str> = command.split(' ').collect();
        arguments.extend(["-n", "3000", "--seed", "5", "--json"]);
        let alone: serde_json::Value = serde_json::from_str(&output(folder.path(), &arguments)).unwrap();
        assert_eq!(alone["stable_proportion"], compared[key]);
    }
}

#[test]
fn shown_study_builds_the_same_surrogate() {
    let folder = workplace();
    let shown = output(folder.path(), &["build", "study.toml", "--show-study"]);
    fs::write(folder.path().join("shown.toml"), shown).unwrap();
    output(folder.path(), &["build", "study.toml", "-o", "a.pcc"]);
    output(folder.path(), &["build", "shown.toml", "-o", "b.pcc"]);
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(bytes("a.pcc"), bytes("b.pcc"));
}

#[test]
fn conversion_there_and_back_gives_identical_bytes() {
    let folder = workplace();
    output(folder.path(), &["convert", "surrogate.pcc", "there.json"]);
    output(folder.path(), &["convert", "there.json", "back.pcc"]);
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(bytes("back.pcc"), bytes("surrogate.pcc"));
}

#[test]
fn requested_checks_decide_the_exit_code() {
    let folder = workplace();
    let compare = ["compare", "surrogate.pcc", "--study", "study.toml", "-n", "2000", "--max-error"];
    assert_eq!(pcc(folder.path(), &[&compare[..], &["50"]].concat()).status.code(), Some(0));
    assert_eq!(pcc(folder.path(), &[&compare[..], &["0"]].concat()).status.code(), Some(1));
    assert_eq!(pcc(folder.path(), &["inspect", "surrogate.pcc", "--check"]).status.code(), Some(0));
}

#[test]
fn bad_studies_are_refused_with_place_and_remedy() {
    let folder = workplace();
    let good = text("surrogates/clutch-r2-eigenvalues.toml");
    let mu = "{ distribution = \"uniform\", lower = 0.0, upper = 0.5 }";
    let cases = [
        ("unknown key", good.replace("[model]", "[model]\ncolour = \"red\"")),
        ("unknown table", format!("{good}\n[extras]\n")),
        ("missing key", good.replace("name = ", "# name = ")),
        ("no inputs table", good.split("[inputs]").next().unwrap().to_owned()),
        ("zero inputs", format!("{}[inputs]\n", good.split("[inputs]").next().unwrap())),
        ("inverted interval", good.replace("lower = 0.0", "lower = 0.7")),
        ("NaN", good.replace("lower = 0.0", "lower = nan")),
        ("infinite", good.replace("upper = 0.5", "upper = inf")),
        ("both forms", good.replace("upper = 0.5", "upper = 0.5, spread = 0.1")),
        ("half a form", good.replace(", upper = 0.5", "")),
        ("negative friction", good.replace("lower = 0.0", "lower = -0.1")),
        ("unknown distribution", good.replace(mu, "{ distribution = \"cauchy\", lower = 0.0, upper = 0.5 }")),
        ("unknown input", good.replace("mu ", "nu ")),
        (
            "input given twice",
            good.replace("[spectrum]", "mu = { distribution = \"uniform\", lower = 0.0, upper = 1.0 }\n[spectrum]"),
        ),
        ("unknown model", good.replace("\"clutch\"", "\"brake\"")),
        ("constant and input", good.replace("[inputs]", "[model.constants]\nmu = 0.3\n[inputs]")),
        ("constant out of range", good.replace("[inputs]", "[model.constants]\nplate_mass = 0.0\n[inputs]")),
        ("unknown constant", good.replace("[inputs]", "[model.constants]\nplate_colour = 1.0\n[inputs]")),
        ("number as text", good.replace("seed = 1", "seed = \"one\"")),
        ("input as number", good.replace(mu, "0.25")),
        ("absurd mass", good.replace("[inputs]", "[model.constants]\nplate_mass = 1e-300\n[inputs]")),
        ("mode that does not exist", good.replace("[3, 4]", "[3, 9]")),
        ("mode zero", good.replace("[3, 4]", "[0, 4]")),
        ("mode twice", good.replace("[3, 4]", "[3, 3]")),
        ("no modes", good.replace("[3, 4]", "[]")),
        ("modes of another type", good.replace("[3, 4]", "3.5")),
        ("unknown target", good.replace("\"eigenvalues\"", "\"eigenvectors\"")),
        ("q_norm zero", format!("{good}\n[fit]\nq_norm = 0.0\n")),
        ("q_norm above one", format!("{good}\n[fit]\nq_norm = 1.5\n")),
        ("max_degree zero", format!("{good}\n[fit]\nmax_degree = 0\n")),
        ("too many candidates", format!("{good}\n[fit]\nq_norm = 1.0\nmax_degree = 1000\n[design]\nmaximum = 1\n")),
        ("epsilon out of range", format!("{good}\n[fit]\nepsilon_forward = -1.0\n")),
        ("unknown method", format!("{good}\n[fit]\nmethod = \"magic\"\n")),
        ("maximum below initial", format!("{good}\n[design]\ninitial = 100\nmaximum = 50\n")),
        (
            "too much memory",
            format!("{good}\n[fit]\nmax_degree = 100\n[design]\nmaximum = 1000000\nstep = 1000000\n")
                .replace("[inputs]", "[inputs]\nl = { distribution = \"uniform\", nominal = 0.0125, spread = 0.05 }"),
        ),
        ("too many quadrature nodes", format!("{good}\n[fit]\nmethod = \"gpc\"\nmax_degree = 100\n")),
        (
            "more quadrature nodes than can be counted",
            text("surrogates/clutch-r8-eigenvalues.toml") + "\n[fit]\nmethod = \"me-gpc\"\nmax_degree = 100\n",
        ),
        (
            "too many points for least squares",
            format!(
                "{good}\n[fit]\nmethod = \"gpc\"\nsolver = \"least-squares\"\nmax_degree = 99\noversampling = 9.0\n"
            ),
        ),
        ("oversampled quadrature", format!("{good}\n[fit]\nmethod = \"gpc\"\noversampling = 2.0\n")),
        ("unknown solver", format!("{good}\n[fit]\nmethod = \"gpc\"\nsolver = \"guess\"\n")),
        ("size of a quadrature", format!("{good}\n[fit]\nmethod = \"gpc\"\n[design]\ninitial = 10\n")),
        ("design of a quadrature", format!("{good}\n[fit]\nmethod = \"gpc\"\n[design]\nkind = \"nested-lhs\"\n")),
        ("a grid for the stepwise method", format!("{good}\n[design]\nkind = \"tensor-gauss\"\n")),
        ("elements of another method", format!("{good}\n[fit]\nelements = 5\n")),
        ("no elements", format!("{good}\n[fit]\nmethod = \"me-gpc\"\nelements = 0\n")),
        ("negative theta", format!("{good}\n[fit]\nmethod = \"me-gpc\"\ntheta_1 = -1.0\n")),
        ("theta above one", format!("{good}\n[fit]\nmethod = \"me-gpc\"\ntheta_2 = 1.5\n")),
        ("target of a full expansion", format!("{good}\n[fit]\nmethod = \"gpc\"\ns2_target = 0.9\n")),
        (
            "derivatives at quadrature nodes",
            format!("{good}\n[fit]\nmethod = \"gpc\"\nderivatives = true\n")
                .replace("\"eigenvalues\"", "\"invariants\""),
        ),
        ("one point", format!("{good}\n[design]\ninitial = 1\n")),
        ("name with a path", good.replace("name = \"clutch-r2-eigenvalues\"", "name = \"../../etc/passwd\"")),
        ("newer format", good.replace("format = 1", "format = 2\nsurprise = true")),
        ("not TOML", "this is not a study".to_owned()),
    ];
    let mut messages = String::new();
    for (case, study) in cases {
        assert_ne!(study, good, "{case} changes nothing");
        fs::write(folder.path().join("study.toml"), study).unwrap();
        messages.push_str(&format!("── {case}\n{}", refusal(folder.path(), &["build", "study.toml"])));
    }
    assert_output!("bad_studies", messages);
}

#[test]
fn bad_files_are_refused_with_place_and_remedy() {
    let folder = workplace();
    let bytes = fs::read(folder.path().join("surrogate.pcc")).unwrap();
    let changed = |position: usize| {
        let mut changed = bytes.clone();
        changed[position] ^= 0x40;
        changed
    };
    let cases: [(&str, Vec<u8>); 6] = [
        ("truncated", bytes[..bytes.len() / 2].to_vec()),
        ("flipped byte", changed(bytes.len() / 2)),
        ("future version", changed(8)),
        ("empty", Vec::new()),
        ("not a surrogate", b"mu,k_p\n0.25,16e6\n".to_vec()),
        ("JSON of something else", b"{\"hello\": 1}".to_vec()),
    ];
    let mut messages = String::new();
    for (case, content) in cases {
        fs::write(folder.path().join("bad.pcc"), content).unwrap();
        for arguments in
            [&["inspect", "bad.pcc"][..], &["eval", "bad.pcc", "-n", "10"], &["convert", "bad.pcc", "x.json"]]
        {
            let message = refusal(folder.path(), arguments);
            if arguments[0] == "inspect" {
                messages.push_str(&format!("── {case}\n{message}"));
            }
        }
    }
    messages.push_str(&format!("── missing\n{}", refusal(folder.path(), &["eval", "none.pcc", "-n", "10"])));
    assert_output!("bad_files", messages);
}

#[test]
fn bad_points_are_refused_with_row_and_remedy() {
    let folder = workplace();
    let cases = [
        ("missing column", "mu,k_f\n0.25,7e6\n"),
        ("repeated column", "mu,k_p,mu\n0.25,16e6,0.25\n"),
        ("decimal commas", "mu,k_p\n0,25,16e6\n"),
        ("text cell", "mu,k_p\n0.25,16e6\nlow,16e6\n"),
        ("empty cell", "mu,k_p\n0.25,\n"),
        ("NaN cell", "mu,k_p\nNaN,16e6\n"),
        ("short row", "mu,k_p\n0.25,16e6\n0.25\n"),
        ("outside the domain", "mu,k_p\n0.25,16e6\n0.25,16e6\n0.6,16e6\n"),
        ("no points", "mu,k_p\n"),
        ("empty file", ""),
    ];
    let mut messages = String::new();
    for (case, points) in cases {
        fs::write(folder.path().join("points.csv"), points).unwrap();
        for (command, file) in [("eval", "surrogate.pcc"), ("reference", "study.toml")] {
            let message = refusal(folder.path(), &[command, file, "--points", "points.csv", "--out", "out.csv"]);
            if command == "eval" {
                messages.push_str(&format!("── {case}\n{message}"));
            }
        }
    }
    assert_output!("bad_points", messages);
    fs::write(folder.path().join("points.csv"), "mu,k_p\n0.6,16e6\n").unwrap();
    for (command, file) in [("eval", "surrogate.pcc"), ("reference", "study.toml")] {
        output(folder.path(), &[command, file, "--points", "points.csv", "--out", "out.csv", "--extrapolate"]);
    }
}

#[test]
fn bad_usage_is_refused() {
    let folder = workplace();
    let mut messages = String::new();
    let cases: [&[&str]; 15] = [
        &["eval"],
        &["certify", "surrogate.pcc"],
        &["eval", "surrogate.pcc", "-n", "0"],
        &["eval", "surrogate.pcc", "-n", "1.5"],
        &["eval", "surrogate.pcc", "-n", "10", "--points", "points.csv", "--out", "x.csv"],
        &["eval", "surrogate.pcc", "--points", "points.csv"],
        &["eval", "surrogate.pcc", "-n", "10", "--out", "x.csv"],
        &["eval", "surrogate.pcc", "-n", "-5"],
        &["eval", "surrogate.pcc", "-n", "10", "--threads", "0"],
        &["reference", "study.toml", "-n", "0"],
        &["compare", "surrogate.pcc", "--study", "study.toml", "-n", "0"],
        &["compare", "surrogate.pcc", "--study", "study.toml", "-n", "10", "--max-error", "nan"],
        &["build", "study.toml", "-o", "no/such/folder/x.pcc"],
        &["build", "study.toml", "-o", "."],
        &["build", "none.toml"],
    ];
    for arguments in cases {
        messages.push_str(&format!("── pcc {}\n{}", arguments.join(" "), refusal(folder.path(), arguments)));
    }
    assert_output!("bad_usage", messages);
}

/// No mistyped output destroys a study, a surrogate or data.
#[test]
fn outputs_never_replace_inputs_or_other_files() {
    let folder = workplace();
    let points = ["--points", "points.csv", "--out"];
    fs::write(folder.path().join("data.json"), "{\"runs\": [1, 2, 3]}").unwrap();
    let cases: [Vec<&str>; 8] = [
        vec!["build", "study.toml", "-o", "data.json"],
        vec!["build", "study.toml", "-o", "study.toml"],
        vec!["build", "study.toml", "-o", "points.csv"],
        vec!["convert", "surrogate.pcc", "study.toml"],
        vec!["convert", "surrogate.pcc", "./surrogate.pcc"],
        [&["eval", "surrogate.pcc"], &points[..], &["surrogate.pcc"]].concat(),
        [&["eval", "surrogate.pcc"], &points[..], &["points.csv"]].concat(),
        [&["reference", "study.toml"], &points[..], &["study.toml"]].concat(),
    ];
    let content = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let before = ["study.toml", "surrogate.pcc", "points.csv"].map(content);
    for arguments in cases {
        let message = refusal(folder.path(), &arguments);
        assert!(message.contains("name another output"), "{arguments:?}: {message}");
    }
    assert_eq!(["study.toml", "surrogate.pcc", "points.csv"].map(content), before);
    output(folder.path(), &["build", "study.toml", "-o", "surrogate.pcc"]); // a surrogate may be replaced
}

#[test]
fn swapped_files_are_named() {
    let folder = workplace();
    output(folder.path(), &["convert", "surrogate.pcc", "surrogate.json"]);
    for name in ["surrogate.pcc", "surrogate.json"] {
        let message = refusal(folder.path(), &["build", name]);
        assert!(message.contains("is a surrogate; give the study"), "{message}");
    }
    let message = refusal(folder.path(), &["eval", "study.toml", "-n", "10"]);
    assert!(message.contains("study.toml: is not a surrogate"), "{message}");
}

/// Whoever samples a surrogate that predicts worse than a constant is told so.
#[test]
fn poor_fits_are_flagged_wherever_the_surrogate_is_used() {
    let folder = workplace();
    let poor = format!(
        "{}\n[design]\ninitial = 12\nmaximum = 12\n[fit]\nepsilon_forward = 0.0\n",
        text("surrogates/clutch-r8-eigenvalues.toml").replace("modes = [3, 4]", "modes = [1, 3]").replace("r8", "poor")
    );
    fs::write(folder.path().join("poor.toml"), poor).unwrap();
    for arguments in [
        &["build", "poor.toml", "-o", "poor.pcc"][..],
        &["eval", "poor.pcc", "-n", "100"],
        &["inspect", "poor.pcc"],
        &["run", "poor.toml"],
    ] {
        let text = output(folder.path(), arguments);
        assert!(text.contains("warning: re_3 is "), "{arguments:?}: {text}");
    }
    assert!(output(folder.path(), &["eval", "poor.pcc", "-n", "100"]).contains("judged by modes 1, 3"));
}

#[test]
fn a_study_of_another_problem_is_not_compared() {
    let folder = workplace();
    let other = text("surrogates/clutch-r2-eigenvalues.toml").replace("upper = 0.5", "upper = 0.4");
    fs::write(folder.path().join("other.toml"), other).unwrap();
    let message = refusal(folder.path(), &["compare", "surrogate.pcc", "--study", "other.toml", "-n", "10"]);
    assert!(message.contains("built for another problem"), "{message}");
}

/// Friction that turns two oscillating modes into real eigenvalues part of the way: ranks do not name the same modes.
#[test]
fn a_changing_number_of_oscillating_modes_shows_two_points() {
    let folder = workplace();
    let study = text("surrogates/clutch-r1-eigenvalues.toml")
        .replace("[inputs]", "[model.constants]\nk_f = 0.0\n[inputs]")
        .replace(
            "mu      = { distribution = \"uniform\", lower = 0.0, upper = 0.5 }",
            "c_f = { distribution = \"uniform\", lower = 0.0, upper = 1e6 }",
        )
        .replace("[3, 4]", "\"all\"");
    for modes in ["\"all\"", "[1, 2]", "[3, 4]"] {
        fs::write(folder.path().join("damped.toml"), study.replace("\"all\"", modes)).unwrap();
        let message = refusal(folder.path(), &["build", "damped.toml"]);
        assert!(message.contains("modes oscillate at c_f = ") && message.contains("\"invariants\""), "{message}");
        // A share takes no numbers of modes.
        let found = output(folder.path(), &["reference", "damped.toml", "-n", "1000"]);
        assert!(found.contains("judged by all eigenvalues"), "{found}");
    }
}

/// Values beyond double precision are errors, never a stable machine.
#[test]
fn values_that_are_not_finite_are_refused() {
    let folder = workplace();
    fs::write(folder.path().join("points.csv"), "mu,k_p\n0.25,16e6\n1e30,16e6\n").unwrap();
    let arguments = ["eval", "surrogate.pcc", "--points", "points.csv", "--out", "out.csv", "--extrapolate"];
    let message = refusal(folder.path(), &arguments);
    assert!(message.contains("points.csv: row 2: the surrogate has no finite value there"), "{message}");
    fs::write(folder.path().join("points.csv"), "mu,k_p\n-1.0,16e6\n").unwrap();
    let arguments = ["reference", "study.toml", "--points", "points.csv", "--out", "out.csv", "--extrapolate"];
    let message = refusal(folder.path(), &arguments);
    assert!(message.contains("mu = -1, but mu must be zero or greater"), "{message}");
}

/// The hash alone does not decide: a file whose inputs differ from the study's is not compared either.
#[test]
fn a_forged_problem_hash_is_noticed() {
    let folder = workplace();
    let hash = |name: &str| {
        let json: serde_json::Value = serde_json::from_str(&text(name)).unwrap();
        json["meta"]["problem_hash"].as_str().unwrap().to_owned()
    };
    let own = hash("surrogates/clutch-r2-eigenvalues.json");
    let forged =
        text("surrogates/clutch-r2-eigenvalues.json").replace(&own, &hash("surrogates/clutch-r8-eigenvalues.json"));
    fs::write(folder.path().join("forged.json"), forged).unwrap();
    fs::write(folder.path().join("other.toml"), text("surrogates/clutch-r8-eigenvalues.toml")).unwrap();
    let message = refusal(folder.path(), &["compare", "forged.json", "--study", "other.toml", "-n", "10"]);
    assert!(message.contains("built for another problem"), "{message}");
}

/// Without damping all real parts are zero: rounding is not fitted, and errors of nothing are zero.
#[test]
fn components_that_do_not_vary_are_constant() {
    let folder = workplace();
    let undamped = text("surrogates/clutch-r2-eigenvalues.toml")
        .replace("mu      = { distribution = \"uniform\", lower = 0.0, upper = 0.5 }", "")
        .replace(
            "[inputs]",
            "[model.constants]\nmu = 0.0\nc_A = 0.0\nc_B = 0.0\nc_C = 0.0\nc_D = 0.0\nc_f = 0.0\n[inputs]",
        );
    fs::write(folder.path().join("undamped.toml"), undamped).unwrap();
    let built: serde_json::Value =
        serde_json::from_str(&output(folder.path(), &["build", "undamped.toml", "-o", "u.pcc", "--json"])).unwrap();
    assert_eq!(built["components"][0]["stop"], "constant");
    assert_eq!(built["components"][0]["terms"], 1);
    assert_eq!(built["components"][1]["stop"], "accurate");
    let compared = output(folder.path(), &["compare", "u.pcc", "--study", "undamped.toml", "-n", "100", "--json"]);
    let compared: serde_json::Value = serde_json::from_str(&compared).unwrap();
    assert!(compared["components"][1]["variance_error_percent"].as_f64().unwrap() < 1.0);
}

#[test]
fn completions_for_every_shell() {
    let folder = workplace();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        assert!(output(folder.path(), &["completions", shell]).contains("reference"), "{shell}");
    }
}

/// Ctrl-C stops long work with exit code 130 and leaves nothing half-written.
#[cfg(unix)]
#[test]
fn interruption_ends_with_130_and_no_file() {
    let folder = workplace();
    let slow = format!(
        "{}\n[design]\ninitial = 20000\nmaximum = 20000\n[fit]\nq_norm = 1.0\nmax_degree = 12\nepsilon_forward = 0.0\n",
        text("surrogates/clutch-r8-eigenvalues.toml").replace("r8", "slow")
    );
    fs::write(folder.path().join("slow.toml"), slow).unwrap();
    let rows: String = (0..2_000_000).map(|_| "0.25,16e6\n").collect();
    fs::write(folder.path().join("many.csv"), format!("mu,k_p\n{rows}")).unwrap();
    let before = fs::read_dir(folder.path()).unwrap().count();
    let cases: [&[&str]; 5] = [
        &["eval", "surrogate.pcc", "-n", "1e13"],
        &["report", "surrogate.pcc", "-n", "1e13"],
        &["reference", "study.toml", "-n", "1e13"],
        &["reference", "study.toml", "--points", "many.csv", "--out", "out.csv"],
        &["build", "slow.toml"],
    ];
    for arguments in cases {
        let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("pcc"))
            .current_dir(folder.path())
            .args(arguments)
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(700));
        let interrupted = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        assert!(interrupted.success(), "{arguments:?} had ended before");
        assert_eq!(child.wait().unwrap().code(), Some(130), "{arguments:?}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), before, "{arguments:?}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_reproduction_keeps_the_rows_that_are_done() {
    let folder = workplace();
    let table = folder.path().join("reproduction/table2.csv");
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("pcc"))
        .current_dir(folder.path())
        .args(["reproduce", "--only", "table2", "--runs", "2000"])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // The rows with one input are there within seconds, those with eight are not.
    while !table.exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended without a table");
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    let interrupted = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(interrupted.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let rows = csv::Reader::from_path(&table).unwrap().records().map(Result::unwrap).count();
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains(&format!("{rows} rows that were done are in ")), "{message}");
    assert!(!folder.path().join("reproduction/report.html").exists());
}

#[test]
fn a_reproduction_replaces_its_own_files_only() {
    let folder = workplace();
    let cases =
        [("table2.csv", "table2"), ("table2.md", "table2"), ("figure3.svg", "figure3"), ("report.html", "figure4")];
    for (name, part) in cases {
        let output = folder.path().join(name.replace('.', "-"));
        fs::create_dir(&output).unwrap();
        fs::write(output.join(name), "mine").unwrap();
        let path = output.to_str().unwrap();
        let message = refusal(folder.path(), &["reproduce", "--only", part, "-o", path]);
        assert!(message.contains(&format!("{name}: exists and was not made by pcc")), "{message}");
        assert_eq!(fs::read_to_string(output.join(name)).unwrap(), "mine");
    }
    for _ in 0..2 {
        output(folder.path(), &["reproduce", "--only", "figure3"]);
        assert_eq!(files(&folder.path().join("reproduction")), ["figure3.svg", "report.html"]);
    }
}

/// A folder with the r = 2 study by invariants and its surrogate.
fn invariants_workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("study.toml"), text("surrogates/clutch-r2.toml")).unwrap();
    fs::copy(repository("surrogates/clutch-r2.pcc"), folder.path().join("surrogate.pcc")).unwrap();
    folder
}

#[test]
fn certificates_are_added_and_shown() {
    let folder = invariants_workplace();
    let certify = ["certify", "surrogate.pcc", "--study", "study.toml", "-n", "200"];
    assert_output!("certify", output(folder.path(), &certify));
    let other = [&certify[..], &["--seed", "2", "-o", "both.json"]].concat();
    let text = output(folder.path(), &other);
    assert!(text.contains("earlier certificates"), "{text}");
    let inspected: serde_json::Value =
        serde_json::from_str(&output(folder.path(), &["inspect", "both.json", "--json"])).unwrap();
    let seeds: Vec<_> = inspected["certificates"].as_array().unwrap().iter().map(|c| c["seed"].clone()).collect();
    assert_eq!(seeds, [1, 2]);
    let report: serde_json::Value =
        serde_json::from_str(&output(folder.path(), &["eval", "both.json", "-n", "1000", "--json"])).unwrap();
    let bound = &report["verified_bound"];
    assert_eq!((bound["samples"].as_u64(), bound["certificates"].as_u64()), (Some(200 + 67 + 50), Some(2)));
    assert!(bound["lower"].as_f64() < report["stable_proportion"].as_f64());
    for line in ["sampling interval", "surrogate band", "verified bound"] {
        assert!(output(folder.path(), &["eval", "both.json", "-n", "1000"]).contains(line), "{line}");
    }
}

#[test]
fn the_runs_of_a_certificate_are_said_and_none_is_made() {
    let folder = invariants_workplace();
    let before = fs::read(folder.path().join("surrogate.pcc")).unwrap();
    let plan = ["certify", "surrogate.pcc", "--target-width", "0.002"];
    assert_output!("certify_plan", output(folder.path(), &plan));
    let report: serde_json::Value =
        serde_json::from_str(&output(folder.path(), &[&plan[..], &["--json"]].concat())).unwrap();
    let first = &report["needed"][0];
    assert_eq!(first["runs"].as_u64(), ["outside", "layer", "inside"].iter().map(|name| first[name].as_u64()).sum());
    assert_eq!(fs::read(folder.path().join("surrogate.pcc")).unwrap(), before, "nothing was written");
    for wrong in ["0", "1", "-0.1", "x", "nan"] {
        let message = refusal(folder.path(), &["certify", "surrogate.pcc", "--target-width", wrong]);
        assert!(message.contains("a part of 1"), "{message}");
    }
    let message = refusal(folder.path(), &["certify", "surrogate.pcc", "--target-width", "1e-9"]);
    assert!(message.contains("use a larger width"), "{message}");
}

#[test]
fn certificates_that_would_mislead_are_refused() {
    let folder = invariants_workplace();
    let other = text("surrogates/clutch-r2.toml").replace("[inputs]", "[model.constants]\nplate_mass = 41.0\n[inputs]");
    fs::write(folder.path().join("other.toml"), other).unwrap();
    let before = fs::read(folder.path().join("surrogate.pcc")).unwrap();
    let of_other = ["certify", "surrogate.pcc", "--study", "other.toml", "-n", "20"];
    let message = refusal(folder.path(), &of_other);
    assert!(message.contains("asks another question") && message.contains("--force"), "{message}");
    assert_eq!(fs::read(folder.path().join("surrogate.pcc")).unwrap(), before, "nothing was written");
    let forced = output(folder.path(), &[&of_other[..], &["--force"]].concat());
    assert!(forced.contains("of another problem"), "{forced}");
    let text = output(folder.path(), &["eval", "surrogate.pcc", "-n", "1000"]);
    assert!(text.contains("verified bound     none yet"), "a bound of another problem is not shown: {text}");
    let own = ["certify", "surrogate.pcc", "--study", "study.toml", "-n", "20"];
    output(folder.path(), &own);
    let message = refusal(folder.path(), &own);
    assert!(message.contains("has a certificate of seed 1 already"), "{message}");
    for (few, hint) in [("0", "use at least 1"), ("9", "use at least 10"), ("-3", "whole number")] {
        let message = refusal(folder.path(), &["certify", "surrogate.pcc", "--study", "study.toml", "-n", few]);
        assert!(message.contains(hint), "{message}");
    }
}

#[test]
fn critical_values_follow_the_answer() {
    let folder = invariants_workplace();
    let critical = ["eval", "surrogate.pcc", "-n", "20000", "--critical", "mu", "--json"];
    let report: serde_json::Value = serde_json::from_str(&output(folder.path(), &critical)).unwrap();
    let quantiles = report["critical"]["quantiles"].as_array().unwrap();
    assert_eq!(quantiles.len(), 7);
    // With two inputs, clutches squeal from a friction coefficient of just below 0.1.
    assert!(quantiles.iter().all(|q| (0.098..0.1).contains(&q["value"].as_f64().unwrap())), "{quantiles:?}");
    assert!(output(folder.path(), &critical[..6]).contains("critical mu: the smallest value"));
    let message = refusal(folder.path(), &["eval", "surrogate.pcc", "-n", "10", "--critical", "nu"]);
    assert!(message.contains("no such input; it has mu, k_p"), "{message}");
}

#[test]
fn studies_by_invariants_that_cannot_be_built_say_why() {
    let folder = invariants_workplace();
    let study = text("surrogates/clutch-r2.toml");
    let mut listing = String::new();
    let cases = [
        ("a list that splits a group", study.replace("\"invariants\"", "\"invariants\"\nmodes = [1, 3]")),
        ("a key of another method", format!("{study}[fit]\nq_norm = 0.5\n")),
        ("an unknown method", format!("{study}[fit]\nmethod = \"lasso\"\n")),
        ("a tolerance too small to be estimated", format!("{study}[fit]\nproportion_tolerance = 1e-9\n")),
        ("no tolerance", format!("{study}[fit]\nproportion_tolerance = 0.0\n")),
        ("a tolerance of more than all", format!("{study}[fit]\nproportion_tolerance = 1.5\n")),
        ("runs at another place", format!("{study}[fit]\nenrich = \"everywhere\"\n")),
        ("a place that is a number", format!("{study}[fit]\nenrich = 3\n")),
        (
            "derivatives of eigenvalues",
            format!("{}[fit]\nderivatives = true\n", study.replace("\"invariants\"", "\"eigenvalues\"")),
        ),
        ("derivatives beyond memory", format!("{study}[design]\nmaximum = 9000\n")),
        ("derivatives neither yes nor no", format!("{study}[fit]\nderivatives = \"yes\"\n")),
        ("derivatives that are a number", format!("{study}[fit]\nderivatives = 3\n")),
        ("an unknown target", study.replace("\"invariants\"", "\"invariant\"")),
    ];
    for (name, text) in cases {
        fs::write(folder.path().join("bad.toml"), text).unwrap();
        listing.push_str(&format!("{name}:\n{}", refusal(folder.path(), &["build", "bad.toml"])));
    }
    assert_output!("invariants_refused", listing);
}

/// A surrogate that forgets the mode that squeals is not believed.
#[test]
fn a_list_without_the_unstable_mode_is_flagged() {
    let folder = invariants_workplace();
    let study = text("surrogates/clutch-r2.toml").replace("\"invariants\"", "\"invariants\"\nmodes = [1, 2]");
    fs::write(folder.path().join("blind.toml"), study.replace("clutch-r2", "blind")).unwrap();
    for arguments in [&["build", "blind.toml"][..], &["eval", "blind.pcc", "-n", "1000"], &["inspect", "blind.pcc"]] {
        let text = output(folder.path(), arguments);
        assert!(
            text.contains("decides whether the system is stable, and the proportion may be off"),
            "{arguments:?}: {text}"
        );
    }
}
