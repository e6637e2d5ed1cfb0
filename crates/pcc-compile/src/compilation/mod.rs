//! The build: design → model runs → components → one expansion each → surrogate, until the stopping rule holds.

mod components;
mod decision;
mod elements;
mod evaluations;
mod record;
mod to_file;

pub use to_file::{BuildFileError, BuiltFile, build_to_file};

use components::ComponentFit;
use decision::{Previous, judge};
use evaluations::Evaluations;

use crate::campaign::{Campaign, Ledger, RunError};
use crate::fitting::fit::Stop;
use crate::fitting::regression::Response;
use crate::mechanics::model::{Model, ModelError};
use crate::mechanics::spectrum::ClusterError;
use pcc_evaluate::components::Output;
use pcc_evaluate::foundation::{Interrupted, Observer};
use pcc_evaluate::polynomials::IndexSetError;
use pcc_evaluate::surrogate::Surrogate;
use thiserror::Error;

/// Why a build gave no surrogate.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BuildError {
    /// The model could not be set up.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A model run failed; it is not replaced by a guess.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Modes could not be grouped.
    #[error("spectrum.modes: {cause}; found at {point}")]
    Clusters {
        /// Where: the inputs with their values.
        point: String,
        /// Why.
        #[source]
        cause: ClusterError,
    },
    /// The study asks for derivatives, which the model does not have.
    #[error("fit.derivatives: the model has no derivatives; remove the key or set it to \"auto\" or false")]
    NoDerivatives,
    /// The study skips runs that fail, but there are too many of them.
    #[error("{failed} of {runs} model runs failed, more than half; the first at {point}: {cause}")]
    TooManyFailures {
        /// Runs that failed.
        failed: usize,
        /// All runs.
        runs: usize,
        /// Where the first failed: the inputs with their values.
        point: String,
        /// Why it did.
        cause: String,
    },
    /// There are too many candidate terms.
    #[error(transparent)]
    IndexSet(#[from] IndexSetError),
    /// The user asked to stop.
    #[error("{0}")]
    Interrupted(#[from] Interrupted),
}

/// Builds the surrogate of a study, or of a campaign that keeps books of its runs, on the current rayon thread pool: the same bits
/// for any number of threads.
///
/// Methods by quadrature run the model at the nodes of their rules, element by element. For the others, derivatives enter the
/// fit beside the values if the study wants them and the model has them. All components share one nested design. Level by level
/// it grows by one step until every component is fitted well enough and, if the study asks for it, the estimated error of the
/// stability proportion is small enough, or has not fallen while the design grew by four levels to twice its size. Modes are
/// grouped anew at each level; no model run is repeated or dropped.
///
/// # Errors
///
/// [`BuildError`] names the point at which a model run failed, or the study's setting that asks for too much.
///
/// # Examples
///
/// ```
/// use pcc_compile::compilation::build;
/// use pcc_compile::study::Study;
/// use pcc_evaluate::foundation::Silent;
/// let study = Study::from_toml(include_str!("../../../../surrogates/clutch-r1-eigenvalues.toml"))?;
/// let surrogate = build(&study, &Silent)?;
/// assert_eq!(surrogate.modes(), [3, 4]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn build<'a>(campaign: impl Into<Campaign<'a>>, observer: &dyn Observer) -> Result<Surrogate, BuildError> {
    let campaign = campaign.into();
    build_with(campaign, campaign.study.model()?, observer)
}

/// The build with a model of your own in place of the study's, whose inputs it takes. The hashes in the surrogate are still
/// those of the study: `compare` and `certify` would run the study's model.
///
/// # Errors
///
/// As [`build`].
pub fn build_with<'a>(
    campaign: impl Into<Campaign<'a>>,
    model: Box<dyn Model>,
    observer: &dyn Observer,
) -> Result<Surrogate, BuildError> {
    let Campaign { study, ledger } = campaign.into();
    let blank = Ledger::blank(study);
    let campaign = Campaign { study, ledger: Some(ledger.unwrap_or(&blank)) };
    if study.fit.method.is_quadrature() {
        return elements::build(campaign, model, observer);
    }
    let mut fit = ComponentFit::new(study)?;
    let mut evaluations = Evaluations::new(campaign, model)?;
    let mut levels = Vec::new();
    let mut grouping: Vec<Output> = Vec::new();
    let mut previous: Option<Previous> = None;
    let mut progress = Progress { lowest: f64::INFINITY, at_size: study.design.initial, levels_since: 0 };
    let mut size = study.design.initial;
    loop {
        levels.push(size as u64);
        evaluations.grow_to(size, observer)?;
        check_failures(campaign, &evaluations)?;
        let outputs = evaluations.outputs()?;
        if groups(&outputs) != groups(&grouping) {
            // Other components: what was learnt of the previous ones does not apply.
            fit.forget(&outputs);
            previous = None;
        }
        let next = study.design.next_size(size).filter(|_| !study.fit.method.has_fixed_design());
        let values = evaluations.components(&outputs)?;
        let gradients = evaluations.gradients(&outputs);
        let resolutions = evaluations.resolutions(&outputs);
        let responses: Vec<Response<'_>> = (0..values.len())
            .map(|id| {
                let gradients = gradients.as_ref().map(|all| &all[id]).filter(|one| !one.points.is_empty());
                Response { gradients, ..Response::of(&values[id], resolutions[id]) }
            })
            .collect();
        let fitted = fit.fit(&evaluations.samples(), &responses, next.is_some(), observer)?;
        grouping.clone_from(&outputs);
        if let (Some(next), None) = (next, &fitted) {
            size = next;
            continue;
        }
        let fitted = fitted.unwrap_or_default();
        let needs_no_points = fitted.iter().all(|fit| fit.result.stop != Stop::DesignExhausted);
        let mut surrogate = record::surrogate(study, &evaluations, outputs, &fitted, gradients.as_deref(), &levels);
        let results: Vec<_> = fitted.into_iter().map(|fit| fit.result).collect();
        let tolerance = study.fit.proportion_tolerance;
        let is_last = next.is_none() || (needs_no_points && tolerance.is_none());
        let judgement = judge(&surrogate, &results, &values, evaluations.runs(), previous, is_last, observer)?;
        (surrogate.decision, previous) = (judgement.decision, judgement.previous);
        progress.note(judgement.reducible_error, size);
        let is_small = |tolerance| judgement.reducible_error.is_some_and(|error| error <= tolerance);
        let is_decided = tolerance.is_none_or(is_small) || progress.has_stalled(size);
        match next {
            Some(next) if !(needs_no_points && is_decided) => size = next,
            _ => {
                surrogate.self_test = surrogate.make_self_test(record::self_test_points(study));
                return Ok(surrogate);
            }
        }
    }
}

/// Whether enough runs answered: those that failed leave holes in the design, and more than half of it is no design.
fn check_failures(campaign: Campaign<'_>, evaluations: &Evaluations<'_>) -> Result<(), BuildError> {
    let (failed, answered) = (evaluations.failed(), evaluations.runs().len());
    if failed <= answered && answered >= LEAST_RUNS {
        return Ok(());
    }
    let first = campaign.ledger.and_then(|ledger| ledger.failures().into_iter().next());
    let (point, cause) =
        first.map_or_else(Default::default, |failure| (campaign.study.inputs.describe(&failure.point), failure.cause));
    Err(BuildError::TooManyFailures { failed, runs: failed + answered, point, cause })
}

/// Fewer runs say nothing of how a component varies.
const LEAST_RUNS: usize = 2;

/// Levels without a lower estimate, and growth of the design over them, after which more runs are taken to be of no use:
/// where stability is within rounding of its limit everywhere, or where the model jumps.
const PATIENCE: usize = 4;
const GROWTH: usize = 2;

/// Whether the estimated error of the proportion still falls.
struct Progress {
    lowest: f64,
    /// Size of the design at the lowest estimate.
    at_size: usize,
    levels_since: usize,
}

impl Progress {
    fn note(&mut self, error: Option<f64>, size: usize) {
        match error {
            Some(error) if error < self.lowest => {
                (self.lowest, self.at_size, self.levels_since) = (error, size, 0);
            }
            Some(_) => self.levels_since += 1,
            // Too few blind residuals yet: nothing is known to have stalled.
            None => {}
        }
    }

    fn has_stalled(&self, size: usize) -> bool {
        self.levels_since >= PATIENCE && size >= GROWTH * self.at_size
    }
}

/// The modes of each output.
fn groups(outputs: &[Output]) -> Vec<&[usize]> {
    outputs.iter().map(|output| output.modes.as_slice()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::model::{Clutch, Linearization};
    use crate::study::Study;
    use nalgebra::{Complex, DMatrix};
    use pcc_evaluate::foundation::Silent;

    const STUDY: &str = include_str!("../../../../surrogates/clutch-r1.toml");

    fn study(fit: &str) -> Study {
        Study::from_toml(&format!("{STUDY}\n[design]\ninitial = 8\nstep = 8\nmaximum = 16\n[fit]\n{fit}")).unwrap()
    }

    /// The clutch without its derivatives.
    struct EigenvaluesAlone(Clutch);

    impl Model for EigenvaluesAlone {
        fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
            self.0.eigenvalues(point)
        }
    }

    #[test]
    fn models_that_know_only_their_eigenvalues_are_fitted_by_values() {
        let model = || Box::new(EigenvaluesAlone(Clutch::new(&[], &["mu"]).unwrap()));
        let found = build_with(&study(""), model(), &Silent).unwrap();
        let by_values = build(&study("derivatives = false\nproportion_tolerance = 2e-4"), &Silent).unwrap();
        assert_eq!((&found.expansions, found.training.counts), (&by_values.expansions, by_values.training.counts));
        assert_eq!(found.training.counts.gradients, 0);
        assert_eq!(build_with(&study("derivatives = true"), model(), &Silent), Err(BuildError::NoDerivatives));
    }

    /// The clutch with one derivative too few.
    struct Forgetful(Clutch);

    impl Model for Forgetful {
        fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
            self.0.eigenvalues(point)
        }

        fn has_derivatives(&self) -> bool {
            true
        }

        fn linearization(&self, point: &[f64]) -> Result<Option<Linearization>, ModelError> {
            let complete = self.0.linearization(point)?;
            Ok(complete.map(|complete| Linearization { derivatives: Vec::new(), ..complete }))
        }
    }

    #[test]
    fn missing_derivatives_are_an_error() {
        let model = Box::new(Forgetful(Clutch::new(&[], &["mu"]).unwrap()));
        let error = build_with(&study(""), model, &Silent).unwrap_err();
        let cause = ModelError::Derivatives { found: 0, expected: 1 };
        assert!(matches!(error, BuildError::Run(RunError::Model { cause: found, .. }) if found == cause));
    }

    /// Two oscillators that are always close, but never by much less than elsewhere, so they form no group. From the middle
    /// of the input on one drives the other, and their eigenvectors almost coincide.
    struct Twins;

    impl Model for Twins {
        fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
            let linearization = self.linearization(point)?.expect("it has derivatives");
            Ok(crate::numerics::eigenvalues::eigenvalues(linearization.state_matrix)?)
        }

        fn has_derivatives(&self) -> bool {
            true
        }

        fn linearization(&self, point: &[f64]) -> Result<Option<Linearization>, ModelError> {
            let (mu, coupling) = (point[0], if point[0] > 0.25 { 1.0 } else { 0.0 });
            let mut state_matrix = DMatrix::zeros(4, 4);
            state_matrix.view_mut((0, 2), (2, 2)).fill_with_identity();
            (state_matrix[(2, 0)], state_matrix[(2, 1)]) = (-100.0 - mu, coupling);
            state_matrix[(3, 1)] = -100.0 - mu - 1e-4;
            let mut derivative = DMatrix::zeros(4, 4);
            (derivative[(2, 0)], derivative[(3, 1)]) = (-1.0, -1.0);
            Ok(Some(Linearization { state_matrix, derivatives: vec![derivative] }))
        }
    }

    #[test]
    fn runs_whose_modes_cannot_be_separated_enter_with_their_values_alone() {
        let surrogate = build_with(&study("s2_target = 0.9"), Box::new(Twins), &Silent).unwrap();
        let counts = surrogate.training.counts;
        assert_eq!((counts.values, counts.gradients), (16, 8));
    }
}
