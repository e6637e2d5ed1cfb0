//! Which eigenvalue of the model is which of a surrogate's, at one point.

use crate::mechanics::spectrum::{Spectrum, Target, nearest};
use nalgebra::Complex;
use pcc_evaluate::components::{Label, OutputKind};
use pcc_evaluate::surrogate::Surrogate;

/// What of a surrogate says how its eigenvalues are found among those of the model.
pub(super) struct Matching {
    target: Target,
    labels: Vec<Label>,
    /// Whether some eigenvalues can be real; else one of each conjugate pair is looked for.
    has_reals: bool,
}

impl Matching {
    pub fn new(surrogate: &Surrogate, target: Target) -> Self {
        Self { target, labels: surrogate.labels(), has_reals: surrogate.has_real_eigenvalues() }
    }

    /// The model's eigenvalue for each of the surrogate's; `None` if the model has too few.
    ///
    /// For the target `eigenvalues` modes have frequency ranks. Else numbers are the surrogate's, and what is nearest
    /// to its prediction is taken, so that the sum of all distances is least.
    pub fn find(&self, predicted: &[Complex<f64>], spectrum: &Spectrum) -> Option<Vec<Complex<f64>>> {
        if self.target == Target::Eigenvalues && !self.has_reals {
            return self.labels.iter().map(|label| spectrum.mode(label.mode()?).ok()).collect();
        }
        let among = if self.has_reals { spectrum.eigenvalues() } else { spectrum.oscillating() };
        if among.len() < predicted.len() {
            return None;
        }
        Some(nearest(predicted, among).into_iter().map(|j| among[j]).collect())
    }
}

/// The eigenvalues of every output, with their kind, from those of all labels.
pub(super) fn by_output<'a>(
    surrogate: &'a Surrogate,
    lambdas: &'a [Complex<f64>],
) -> impl Iterator<Item = (OutputKind, &'a [Complex<f64>])> {
    let mut first = 0;
    surrogate.outputs.iter().map(move |output| {
        let own = first..first + output.eigenvalue_count();
        first = own.end;
        (output.kind, &lambdas[own])
    })
}
