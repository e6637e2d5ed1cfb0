//! Models by matrices of the user's: against the built-in clutch, against LAPACK, by their derivatives, and by what
//! they refuse.

use crate::support::{built, csv_rows, invariants_study, repository, text};
use nalgebra::Complex;
use pcc_compile::compilation::build;
use pcc_compile::mechanics::model::Model;
use pcc_compile::mechanics::spectrum::Spectrum;
use pcc_compile::reference::compare_with_model;
use pcc_compile::study::Study;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::probability::inputs::random_points;
use pcc_evaluate::probability::random::Purpose;
use std::fs;
use std::path::Path;

/// The shipped study of this name.
fn study(name: &str) -> Study {
    Study::from_toml_in(&text(&format!("surrogates/{name}.toml")), &repository("surrogates")).unwrap()
}

/// The largest distance of an eigenvalue of `found` to its partner in `expected`.
fn distance(mut found: Vec<Complex<f64>>, expected: &[Complex<f64>]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let nearest = |found: &[Complex<f64>], to: Complex<f64>| {
        (0..found.len()).min_by(|&i, &k| (found[i] - to).norm().total_cmp(&(found[k] - to).norm())).unwrap()
    };
    expected
        .iter()
        .map(|&expected| {
            let at = nearest(&found, expected);
            (found.swap_remove(at) - expected).norm()
        })
        .fold(0.0, f64::max)
}

/// What `expected` says of the state matrix must hold to this share of its largest entry.
const SAME_MATRIX: f64 = 1e-14;

#[test]
fn the_clutch_as_matrices_is_the_built_in_one() {
    let (written, built_in) = (study("clutch-matrices"), invariants_study(8));
    assert_eq!(written.inputs, built_in.inputs);
    let mut largest_error = 0f64;
    let (model, clutch) = (written.model().unwrap(), built_in.model().unwrap());
    for point in random_points(&written.inputs, 3, Purpose::Evaluation, 0..200) {
        let point = written.inputs.physical(&point);
        let (found, expected) =
            (model.linearization(&point).unwrap().unwrap(), clutch.linearization(&point).unwrap().unwrap());
        let scale = expected.state_matrix.amax();
        assert!((found.state_matrix - &expected.state_matrix).amax() <= SAME_MATRIX * scale);
        for (found, expected) in found.derivatives.iter().zip(&expected.derivatives) {
            assert!((found - expected).amax() <= SAME_MATRIX * expected.amax());
        }

        // All but the fourfold zero of the rigid motions.
        let modes = |model: &dyn Model| Spectrum::new(&model.eigenvalues(&point).unwrap()).unwrap();
        let (found, expected) = (modes(&*model), modes(&*clutch));
        let error = distance(found.oscillating().to_vec(), expected.oscillating()) / expected.largest();
        largest_error = largest_error.max(error);
        assert!(error <= 1e-12, "{error:e}");
    }
    println!("largest difference of an eigenvalue: {largest_error:.1e} of the largest");
}

/// Names of the other shipped studies by matrices.
const SYSTEMS: [&str; 5] = ["mode-coupling", "three-modes", "flutter", "rotor", "block"];

#[test]
fn eigenvalues_are_those_of_lapack() {
    /// Both solvers are good to some 1e-13 of the largest eigenvalue, which is up to 60 times the modes compared.
    const TOLERANCE: f64 = 1e-11;
    for name in SYSTEMS {
        let (study, rows) = (study(name), csv_rows(&format!("tests/data/models/eigenvalues_{name}.csv")));
        let (model, inputs) = (study.model().unwrap(), study.inputs.dimension());
        assert_eq!(rows.len(), 20);
        for row in rows {
            let (point, parts) = row.split_at(inputs);
            let expected: Vec<_> = parts.chunks_exact(2).map(|pair| Complex::new(pair[0], pair[1])).collect();
            let spectrum = Spectrum::new(&model.eigenvalues(point).unwrap()).unwrap();
            assert_eq!(spectrum.count(), if name == "block" { 200 } else { expected.len() });
            let found = spectrum.oscillating()[..expected.len()].to_vec();
            let error = distance(found, &expected) / expected.iter().map(|lambda| lambda.norm()).fold(0.0, f64::max);
            assert!(error <= TOLERANCE, "{name}: {error:e}");
        }
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    for name in SYSTEMS {
        let study = study(name);
        let model = study.model().unwrap();
        for point in random_points(&study.inputs, 1, Purpose::Evaluation, 0..3) {
            let point = study.inputs.physical(&point);
            let found = model.linearization(&point).unwrap().unwrap();
            for (j, derivative) in found.derivatives.iter().enumerate() {
                let step = 1e-4 * point[j];
                let at = |offset: f64| {
                    let mut moved = point.clone();
                    moved[j] += offset;
                    model.linearization(&moved).unwrap().unwrap().state_matrix
                };
                let difference = (at(step) - at(-step)) / (2.0 * step);
                let error = (derivative - &difference).amax() / difference.amax();
                assert!(error < 1e-7, "{name}, input {j}: {error:e}");
            }
        }
    }
}

/// All defaults, at most 100 runs, the proportion of the model on the same 10⁵ points to 0.1 %.
#[test]
fn proportions_are_those_of_the_model() {
    for name in &SYSTEMS[..4] {
        let surrogate = built(name);
        let runs = surrogate.training.counts.direct_computations;
        let error =
            compare_with_model(surrogate, &study(name), 100_000, 1, &Silent).unwrap().relative_error_percent().unwrap();
        println!("{name}: {runs} runs, {error:.4} % off");
        assert!(runs <= 100 && error <= 0.1, "{name}: {runs} runs, {error} %");
    }
}

/// What a study of two inputs with this model says.
fn refusal(model: &str) -> String {
    let inputs = "a = { distribution = \"uniform\", lower = 1.0, upper = 2.0 }\nb = { distribution = \"uniform\", lower = 1.0, upper = 2.0 }";
    let toml = format!("format = 1\nname = \"x\"\n[model]\nkind = \"matrices\"\n{model}\n[inputs]\n{inputs}\n");
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("wide.mtx"), "%%MatrixMarket matrix array real general\n2 3\n1\n2\n3\n4\n5\n6\n")
        .unwrap();
    fs::write(folder.path().join("bad.mtx"), "%%MatrixMarket matrix coordinate real general\n2 2 1\n3 1 1.0\n")
        .unwrap();
    Study::from_toml_in(&toml, folder.path()).unwrap_err().to_string()
}

#[test]
fn wrong_matrices_are_named_by_row_column_and_text() {
    let second_row = |entry: &str| format!("M = {{ diagonal = [1, 1] }}\nK = [[\"a\", 0], [{entry}, \"b\"]]");
    let with_k = |matrix: &str| format!("M = {{ diagonal = [1, 1] }}\nK = {matrix}");
    let cases = [
        second_row("\"2*q\""),
        second_row("\"2*(a\""),
        second_row("\"2 a\""),
        second_row("\"a**2\""),
        second_row("\"log(a)\""),
        second_row("\"\""),
        second_row("\"1/0\""),
        second_row("nan"),
        second_row("true"),
        with_k("[[\"a\", 0], [0, \"b\"], [0, 0]]"),
        with_k("[[\"a\", 0], [\"b\"]]"),
        with_k("[]"),
        with_k("3"),
        with_k("\"K.mtx\""),
        with_k("{ file = \"missing.mtx\" }"),
        with_k("{ file = \"wide.mtx\" }"),
        with_k("{ file = \"bad.mtx\" }"),
        with_k("{ file = 7 }"),
        with_k("{ entries = [[1, 1, \"a\"]] }"),
        with_k("{ size = 2, entries = [[1, 3, \"a\"]] }"),
        with_k("{ size = 2, entries = [[0, 1, \"a\"]] }"),
        with_k("{ size = 2, entries = [[1, 2, \"a\"], [1, 2, \"b\"]] }"),
        with_k("{ size = 2, form = \"symmetric\", entries = [[1, 2, \"a\"], [2, 1, \"b\"]] }"),
        with_k("{ size = 3, entries = [[1, 2, \"a\"]] }"),
        with_k("{ form = \"symmetric\", rows = [[\"a\", 0], [0, \"b\"]] }"),
        with_k("{ form = \"skew-symmetric\", rows = [[\"a\"], [\"b\", 0]] }"),
        with_k("{ form = \"hermitian\", rows = [[\"a\"], [\"b\", 0]] }"),
        with_k("{ form = \"symmetric\", diagonal = [\"a\", \"b\"] }"),
        with_k("{ rows = [[\"a\"]], diagonal = [\"a\"] }"),
        with_k("{ diagonal = [\"a\", \"b\"], colour = \"red\" }"),
        with_k("{ factor = \"a\" }"),
        with_k("{ diagonal = [1, 1], factor = \"a*\" }"),
        with_k("{ diagonal = [1, 1], factor = \"a/0\" }"),
        with_k("[{ diagonal = [\"a\", \"b\"] }, [1, 2]]"),
        "M = [[1]]".to_owned(),
        "K = [[\"a*b\"]]".to_owned(),
        "A = [[\"a\"]]\nM = [[\"b\"]]".to_owned(),
        "M = [[1, 1], [1, 1]]\nK = [[\"a\", 0], [0, \"b\"]]".to_owned(),
        "M = [[1, 0], [0, 1]]\nK = [[\"a\", 0], [0, 1]]".to_owned(),
        "M = [[1]]\nK = [[\"a*b*c\"]]\n[model.let]\nc = \"2*d\"".to_owned(),
        "M = [[1]]\nK = [[\"a*b*a_2\"]]\n[model.let]\na_2 = \"a^2\"\na = \"1\"".to_owned(),
        "M = [[1]]\nK = [[\"a*b\"]]\n[model.constants]\nsin = 1.0".to_owned(),
        "M = [[1]]\nK = [[\"a*b\"]]\n[model.constants]\na = 1.0".to_owned(),
        "M = [[1]]\nK = [[\"a*b\"]]\n[model.constants]\n\"; rm -rf\" = 1.0".to_owned(),
        "M = [[1]]\nK = [[\"a*b\"]]\n[model.constants]\nm = inf".to_owned(),
        "M = [[1]]\nK = [[\"a*b\"]]\ncommand = [\"sh\"]".to_owned(),
        "M = [[1]]\nK = [[\"a*b\"]]\nmass = 1".to_owned(),
    ];
    let said: Vec<String> =
        cases.iter().map(|model| format!("{}\n    {}", model.replace('\n', " | "), refusal(model))).collect();
    insta::assert_snapshot!(said.join("\n"));
}

#[test]
fn entries_that_stop_being_numbers_are_named_at_the_run() {
    let study = Study::from_toml(
        r#"
        format = 1
        name = "x"
        [model]
        kind = "matrices"
        M = [["m"]]
        C = { diagonal = ["0.1"], factor = "1/(k - 2)" }
        K = [["sqrt(k - 1)"]]
        [inputs]
        m = { distribution = "uniform", lower = -1.0, upper = 1.0 }
        k = { distribution = "uniform", lower = 0.0, upper = 4.0 }
        "#,
    )
    .unwrap();
    let model = study.model().unwrap();
    let said = |point: &[f64]| model.eigenvalues(point).unwrap_err().to_string();
    assert_eq!(said(&[1.0, 0.5]), "K, row 1, column 1: sqrt(k - 1) is NaN; entries must be finite numbers");
    assert_eq!(said(&[1.0, 2.0]), "C, factor of term 1: 1/(k - 2) is inf; factors must be finite numbers");
    assert_eq!(said(&[0.0, 3.0]), "the mass matrix is singular");
    assert!(model.eigenvalues(&[1.0, 3.0]).is_ok());
    // A value, but no slope.
    assert!(model.eigenvalues(&[1.0, 1.0]).is_ok());
    let slope = model.linearization(&[1.0, 1.0]).unwrap_err().to_string();
    assert!(slope.starts_with("K, row 1, column 1: the derivative of sqrt(k - 1) by k is inf; keep"), "{slope}");
    // And a build says where.
    let error = build(&study, &Silent).unwrap_err().to_string();
    assert!(error.starts_with("the model run at m = ") && error.contains(" failed: "), "{error}");
}

/// Every way to write a matrix, against rows.
#[test]
fn all_forms_write_the_same_matrices() {
    let folder = repository("tests/data/matrix_market");
    let eigenvalues = |model: &str| {
        let toml = format!(
            "format = 1\nname = \"x\"\n[model]\nkind = \"matrices\"\n{model}\n[inputs]\n\
             a = {{ distribution = \"uniform\", lower = 1.0, upper = 2.0 }}\n"
        );
        let study = Study::from_toml_in(&toml, Path::new(&folder)).unwrap_or_else(|error| panic!("{model}: {error}"));
        // Printed and read again it is the same study.
        assert_eq!(Study::from_toml_in(&study.to_toml(), Path::new(&folder)).unwrap(), study, "{}", study.to_toml());
        let found = study.model().unwrap().linearization(&[1.5]).unwrap().unwrap();
        (found.state_matrix, found.derivatives)
    };
    let rows = eigenvalues(
        "M = [[2, 0], [0, 4]]\nC = [[0.1, 3], [-3, 0.2]]\nK = [[\"10*a\", \"-a - a^2\"], [\"a^2 - a\", 40]]",
    );
    let sparse = eigenvalues(
        "M = { size = 2, entries = [[2, 2, 4], [1, 1, \"2\"]] }\nC = { diagonal = [0.1, 0.2] }\n\
         G = { size = 2, form = \"skew-symmetric\", entries = [[1, 2, 3]] }\n\
         K = { form = \"symmetric\", rows = [[\"10*a\"], [\"-a\", 40]] }\n\
         N = { form = \"skew-symmetric\", rows = [[0], [\"a\", 0]], factor = \"a\" }",
    );
    assert_eq!(rows, sparse);
    let terms = eigenvalues(
        "M = { rows = [[1, 0], [0, 2]], factor = 2 }\nC = [{ diagonal = [0.1, 0] }, { diagonal = [0, \"b/5\"] }]\n\
         G = [[0, 3], [-3, 0]]\n\
         K = [{ rows = [[10, -1], [-1, 0]], factor = \"a\" }, { diagonal = [0, 40] }]\n\
         N = { rows = [[0, -1], [1, 0]], factor = \"a_squared\" }\n\
         [model.constants]\nb = 1.0\n[model.let]\na_squared = \"a*a\"",
    );
    assert_eq!(rows, terms);
    let first_order = eigenvalues(
        "A = [[0, 0, 1, 0], [0, 0, 0, 1], [\"-10*a/2\", \"(a + a^2)/2\", -0.05, -1.5], [\"-(a^2 - a)/4\", -10, 0.75, -0.05]]",
    );
    assert_eq!(rows, first_order);
}
