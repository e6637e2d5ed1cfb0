//! The study's fitting method on components of a design.

use crate::fitting::design::Samples;
use crate::fitting::fit::Fitted;
use crate::fitting::fit::method::{FitSize, Previous, Solver};
use crate::fitting::regression::{BasisTables, Response};
use crate::study::Study;
use pcc_evaluate::foundation::{Interrupted, Observer, try_map};
use pcc_evaluate::polynomials::{IndexSetError, Recurrence};

/// A fitted component and the name of the method that fitted it.
#[derive(Debug, Clone)]
pub(super) struct ComponentResult {
    pub result: Fitted,
    pub solver: &'static str,
}

/// The method, ready for components of any design of the study.
pub(super) struct ComponentFit<'a> {
    study: &'a Study,
    recurrences: Vec<Recurrence>,
    solver: Box<dyn Solver + 'a>,
    /// What trials are fitted by.
    trial: Option<Box<dyn Solver + 'a>>,
}

/// How thoroughly components are fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Care {
    /// Well enough to compare groupings: by one method, where the study's chooses among several.
    Trial,
    /// By the study's method.
    Full,
}

impl<'a> ComponentFit<'a> {
    pub fn new(study: &'a Study) -> Result<Self, IndexSetError> {
        let inputs = study.inputs.dimension();
        let degree = usize::from(study.fit.method.max_degree());
        let derivatives = if study.uses_derivatives() { inputs } else { 0 };
        let solver = study.fit.method.solver(FitSize { inputs, maximum: study.design.maximum, derivatives })?;
        let recurrences =
            study.inputs.inputs().iter().map(|input| input.marginal.family().recurrence(degree)).collect();
        Ok(Self { study, recurrences, solver, trial: study.fit.method.trial_solver() })
    }

    /// Whether trials are fitted as everything else.
    pub fn trials_are_full(&self) -> bool {
        self.trial.is_none()
    }

    /// What a component starts from that was fitted on no smaller design.
    pub fn nothing(&self) -> Previous {
        Previous::new(self.study.inputs.dimension())
    }

    /// The polynomials at the points of a design, and their slopes if some responses have derivatives.
    pub fn tables(&self, samples: &Samples, with_slopes: bool) -> BasisTables {
        let degree = usize::from(self.study.fit.method.max_degree());
        match with_slopes {
            true => BasisTables::with_slopes(samples, &self.recurrences, degree),
            false => BasisTables::new(samples, &self.recurrences, degree),
        }
    }

    /// Fits `responses`, one per component, to what the model answered at the points of `tables`; `previous` is what
    /// smaller designs have taught of each. `None` if the method asks for a larger design, as long as the design
    /// `can_grow`; else each component settles for what the design carries.
    pub fn fit(
        &self,
        tables: &BasisTables,
        responses: &[Response<'_>],
        previous: &[Previous],
        (care, can_grow): (Care, bool),
        observer: &dyn Observer,
    ) -> Result<Option<Vec<(ComponentResult, Previous)>>, Interrupted> {
        let solver = self.trial.as_ref().filter(|_| care == Care::Trial).unwrap_or(&self.solver);
        observer.begin("fitting components", responses.len() as u64);
        let found = try_map(responses.len(), |id| {
            let found = solver.fit(tables, responses[id], &previous[id], can_grow, observer);
            observer.advance(1);
            found
        });
        observer.finish();
        let keep = |(result, solver, previous)| (ComponentResult { result, solver }, previous);
        Ok(found?.into_iter().map(|found| found.map(keep)).collect())
    }

    /// The value of a fit in the middle of the inputs, ξ = 0.
    pub fn value_at_center(&self, fitted: &Fitted) -> f64 {
        let univariate: Vec<Vec<f64>> = self
            .recurrences
            .iter()
            .map(|recurrence| {
                let mut values = vec![0.0; usize::from(self.study.fit.method.max_degree()) + 1];
                recurrence.evaluate(0.0, &mut values);
                values
            })
            .collect();
        let term = |alpha: &pcc_evaluate::polynomials::MultiIndex| -> f64 {
            univariate.iter().enumerate().map(|(j, values)| values[usize::from(alpha[j])]).product()
        };
        fitted.indices.iter().zip(&fitted.coefficients).map(|(alpha, c)| c * term(alpha)).sum()
    }
}
