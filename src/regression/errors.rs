//! Error measures of a least-squares fit: R², S² and the corrected S² (equations 17 to 24 of the paper).

use crate::statistics::Moments;

/// Leverages closer to one than this leave a leave-one-out residual undetermined.
const LEVERAGE_MARGIN: f64 = 1e-10;

/// Quality of a fit with N values and P terms. Errors are relative to the variance of the values with divisor N − 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorMeasures {
    /// R² = 1 − Err_emp/V̂: the share of variance explained on the design itself.
    pub r2: f64,
    /// S² = 1 − Err_LOO/V̂: the share explained at points left out. `None` if a value cannot be predicted from the others.
    pub s2: Option<f64>,
    /// S² with the error increased by N/(N − P)·(1 + tr (ΨᵀΨ)⁻¹) (Chapelle, Vapnik and Bengio 2002,
    /// <https://doi.org/10.1023/A:1013943418833>), for small designs.
    pub corrected_s2: Option<f64>,
}

impl ErrorMeasures {
    /// From residuals of the fit, leverages h_i, tr (ΨᵀΨ)⁻¹, the number of terms P, and the variance V̂ of the values.
    pub(crate) fn new(residuals: &[f64], leverages: &[f64], inverse_trace: f64, terms: usize, variance: f64) -> Self {
        let samples = residuals.len() as f64;
        let mean_square = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>() / samples;
        let r2 = 1.0 - mean_square(residuals) / variance;
        let error = leave_one_out_residuals(residuals, leverages).map(|left_out| mean_square(&left_out) / variance);
        let correction = samples / (samples - terms as f64) * (1.0 + inverse_trace);
        Self {
            r2,
            s2: error.map(|error| 1.0 - error),
            corrected_s2: error.filter(|_| terms < residuals.len()).map(|error| 1.0 - error * correction),
        }
    }
}

/// Δ_i = (y_i − ŷ_i)/(1 − h_i), equation 22: what a fit without point i misses at point i. `None` if a leverage is one.
pub fn leave_one_out_residuals(residuals: &[f64], leverages: &[f64]) -> Option<Vec<f64>> {
    residuals
        .iter()
        .zip(leverages)
        .map(|(residual, leverage)| (1.0 - leverage > LEVERAGE_MARGIN).then(|| residual / (1.0 - leverage)))
        .collect()
}

/// The values of one component on a design.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response<'a> {
    /// One value per point.
    pub values: &'a [f64],
    /// Differences up to this size are rounding of the model, in the unit of the values.
    pub resolution: f64,
}

impl Response<'_> {
    /// V̂ = Σ(y_i − ȳ)²/(N − 1), or `None` if the values are constant but for rounding.
    pub fn variance(&self) -> Option<f64> {
        let variance = Moments::of(self.values).variance();
        (variance > self.resolution * self.resolution).then_some(variance)
    }
}
