//! Sessions: refusals before any sample, interruptions that keep what there is, parts that say what the whole does.

use super::{Evaluation, Request, Session, SessionError};
use crate::artifact::decode;
use crate::evaluation::{Condition, EvalError, Sampler, Sweep};
use crate::foundation::{InstructionSet, Observer, Silent, is_interruption};
use crate::shard_file::{PartError, merge};
use crate::surrogate::Surrogate;
use std::sync::atomic::{AtomicU64, Ordering};

fn surrogate() -> Surrogate {
    decode(include_bytes!("../../../../surrogates/clutch-r2.pcc")).unwrap().surrogate
}

fn refusal(request: &Request) -> SessionError {
    let surrogate = surrogate();
    let question = match request.question(&surrogate) {
        Ok(question) => question,
        Err(error) => return error,
    };
    Session::new(&surrogate, &question, request.critical.as_deref(), InstructionSet::best()).unwrap_err()
}

/// Stops after so many steps of work.
struct After(AtomicU64);

impl Observer for After {
    fn begin(&self, _: &str, _: u64) {}
    fn advance(&self, steps: u64) {
        let left = self.0.load(Ordering::SeqCst);
        self.0.store(left.saturating_sub(steps), Ordering::SeqCst);
    }
    fn finish(&self) {}
    fn interrupted(&self) -> bool {
        self.0.load(Ordering::SeqCst) == 0
    }
}

fn ask<R>(request: &Request, observer: &dyn Observer, look: impl FnOnce(Result<Evaluation<'_>, EvalError>) -> R) -> R {
    let surrogate = surrogate();
    let question = request.question(&surrogate).unwrap();
    let critical = request.critical.as_deref();
    let session = Session::new(&surrogate, &question, critical, InstructionSet::best()).unwrap();
    look(session.run(observer))
}

#[test]
fn what_does_not_fit_is_refused_before_the_first_sample() {
    let critical = |name: &str| Request { critical: Some(name.to_owned()), ..Request::plain(1000, 1) };
    let unknown = refusal(&critical("colour"));
    assert!(matches!(&unknown, SessionError::NoSuchInput { known, .. } if known == &["mu", "k_p"]), "{unknown}");
    let fixed = Condition { input: "mu".to_owned(), lower: 0.1, upper: 0.1 };
    let confined = refusal(&Request { conditions: vec![fixed], ..critical("mu") });
    assert!(matches!(&confined, SessionError::ConfinedInput { input } if input == "mu"), "{confined}");
    let sobol = refusal(&Request { sampler: Sampler::Sobol, samples: 1024, ..critical("mu") });
    assert!(matches!(sobol, SessionError::CriticalSampler), "{sobol}");
    let sweep = Sweep { input: "mu".to_owned(), from: 0.0, to: 0.5, points: 3 };
    let along = refusal(&Request { sweeps: vec![sweep], ..critical("k_p") });
    assert!(matches!(along, SessionError::CriticalOfSweep), "{along}");
    assert!(matches!(refusal(&Request::plain(0, 1)), SessionError::Survey(_)));
}

#[test]
fn an_answer_has_all_that_was_asked_for() {
    let request = Request { critical: Some("mu".to_owned()), ..Request::plain(2000, 1) };
    ask(&request, &Silent, |found| {
        let found = found.unwrap();
        assert!(found.is_complete && found.sensitivities.is_some());
        assert_eq!(found.critical.as_ref().map(|(input, _)| *input), Some(0));
    });
    let sweep = Sweep { input: "mu".to_owned(), from: 0.0, to: 0.5, points: 3 };
    ask(&Request { sweeps: vec![sweep], ..Request::plain(2000, 1) }, &Silent, |found| {
        let found = found.unwrap();
        assert_eq!((found.answer.cells.len(), found.sensitivities), (3, None));
    });
}

#[test]
fn an_interruption_keeps_what_there_is_and_says_so() {
    let samples = 200_000;
    let request = Request { critical: Some("mu".to_owned()), ..Request::plain(samples, 1) };
    ask(&request, &After(AtomicU64::new(0)), |found| assert!(is_interruption(&found.unwrap_err())));
    ask(&request, &After(AtomicU64::new(samples / 2)), |found| {
        let found = found.unwrap();
        assert!(!found.is_complete && found.sensitivities.is_none() && found.critical.is_none());
        assert!(found.answer.cells[0].total.summary.samples() < samples);
    });
    ask(&request, &After(AtomicU64::new(samples)), |found| {
        let found = found.unwrap();
        assert!(found.answer.is_complete && !found.is_complete, "samples are there, the rest is not");
    });
}

#[test]
fn parts_say_what_one_evaluation_says() {
    let (surrogate, request) = (surrogate(), Request::plain(100_000, 3));
    let question = request.question(&surrogate).unwrap();
    let session = Session::new(&surrogate, &question, None, InstructionSet::best()).unwrap();
    let whole = session.run(&Silent).unwrap();
    let parts: Vec<_> =
        (0..3).map(|shard| (shard.to_string(), session.run_shard(shard, 3, &Silent).unwrap())).collect();
    let merged = merge(parts.clone()).unwrap();
    let found = Evaluation::of_parts(&merged, 3, &Silent).unwrap();
    assert_eq!((&found.answer, &found.sensitivities), (&whole.answer, &whole.sensitivities));
    assert_eq!(found.merged_parts, Some(3));
    assert!(matches!(session.run_shard(3, 3, &Silent), Err(SessionError::NoSuchShard { number: 3, of: 3 })));
    let without_the_last = merge(parts[..2].to_vec()).unwrap();
    let error = Evaluation::of_parts(&without_the_last, 2, &Silent).unwrap_err();
    assert!(matches!(error, SessionError::Part(PartError::Gap { .. })), "{error}");
}
