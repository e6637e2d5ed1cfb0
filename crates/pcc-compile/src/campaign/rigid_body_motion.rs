//! Which eigenvalues are rigid-body motion: those that are zero at every point, by the structure of the model.
//!
//! Their computed copies scatter about zero, and a slow mode beside a fast one may lie as low, so size alone does not
//! tell. Where the model has matrices, their null spaces do ([`zero_eigenvalues`]). Models that know only their
//! eigenvalues are taken at their word: what is negligible at every point is zero.

use super::run::Run;
use crate::mechanics::model::{Linearization, Model};
use crate::mechanics::spectrum::{Spectrum, SpectrumError, free_motion};
use crate::numerics::zero_eigenvalues::zero_eigenvalues;
use crate::study::Study;
use nalgebra::Complex;
use pcc_evaluate::probability::inputs::random_point;
use pcc_evaluate::probability::random::Purpose;
use std::sync::OnceLock;

/// Takes as many eigenvalues for rigid-body motion as are negligible in every run, at most `known` from earlier ones: a
/// slow eigenvalue is negligible only where it passes zero. Returns their number.
pub fn agree_on_rigid_body_motion(runs: &mut [Run], known: usize) -> usize {
    let count = runs.iter().map(|run| run.spectrum.rigid_body_modes()).min().unwrap_or(0).min(known);
    for run in runs.iter_mut().filter(|run| run.spectrum.rigid_body_modes() != count) {
        // Fewer are dropped than before, so some remain.
        if let Ok(spectrum) = run.spectrum.clone().with_rigid_body_modes(count) {
            run.spectrum = spectrum;
        }
    }
    count
}

/// Points at which the structure of a model is looked at, whatever the points of the runs: what is zero at random
/// points is zero everywhere, while a slow eigenvalue may pass zero just where somebody asks.
const STRUCTURE_POINTS: u64 = 16;

/// The same of models with more than so many states, each of which takes a second or so: every run counts anew besides.
const POINTS_OF_LARGE: u64 = 4;
const LARGE: usize = 100;

/// They are numbers of a stream that no design has.
const FIRST_STRUCTURE_POINT: u64 = 1 << 41;

/// What is known of the structure of a model.
#[derive(Debug, Default)]
pub(super) struct Structure {
    /// Number of eigenvalues that it makes zero.
    zeros: OnceLock<usize>,
    /// Whether it is undamped with symmetric matrices.
    is_self_adjoint: OnceLock<bool>,
}

impl Structure {
    /// Whether the model is undamped with symmetric matrices, so that λ² is real.
    pub fn is_self_adjoint(&self, study: &Study, model: &dyn Model) -> bool {
        let at_point = |system: Option<Linearization>| {
            system.and_then(|system| system.second_order).is_some_and(|system| system.is_self_adjoint())
        };
        *self.is_self_adjoint.get_or_init(|| (0..STRUCTURE_POINTS).all(|index| at_point(system(study, model, index))))
    }

    /// How many eigenvalues the structure of a model makes zero; no limit, if it is not known.
    pub fn zeros(&self, study: &Study, model: &dyn Model) -> usize {
        *self.zeros.get_or_init(|| zeros(study, model))
    }

    /// How many of these eigenvalues of a model are rigid-body motion: of those that are negligible beside the largest
    /// as many as the structure of the model makes zero, since the others are slow; or what the study says.
    ///
    /// # Errors
    ///
    /// [`SpectrumError::RigidBodyModes`] if they contradict the study.
    pub fn rigid_body_modes(
        &self,
        eigenvalues: &[Complex<f64>],
        study: &Study,
        model: &dyn Model,
    ) -> Result<usize, SpectrumError> {
        let negligible = Spectrum::negligible(eigenvalues);
        // Most models have none, and need not be looked at.
        let zeros = || self.zeros(study, model);
        let Some(stated) = study.spectrum.rigid_body_modes else {
            return Ok(if negligible > 0 { negligible.min(zeros()) } else { 0 });
        };
        if let Some(found) = Spectrum::contradiction(eigenvalues, stated) {
            return Err(SpectrumError::RigidBodyModes { stated, found });
        }
        match if negligible > stated { zeros() } else { 0 } {
            more if more > stated && more != usize::MAX => {
                let found = format!("the structure of the model makes {more} eigenvalues zero");
                Err(SpectrumError::RigidBodyModes { stated, found })
            }
            _ => Ok(stated),
        }
    }
}

/// The least number of eigenvalues that are zero by structure at some random points; no limit, if it is not known.
fn zeros(study: &Study, model: &dyn Model) -> usize {
    let mut least = usize::MAX;
    for index in 0..STRUCTURE_POINTS {
        let Some(Linearization { state_matrix, second_order, .. }) = system(study, model, index) else { continue };
        let is_large = state_matrix.nrows() > LARGE;
        let most = zero_eigenvalues(state_matrix);
        let found = second_order.filter(|_| most > 0).and_then(|system| free_motion(&system, most));
        least = least.min(found.unwrap_or(most));
        if least == 0 || (is_large && index + 1 >= POINTS_OF_LARGE) {
            break;
        }
    }
    least
}

/// The model at the point of this number, if it has matrices.
fn system(study: &Study, model: &dyn Model, index: u64) -> Option<Linearization> {
    let inputs = &study.inputs;
    let mut point = vec![0.0; inputs.dimension()];
    random_point(inputs, study.seed, Purpose::Design, FIRST_STRUCTURE_POINT + index, &mut point);
    model.system(&inputs.physical(&point)).ok().flatten()
}
