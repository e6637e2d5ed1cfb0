//! Error measures of a least-squares fit: R², S² and the corrected S² (equations 17 to 24 of the paper).

use super::equations::{Equations, Gradients};
use pcc_evaluate::probability::statistics::Moments;

/// Leverages closer to one than this, or eigenvalues of the leverages of a run, leave a leave-one-out residual
/// undetermined.
pub(super) const LEVERAGE_MARGIN: f64 = 1e-10;

/// Quality of a fit with N values and P terms. Errors are relative to the variance of the values with divisor N − 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorMeasures {
    /// R² = 1 − Err_emp/V̂: the share of variance explained on the design itself.
    pub r2: f64,
    /// S² = 1 − Err_LOO/V̂: the share explained at points left out. `None` if a value cannot be predicted from the
    /// others.
    pub s2: Option<f64>,
    /// S² with the error increased by N/(N − P)·(1 + tr (ΨᵀΨ)⁻¹) (Chapelle, Vapnik and Bengio 2002,
    /// <https://doi.org/10.1023/A:1013943418833>), for small designs.
    pub corrected_s2: Option<f64>,
}

impl ErrorMeasures {
    /// From residuals of the fit, leverages h_i, tr (ΨᵀΨ)⁻¹, the number of terms P, and the variance V̂ of the values.
    pub(crate) fn new(residuals: &[f64], leverages: &[f64], inverse_trace: f64, terms: usize, variance: f64) -> Self {
        let left_out = leave_one_out_residuals(residuals, leverages);
        let samples = residuals.len() as f64;
        let correction = samples / (samples - terms as f64) * (1.0 + inverse_trace);
        let error =
            left_out.as_deref().filter(|_| terms < residuals.len()).map(|left_out| mean_square(left_out) / variance);
        let plain = Self::of_residuals(residuals, left_out.as_deref(), variance);
        Self { corrected_s2: error.map(|error| 1.0 - error * correction), ..plain }
    }

    /// R² and S² from residuals and leave-one-out residuals of the values.
    pub(crate) fn of_residuals(residuals: &[f64], left_out: Option<&[f64]>, variance: f64) -> Self {
        let share = |values: &[f64]| 1.0 - mean_square(values) / variance;
        Self { r2: share(residuals), s2: left_out.map(share), corrected_s2: None }
    }
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64
}

/// Δ_i = (y_i − ŷ_i)/(1 − h_i), equation 22: what a fit without point i misses at point i. `None` if a leverage is one.
pub fn leave_one_out_residuals(residuals: &[f64], leverages: &[f64]) -> Option<Vec<f64>> {
    residuals
        .iter()
        .zip(leverages)
        .map(|(residual, leverage)| (1.0 - leverage > LEVERAGE_MARGIN).then(|| residual / (1.0 - leverage)))
        .collect()
}

/// The values of one component on a design, perhaps with derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response<'a> {
    /// One value per point.
    pub values: &'a [f64],
    /// Derivatives in standardized variables.
    pub gradients: Option<&'a Gradients>,
    /// Differences up to this size are rounding of the model, in the unit of the values.
    pub resolution: f64,
}

impl<'a> Response<'a> {
    /// Values alone.
    pub fn of(values: &'a [f64], resolution: f64) -> Self {
        Self { values, gradients: None, resolution }
    }

    /// The response as a fit with this weight of derivatives sees it: without them if the weight is 0.
    pub fn with_weight(self, weight: f64) -> Self {
        Self { gradients: self.gradients.filter(|_| weight > 0.0), ..self }
    }

    /// V̂ = Σ(y_i − ȳ)²/(N − 1), or `None` if the values are constant but for rounding: of the model, or of numbers as
    /// large as these, of which the last digits follow no law.
    pub fn variance(&self) -> Option<f64> {
        /// A spread below this share of the values is lost beside them.
        const LEAST_SPREAD: f64 = 1e3 * f64::EPSILON;
        let variance = Moments::of(self.values).variance();
        let largest = self.values.iter().map(|value| value.abs()).fold(0.0, f64::max);
        (variance.sqrt() > self.resolution.max(LEAST_SPREAD * largest)).then_some(variance)
    }

    /// Which equations these are, for so many inputs.
    pub fn equations(&self, inputs: usize) -> Equations {
        match self.gradients {
            Some(gradients) => Equations::with_derivatives(self.values.len(), inputs, gradients.points.clone()),
            None => Equations::values_alone(self.values.len()),
        }
    }

    /// The right-hand sides of the equations, in their order.
    pub fn targets(&self) -> impl Iterator<Item = f64> + 'a {
        let slopes: &'a [f64] = self.gradients.map_or(&[], |gradients| &gradients.slopes);
        self.values.iter().chain(slopes).copied()
    }
}
