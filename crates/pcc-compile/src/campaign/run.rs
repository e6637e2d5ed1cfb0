//! Direct computations at points of the input space, with errors that name the point.

mod given_answers;

use super::ledger::{Campaign, Ledger};
use super::rigid_body_motion::Structure;
use crate::campaign::journal::{JournalError, RunOutcome};
use crate::mechanics::model::{Concurrency, Linearization, Model, ModelAnswer, ModelError};
use crate::mechanics::spectrum::{Computation, Reductions, Slopes, Solution, Spectrum, SpectrumError};
use crate::numerics::accuracy::Accuracy;
use crate::study::Study;
use nalgebra::Complex;
use pcc_evaluate::foundation::{Interrupted, Observer, try_map, try_map_waiting};

use std::time::{Duration, Instant};
use thiserror::Error;

/// Why a direct computation gave no spectrum. `point` lists the inputs with their values.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RunError {
    /// The model failed.
    #[error("the model run at {point} failed: {cause}")]
    Model {
        /// Where.
        point: String,
        /// Why.
        #[source]
        cause: ModelError,
    },
    /// Its eigenvalues cannot be sorted into modes, or a mode of `spectrum.modes` is missing.
    #[error("{cause}; found at {point}")]
    Spectrum {
        /// Where.
        point: String,
        /// Why.
        #[source]
        cause: SpectrumError,
    },
    /// Two runs found different numbers of oscillating modes, so ranks do not name the same modes.
    #[error(
        "{first_count} modes oscillate at {first_point}, but {count} at {point}; modes cannot be numbered by frequency \
         over this input space: use spectrum.target = \"invariants\" with fit.method = \"auto\", or narrow the inputs"
    )]
    ModeCount {
        /// A first point.
        first_point: String,
        /// Number of oscillating modes there.
        first_count: usize,
        /// A second point.
        point: String,
        /// Number of oscillating modes there.
        count: usize,
    },
    /// Two runs have different numbers of eigenvalues, so that they cannot be followed.
    #[error(
        "the model has {first_count} eigenvalues at {first_point}, but {count} at {point}, conjugates counted; give all of them \
         at every point"
    )]
    EigenvalueCount {
        /// A first point.
        first_point: String,
        /// Number of eigenvalues there.
        first_count: usize,
        /// A second point.
        point: String,
        /// Number of eigenvalues there.
        count: usize,
    },
    /// Answers are missing, and the model is not to be run.
    #[error(
        "pcc does not run this model here, and {missing} points of the design are not answered yet: write them to a table \
         with pcc design STUDY --emit ROWS.csv, run them, and hand the answers over with pcc ingest STUDY RESULTS.csv"
    )]
    Unanswered {
        /// Number of points without an answer.
        missing: usize,
    },
    /// Runs could not be recorded.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The user asked to stop.
    #[error("{0}")]
    Interrupted(#[from] Interrupted),
}

/// One direct computation, seen as a study asks.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// All eigenvalues.
    pub spectrum: Spectrum,
    /// Eigenvalues of the study's modes by frequency rank; of a [`Runner`] that does not rank modes none.
    pub eigenvalues: Vec<Complex<f64>>,
    /// The system with its derivatives, if they were asked for.
    pub reductions: Option<Reductions>,
}

/// Runs the model of a study. Unless it is told otherwise, modes have frequency ranks, and it sees to it that all
/// points have the same number of them.
pub struct Runner<'a> {
    study: &'a Study,
    ledger: Option<&'a Ledger>,
    model: Box<dyn Model>,
    with_derivatives: bool,
    /// The same of runs that are given, whether the model has derivatives or not.
    wants_derivatives: bool,
    ranks_modes: bool,
    /// The first point, and how many modes oscillate there, or how many eigenvalues there are.
    first: Option<(Vec<f64>, usize)>,
    modes: Vec<usize>,
    structure: Structure,
}

/// What is kept of a run until all are there: its spectrum, and the reduced systems.
type RunSpectrum = (Spectrum, Option<Reductions>);

/// A run that counts: it answered, or it failed and is skipped, for this cause.
type Settled = Result<RunSpectrum, String>;

impl<'a> Runner<'a> {
    /// Sets up the model.
    ///
    /// # Errors
    ///
    /// [`ModelError`].
    pub fn new(campaign: impl Into<Campaign<'a>>) -> Result<Self, ModelError> {
        let campaign = campaign.into();
        Ok(Self::of(campaign, campaign.study.model()?))
    }

    /// Runs `model` in place of the study's.
    pub fn of(campaign: impl Into<Campaign<'a>>, model: Box<dyn Model>) -> Self {
        let Campaign { study, ledger, .. } = campaign.into();
        Self {
            study,
            ledger,
            model,
            with_derivatives: false,
            wants_derivatives: false,
            ranks_modes: true,
            first: None,
            modes: Vec::new(),
            structure: Structure::default(),
        }
    }

    /// Whether the model has derivatives.
    pub fn model_has_derivatives(&self) -> bool {
        self.model.has_derivatives()
    }

    /// Asks the model for derivatives, too, if it has them.
    #[must_use]
    pub fn with_derivatives(self, wanted: bool) -> Self {
        Self { with_derivatives: wanted && self.model.has_derivatives(), wants_derivatives: wanted, ..self }
    }

    /// Leaves it open which eigenvalue is which mode: any number of them may oscillate.
    #[must_use]
    pub fn without_ranks(self) -> Self {
        Self { ranks_modes: false, ..self }
    }

    /// Whether the model is undamped with symmetric matrices, so that λ² is real.
    pub fn is_self_adjoint(&self) -> bool {
        self.structure.is_self_adjoint(self.study, &*self.model)
    }

    /// Whether runs come with derivatives.
    pub fn has_derivatives(&self) -> bool {
        self.with_derivatives
    }

    /// Frequency ranks of the study's modes; empty before the first run.
    pub fn modes(&self) -> &[usize] {
        &self.modes
    }

    /// Direct computations at physical points, in parallel and in order. Those that the ledger knows are not run again.
    ///
    /// # Errors
    ///
    /// [`RunError`] names the first point that failed.
    pub fn run(&mut self, points: &[Vec<f64>], observer: &dyn Observer) -> Result<Vec<Run>, RunError> {
        let runs = self.run_or_recall(points, false, observer)?;
        // Nothing was skipped.
        Ok(runs.into_iter().flatten().collect())
    }

    /// The same, but with nothing in place of runs that failed, if the study says that they are to be skipped.
    ///
    /// # Errors
    ///
    /// As [`Runner::run`].
    pub fn run_skipping(&mut self, points: &[Vec<f64>], observer: &dyn Observer) -> Result<Vec<Option<Run>>, RunError> {
        self.run_or_recall(points, self.study.model.skips_failures(), observer)
    }

    /// The same, whatever the study says.
    ///
    /// # Errors
    ///
    /// As [`Runner::run`], but for points that failed.
    pub fn run_counting(&mut self, points: &[Vec<f64>], observer: &dyn Observer) -> Result<Vec<Option<Run>>, RunError> {
        self.run_or_recall(points, true, observer)
    }

    /// Runs the model, or recalls what the ledger knows of it.
    fn run_or_recall(
        &mut self,
        points: &[Vec<f64>],
        skips: bool,
        observer: &dyn Observer,
    ) -> Result<Vec<Option<Run>>, RunError> {
        let known = points.iter().map(|point| self.known(point, skips)).collect::<Result<Vec<_>, _>>()?;
        // Answers that others gave are wrong before the last one is there.
        for (point, known) in points.iter().zip(&known) {
            if let Some(Ok((spectrum, _))) = known {
                self.check_count(point, spectrum)?;
            }
        }
        let answers = self.fill_in(points, known, skips, observer)?;
        // Every point first: where their number changes, a missing mode is the lesser news.
        for (point, answer) in points.iter().zip(&answers) {
            if let Some((spectrum, _)) = answer {
                self.check_count(point, spectrum)?;
            }
        }
        let select = |(point, answer): (&Vec<f64>, Option<RunSpectrum>)| {
            answer.map(|(spectrum, reductions)| self.select(point, spectrum, reductions)).transpose()
        };
        points.iter().zip(answers).map(select).collect()
    }

    /// The answers that are known, and those of the model at the other points.
    fn fill_in(
        &self,
        points: &[Vec<f64>],
        known: Vec<Option<Settled>>,
        skips: bool,
        observer: &dyn Observer,
    ) -> Result<Vec<Option<RunSpectrum>>, RunError> {
        let missing: Vec<usize> = (0..points.len()).filter(|&i| known[i].is_none()).collect();
        if let Some(ledger) = self.ledger {
            ledger.note(points, |i| known[i].is_some());
            if !ledger.may_run() && !missing.is_empty() {
                return Err(RunError::Unanswered { missing: missing.len() });
            }
        }
        observer.advance((points.len() - missing.len()) as u64);
        let missing_points: Vec<&Vec<f64>> = missing.iter().map(|&i| &points[i]).collect();
        let found = self.run_missing(&missing_points, skips, observer);
        if let Some(ledger) = self.ledger {
            // Runs that ended before another failed count as well.
            ledger.sync()?;
        }
        let mut found = found?.into_iter();
        let settled = known.into_iter().zip(points).filter_map(|(known, point)| {
            let one = known.or_else(|| found.next())?;
            if let (Some(ledger), Err(cause)) = (self.ledger, &one) {
                ledger.note_failure(point, cause.clone());
            }
            Some(one.ok())
        });
        Ok(settled.collect())
    }

    /// What the ledger knows of a point, if that is enough: an answer, or a failure that may be left out.
    fn known(&self, point: &[f64], skips: bool) -> Result<Option<Settled>, RunError> {
        let Some(ledger) = self.ledger else { return Ok(None) };
        match ledger.find(point) {
            Some(RunOutcome::Answered(computation)) if self.suffices(computation) => {
                self.see(point, computation.clone()).map(|answer| Some(Ok(answer)))
            }
            Some(RunOutcome::Failed { cause, by_circumstances, .. }) if skips && ledger.may_skip(*by_circumstances) => {
                Ok(Some(Err(cause.clone())))
            }
            _ => Ok(None),
        }
    }

    /// Whether a recorded answer has the derivatives that are wanted, for the modes that are wanted.
    fn suffices(&self, computation: &Computation) -> bool {
        let has_them = |modes: Vec<usize>| computation.reductions.as_ref().is_some_and(|found| found.modes == modes);
        !self.with_derivatives || has_them(self.modes_of_interest(computation))
    }

    /// Frequency ranks of the modes that the study asks for, as far as they oscillate.
    fn modes_of_interest(&self, computation: &Computation) -> Vec<usize> {
        self.spectrum(&computation.eigenvalues, &computation.accuracies)
            .map_or(Vec::new(), |spectrum| self.study.spectrum.modes.of_interest(&spectrum))
    }

    fn spectrum(&self, eigenvalues: &[Complex<f64>], accuracies: &[Accuracy]) -> Result<Spectrum, SpectrumError> {
        let rigid_body_modes = self.structure.rigid_body_modes(eigenvalues, self.study, &*self.model)?;
        let settings = &self.study.spectrum;
        Spectrum::with_zeros(eigenvalues, accuracies, rigid_body_modes, settings.margin)?.with_noise(settings.noise)
    }

    /// The model at points that the ledger does not know.
    fn run_missing(
        &self,
        points: &[&Vec<f64>],
        skips: bool,
        observer: &dyn Observer,
    ) -> Result<Vec<Settled>, RunError> {
        let watch = || {
            if observer.interrupted() {
                self.model.interrupt();
            }
        };
        let run = |point: &Vec<f64>, records_at_once: bool| {
            observer.check()?;
            let start = Instant::now();
            let answer = self.model.run(point, self.with_derivatives);
            let result = answer.and_then(|answer| self.computation(answer));
            self.record(point, result, start.elapsed(), records_at_once, skips, observer)
        };
        match self.model.concurrency() {
            Concurrency::Threads => try_map(points.len(), |k| run(points[k], false)),
            Concurrency::Jobs(jobs) => try_map_waiting(jobs, points.len(), watch, |k| run(points[k], true)),
            Concurrency::Together if points.is_empty() => Ok(Vec::new()),
            Concurrency::Together => {
                let all = |_| self.run_in_one_call(points, skips, observer);
                try_map_waiting(1, 1, watch, all).map(|answers| answers.into_iter().flatten().collect())
            }
        }
    }

    /// The same for models that take all points together.
    fn run_in_one_call(
        &self,
        points: &[&Vec<f64>],
        skips: bool,
        observer: &dyn Observer,
    ) -> Result<Vec<Settled>, RunError> {
        observer.check()?;
        let start = Instant::now();
        let points: Vec<&[f64]> = points.iter().map(|point| point.as_slice()).collect();
        let results = self.model.eigenvalues_together(&points);
        let each = start.elapsed().div_f64(points.len() as f64);
        // All are recorded before the first failure ends the build.
        let settled: Vec<_> = results
            .into_iter()
            .zip(&points)
            .map(|(result, point)| {
                let computation = result.map(Computation::of_eigenvalues);
                self.record(point, computation, each, false, skips, observer)
            })
            .collect();
        settled.into_iter().collect()
    }

    /// Records how a run ended.
    fn record(
        &self,
        point: &[f64],
        result: Result<Computation, ModelError>,
        duration: Duration,
        at_once: bool,
        skips: bool,
        observer: &dyn Observer,
    ) -> Result<Settled, RunError> {
        let outcome = || match &result {
            Ok(computation) => RunOutcome::Answered(computation.clone()),
            Err(cause) => RunOutcome::Failed {
                attempts: cause.attempts(),
                cause: cause.to_string(),
                by_circumstances: cause.is_by_circumstances(),
            },
        };
        // A run that was stopped, or could not even be started, did not fail.
        let has_run = result.as_ref().err().is_none_or(|cause| cause.is_of_run());
        if result.is_err() && observer.interrupted() {
            return Err(Interrupted.into());
        }
        if let Some(ledger) = self.ledger.filter(|_| has_run) {
            ledger.record(point, outcome, duration, at_once)?;
        }
        observer.advance(1);
        match result {
            Ok(computation) => self.see(point, computation).map(Ok),
            Err(cause) if skips && has_run => Ok(Err(cause.to_string())),
            Err(cause) => Err(RunError::Model { point: self.study.inputs.describe(point), cause }),
        }
    }

    /// The answer as the study sees it.
    fn see(&self, point: &[f64], computation: Computation) -> Result<RunSpectrum, RunError> {
        let Computation { eigenvalues, accuracies, reductions } = computation;
        let spectrum = self
            .spectrum(&eigenvalues, &accuracies)
            .map_err(|cause| RunError::Spectrum { point: self.study.inputs.describe(point), cause })?;
        Ok((spectrum, reductions.filter(|_| self.with_derivatives)))
    }

    /// What follows from an answer: eigenvalues, and reduced systems if derivatives are wanted.
    pub(crate) fn computation(&self, answer: ModelAnswer) -> Result<Computation, ModelError> {
        let system = match answer {
            ModelAnswer::Eigenvalues(eigenvalues) => return Ok(Computation::of_eigenvalues(eigenvalues)),
            ModelAnswer::System(system) => *system,
        };
        let Linearization { state_matrix, derivatives, second_order, second_order_derivatives } = system;
        if self.with_derivatives {
            let expected = self.study.inputs.dimension();
            let found = derivatives.iter().filter(|derivative| derivative.shape() == state_matrix.shape()).count();
            if (found, derivatives.len()) != (expected, expected) {
                return Err(ModelError::Derivatives { found, expected });
            }
        }
        let mut solution = Solution::new(state_matrix, second_order)?;
        // What contradicts the study is told where the spectrum is asked for.
        let rigid = self.structure.rigid_body_modes(solution.eigenvalues(), self.study, &*self.model).unwrap_or(0);
        solution.look_closer(rigid);
        let (eigenvalues, accuracies) = (solution.eigenvalues().to_vec(), solution.accuracies().to_vec());
        let reduce = |spectrum: Spectrum| {
            let modes = self.study.spectrum.modes.of_interest(&spectrum);
            let slopes = Slopes { state_matrix: &derivatives, second_order: &second_order_derivatives };
            Reductions::new(&solution, slopes, &spectrum, modes)
        };
        let reductions = match self.with_derivatives {
            true => self.spectrum(&eigenvalues, &accuracies).ok().map(reduce),
            false => None,
        };
        Ok(Computation { eigenvalues, accuracies, reductions })
    }

    /// Modes with ranks must be as many at every point, and eigenvalues that are followed, too.
    fn check_count(&mut self, point: &[f64], spectrum: &Spectrum) -> Result<(), RunError> {
        let inputs = &self.study.inputs;
        let count = match self.ranks_modes {
            true => spectrum.count(),
            false => spectrum.eigenvalues().len() + spectrum.rigid_body_modes(),
        };
        let (first_point, first_count) = self.first.get_or_insert_with(|| (point.to_vec(), count));
        if *first_count == count {
            return Ok(());
        }
        let (first_point, first_count, point) = (inputs.describe(first_point), *first_count, inputs.describe(point));
        Err(match self.ranks_modes {
            true => RunError::ModeCount { first_point, first_count, point, count },
            false => RunError::EigenvalueCount { first_point, first_count, point, count },
        })
    }

    /// What the study asks of a spectrum.
    fn select(&mut self, point: &[f64], spectrum: Spectrum, reductions: Option<Reductions>) -> Result<Run, RunError> {
        if !self.ranks_modes {
            return Ok(Run { eigenvalues: Vec::new(), spectrum, reductions });
        }
        let Study { inputs, spectrum: settings, .. } = self.study;
        let unusable = |cause| RunError::Spectrum { point: inputs.describe(point), cause };
        self.modes = settings.modes.ranks(spectrum.count()).map_err(unusable)?;
        let eigenvalues = self.modes.iter().map(|&mode| spectrum.mode(mode)).collect::<Result<_, _>>();
        Ok(Run { eigenvalues: eigenvalues.map_err(unusable)?, spectrum, reductions })
    }
}
