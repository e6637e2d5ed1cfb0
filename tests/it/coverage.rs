//! Models that do not answer everywhere: what is not known reaches the file and every answer.

use num_complex::Complex;
use pcc::report::{EvalReport, FitReport, SweepReport};
use pcc_compile::compilation::build_with;
use pcc_compile::mechanics::model::{Model, ModelError};
use pcc_compile::study::Study;
use pcc_evaluate::artifact::{Format, decode, encode};
use pcc_evaluate::evaluation::{Condition, Question, Sweep};
use pcc_evaluate::foundation::{InstructionSet, Silent};
use pcc_evaluate::session::Session;
use pcc_evaluate::surrogate::Surrogate;

/// λ = a − 0.6 + 0.1 b + (50 + b) i, and nothing for a > 0.8: 60 % are stable for certain, up to 80 % may be.
struct Failing;

impl Model for Failing {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        let &[a, b] = point else { unreachable!("two inputs") };
        if a > 0.8 { Err(ModelError::NotRun) } else { Ok(vec![Complex::new(a - 0.6 + 0.1 * b, 50.0 + b)]) }
    }
}

/// Programs that may fail, with two inputs.
pub(crate) const STUDY: &str = r#"
    format = 1
    name = "failing"
    [model]
    kind = "command"
    command = ["none"]
    eigenvalues = 1
    on_failure = "skip"
    [inputs]
    a = { distribution = "uniform", lower = 0.0, upper = 1.0 }
    b = { distribution = "uniform", lower = -1.0, upper = 1.0 }
"#;

/// The surrogate of that model.
pub(crate) fn built(seed: u64) -> Surrogate {
    let study = Study { seed, ..Study::from_toml(STUDY).unwrap() };
    build_with(&study, Box::new(Failing), &Silent).unwrap()
}

fn report(surrogate: &Surrogate, conditions: Vec<Condition>) -> EvalReport {
    let question = Question { conditions, ..Question::plain(200_000, 1) };
    let session = Session::new(surrogate, &question, None, InstructionSet::best()).unwrap();
    EvalReport::of_surrogate(&session.run(&Silent).unwrap()).unwrap()
}

#[test]
fn bounds_hold_whatever_the_model_would_have_answered() {
    for seed in 1..=5 {
        let report = report(&built(seed), Vec::new());
        let (unanswered, bounds) = (report.unanswered_proportion.unwrap(), report.bounds.unwrap());
        assert!((unanswered - 0.2).abs() < 0.05, "{unanswered}, seed {seed}");
        let (stable, unstable) = (bounds.stable, bounds.unstable);
        assert!(stable.lower <= 0.5999 && stable.upper >= 0.7999, "{stable:?}, seed {seed}");
        assert!(unstable.lower <= 0.2001 && unstable.upper >= 0.4001, "{unstable:?}, seed {seed}");
        // They say something, too.
        assert!(stable.lower > 0.5 && stable.upper < 0.95, "{stable:?}, seed {seed}");
    }
}

#[test]
fn every_face_says_where_there_was_no_answer() {
    let surrogate = built(1);
    let warnings = FitReport::warnings_of(&surrogate).join("\n");
    assert!(warnings.contains("did not answer in 7 of 36 runs of the design, all at a 0.8"), "{warnings}");
    let report = report(&surrogate, Vec::new());
    assert!(report.to_string().contains("unanswered") && report.warnings.join("").contains("did not answer"));
    let json = serde_json::to_value(&report).unwrap();
    assert!(json["bounds"]["stable"]["upper"].is_f64() && json["unanswered_proportion"].is_f64());
}

#[test]
fn a_part_of_the_domain_that_answered_is_known() {
    let inside = Condition { input: "a".to_owned(), lower: 0.0, upper: 0.4 };
    let report = report(&built(1), vec![inside]);
    assert_eq!(report.unanswered_proportion, Some(0.0));
    assert!(report.bounds.unwrap().stable.lower > 0.99);
}

#[test]
fn it_survives_in_both_forms_and_stays_outside_the_content_id() {
    let surrogate = built(1);
    let bytes = encode(&surrogate, Format::Binary).unwrap();
    let found = decode(&bytes).unwrap();
    assert!(found.surrogate == surrogate && found.version == (1, 3));
    assert_eq!(decode(&encode(&surrogate, Format::Json).unwrap()).unwrap().surrogate, surrogate);
    let without = Surrogate { coverage: None, ..surrogate.clone() };
    assert_eq!(decode(&encode(&without, Format::Binary).unwrap()).unwrap().content_id, found.content_id);
    let mut outside = surrogate;
    outside.coverage.as_mut().unwrap().unanswered[0][0] = 1.5;
    assert!(decode(&encode(&outside, Format::Binary).unwrap()).unwrap_err().to_string().contains("coverage"));
}

/// At a = 0.9 the model never answers, at a = 0.1 always.
#[test]
fn points_of_a_sweep_know_where_nothing_is_known() {
    let surrogate = built(1);
    let sweep = Sweep { input: "a".to_owned(), from: 0.1, to: 0.9, points: 2 };
    let question = Question { sweeps: vec![sweep], ..Question::plain(10_000, 1) };
    let session = Session::new(&surrogate, &question, None, InstructionSet::best()).unwrap();
    let report = SweepReport::new(&session.run(&Silent).unwrap());
    let [known, unknown] = &report.points[..] else { panic!("two points") };
    assert!(known.unanswered_proportion == Some(0.0) && known.bounds.unwrap().stable.lower > 0.99);
    let bounds = unknown.bounds.unwrap().stable;
    assert!(unknown.unanswered_proportion == Some(1.0) && bounds.lower < 0.01 && bounds.upper > 0.99, "{bounds:?}");
    assert!(report.to_string().contains("whatever it would answer"), "{report}");
}
