//! Inputs of other laws than the uniform one: shares with a closed form, the clutch, files, and what is refused.

use crate::support::command::{output, refusal};
use crate::support::studies::{built_from, folder_with, json, number};
use crate::support::{build, in_one_line, invariants_study, text};
use pcc_compile::reference::compare_with_model;
use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::surrogate::Surrogate;
use std::fs;

/// An oscillator with λ = (Σ inputs − 1.1) ± ≈10i.
pub(crate) fn oscillator(inputs: &[(&str, &str)], threshold: f64, rest: &str) -> String {
    let names: Vec<&str> = inputs.iter().map(|(name, _)| *name).collect();
    let laws: String = inputs.iter().map(|(name, law)| format!("{name} = {{ distribution = {law} }}\n")).collect();
    format!(
        "format = 1\nname = \"oscillator\"\n[model]\nkind = \"matrices\"\nM = [[1]]\nC = [[\"2 * ({threshold:?} - {})\"]]\n\
         K = [[100]]\n[inputs]\n{laws}{rest}",
        names.join(" - ")
    )
}

pub(crate) const UNIFORM: &str = "\"uniform\", lower = 0.0, upper = 0.2";
pub(crate) const NORMAL: &str = "\"normal\", mean = 1.0, std = 0.2";

/// The surrogate of an oscillator with a uniform and a normal input.
pub(crate) fn built() -> Surrogate {
    build(&Study::from_toml(&oscillator(&[("u", UNIFORM), ("x", NORMAL)], 1.1, "")).unwrap())
}

/// A law, c, F(c), an interval, and F(c) on condition that the input lies there; from the distribution functions, by
/// Python.
const SHARES: [(&str, f64, f64, [f64; 2], f64); 12] = [
    ("\"gamma\", mean = 1.0, std = 0.5", 1.1, 0.640552227211231, [0.8, 1.5], 0.5385850200593046),
    ("\"gamma\", shape = 0.5, scale = 1.0", 0.8, 0.7940967892679318, [0.3, 1.2], 0.7334282548090078),
    ("\"beta\", alpha = 2.0, beta = 3.0, lower = 0.5, upper = 1.5", 0.95, 0.60901875, [0.7, 1.2], 0.5822144799456151),
    ("\"triangular\", lower = 0.5, mode = 1.0, upper = 2.5", 1.2, 0.4366666666666667, [0.8, 1.6], 0.5416666666666666),
    ("\"normal\", mean = 1.0, std = 0.2", 1.1, 0.6914624612740132, [0.8, 1.3], 0.6879036541480422),
    ("\"lognormal\", mean = 1.0, cv = \"25%\"", 1.1, 0.6950453214839031, [0.8, 1.3], 0.7181909160424771),
    ("\"log-uniform\", lower = 0.2, upper = 2.0", 0.7, 0.5440680443502756, [0.4, 1.5], 0.4233881712547671),
    ("\"exponential\", mean = 0.5", 0.8, 0.7981034820053446, [0.3, 1.2], 0.7573016854880691),
    ("\"weibull\", shape = 1.5, scale = 1.0", 1.1, 0.6845293830353467, [0.5, 1.6], 0.6784003040507642),
    ("\"gumbel\", location = 1.0, scale = 0.2", 1.2, 0.6922006275553463, [0.8, 1.5], 0.7322362921334442),
    ("\"normal\", mean = 1.0, std = 0.5, lower = 0.0", 1.2, 0.6474000461349728, [0.6, 1.8], 0.6048533169157017),
    (
        "\"normal\", mean = 1.0, std = 0.5, lower = 0.5, upper = 1.4",
        1.2,
        0.7891578938761771,
        [0.6, 1.3],
        0.8631517686616555,
    ),
];

#[test]
fn shares_are_those_of_the_distribution_functions() {
    for (law, threshold, expected, [from, to], expected_inside) in SHARES {
        let folder = built_from(&oscillator(&[("x", law)], threshold, ""));
        let eval = ["eval", "built.pcc", "-n", "1000000"];
        let whole = number(&json(folder.path(), &eval), "/stable_proportion");
        let inside = format!("x={from}..{to}");
        let part = number(&json(folder.path(), &[&eval[..], &["--where", &inside]].concat()), "/stable_proportion");
        println!("{law}: {whole} for {expected}, {part} for {expected_inside}");
        for (found, expected) in [(whole, expected), (part, expected_inside)] {
            let error = (expected * (1.0 - expected) / 1e6).sqrt();
            assert!((found - expected).abs() < 4.5 * error, "{law}: {found} for {expected}");
        }
        // The input decides alone, so that all samples lose stability there.
        let critical = json(folder.path(), &["eval", "built.pcc", "-n", "1000", "--critical", "x"]);
        for end in ["minimum", "maximum"] {
            let value = number(&critical, &format!("/critical/{end}"));
            assert!((value - threshold).abs() < 0.002 * threshold, "{law}: critical {value}");
        }
        let fixed = |at: f64| {
            let condition = format!("x={at}");
            let eval = ["eval", "built.pcc", "-n", "100", "--where", &condition];
            number(&json(folder.path(), &eval), "/stable_proportion")
        };
        assert_eq!((fixed(0.98 * threshold), fixed(1.02 * threshold)), (1.0, 0.0), "{law}");
    }
}

/// The critical value of x is 1.1 − y.
#[test]
fn critical_values_have_the_law_of_what_is_left() {
    let inputs = [("x", "\"normal\", mean = 1.0, std = 0.5"), ("y", "\"normal\", mean = 0.2, std = 0.1")];
    let folder = built_from(&oscillator(&inputs, 1.1, ""));
    let report = json(folder.path(), &["eval", "built.pcc", "-n", "100000", "--critical", "x"]);
    let quantiles = report["critical"]["quantiles"].as_array().unwrap();
    let median = quantiles.iter().find(|quantile| quantile["level"] == 0.5).unwrap();
    assert!((number(median, "/value") - 0.9).abs() < 0.003, "{quantiles:?}");
    assert!((number(&report, "/critical/mean") - 0.9).abs() < 0.003, "{report}");
    assert_eq!(number(&report, "/critical/never"), 0.0);
}

/// The critical value of x is y, which is uniform: its mean, quartiles and largest value, also where those are in the
/// tail of x; of x without bounds as far as it is looked for, of which the last value is the quantile 99.988 %.
#[test]
fn critical_values_are_those_of_the_other_input_whatever_the_law() {
    for (law, [from, to], last) in [
        ("\"exponential\", mean = 1.0", [0.5, 5.0], f64::INFINITY),
        ("\"log-uniform\", lower = 1e-3, upper = 1e3", [0.5, 5.0], f64::INFINITY),
        ("\"beta\", alpha = 2.0, beta = 4.0", [0.1, 0.95], f64::INFINITY),
        ("\"normal\", mean = 0.0, std = 1.0, lower = -3.0, upper = 7.0", [2.0, 6.0], f64::INFINITY),
        ("\"normal\", mean = 0.0, std = 1.0", [2.0, 6.0], 3.668_329_2),
        ("\"discrete\", values = [1.0, 2.0, 3.0]", [1.0, 1.999], f64::INFINITY),
    ] {
        let inputs = [("x", law), ("y", &*format!("\"uniform\", lower = {from:?}, upper = {to:?}"))];
        let study = oscillator(&inputs, 0.0, "").replace("2 * (0.0 - x - y)", "2 * (y - x)");
        let folder = built_from(&study);
        let report = json(folder.path(), &["eval", "built.pcc", "-n", "100000", "--critical", "x"]);
        let is_discrete = law.contains("discrete");
        // Levels are all there is: above 1 and below 2 stability is lost at 2.
        let expected = |share: f64| if is_discrete { 2.0 } else { from + share * (to - from) };
        let lost = ((last.min(to) - from) / (to - from)).min(1.0);
        let tolerance = 0.004 * (to - from);
        let mean = number(&report, "/critical/mean");
        assert!((mean - expected(0.5 * lost)).abs() < tolerance, "{law}: mean {mean} for {}", expected(0.5 * lost));
        for (at, level) in [(2, 0.25), (4, 0.75)] {
            let found = &report["critical"]["quantiles"][at];
            assert_eq!(found["level"], level);
            match found["value"].as_f64() {
                Some(value) => assert!((value - expected(level)).abs() < tolerance, "{law}: {level} at {value}"),
                None => assert!(level > lost, "{law}: {level} is not known"),
            }
        }
        let never = number(&report, "/critical/never");
        assert!((never - (1.0 - lost)).abs() < 0.005, "{law}: {never} never");
    }
}

/// Shares of the variance of x + y are those of the variances.
#[test]
fn sensitivities_to_normal_inputs_are_shares_of_the_variance() {
    let inputs = [("x", "\"normal\", mean = 1.0, std = 0.3"), ("y", "\"normal\", mean = 0.2, std = 0.4")];
    let folder = built_from(&oscillator(&inputs, 1.1, ""));
    let report = json(folder.path(), &["eval", "built.pcc", "-n", "200000"]);
    for (at, expected) in [0.36, 0.64].into_iter().enumerate() {
        for order in ["first", "total"] {
            let found = number(&report, &format!("/sensitivity/inputs/{at}/max_re/{order}/value"));
            assert!((found - expected).abs() < 0.01, "{order} {at}: {found}");
        }
    }
}

/// The clutch with scatter of the same mean and standard deviation as that of the shipped study, but for this law of
/// its friction.
fn clutch(friction: &str) -> String {
    let study = text("surrogates/clutch-r3.toml");
    let head = study.split("[inputs]").next().unwrap();
    let std = |half: f64| half / 3f64.sqrt();
    format!(
        "{head}[inputs]\nmu = {{ distribution = {friction} }}\nk_p = {{ distribution = \"normal\", mean = 16e6, std = \
         {:?} }}\nk_f = {{ distribution = \"lognormal\", mean = 7e6, std = {:?} }}\n[spectrum]\ntarget = \
         \"invariants\"\n",
        std(0.8e6),
        std(0.35e6)
    )
}

/// Runs, and the error of the share in percent.
fn runs_and_error(study: &Study) -> (u64, f64) {
    let surrogate = build(study);
    let compared = compare_with_model(&surrogate, study, 20_000, 1, &Silent).unwrap();
    (surrogate.training.counts.direct_computations, compared.relative_error_percent().unwrap().abs())
}

#[test]
fn the_clutch_with_scatter_without_bounds_is_as_exact_as_with_intervals() {
    let std = 0.25 / 3f64.sqrt();
    let truncated = format!("\"normal\", mean = 0.25, std = {std:?}, lower = 0.0");
    for friction in ["\"uniform\", lower = 0.0, upper = 0.5", "\"normal\", mean = 0.12, std = 0.015", &truncated] {
        for seed in [1, 2] {
            let (uniform_runs, _) = runs_and_error(&Study { seed, ..invariants_study(3) });
            let (runs, error) = runs_and_error(&Study { seed, ..Study::from_toml(&clutch(friction)).unwrap() });
            let found =
                format!("{friction}, seed {seed}: {runs} runs, {uniform_runs} of uniform inputs; error {error} %");
            println!("{found}");
            assert!(error <= 0.1 && 2 * runs <= 3 * uniform_runs, "{found}");
        }
    }
}

#[test]
fn files_keep_laws_in_both_forms() {
    let mut laws: Vec<(String, &str)> = SHARES.iter().enumerate().map(|(at, row)| (format!("x{at}"), row.0)).collect();
    laws.push(("u".to_owned(), "\"uniform\", lower = 0.0, upper = 0.1"));
    let inputs: Vec<(&str, &str)> = laws.iter().map(|(name, law)| (name.as_str(), *law)).collect();
    let study = oscillator(&inputs, 9.0, "");
    let folder = built_from(&study);
    let path = folder.path();
    output(path, &["convert", "built.pcc", "there.json"]);
    output(path, &["convert", "there.json", "back.pcc"]);
    let inspect = |name: &str| json(path, &["inspect", name]);
    assert_eq!(inspect("built.pcc")["content_id"], inspect("there.json")["content_id"]);
    assert_eq!(inspect("built.pcc")["format"], "1.3");
    assert_eq!(fs::read(path.join("built.pcc")).unwrap(), fs::read(path.join("back.pcc")).unwrap());
    let shown = in_one_line(&output(path, &["inspect", "built.pcc"]));
    assert!(shown.contains("x4 normal mean 1, std 0.2 hermite"), "{shown}");
    assert!(shown.contains("x6 log-uniform lower 0.2, upper 2 legendre"), "{shown}");

    // Files that say a law in two ways, or of which the polynomials are others.
    let text = fs::read_to_string(path.join("there.json")).unwrap();
    for (from, to) in [("\"hermite\"", "\"legendre\""), ("\"lognormal\"", "\"lognorm\""), ("\"std\"", "\"cv\"")] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text, "{from}");
        fs::write(path.join("bad.json"), changed).unwrap();
        refusal(path, &["inspect", "bad.json"]);
    }

    // A study that is printed is the same study.
    let first = Study::from_toml(&study).unwrap();
    let again = Study::from_toml(&first.to_toml()).unwrap();
    assert_eq!((again.problem_hash(), again.study_hash()), (first.problem_hash(), first.study_hash()));
}

#[test]
fn laws_that_make_no_sense_are_refused() {
    for (law, expected) in [
        ("\"normal\", mean = 1.0, std = 0.0", "std is 0, but must be a positive number"),
        ("\"normal\", mean = 0.0, cv = 0.1", "cv = 0.1 is a share of mean, which is 0; give mean and std instead"),
        ("\"normal\", mean = 1.0, cv = \"-5%\"", "above 0"),
        ("\"normal\", mean = 1.0", "mean and std, mean and cv, or nominal and cv"),
        ("\"normal\", mean = 1.0, std = 0.1, shape = 2.0", "a normal law has mean and std"),
        ("\"normal\", mean = 1.0, std = 0.1, mode = 1.0", "it off; mode does not belong to it; remove that key"),
        ("\"exponential\", mean = 1.0, std = 0.1", "an exponential law has mean; std does not belong to it"),
        ("\"exponential\", mean = 1.0, polynomials = \"own\", upper = 9.0", "an exponential law cannot be cut off"),
        ("\"weibull\", shape = 2.0, values = [1.0, 2.0]", "shape and scale; values does not belong to it"),
        ("\"normal\", mean = nan, std = 0.1", "mean is NaN"),
        ("\"normal\", mean = 1.0, std = 0.1, lower = 3.0", "lower = 3 leaves nothing of the probability, but"),
        ("\"normal\", mean = 1.0, std = 0.1, lower = 1.2, upper = 1.1", "(1.2) is not below"),
        ("\"lognormal\", mean = -1.0, std = 0.1", "mean is -1, but must be a positive number"),
        ("\"log-uniform\", lower = 0.0, upper = 1.0", "lower is 0, but must be a positive number"),
        ("\"log-uniform\", lower = 2.0, upper = 1.0", "(2) is not below"),
        ("\"exponential\", mean = inf", "mean is inf"),
        ("\"weibull\", shape = 1.0, scale = -1.0", "scale is -1"),
        ("\"gamma\", shape = 0.0, scale = 1.0", "shape is 0, but must be a positive number"),
        ("\"gamma\", mean = 1.0, std = 1e-5", "take a normal law"),
        ("\"gamma\", mean = 1.0, cv = \"1000%\"", "with mean = 1, cv = 10, std is 10, but must be from 0.001 to 4.47"),
        ("\"gamma\", shape = 1e-3, scale = 1.0", "shape is 0.001, but must be from 0.05 to 1e6"),
        ("\"beta\", mean = 2.0, std = 0.1", "mean is 2, but must be between lower (0) and upper (1)"),
        ("\"log-uniform\", lower = 1e-300, upper = 1e300", "span 600 orders of magnitude, and expansions follow 16"),
        ("\"log-uniform\", lower = 1e-10, upper = 1e7", "bring lower and upper closer together"),
        ("\"lognormal\", mean = 1.0, cv = 1e6", "narrow it, or take a log-uniform law between the values that matter"),
        ("\"lognormal\", median = 1.0, cv = 1e100", "orders of magnitude"),
        ("\"weibull\", shape = 0.1, scale = 1.0", "orders of magnitude"),
        ("\"gamma\", shape = 0.05, scale = 1.0, polynomials = \"hermite\"", "orders of magnitude"),
        ("\"beta\", alpha = 1.0, beta = 2.0, lower = 1.0", "a beta law has alpha and beta"),
        ("\"triangular\", lower = 1.0, mode = 3.0, upper = 2.0", "mode is 3, but must be between lower and upper"),
        ("\"normal\", mean = 1.0, std = 0.1, polynomials = \"own\"", "leaves no choice of polynomials"),
        ("\"gamma\", mean = 1.0, std = 0.1, polynomials = \"laguerre\"", "choose \"own\" or \"hermite\""),
        ("\"gauss\", mean = 1.0, std = 1.0", "choose \"uniform\", \"normal\", \"lognormal\", \"gamma\", \"beta\""),
    ] {
        let folder = folder_with(&oscillator(&[("x", law)], 1.1, ""));
        let message = in_one_line(&refusal(folder.path(), &["build", "study.toml"]));
        assert!(message.contains(expected) && message.contains("inputs.x"), "{law}: {message}");
    }
}

/// A normal friction coefficient is negative now and then.
#[test]
fn laws_beyond_what_a_parameter_can_be_are_to_be_cut_off() {
    let folder = folder_with(&clutch("\"normal\", mean = 0.25, cv = 0.3"));
    let message = in_one_line(&refusal(folder.path(), &["build", "study.toml"]));
    assert!(message.contains("inputs.mu") && message.contains("cut the law off with lower"), "{message}");
}

#[test]
fn elements_divide_uniform_inputs_alone() {
    let study = |law: &str| {
        let inputs = [("u", "\"uniform\", lower = 0.5, upper = 1.5"), ("x", law)];
        oscillator(&inputs, 1.1, "[fit]\nmethod = \"me-gpc\"\nelements = 4\n")
    };
    for (law, name) in [
        ("\"normal\", mean = 0.0, std = 0.1", "normal"),
        ("\"exponential\", mean = 0.1", "exponential"),
        ("\"triangular\", lower = 0.0, mode = 0.1, upper = 0.2", "triangular"),
        ("\"discrete\", values = [0.0, 0.1]", "discrete"),
    ] {
        let folder = folder_with(&study(law));
        let message = in_one_line(&refusal(folder.path(), &["build", "study.toml"]));
        let expected = format!(
            "line 10: inputs.x: elements divide uniform and log-uniform inputs only, and this law is {name}; use one of"
        );
        assert!(message.contains(&expected), "{message}");
    }
    built_from(&study("\"log-uniform\", lower = 0.05, upper = 0.2"));
}

#[test]
fn critical_values_say_where_they_were_looked_for() {
    let folder = built_from(&oscillator(&[("u", UNIFORM), ("x", NORMAL)], 1.1, ""));
    let critical = ["eval", "built.pcc", "-n", "1000", "--critical", "x", "--where", "u=0.1"];
    let report = json(folder.path(), &critical);
    // Quantiles of a normal law at 1/8192 and 8191/8192, by SciPy: ∓3.668 329 standard deviations.
    let ends = ["from", "to"].map(|end| number(&report, &format!("/critical/{end}")));
    assert!(
        (ends[0] - (1.0 - 0.2 * QUANTILE)).abs() < 1e-9 && (ends[1] - (1.0 + 0.2 * QUANTILE)).abs() < 1e-9,
        "{ends:?}"
    );
    let shown = in_one_line(&output(folder.path(), &critical));
    assert!(shown.contains("looked for from 0.2663 to 1.734 its quantiles of 0.012 % and 99.988 %"), "{shown}");
    let inputs = [("u", UNIFORM), ("x", "\"uniform\", lower = 0.5, upper = 1.5")];
    let folder = built_from(&oscillator(&inputs, 1.1, ""));
    let report = json(folder.path(), &critical);
    assert_eq!((number(&report, "/critical/from"), number(&report, "/critical/to")), (0.5, 1.5));
    assert!(!output(folder.path(), &critical).contains("looked for"));
}

/// −Φ⁻¹(1/8192), by SciPy.
const QUANTILE: f64 = 3.6683292851213234;

/// Of two oscillators the first has ω² = 100, the other ω² = x: below 100 or above, and at the mean of x before
/// truncation, where there is nothing of its law, zero.
#[test]
fn modes_are_numbered_at_medians() {
    let study = "format = 1\nname = \"crossing\"\n[model]\nkind = \"matrices\"\nM = [[1, 0], [0, 1]]\nC = [[0.2, 0], [0, \
                 0.5]]\nK = [[100, 0], [0, \"x\"]]\n[inputs]\nx = { distribution = \"normal\", mean = 0.0, std = 100.0, \
                 lower = 60.0, upper = 400.0 }\n[spectrum]\ntarget = \"invariants\"\n";
    let folder = built_from(study);
    let report = json(folder.path(), &["eval", "built.pcc", "-n", "1000"]);
    let modes = report["modes"].as_array().unwrap();
    // The median of x is above 100.
    let median = {
        let study = Study::from_toml(study).unwrap();
        study.inputs.physical(&study.inputs.middle())[0]
    };
    assert!((105.0..115.0).contains(&median), "{median}");
    let growth = |number: u64| {
        let mode = modes.iter().find(|mode| mode["mode"] == number).unwrap();
        mode["growth_rate"]["mean"].as_f64().unwrap()
    };
    assert!((growth(1) + 0.1).abs() < 1e-9 && (growth(2) + 0.25).abs() < 1e-9, "{modes:?}");
}

/// One in twenty thousand is overdamped, x > 20: there the model has one frequency, and the surrogate two.
#[test]
fn points_at_which_components_cannot_be_compared_are_counted() {
    let folder = built_from(
        "format = 1\nname = \"two\"\n[model]\nkind = \"matrices\"\nM = [[1, 0], [0, 1]]\nC = [[\"x\", 0], [0, 0.5]]\n\
         K = [[100, 0], [0, 400]]\n[inputs]\nx = { distribution = \"exponential\", mean = 2.0 }\n",
    );
    let arguments = ["compare", "built.pcc", "--study", "study.toml", "-n", "1e5"];
    let overdamped = 100_000 - json(folder.path(), &arguments)["matched_points"].as_u64().unwrap();
    let expected = 1e5 * (-10.0_f64).exp();
    assert!(overdamped > 0 && (overdamped as f64 - expected).abs() <= 4.5 * expected.sqrt(), "{overdamped}");
    let text = in_one_line(&output(folder.path(), &arguments));
    assert!(text.contains(&format!("compared; at the other {overdamped} the model has fewer")), "{text}");
}

/// Far out in the tail the oscillator is overdamped, at points that no run has: x − 1.1 > 10.
#[test]
fn tails_that_no_run_has_seen_may_diverge() {
    for (law, expected) in [
        ("\"exponential\", mean = 2.0", (-11.1_f64 / 2.0).exp()),
        ("\"weibull\", shape = 0.8, scale = 1.5", (-(11.1_f64 / 1.5).powf(0.8)).exp()),
        // erfc(√(11.1/4)), by Python.
        ("\"gamma\", shape = 0.5, scale = 4.0", 0.018480687),
    ] {
        let folder = built_from(&oscillator(&[("x", law)], 1.1, ""));
        let events = ["eval", "built.pcc", "-n", "400000", "--events", "divergence,frequency_1<0"];
        let report = json(folder.path(), &events);
        let found = [0, 1].map(|event| number(&report, &format!("/events/{event}/proportion")));
        let error = (expected / 4e5).sqrt();
        assert!((found[0] - expected).abs() <= 4.5 * error, "{law}: {found:?} for {expected}");
        assert_eq!(found[1], 0.0, "{law}");
    }
}
