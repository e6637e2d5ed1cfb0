//! Models that are functions of the program that reads the study, and builds whose runs that program makes.

use num_complex::Complex;
use pcc::{
    AskError, BuildError, Contents, Linearization, Model, ModelAnswer, ModelError, RunError, Silent, Study, Surrogate,
    TellError, ask, ask_runs, build, build_from_answers, compare_with_model, tell_runs,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

const REST: &str = "
[inputs]
mu = { distribution = \"uniform\", lower = 0.0, upper = 0.5 }
k_p = { distribution = \"uniform\", lower = 15.2e6, upper = 16.8e6 }
[spectrum]
target = \"invariants\"
";

fn study(model: &str) -> Study {
    Study::from_toml(&format!("format = 1\nname = \"same\"\n[model]\n{model}{REST}")).unwrap()
}

/// The clutch, built in.
fn clutch() -> Study {
    study("kind = \"clutch\"")
}

/// The same in the words of a function.
fn announced(answers: &str) -> Study {
    study(&format!("kind = \"function\"\nanswers = \"{answers}\""))
}

/// The clutch as a function that answers matrices, or eigenvalues alone, and counts how often it is called.
struct Clutch {
    study: Study,
    answers_matrices: bool,
    calls: Arc<AtomicUsize>,
}

impl Model for Clutch {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        self.run(point, false)?.eigenvalues()
    }

    fn system(&self, point: &[f64]) -> Result<Option<Linearization>, ModelError> {
        if self.answers_matrices { self.study.model()?.system(point) } else { Ok(None) }
    }

    fn run(&self, point: &[f64], with_derivatives: bool) -> Result<ModelAnswer, ModelError> {
        self.calls.fetch_add(1, Ordering::SeqCst);
        let model = self.study.model()?;
        match self.answers_matrices {
            true => model.run(point, with_derivatives),
            false => model.eigenvalues(point).map(ModelAnswer::Eigenvalues),
        }
    }
}

fn given(answers: &str) -> (Study, Arc<AtomicUsize>) {
    let calls = Arc::new(AtomicUsize::new(0));
    let function = Clutch { study: clutch(), answers_matrices: answers == "matrices", calls: calls.clone() };
    (announced(answers).with_function(Arc::new(function)).unwrap(), calls)
}

fn runs(surrogate: &Surrogate) -> u64 {
    surrogate.training.counts.direct_computations
}

/// The surrogate of answers that are told step by step, and the number of steps.
fn stepped(study: &Study) -> (Surrogate, usize) {
    let (mut contents, model) = (Contents::default(), study.model().unwrap());
    for steps in 0.. {
        let step = ask_runs(study, &contents, &Silent).unwrap();
        let run = |(_, point): (u64, &[f64])| {
            let answer = model.run(point, study.uses_derivatives()).map_err(|error| error.to_string());
            (point.to_vec(), answer)
        };
        let answers: Vec<_> = step.open().map(run).collect();
        if answers.is_empty() {
            return (build_from_answers(study, &contents, &Silent).unwrap(), steps);
        }
        tell_runs(study, None, &mut contents, &answers, &Silent).unwrap();
    }
    unreachable!()
}

#[test]
fn functions_of_matrices_build_what_the_same_model_builds() {
    let (function, calls) = given("matrices");
    assert!(function.uses_derivatives());
    let (built, of_clutch) = (build(&function, &Silent).unwrap(), build(&clutch(), &Silent).unwrap());
    assert_eq!((&built.expansions, runs(&built)), (&of_clutch.expansions, runs(&of_clutch)));
    // Another run of the function than those of the design would be one too many.
    assert_eq!(calls.load(Ordering::SeqCst) as u64, runs(&built));
    let comparison = compare_with_model(&built, &function, 200, 1, &Silent).unwrap();
    assert!(comparison.misclassified_percent() < 1.0);
}

#[test]
fn functions_of_eigenvalues_are_called_once_a_run() {
    let (function, calls) = given("eigenvalues");
    assert!(!function.uses_derivatives() && function.model.is_external());
    let built = build(&function, &Silent).unwrap();
    assert_eq!(calls.load(Ordering::SeqCst) as u64, runs(&built));
}

#[test]
fn told_answers_make_the_bytes_of_a_direct_build() {
    for answers in ["matrices", "eigenvalues"] {
        let (function, _) = given(answers);
        let direct = build(&function, &Silent).unwrap();
        let (told, steps) = stepped(&function);
        assert!(told == direct && steps > 1, "{answers}, {steps} steps");
    }
}

#[test]
fn answers_that_cannot_be_taken_change_nothing() {
    let (function, _) = given("matrices");
    let mut contents = Contents::default();
    let eigenvalues = |count| Ok(ModelAnswer::Eigenvalues(vec![Complex::new(-1.0, 5.0); count]));
    let error = tell_runs(&function, None, &mut contents, &[(vec![0.1, 16e6], eigenvalues(2))], &Silent).unwrap_err();
    assert!(matches!(&error, TellError::Rows(problems) if problems.len() == 1), "{error}");
    assert_eq!(contents, Contents::default());
    let error = build_from_answers(&function, &contents, &Silent).unwrap_err();
    assert!(matches!(error, BuildError::Run(RunError::Unanswered { .. })), "{error}");
    // Tables have no place for derivatives.
    assert!(matches!(ask(&function, &contents, &Silent), Err(AskError::Derivatives)));
}

#[test]
fn a_function_is_announced_by_the_study_and_given_by_the_program() {
    let alone = announced("matrices");
    assert_eq!(Study::from_toml(&alone.to_toml()).unwrap(), alone);
    let error = build(&alone, &Silent).unwrap_err();
    assert!(error.to_string().contains("functions of the program that reads the study"), "{error}");
    let function = Clutch { study: clutch(), answers_matrices: true, calls: Arc::default() };
    let error = clutch().with_function(Arc::new(function)).unwrap_err();
    assert!(matches!(error, ModelError::NotFunction { kind: "clutch" }), "{error}");
    // What is given is no part of the question, what it answers is.
    assert_eq!(given("matrices").0.problem_hash(), alone.problem_hash());
    assert_ne!(announced("eigenvalues").problem_hash(), alone.problem_hash());
    let error = Study::from_toml(&alone.to_toml().replace("= \"matrices\"", "= \"modes\"")).unwrap_err().to_string();
    assert!(error.contains("\"modes\" is not known; choose \"matrices\" or \"eigenvalues\""), "{error}");
}
