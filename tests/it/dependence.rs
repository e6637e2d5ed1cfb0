//! Inputs that depend on each other: shares with a closed form, conditions, sensitivities, the clutch, files, refusals.

use crate::support::command::{output, refusal};
use crate::support::studies::{built_from, json, number};
use crate::support::{build, in_one_line, invariants_study, text};
use pcc_compile::reference::compare_with_model;
use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::probability::inputs::random_points;
use pcc_evaluate::probability::random::Purpose;
use pcc_evaluate::surrogate::Surrogate;
use serde_json::Value;
use std::fs;

/// An oscillator with λ = (x + y + z − 1.5) ± ≈10i, of which z is independent; Pearson's correlation of x and y is 0.6.
const OSCILLATOR: &str = "format = 1
name = \"oscillator\"
[model]
kind = \"matrices\"
M = [[1]]
C = [[\"2 * (1.5 - x - y - z)\"]]
K = [[100]]
[inputs]
x = { distribution = \"normal\", mean = 1.0, std = 0.3 }
y = { distribution = \"normal\", mean = 0.2, std = 0.2 }
z = { distribution = \"normal\", mean = 0.1, std = 0.1 }
[dependence]
kind = \"gaussian-copula\"
pearson = [[\"x\", \"y\", 0.6]]
";

/// The oscillator's surrogate.
pub fn surrogate() -> Surrogate {
    build(&Study::from_toml(OSCILLATOR).unwrap())
}

/// Conditions and the share of stable systems: the first is Φ(0.2/√0.212), the second that of the conditional law, the
/// others by SciPy's quad.
const SHARES: [(&[&str], f64); 5] = [
    (&[], 0.6679909245577871),
    (&["y=0.5"], 0.07735692864316325),
    (&["x=0.9..1.2"], 0.7260283163251663),
    (&["y=0.5", "x=0.9..1.2"], 0.09094012975449023),
    (&["x=1.3", "z=0.0..0.2"], 0.09643734014638959),
];

#[test]
fn shares_are_those_of_the_joint_law_with_and_without_conditions() {
    let folder = built_from(OSCILLATOR);
    for (conditions, expected) in SHARES {
        for sampler in ["monte-carlo", "latin-hypercube", "sobol"] {
            let options: Vec<&str> = conditions.iter().flat_map(|condition| ["--where", condition]).collect();
            let eval = ["eval", "built.pcc", "-n", "1048576", "--sampler", sampler];
            let found = number(&json(folder.path(), &[&eval[..], &options].concat()), "/stable_proportion");
            let error = (expected * (1.0 - expected) / 1e6).sqrt();
            println!("{conditions:?} {sampler}: {found} for {expected}");
            // Points of the other samplers scatter less.
            assert!((found - expected).abs() < 4.5 * error, "{conditions:?} {sampler}: {found} for {expected}");
        }
    }
}

/// Along y the mean of x + z moves by its regression 0.9 y, and what is left has the variance 0.0676.
#[test]
fn sweeps_are_conditional_at_every_point() {
    let folder = built_from(OSCILLATOR);
    let report = json(folder.path(), &["eval", "built.pcc", "-n", "200000", "--sweep", "y=-0.2..0.6:3"]);
    for (at, expected) in SWEEP.into_iter().enumerate() {
        let found = number(&report, &format!("/points/{at}/stable_proportion"));
        let error = (expected * (1.0 - expected) / 2e5f64).sqrt();
        assert!((found - expected).abs() < 4.5 * error, "{at}: {found} for {expected}");
    }
    assert_eq!(report["dependence"]["correlations"][0]["normal_scores"], 0.6);
}

/// Shares of stable systems at y = −0.2, 0.2, 0.6.
const SWEEP: [f64; 3] = [0.9998888858149771, 0.7791218362875403, 0.01562611942846938];

/// Owen and Prieur (2017), with x and y of the variances 0.09 and 0.04, the covariance 0.036, and z of 0.01.
#[test]
fn shapley_effects_hold_the_closed_form() {
    let folder = built_from(OSCILLATOR);
    let report = json(folder.path(), &["eval", "built.pcc", "-n", "100000"]);
    assert_eq!(report["sensitivity"], Value::Null);
    let half = 0.5 * 0.36;
    let [x, y, z, shared] = [0.09, 0.04, 0.01, 0.036];
    let variance = x + y + z + 2.0 * shared;
    let exact = [x * (1.0 - half) + shared + y * half, y * (1.0 - half) + shared + x * half, z];
    for (at, (name, exact)) in ["x", "y", "z"].into_iter().zip(exact.map(|part| part / variance)).enumerate() {
        let effect = |end: &str| number(&report, &format!("/shapley/inputs/{at}/max_re/{end}"));
        assert_eq!(report["shapley"]["inputs"][at]["input"], name);
        assert!(effect("lower") <= exact && exact <= effect("upper"), "{name}: {report}");
        assert!((effect("value") - exact).abs() < 0.02);
    }
    let sum: f64 = (0..3).map(|at| number(&report, &format!("/shapley/inputs/{at}/stability/value"))).sum();
    assert!((sum - 1.0).abs() < 1e-12);
    // What follows from coefficients for independent inputs is not there.
    assert!(report["components"][0].get("mean_from_coefficients").is_none(), "{}", report["components"][0]);
    let shown = output(folder.path(), &["eval", "built.pcc", "-n", "20000"]);
    assert!(in_one_line(&shown).contains("x with y 0.582 correlations of ranks"), "{shown}");
    assert!(shown.contains("Shapley effect") && !shown.contains("in all"), "{shown}");
    let details = output(folder.path(), &["eval", "built.pcc", "-n", "20000", "--details"]);
    assert!(details.contains("Shapley effect") && !details.contains("exact mean"), "{details}");
    let confined = json(folder.path(), &["eval", "built.pcc", "-n", "20000", "--where", "x=0.9..1.2"]);
    assert!(confined.get("shapley").is_none() && confined["complete"] == true);
    let fixed = json(folder.path(), &["eval", "built.pcc", "-n", "20000", "--where", "y=0.5"]);
    assert_eq!(fixed["shapley"]["inputs"].as_array().unwrap().len(), 2);
    // Given y, x keeps 0.64 of its variance.
    let alone = 0.64 * x / (0.64 * x + z);
    assert!((number(&fixed, "/shapley/inputs/0/max_re/value") - alone).abs() < 0.02);
    output(folder.path(), &["report", "built.pcc", "-o", "page.html", "--quiet"]);
    let page = fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert!(page.contains("Shapley effects on stability") && page.contains("x with y 0.582"));
}

#[test]
fn threads_and_parts_give_the_same_bytes() {
    let folder = built_from(OSCILLATOR);
    let path = folder.path();
    let without_time = |arguments: &[&str]| {
        let mut report = json(path, arguments);
        report["elapsed_seconds"] = Value::Null;
        report
    };
    let eval =
        |more: &[&str]| without_time(&[&["eval", "built.pcc", "-n", "100000", "--where", "y=0.3"], more].concat());
    let one = eval(&["--threads", "1"]);
    assert!(one == eval(&["--threads", "2"]) && one == eval(&["--threads", "8"]));
    for shard in ["0/3", "1/3", "2/3"] {
        let name = format!("{}.part", &shard[..1]);
        let eval =
            ["eval", "built.pcc", "-n", "100000", "--where", "y=0.3", "--shard", shard, "--part", &name, "--quiet"];
        output(path, &eval);
    }
    let merged = without_time(&["merge", "0.part", "1.part", "2.part"]);
    assert_eq!((&merged["stable_samples"], &merged["shapley"]), (&one["stable_samples"], &one["shapley"]));
    let bytes = |threads: &str| {
        output(path, &["build", "study.toml", "-o", "again.pcc", "--threads", threads, "--quiet"]);
        fs::read(path.join("again.pcc")).unwrap()
    };
    let built = fs::read(path.join("built.pcc")).unwrap();
    assert!(bytes("1") == built && bytes("2") == built && bytes("8") == built);
}

#[test]
fn files_keep_dependence_and_studies_must_have_the_same() {
    let folder = built_from(OSCILLATOR);
    let path = folder.path();
    output(path, &["convert", "built.pcc", "there.json"]);
    output(path, &["convert", "there.json", "back.pcc"]);
    assert_eq!(fs::read(path.join("built.pcc")).unwrap(), fs::read(path.join("back.pcc")).unwrap());
    let inspect = json(path, &["inspect", "built.pcc"]);
    let pair = &inspect["dependence"]["correlations"][0];
    assert_eq!((&pair["first"], &pair["second"], number(pair, "/normal_scores")), (&"x".into(), &"y".into(), 0.6));
    assert!(in_one_line(&output(path, &["inspect", "built.pcc"])).contains("x with y 0.582 correlations of ranks"));
    let compared = json(path, &["compare", "built.pcc", "--study", "study.toml", "-n", "2000"]);
    assert_eq!(number(&compared, "/misclassified_percent"), 0.0);
    assert_eq!(compared["dependence"]["correlations"][0]["first"], "x");
    output(path, &["certify", "built.pcc", "--study", "study.toml", "-n", "200", "--quiet"]);
    fs::write(path.join("other.toml"), OSCILLATOR.replace("0.6]]", "0.61]]")).unwrap();
    refusal(path, &["compare", "built.pcc", "--study", "other.toml", "-n", "2000"]);
}

#[test]
fn what_cannot_be_said_of_dependent_inputs_is_refused_with_the_reason() {
    let folder = built_from(OSCILLATOR);
    let refused = |arguments: &[&str]| {
        in_one_line(&refusal(folder.path(), &[&["eval", "built.pcc", "-n", "1000"], arguments].concat()))
    };
    let critical = refused(&["--critical", "x"]);
    assert!(
        critical.contains("y and x depend on each other")
            && critical.contains("--critical x: ")
            && critical.contains("--sweep x=FROM..TO:POINTS"),
        "{critical}"
    );
    assert!(critical.contains("fix the others (--where y=VALUE)"), "{critical}");
    let confined = refused(&["--critical", "x", "--where", "y=0.1..0.3"]);
    assert!(confined.contains("y and x depend on each other"), "{confined}");
    let intervals = refused(&["--where", "x=0.9..1.2", "--where", "y=0.0..0.3"]);
    assert!(intervals.contains("x and y depend on each other, and only one of them"), "{intervals}");
    let report = json(folder.path(), &["eval", "built.pcc", "-n", "20000", "--critical", "z"]);
    // The critical value of z is 1.5 − x − y.
    let quantiles = report["critical"]["quantiles"].as_array().unwrap();
    let median = quantiles.iter().find(|quantile| quantile["level"] == 0.5).unwrap();
    assert!((number(median, "/value") - 0.3).abs() < 0.015, "{quantiles:?}");
}

/// With y fixed, x is normal with the mean 1 + 0.9 (y − 0.2) and the standard deviation 0.24, and the critical value is
/// 1.5 − y − z.
#[test]
fn critical_values_are_found_where_all_that_an_input_depends_on_is_fixed() {
    let folder = built_from(OSCILLATOR);
    for (y, never, from_start) in [(0.5, 0.0, 0.0), (0.1, 0.0, 0.0), (0.9, 0.0, 1.0)] {
        let condition = format!("y={y:?}");
        let eval = ["eval", "built.pcc", "-n", "20000", "--critical", "x", "--where", &condition];
        let report = json(folder.path(), &eval);
        let mean = 0.9f64.mul_add(y - 0.2, 1.0);
        let ends = ["from", "to"].map(|end| number(&report, &format!("/critical/{end}")));
        let expected = [-1.0, 1.0].map(|side| 0.24f64.mul_add(side * 3.668_329_285_121, mean));
        assert!(ends.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{ends:?} {expected:?}");
        assert!((number(&report, "/critical/never") - never).abs() < 1e-3, "{report}");
        assert!((number(&report, "/critical/unstable_from_start") - from_start).abs() < 0.01, "{report}");
        if from_start == 0.0 {
            // Of 20 000 values of z with a standard deviation of 0.1.
            let critical = number(&report, "/critical/mean");
            assert!((critical - (1.5 - y - 0.1)).abs() < 4.5 * 0.1 / 20_000f64.sqrt(), "{y}: {critical}");
        }
    }
}

/// Ranks from 0, for numbers that are all different.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    order.into_iter().enumerate().for_each(|(rank, at)| ranks[at] = rank as f64);
    ranks
}

/// The correlation of two lists, and its standard error by the fourth moments.
fn correlation(a: &[f64], b: &[f64]) -> (f64, f64) {
    let count = a.len() as f64;
    let standard = |list: &[f64]| -> Vec<f64> {
        let mean = list.iter().sum::<f64>() / count;
        let deviation = (list.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt();
        list.iter().map(|x| (x - mean) / deviation).collect()
    };
    let (a, b) = (standard(a), standard(b));
    let products = || a.iter().zip(&b);
    let found = products().map(|(a, b)| a * b).sum::<f64>() / count;
    // The influence of a point on the correlation is ab − r (a² + b²)/2.
    let influence = |(a, b): (&f64, &f64)| (a * b - 0.5 * found * (a * a + b * b)).powi(2);
    (found, (products().map(influence).sum::<f64>() / count / count).sqrt())
}

#[test]
fn a_million_samples_have_the_correlations_that_were_asked_for() {
    let laws = [
        ("a", "\"normal\", mean = 2.0, std = 0.3"),
        ("b", "\"lognormal\", mean = 1.0, cv = 0.5"),
        ("c", "\"uniform\", lower = 0.0, upper = 3.0"),
        ("d", "\"normal\", mean = 1.0, std = 0.5, lower = 0.2"),
        ("e", "\"weibull\", shape = 1.5, scale = 2.0"),
    ];
    let inputs: String = laws.iter().map(|(name, law)| format!("{name} = {{ distribution = {law} }}\n")).collect();
    let asked = [("a", "b", 0.6), ("b", "c", -0.3), ("c", "d", 0.7), ("d", "e", -0.5)];
    for measure in ["spearman", "pearson"] {
        let pairs = asked.map(|(one, other, value)| format!("[\"{one}\", \"{other}\", {value:?}]")).join(", ");
        let study = format!(
            "format = 1\nname = \"s\"\n[model]\nkind = \"matrices\"\nM = [[1]]\nC = [[\"a + b + c + d + e\"]]\nK = \
             [[100]]\n[inputs]\n{inputs}[dependence]\nkind = \"gaussian-copula\"\n{measure} = [{pairs}]\n"
        );
        let study = Study::from_toml(&study).unwrap();
        let points = random_points(&study.inputs, 11, Purpose::Evaluation, 0..1_000_000);
        let column = |name: &str| -> Vec<f64> {
            let at = study.inputs.names().position(|known| known == name).unwrap();
            let marginal = &study.inputs.inputs()[at].marginal;
            let values: Vec<f64> = points.iter().map(|point| marginal.physical(point[at])).collect();
            if measure == "spearman" { ranks(&values) } else { values }
        };
        let columns: Vec<Vec<f64>> = laws.iter().map(|(name, _)| column(name)).collect();
        for i in 0..laws.len() {
            for k in i + 1..laws.len() {
                let (one, other) = (laws[i].0, laws[k].0);
                let expected = asked.iter().find(|pair| (pair.0, pair.1) == (one, other)).map_or(0.0, |pair| pair.2);
                let (found, error) = correlation(&columns[i], &columns[k]);
                println!("{measure} {one} {other}: {found} ± {error} for {expected}");
                assert!((found - expected).abs() < 4.5 * error, "{measure} {one} {other}: {found} for {expected}");
            }
        }
    }
}

/// The clutch with three correlated pairs: friction cut off at 0 or uniform, normal and lognormal stiffness, of the
/// means and standard deviations of the shipped study.
fn clutch(friction: &str) -> String {
    let study = text("surrogates/clutch-r3.toml");
    let head = study.split("[inputs]").next().unwrap();
    let std = |half: f64| half / 3f64.sqrt();
    format!(
        "{head}[inputs]\nmu = {{ distribution = {friction} }}\nk_p = {{ distribution = \"normal\", mean = 16e6, std = \
         {:?} }}\nk_f = {{ distribution = \"lognormal\", mean = 7e6, std = {:?} }}\n[dependence]\nkind = \
         \"gaussian-copula\"\nspearman = [[\"mu\", \"k_p\", 0.5], [\"mu\", \"k_f\", -0.3], [\"k_p\", \"k_f\", \
         0.4]]\n[spectrum]\ntarget = \"invariants\"\n",
        std(0.8e6),
        std(0.35e6)
    )
}

/// Runs, and the error of the share in percent.
fn runs_and_error(study: &Study, points: u64) -> (u64, f64) {
    let surrogate = build(study);
    let compared = compare_with_model(&surrogate, study, points, 1, &Silent).unwrap();
    (surrogate.training.counts.direct_computations, compared.relative_error_percent().unwrap().abs())
}

#[test]
fn the_clutch_with_three_correlated_pairs_is_as_exact_as_with_intervals() {
    let std = 0.25 / 3f64.sqrt();
    let truncated = format!("\"normal\", mean = 0.25, std = {std:?}, lower = 0.0");
    for friction in ["\"uniform\", lower = 0.0, upper = 0.5", &truncated] {
        for seed in 1..=5 {
            let (uniform_runs, _) = runs_and_error(&Study { seed, ..invariants_study(3) }, 100);
            let study = Study { seed, ..Study::from_toml(&clutch(friction)).unwrap() };
            let (runs, error) = runs_and_error(&study, 20_000);
            let found =
                format!("{friction}, seed {seed}: {runs} runs, {uniform_runs} of uniform inputs; error {error} %");
            println!("{found}");
            assert!(error <= 0.05 && 2 * runs <= 3 * uniform_runs, "{found}");
        }
    }
}
