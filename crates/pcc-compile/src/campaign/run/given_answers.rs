//! Runs that others have made, seen as those of the model.

use super::{Run, RunError, Runner};
use crate::mechanics::spectrum::{Computation, Spectrum};
use nalgebra::Complex;

impl Runner<'_> {
    /// Takes runs that others have made at physical points: what they answered, or why they failed. They come back in
    /// order, with the derivatives that they have, if derivatives are wanted.
    ///
    /// # Errors
    ///
    /// [`RunError`] names the first point whose answer cannot be that of the model.
    pub fn take(&mut self, given: Vec<(&[f64], Result<Computation, String>)>) -> Result<Vec<Option<Run>>, RunError> {
        let states = given.first().and_then(|(point, _)| self.states(point));
        let mut seen = Vec::with_capacity(given.len());
        for (point, answer) in given {
            let mut computation = match answer {
                Ok(computation) => computation,
                Err(cause) => {
                    self.ledger.iter().for_each(|ledger| ledger.note_failure(point, cause.clone()));
                    seen.push(None);
                    continue;
                }
            };
            let reductions = computation.reductions.take().filter(|_| self.wants_derivatives);
            self.add_zeros(&mut computation.eigenvalues, states);
            let (spectrum, _) = self.see(point, computation)?;
            self.check_count(point, &spectrum)?;
            seen.push(Some(self.select(point, spectrum, reductions)?));
        }
        Ok(seen)
    }

    /// Number of states of the model, if it has matrices.
    fn states(&self, point: &[f64]) -> Option<usize> {
        self.model.system(point).ok().flatten().map(|system| system.state_matrix.nrows())
    }

    /// Tables leave out rigid-body motion, as result tables of pcc do: where the structure of the model makes as many
    /// eigenvalues zero as are missing, these are the missing ones.
    fn add_zeros(&self, eigenvalues: &mut Vec<Complex<f64>>, states: Option<usize>) {
        let (Some(states), Ok(spectrum)) = (states, Spectrum::new(eigenvalues)) else { return };
        let found = spectrum.eigenvalues().len() + spectrum.rigid_body_modes();
        let missing = states.saturating_sub(found);
        if missing > 0 && self.structure.zeros(self.study, &*self.model) == missing {
            eigenvalues.extend(std::iter::repeat_n(Complex::new(0.0, 0.0), missing));
        }
    }
}
