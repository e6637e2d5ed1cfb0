//! Why a build gave no surrogate.

use crate::campaign::RunError;
use crate::mechanics::model::ModelError;
use crate::mechanics::spectrum::ClusterError;
use pcc_evaluate::foundation::Interrupted;
use pcc_evaluate::polynomials::IndexSetError;
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
    /// A list of modes has some of a group, but not all.
    #[error(
        "spectrum.modes = {listed:?} splits a group: modes {group:?} are known well only together; use modes = {smallest:?}"
    )]
    SplitGroup {
        /// The list.
        listed: Vec<usize>,
        /// Numbers of the modes of the group.
        group: Vec<usize>,
        /// The smallest list that has all of its groups.
        smallest: Vec<usize>,
    },
    /// A band of frequencies without modes.
    #[error("spectrum.frequencies: no mode is there in the middle of the inputs; there are modes at {}", listed(.frequencies))]
    EmptyBand {
        /// Those of all modes there, in Hz.
        frequencies: Vec<f64>,
    },
    /// An eigenvalue grows beyond all bounds inside the ranges of the inputs.
    #[error(
        "an eigenvalue goes to infinity, or nearly so, inside the ranges of the inputs, near {point}, as where a mass or a time constant vanishes: it \
         has no expansion there; narrow the ranges so that this point lies outside"
    )]
    Infinite {
        /// Where: the inputs with their values.
        point: String,
    },
    /// The study asks for derivatives, which the model does not have.
    #[error("fit.derivatives: the model has no derivatives; remove the key or set it to \"auto\" or false")]
    NoDerivatives,
    /// The study skips runs that fail, but there are too many of them.
    #[error("{}", too_many_failures(*.failed, *.runs, .point, .cause))]
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
    /// Fewer runs were given, or are left, than a fit takes.
    #[error("a fit takes at least {least} model runs, and here are {runs}; give more, or hold fewer out")]
    TooFewRuns {
        /// Runs that there are.
        runs: usize,
        /// Runs that it takes.
        least: usize,
    },
    /// There are too many candidate terms.
    #[error(transparent)]
    IndexSet(#[from] IndexSetError),
    /// The user asked to stop.
    #[error("{0}")]
    Interrupted(#[from] Interrupted),
}

/// What failed in all runs is rather the set-up, so its cause comes first.
fn too_many_failures(failed: usize, runs: usize, point: &str, cause: &str) -> String {
    match failed == runs {
        true => format!("all of {runs} model runs failed: {cause}; the first at {point}"),
        false => format!("{failed} of {runs} model runs failed, more than half; the first at {point}: {cause}"),
    }
}

/// The first of many frequencies, and the last.
fn listed(frequencies: &[f64]) -> String {
    const MOST_NAMED: usize = 8;
    let text = |frequency: &f64| format!("{frequency:.4}");
    let named: Vec<String> = frequencies.iter().take(MOST_NAMED).map(text).collect();
    match frequencies.last().filter(|_| frequencies.len() > MOST_NAMED) {
        Some(last) => format!("{}, … up to {} Hz", named.join(", "), text(last)),
        None => format!("{} Hz", named.join(", ")),
    }
}
