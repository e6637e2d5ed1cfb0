//! Builds whose model somebody else runs: ask for the points, tell the answers, step by step.
//!
//! A build is stepped on what a journal knows of its runs. [`ask`] says which points it waits for; [`tell`] takes
//! answers to them from a table, and takes none if the build could not go on with them. Once nothing is missing,
//! [`crate::compilation::build`] with the journal makes the surrogate, with the bytes of a build that ran the model
//! itself.
//!
//! [`ask`] and [`tell`] exchange tables, which hold eigenvalues alone. A program that has the answers themselves, with
//! matrices and derivatives, exchanges them with [`ask_runs`] and [`tell_runs`].

use crate::campaign::journal::{Contents, Journal, JournalError, Record, RunOutcome};
use crate::campaign::{
    Campaign, DesignPoint, Ledger, MatchedAnswers, RowProblem, RunError, Runner, match_answers, match_runs,
};
use crate::compilation::{BuildError, build};
use crate::mechanics::model::ModelAnswer;
use crate::mechanics::model::command::results_table::ResultRow;
use crate::study::Study;
use pcc_evaluate::foundation::{Observer, is_interruption, plural};
use pcc_evaluate::surrogate::Surrogate;
use thiserror::Error;

/// Rows that are named when they cannot be taken.
const SHOWN_PROBLEMS: usize = 10;

/// Why a build cannot be stepped.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum AskError {
    /// The study fits derivatives, and tables of results hold eigenvalues alone.
    #[error(
        "fits derivatives, which tables of results do not hold; set fit.derivatives = false, or let pcc run the model"
    )]
    Derivatives,
    /// The answers there are cannot be right, or are not enough; or the user asked to stop.
    #[error(transparent)]
    Build(#[from] BuildError),
}

/// Why answers were not taken; then none was.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TellError {
    /// The build cannot be stepped.
    #[error(transparent)]
    Ask(#[from] AskError),
    /// Rows that belong nowhere, or contradict what is known.
    #[error("{} cannot be taken, so none was:\n{}", plural(.0.len(), "row"), shown(.0))]
    Rows(Vec<RowProblem>),
    /// With these answers the build would fail.
    #[error("with these answers the build cannot go on, so none was taken: {0}")]
    CannotGoOn(#[source] BuildError),
    /// The journal could not be written.
    #[error(transparent)]
    Journal(#[from] JournalError),
}

fn shown(problems: &[RowProblem]) -> String {
    let lines: Vec<String> = problems.iter().take(SHOWN_PROBLEMS).map(|problem| format!("  {problem}")).collect();
    let more = match problems.len().saturating_sub(SHOWN_PROBLEMS) {
        0 => String::new(),
        more => format!("\n  and {}", plural(more, "other row")),
    };
    lines.join("\n") + &more
}

/// How far a build has come.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Every point it asked for, in the order of the design.
    pub asked: Vec<DesignPoint>,
    /// Whether it needs no more.
    pub is_complete: bool,
}

impl Step {
    /// The points that wait for an answer, with their numbers from 1.
    pub fn open(&self) -> impl Iterator<Item = (u64, &[f64])> {
        (1..).zip(&self.asked).filter(|(_, asked)| !asked.is_known).map(|(run, asked)| (run, asked.point.as_slice()))
    }
}

/// What a table of results brought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Told {
    /// New answers.
    pub answered: usize,
    /// New failures.
    pub failed: usize,
    /// Rows that said what was known.
    pub repeated: usize,
    /// Points that the build waits for now.
    pub missing: usize,
    /// Whether it needs no more.
    pub is_complete: bool,
}

/// Whether the build of `study` can be stepped at all.
///
/// # Errors
///
/// [`AskError::Derivatives`].
pub fn check(study: &Study) -> Result<(), AskError> {
    // Those of given runs come with their table.
    match study.uses_derivatives() && study.model.has_derivatives() {
        true => Err(AskError::Derivatives),
        false => Ok(()),
    }
}

/// Steps the build of `study` as far as it goes on what `contents` has of its model. The model is not run.
///
/// # Errors
///
/// [`AskError`] if the build fits derivatives, or fails on these answers.
///
/// # Examples
///
/// ```
/// use pcc_compile::{ask_and_tell::ask, campaign::journal::Contents, study::Study};
/// use pcc_evaluate::foundation::Silent;
/// let study = Study::from_toml(include_str!("../../../surrogates/clutch-r2-eigenvalues.toml"))?;
/// let step = ask(&study, &Contents::default(), &Silent)?;
/// assert_eq!((step.open().count(), step.is_complete), (60, false));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn ask(study: &Study, contents: &Contents, observer: &dyn Observer) -> Result<Step, AskError> {
    check(study)?;
    ask_runs(study, contents, observer)
}

/// The same of a study whose answers are told by [`tell_runs`]: it may fit derivatives.
///
/// # Errors
///
/// [`AskError::Build`] if the build fails on these answers.
pub fn ask_runs(study: &Study, contents: &Contents, observer: &dyn Observer) -> Result<Step, AskError> {
    let (step, failure) = step(study, contents, observer);
    match failure {
        Some(error) => Err(error.into()),
        None => Ok(step),
    }
}

/// The surrogate that these answers make, once they are complete: the model is not run.
///
/// # Errors
///
/// [`BuildError`]; of a build that waits for more answers [`RunError::Unanswered`].
pub fn build_from_answers(
    study: &Study,
    contents: &Contents,
    observer: &dyn Observer,
) -> Result<Surrogate, BuildError> {
    let ledger = Ledger::blank(study).knowing(contents).asking();
    build(Campaign { study, ledger: Some(&ledger), counts_failures: false }, observer)
}

/// Takes `rows` of answers into `journal`, which has `contents`. With `replaces`, an answer that contradicts an earlier
/// one takes its place.
///
/// # Errors
///
/// [`TellError`]; the journal is then as it was.
pub fn tell(
    study: &Study,
    journal: &Journal,
    mut contents: Contents,
    rows: &[ResultRow],
    replaces: bool,
    observer: &dyn Observer,
) -> Result<Told, TellError> {
    check(study)?;
    let matched = |asked: &[DesignPoint], known: &Ledger| {
        match_answers(study, asked, |point| known.find(point).cloned(), rows, replaces).map_err(TellError::Rows)
    };
    take(study, Some(journal), &mut contents, matched, observer)
}

/// Takes answers of model runs into `contents`, and into `journal` if there is one: the system or the eigenvalues at
/// points that were asked for, or why there are none. Points are known by the bits of their inputs.
///
/// # Errors
///
/// [`TellError`]; `contents` and journal are then as they were.
pub fn tell_runs(
    study: &Study,
    journal: Option<&Journal>,
    contents: &mut Contents,
    answers: &[(Vec<f64>, Result<ModelAnswer, String>)],
    observer: &dyn Observer,
) -> Result<Told, TellError> {
    let runner = Runner::new(study).map_err(|error| AskError::Build(error.into()))?;
    let runner = runner.with_derivatives(study.uses_derivatives());
    let outcome = |answer: &Result<ModelAnswer, String>| {
        let found = answer.clone().and_then(|answer| runner.computation(answer).map_err(|cause| cause.to_string()));
        match found {
            Ok(computation) => RunOutcome::Answered(computation),
            Err(cause) => RunOutcome::Failed { attempts: 1, cause, by_circumstances: false },
        }
    };
    let matched = |asked: &[DesignPoint], known: &Ledger| {
        let runs = answers.iter().map(|(point, answer)| (point.clone(), outcome(answer)));
        match_runs(study, asked, |point| known.find(point).cloned(), runs).map_err(TellError::Rows)
    };
    take(study, journal, contents, matched, observer)
}

/// Takes what `matched` finds new for the points that the build has asked for.
fn take(
    study: &Study,
    journal: Option<&Journal>,
    contents: &mut Contents,
    matched: impl FnOnce(&[DesignPoint], &Ledger) -> Result<MatchedAnswers, TellError>,
    observer: &dyn Observer,
) -> Result<Told, TellError> {
    let taken = contents.records.len();
    let told = try_to_take(study, journal, contents, matched, observer);
    if told.is_err() {
        contents.records.truncate(taken);
    }
    told
}

fn try_to_take(
    study: &Study,
    journal: Option<&Journal>,
    contents: &mut Contents,
    matched: impl FnOnce(&[DesignPoint], &Ledger) -> Result<MatchedAnswers, TellError>,
    observer: &dyn Observer,
) -> Result<Told, TellError> {
    let known = Ledger::blank(study).knowing(contents);
    let (before, failure) = step(study, contents, observer);
    if let Some(error) = failure.as_ref().filter(|error| is_interruption(*error)) {
        return Err(AskError::Build(error.clone()).into());
    }
    let found = matched(&before.asked, &known)?;
    // What would end the build must not get into the journal, where it could not be taken back.
    contents.records.extend(found.records.iter().cloned());
    let (after, failure) = match before.is_complete && found.records.is_empty() {
        true => (before, None),
        false => step(study, contents, observer),
    };
    match failure {
        Some(error) if is_interruption(&error) => return Err(AskError::Build(error).into()),
        Some(error) => return Err(TellError::CannotGoOn(error)),
        None => {}
    }
    if let Some(journal) = journal {
        journal.append(&found.records.iter().collect::<Vec<&Record>>())?;
    }
    let failed = found.records.iter().filter(|record| matches!(record.outcome, RunOutcome::Failed { .. })).count();
    Ok(Told {
        answered: found.records.len() - failed,
        failed,
        repeated: found.repeated,
        missing: after.open().count(),
        is_complete: after.is_complete,
    })
}

/// The build as far as it goes, and what it failed with, other than a want of answers.
fn step(study: &Study, contents: &Contents, observer: &dyn Observer) -> (Step, Option<BuildError>) {
    let ledger = Ledger::blank(study).knowing(contents).asking();
    let built = build(Campaign { study, ledger: Some(&ledger), counts_failures: false }, observer);
    let step = Step { asked: ledger.asked(), is_complete: built.is_ok() };
    match built {
        Ok(_) | Err(BuildError::Run(RunError::Unanswered { .. })) => (step, None),
        Err(error) => (step, Some(error)),
    }
}
