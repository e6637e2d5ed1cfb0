//! Evaluation point by point: the plain reference for the fast evaluator, and the values a self-test expects.

use super::{SelfTest, Surrogate};
use crate::components::{Top, spectral_abscissa};
use num_complex::Complex;

/// Evaluators add the same terms in different orders; coefficients fall off, so rounding stays far below this.
const SELF_TEST_TOLERANCE: f64 = 1e-9;

impl Surrogate {
    /// Values of all components by id at the standardized point ξ.
    pub fn evaluate(&self, standardized: &[f64]) -> Vec<f64> {
        let inputs = self.inputs.inputs();
        let mut values = vec![0.0; self.component_count()];
        let element = self.mesh.locate(standardized);
        let local = self.mesh.elements()[element].local(standardized);
        for component in self.components() {
            let expansion = self.expansion(element, component.id);
            let degrees = expansion.indices.highest_degrees(inputs.len());
            let univariate: Vec<Vec<f64>> = (0..inputs.len())
                .map(|j| {
                    let mut values = vec![0.0; usize::from(degrees[j]) + 1];
                    let recurrence = inputs[j].marginal.family().recurrence(usize::from(degrees[j]));
                    recurrence.evaluate(local[j], &mut values);
                    values
                })
                .collect();
            let sum: f64 = expansion
                .indices
                .iter()
                .zip(&expansion.coefficients)
                .map(|(alpha, c)| c * (0..inputs.len()).map(|j| univariate[j][usize::from(alpha[j])]).product::<f64>())
                .sum();
            values[component.id] = component.center + component.scale * sum;
        }
        values
    }

    /// All eigenvalues, in the order of [`Surrogate::labels`], from the values of all components.
    pub fn eigenvalues(&self, components: &[f64]) -> Vec<Complex<f64>> {
        let mut eigenvalues = Vec::new();
        for output in &self.outputs {
            output.recombine(components, &mut eigenvalues);
        }
        eigenvalues.iter_mut().for_each(|lambda| *lambda = self.verdict.settled(*lambda));
        eigenvalues
    }

    /// max Re λ over all eigenvalues, in 1/s, from the values of all components.
    pub fn max_re(&self, components: &[f64]) -> f64 {
        spectral_abscissa(&self.eigenvalues(components))
    }

    /// What decides on stability, from the values of all components.
    pub fn top(&self, components: &[f64]) -> Top {
        self.verdict.top(&self.eigenvalues(components))
    }

    /// What an evaluator must find at these physical points.
    pub fn make_self_test(&self, points: Vec<Vec<f64>>) -> SelfTest {
        let components: Vec<Vec<f64>> =
            points.iter().map(|point| self.evaluate(&self.inputs.standardized(point))).collect();
        let max_re = components.iter().map(|values| self.max_re(values)).collect();
        SelfTest { points, components, max_re, tolerance: SELF_TEST_TOLERANCE }
    }
}
