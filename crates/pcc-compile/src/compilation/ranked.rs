//! Levels whose modes have frequency ranks: the paper's way, and that of methods that ask for larger designs.

use super::BuildError;
use super::components::{Care, ComponentFit, ComponentResult, Learnt, Start};
use super::evaluations::{Evaluations, Level, groups};
use pcc_evaluate::components::Output;
use pcc_evaluate::foundation::Observer;

/// Fits modes by frequency rank; those that come close form groups if the study's target wants it.
pub(super) struct RankedModes<'a> {
    fit: ComponentFit<'a>,
    grouping: Vec<Output>,
    previous: Vec<Learnt>,
}

impl<'a> RankedModes<'a> {
    pub fn new(fit: ComponentFit<'a>) -> Self {
        Self { fit, grouping: Vec::new(), previous: Vec::new() }
    }

    /// Fits everything on the current design. `None` if the method asks for a larger one.
    pub fn fit(
        &mut self,
        evaluations: &Evaluations<'_>,
        can_grow: bool,
        observer: &dyn Observer,
    ) -> Result<Option<(Level, Vec<ComponentResult>)>, BuildError> {
        let level = evaluations.by_rank()?;
        // A fit starts from nothing, and from what smaller designs have taught of the same components.
        if groups(&level.outputs) != groups(&self.grouping) {
            self.previous = vec![self.fit.nothing(); level.values.len()];
        }
        self.grouping.clone_from(&level.outputs);
        let responses = level.responses();
        let with_slopes = responses.iter().any(|response| response.gradients.is_some());
        let tables = self.fit.tables(&level.samples, with_slopes);
        let starts = self.previous.iter().map(Start::from).collect();
        let found = self.fit.fit(&tables, &responses, starts, (Care::Full, can_grow), observer)?;
        let Some(found) = found else { return Ok(None) };
        let (results, previous) = found.into_iter().unzip();
        self.previous = previous;
        Ok(Some((level, results)))
    }
}
