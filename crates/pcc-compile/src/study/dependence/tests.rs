//! Correlations of studies: what they mean, how they are kept, and which are refused.

use crate::study::{Study, StudyError};

/// Inputs with laws of four kinds.
fn study(dependence: &str) -> Result<Study, StudyError> {
    Study::from_toml(&format!(
        "format = 1\nname = \"s\"\n[model]\nkind = \"matrices\"\nM = [[1]]\nC = [[\"0 - a - b - c - d\"]]\nK = \
         [[100]]\n[inputs]\na = {{ distribution = \"normal\", mean = 1.0, std = 0.1 }}\nb = {{ distribution = \
         \"lognormal\", mean = 1.0, std = 1.0 }}\nc = {{ distribution = \"uniform\", lower = 0.0, upper = 1.0 }}\nd = \
         {{ distribution = \"lognormal\", mean = 2.0, std = 2.0 }}\n{dependence}"
    ))
}

fn copula(lines: &str) -> String {
    format!("[dependence]\nkind = \"gaussian-copula\"\n{lines}\n")
}

fn refusal(dependence: &str) -> String {
    study(dependence).unwrap_err().to_string()
}

fn scores(lines: &str) -> Vec<(usize, usize, f64)> {
    let study = study(&copula(lines)).unwrap();
    let correlations = study.inputs.dependence().unwrap().correlations();
    correlations.iter().map(|pair| (pair.first, pair.second, pair.value)).collect()
}

#[test]
fn correlations_of_ranks_and_of_values_are_those_of_normal_scores() {
    let by_rank = scores("spearman = [[\"c\", \"a\", 0.6], [\"b\", \"d\", -0.5]]");
    assert_eq!(by_rank.iter().map(|pair| (pair.0, pair.1)).collect::<Vec<_>>(), [(0, 2), (1, 3)]);
    // 2 sin(0.1 π) is the golden ratio less 1; 2 sin(−π/12) = (1 − √3)/√2.
    assert!((by_rank[0].2 - 0.618_033_988_749_894_9).abs() < 1e-15);
    assert!((by_rank[1].2 - (1.0 - 3f64.sqrt()) / 2f64.sqrt()).abs() < 1e-15);
    let by_value = scores("pearson = [[\"a\", \"c\", 0.6], [\"b\", \"d\", 0.5]]");
    assert!((by_value[0].2 - 0.6 * (std::f64::consts::PI / 3.0).sqrt()).abs() < 1e-13);
    // Both have σ² = ln 2: ρ = ln(1 + 0.5 (e^σ² − 1))/σ².
    assert!((by_value[1].2 - 1.5f64.ln() / 2f64.ln()).abs() < 1e-13);
}

#[test]
fn dependence_is_printed_and_hashed_as_it_is_given() {
    let plain = study("").unwrap();
    let first = study(&copula("spearman = [[\"a\", \"b\", 0.3], [\"d\", \"c\", -0.123456789]]")).unwrap();
    let again = Study::from_toml(&first.to_toml()).unwrap();
    assert_eq!(again, first, "{}", first.to_toml());
    assert!(first.to_toml().contains("spearman = [[\"a\", \"b\", 0.3], [\"c\", \"d\", -0.123456789]]"));
    assert_eq!((again.problem_hash(), again.study_hash()), (first.problem_hash(), first.study_hash()));
    assert_eq!(first.model_hash(), plain.model_hash(), "runs stay what they are");
    let turned = study(&copula("spearman = [[\"c\", \"d\", -0.123456789], [\"b\", \"a\", 0.3]]")).unwrap();
    assert_eq!((turned.problem_hash(), &turned), (first.problem_hash(), &first));
    let others = [
        "",
        &copula("spearman = [[\"a\", \"b\", 0.3], [\"d\", \"c\", -0.1234]]"),
        &copula("spearman = [[\"a\", \"b\", 0.3], [\"d\", \"a\", -0.123456789]]"),
        &copula("pearson = [[\"a\", \"b\", 0.3], [\"d\", \"c\", -0.123456789]]"),
    ];
    for other in others {
        let other = study(other).unwrap();
        assert!(other.problem_hash() != first.problem_hash() && !other.inputs.is_same_as(&first.inputs));
    }
    for independent in ["spearman = []", "pearson = [[\"a\", \"b\", 0.0]]"] {
        let independent = study(&copula(independent)).unwrap();
        assert_eq!((independent.problem_hash(), &independent), (plain.problem_hash(), &plain));
    }
}

#[test]
fn what_is_no_dependence_is_refused_with_key_and_line() {
    for (lines, expected) in [
        ("", "line 13: dependence: give one list of correlations"),
        ("spearman = []\npearson = []", "line 13: dependence: give one list"),
        (
            "spearman = [[\"a\", \"x\", 0.5]]",
            "line 15: dependence.spearman: there is no input x; the study has a, b, c or d",
        ),
        (
            "pearson = [[\"a\", \"b\", 0.5],\n[\"b\", \"b\", 0.5]]",
            "line 16: dependence.pearson: b is correlated with itself",
        ),
        ("spearman = [[\"a\", \"b\", 0.5], [\"b\", \"a\", 0.5]]", "correlation of b and a is given twice"),
        ("spearman = [[\"a\", \"b\", 1.0]]", "correlation of a and b is 1.0, but must be above -1 and below 1"),
        ("spearman = [[\"a\", \"b\", -2]]", "is -2.0, but must be above -1"),
        ("spearman = [[\"a\", \"b\", nan]]", "is NaN, but must be above -1"),
        ("spearman = [[\"a\", \"b\", inf]]", "is inf, but must be above -1"),
        ("pearson = [[\"b\", \"d\", -0.6]]", "it can only be between -0.5000 and 1.0000"),
        ("pearson = [[\"a\", \"b\", 0.9]]", "it can only be between -0.8326 and 0.8326"),
        ("spearman = [[\"a\", \"b\"]]", "two inputs and their correlation, like [\"k\", \"c\", 0.6]"),
        ("spearman = [[\"a\", \"b\", 0.5, 1]]", "two inputs and their correlation, like [\"k\", \"c\", 0.6]"),
        ("pearson = [[\"a\", \"b\", 0.5],\n[\"b\", \"c\", 0.5, \"d\", 0.5]]", "line 16, column"),
        ("spearman = [[\"a\", \"b\", 0.5, []]]", "invalid length 4"),
        ("spearman = [[]]", "invalid length 0"),
        ("spearman = [\"a\", \"b\", 0.5]", "expected two inputs and their correlation"),
        ("spearman = [[\"a\", 0.5]]", "expected a text in quotes"),
        ("spearman = [[\"a\", \"b\", \"0.5\"]]", "expected a number"),
        ("spearman = \"a\"", "expected a list"),
        ("kendall = [[\"a\", \"b\", 0.5]]", "unknown key `kendall`"),
        ("spearman = [[\"a\", \"b\", 0.99999999999999]]", "cannot hold together"),
        ("spearman = [[\"a\", \"b\", 0.9999999999999]]", "matrix is 9.1e-14, but must be at least 1e-10. The nearest"),
        ("pearson = [[\"b\", \"d\", 0.999999999999]]", "e-13, but must be at least 1e-10"),
    ] {
        let message = refusal(&copula(lines));
        assert!(message.contains(expected), "{lines}: {message}");
    }
    assert!(refusal("[dependence]\nkind = \"vine\"\nspearman = []").contains("choose \"gaussian-copula\""));
    assert!(refusal("[dependence]\nspearman = []").contains("missing key `kind`; add it"));
}

/// 0.7, 0.7 and −0.6 contradict each other; what is proposed can be pasted.
#[test]
fn contradictions_are_refused_with_the_nearest_that_can_hold() {
    for measure in ["spearman", "pearson"] {
        let lines = format!("{measure} = [[\"a\", \"c\", 0.7], [\"c\", \"b\", 0.7], [\"a\", \"b\", -0.6]]");
        let message = refusal(&copula(&lines));
        let expected = format!("line 15: dependence.{measure}: these correlations cannot hold together: the smallest");
        assert!(message.contains(&expected) && message.contains("is -"), "{message}");
        let (_, proposed) = message.split_once("The nearest that can: ").unwrap();
        let found = study(&copula(proposed)).unwrap_or_else(|error| panic!("{proposed}: {error}"));
        let pairs = found.dependence.unwrap().pairs;
        let near = [(0, 1, -0.6), (0, 2, 0.7), (1, 2, 0.7)];
        for (found, given) in pairs.iter().zip(near) {
            assert!((found.0, found.1) == (given.0, given.1) && (found.2 - given.2).abs() < 0.6, "{pairs:?}");
            assert!(found.2.abs() < given.2.abs(), "{pairs:?}");
        }
    }
}

#[test]
fn quadrature_is_refused() {
    let dependence = copula("spearman = [[\"a\", \"b\", 0.5]]");
    for fit in ["method = \"gpc\"\nmax_degree = 3\nsolver = \"quadrature\"", "method = \"me-gpc\"\nmax_degree = 2"] {
        let message = refusal(&format!("{dependence}[fit]\n{fit}\n"));
        assert!(message.contains("line 13: dependence: fit.method") && message.contains("independent"), "{message}");
    }
    let regression = format!("{dependence}[fit]\nmethod = \"gpc\"\nmax_degree = 3\nsolver = \"least-squares\"\n");
    assert!(study(&regression).is_ok());
}

#[test]
fn inputs_of_single_values_are_correlated_with_none() {
    for measure in ["spearman", "pearson"] {
        let study = Study::from_toml(&format!(
            "format = 1\nname = \"s\"\n[model]\nkind = \"matrices\"\nM = [[1]]\nK = [[\"a * b\"]]\n[inputs]\n\
             a = {{ distribution = \"discrete\", values = [1.0, 2.0] }}\n\
             b = {{ distribution = \"normal\", mean = 9.0, std = 0.1 }}\n{}",
            copula(&format!("{measure} = [[\"b\", \"a\", 0.3]]"))
        ));
        let message = study.unwrap_err().to_string();
        assert!(message.contains("a takes single values, which have no such correlation"), "{message}");
    }
}
