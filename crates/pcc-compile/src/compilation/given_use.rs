//! What became of the runs that a build was given, and what they say of the surrogate.

use super::BuildError;
use super::evaluations::Evaluations;
use super::given::GivenLevels;
use super::uncovered::{Uncovered, uncovered};
use super::validation::{Validation, validate};
use crate::study::Study;
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::surrogate::Surrogate;

/// What became of the runs that a build was given.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenUse {
    /// The tables.
    pub files: Vec<String>,
    /// Points that they have.
    pub points: u64,
    /// Runs that entered the fit.
    pub fitted: u64,
    /// Runs that failed.
    pub failed: u64,
    /// Runs that were held out.
    pub held_out: u64,
    /// What runs say that no fit has seen: those that were held out, and those that were too many for a fit.
    pub validation: Option<Validation>,
    /// Where no run is, if there are no others than those that were given.
    pub uncovered: Option<Uncovered>,
    /// Rows that said what others say, too.
    pub repetitions: u64,
    /// The first few of them.
    pub repeated: Vec<String>,
    /// Columns that mean nothing.
    pub ignored: Vec<String>,
}

impl GivenUse {
    /// Looks at the runs that were given once everything is fitted.
    ///
    /// # Errors
    ///
    /// [`BuildError`] if runs that no fit has seen cannot be answers of the same model.
    pub(super) fn of(
        given: &GivenLevels<'_>,
        evaluations: &mut Evaluations<'_>,
        surrogate: &Surrogate,
        study: &Study,
    ) -> Result<Self, BuildError> {
        let data = given.data();
        let (points, runs) = evaluations.outside(&given.validating().collect::<Vec<_>>())?;
        // Quick work: nobody stops it.
        let validation = validate(surrogate, &points, &runs, &Silent)?;
        let samples = evaluations.samples();
        let is_alone = evaluations.sizes().design == 0;
        let uncovered = is_alone.then(|| uncovered(&study.inputs, study.seed, &samples, &Silent)).transpose()?;
        let failed = data.runs.runs.iter().filter(|run| run.answer.is_err()).count();
        Ok(Self {
            files: data.files.clone(),
            points: data.runs.runs.len() as u64,
            fitted: (data.runs.runs.len() - failed - runs.len()) as u64,
            failed: failed as u64,
            held_out: given.held_out() as u64,
            validation,
            uncovered,
            repetitions: data.runs.repetitions as u64,
            repeated: data.runs.repeated.clone(),
            ignored: data.runs.ignored.clone(),
        })
    }
}
