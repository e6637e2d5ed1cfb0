//! The study's fitting method on all components of a design.

use crate::fitting::design::Samples;
use crate::fitting::fit::auto::{self, Previous};
use crate::fitting::fit::omp::{self, Candidates};
use crate::fitting::fit::stepwise::{self, Outcome};
use crate::fitting::fit::{Fitted, gpc, minimum_norm};
use crate::fitting::regression::{BasisTables, Response};
use crate::study::{FitMethod, Smooth, Stepwise, Study};
use pcc_evaluate::components::Output;
use pcc_evaluate::foundation::{Interrupted, Observer, try_map};
use pcc_evaluate::polynomials::{Hyperbolic, IndexSet, IndexSetError, MultiIndex, Recurrence};

/// A fitted component and the name of the method that fitted it.
pub(super) struct ComponentResult {
    pub result: Fitted,
    pub solver: &'static str,
}

/// The method with what it has found of each component on smaller designs.
pub(super) struct ComponentFit<'a> {
    study: &'a Study,
    recurrences: Vec<Recurrence>,
    solver: Solver<'a>,
    previous: Vec<Previous>,
}

/// A method with its settings and the candidate terms it takes.
enum Solver<'a> {
    Stepwise(&'a Stepwise, Vec<Vec<MultiIndex>>),
    Omp(&'a Smooth, Candidates),
    MinimumNorm(&'a Smooth),
    Auto(&'a Smooth, Candidates),
    Gpc(IndexSet),
}

impl<'a> ComponentFit<'a> {
    pub fn new(study: &'a Study) -> Result<Self, IndexSetError> {
        let inputs = study.inputs.dimension();
        let degree = usize::from(study.fit.method.max_degree());
        let derivatives = if study.uses_derivatives() { inputs } else { 0 };
        let candidates =
            |settings: &Smooth| Candidates::new(inputs, settings.max_degree, study.design.maximum, derivatives);
        let solver = match &study.fit.method {
            FitMethod::Stepwise(settings) => {
                let hyperbolic = Hyperbolic { inputs, q_norm: settings.q_norm };
                Solver::Stepwise(settings, hyperbolic.shells(settings.max_degree)?)
            }
            FitMethod::Omp(settings) => Solver::Omp(settings, candidates(settings)?),
            FitMethod::MinimumNorm(settings) => Solver::MinimumNorm(settings),
            FitMethod::Auto(settings) => Solver::Auto(settings, candidates(settings)?),
            // By least squares: quadrature has a build of its own.
            FitMethod::Gpc(_) | FitMethod::MultiElement(_) => {
                Solver::Gpc(gpc::total_degree(inputs, study.fit.method.max_degree())?)
            }
        };
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
            let found = self.component(&tables, responses[id], &self.previous[id], can_grow, observer);
            observer.advance(1);
            found
        });
        observer.finish();
        let found: Option<Vec<_>> = found?.into_iter().collect();
        let Some(found) = found else { return Ok(None) };
        let (results, previous) = found.into_iter().unzip();
        self.previous = previous;
        Ok(Some(results))
    }

    fn component(
        &self,
        tables: &BasisTables,
        response: Response<'_>,
        previous: &Previous,
        can_grow: bool,
        observer: &dyn Observer,
    ) -> Result<Option<(ComponentResult, Previous)>, Interrupted> {
        let (result, solver, previous) = match &self.solver {
            Solver::Auto(settings, candidates) => {
                auto::fit(tables, response, candidates, settings, previous, observer)?
            }
            Solver::Omp(settings, candidates) => {
                (omp::fit(tables, response, candidates, settings, observer)?, "omp", previous.clone())
            }
            Solver::Stepwise(settings, shells) => {
                let result = match stepwise::fit(tables, response, shells, settings, observer)? {
                    Outcome::Fitted(fitted) => fitted,
                    Outcome::TooFewSamples { .. } if can_grow => return Ok(None),
                    Outcome::TooFewSamples { indices, degree } => {
                        stepwise::settle(tables, response, &indices, degree, observer)?
                    }
                };
                (result, "stepwise", previous.clone())
            }
            Solver::Gpc(indices) => (gpc::least_squares(tables, response, indices, observer)?, "gpc", previous.clone()),
            Solver::MinimumNorm(settings) => {
                let (result, minimum_norm) =
                    minimum_norm::fit(tables, response, settings, &previous.minimum_norm, observer)?;
                (result, "minimum-norm", Previous { minimum_norm, ..*previous })
            }
        };
        Ok(Some((ComponentResult { result, solver }, previous)))
    }
}
