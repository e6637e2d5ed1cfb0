//! The study's fitting method on all components of a design.

use crate::fitting::design::Samples;
use crate::fitting::fit::Fitted;
use crate::fitting::fit::method::{FitSize, Previous, Solver};
use crate::fitting::regression::{BasisTables, Response};
use crate::study::Study;
use pcc_evaluate::components::Output;
use pcc_evaluate::foundation::{Interrupted, Observer, try_map};
use pcc_evaluate::polynomials::{IndexSetError, Recurrence};

/// A fitted component and the name of the method that fitted it.
pub(super) struct ComponentResult {
    pub result: Fitted,
    pub solver: &'static str,
}

/// The method with what it has found of each component on smaller designs.
pub(super) struct ComponentFit<'a> {
    study: &'a Study,
    recurrences: Vec<Recurrence>,
    solver: Box<dyn Solver + 'a>,
    previous: Vec<Previous>,
}

impl<'a> ComponentFit<'a> {
    pub fn new(study: &'a Study) -> Result<Self, IndexSetError> {
        let inputs = study.inputs.dimension();
        let degree = usize::from(study.fit.method.max_degree());
        let derivatives = if study.uses_derivatives() { inputs } else { 0 };
        let solver = study.fit.method.solver(FitSize { inputs, maximum: study.design.maximum, derivatives })?;
        let recurrences =
            study.inputs.inputs().iter().map(|input| input.marginal.family().recurrence(degree)).collect();
        Ok(Self { study, recurrences, solver, previous: Vec::new() })
    }

    /// Starts anew, because the components are now those of `outputs`.
    pub fn forget(&mut self, outputs: &[Output]) {
        let count = outputs.iter().map(|output| output.components.len()).sum();
        self.previous = vec![Previous::new(self.study.inputs.dimension()); count];
    }

    /// Fits `responses`, one per component, to what the model answered at the points of `samples`. `None` if the method
    /// asks for a larger design, as long as the design `can_grow`; else each component settles for what the design
    /// carries.
    pub fn fit(
        &mut self,
        samples: &Samples,
        responses: &[Response<'_>],
        can_grow: bool,
        observer: &dyn Observer,
    ) -> Result<Option<Vec<ComponentResult>>, Interrupted> {
        let degree = usize::from(self.study.fit.method.max_degree());
        let has_derivatives = responses.iter().any(|response| response.gradients.is_some());
        let tables = match has_derivatives {
            true => BasisTables::with_slopes(samples, &self.recurrences, degree),
            false => BasisTables::new(samples, &self.recurrences, degree),
        };
        observer.begin("fitting components", responses.len() as u64);
        let found = try_map(responses.len(), |id| {
            let found = self.solver.fit(&tables, responses[id], &self.previous[id], can_grow, observer);
            observer.advance(1);
            found
        });
        observer.finish();
        let found: Option<Vec<_>> = found?.into_iter().collect();
        let Some(found) = found else { return Ok(None) };
        let keep = |(result, solver, previous)| (ComponentResult { result, solver }, previous);
        let (results, previous) = found.into_iter().map(keep).unzip();
        self.previous = previous;
        Ok(Some(results))
    }
}
