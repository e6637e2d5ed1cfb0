//! Builds with models of a test's own.

use super::*;
use crate::campaign::RunError;
use crate::mechanics::model::{Clutch, Linearization, ModelError};
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
    let by_values = build(&study("derivatives = false\nproportion_tolerance = 1e-4"), &Silent).unwrap();
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
        Ok(Some(Linearization::first_order(state_matrix, vec![derivative])))
    }
}

#[test]
fn runs_whose_modes_cannot_be_separated_enter_with_their_values_alone() {
    let surrogate = build_with(&study("s2_target = 0.9"), Box::new(Twins), &Silent).unwrap();
    let counts = surrogate.training.counts;
    assert_eq!((counts.values, counts.gradients), (16, 8));
}
