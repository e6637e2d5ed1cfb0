//! How far the surrogate is off where stability is decided, from leave-one-out predictions.

use crate::design::Run;
use crate::fit::Fitted;
use crate::spectrum::{Output, spectral_abscissa};
use crate::surrogate::{Decision, Quantile};

/// Levels of the stored quantiles.
const LEVELS: [f64; 9] = [0.005, 0.025, 0.05, 0.25, 0.5, 0.75, 0.95, 0.975, 0.995];

/// Quantiles of (max Re of the model) − (max Re of its prediction without the point): every component is predicted from
/// the other points, all predictions of a point are recombined together.
pub(super) fn decision(outputs: &[Output], fitted: &[Fitted], runs: &[Run]) -> Decision {
    let left_out: Option<Vec<&Vec<f64>>> = fitted.iter().map(|fit| fit.leave_one_out_residuals.as_ref()).collect();
    let Some(left_out) = left_out else { return Decision::default() };
    let mut residuals: Vec<f64> = runs
        .iter()
        .enumerate()
        .map(|(i, run)| {
            let predicted: Vec<f64> =
                run.components.iter().zip(&left_out).map(|(value, rest)| value - rest[i]).collect();
            let mut eigenvalues = Vec::new();
            outputs.iter().for_each(|output| output.recombine(&predicted, &mut eigenvalues));
            run.spectrum.max_re() - spectral_abscissa(&eigenvalues)
        })
        .collect();
    residuals.sort_by(f64::total_cmp);
    let max_re_residuals = LEVELS.map(|level| Quantile { level, value: quantile(&residuals, level) }).to_vec();
    Decision { max_re_residuals, proportion_error: None }
}

/// The quantile of sorted values by linear interpolation between order statistics (type 7 of Hyndman and Fan 1996).
fn quantile(sorted: &[f64], level: f64) -> f64 {
    let position = level * (sorted.len() - 1) as f64;
    let below = position.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (position - below as f64) * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::quantile;

    #[test]
    fn quantiles_interpolate_between_order_statistics() {
        let sorted = [0.0, 1.0, 4.0];
        assert_eq!([0.0, 0.25, 0.5, 0.75, 1.0].map(|level| quantile(&sorted, level)), [0.0, 0.5, 1.0, 2.5, 4.0]);
        assert_eq!(quantile(&[7.0], 0.3), 7.0);
    }
}
