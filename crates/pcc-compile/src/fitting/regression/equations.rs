//! The equations of a fit: what each model run answered, value and derivatives together.

use super::errors::LEVERAGE_MARGIN;
use nalgebra::{DMatrix, DMatrixView, SymmetricEigen};

/// Iterations for the eigenvalues of one block; two or three per row are usual.
const MOST_SWEEPS: usize = 10_000;

/// Derivatives of one component at some points of a design.
#[derive(Debug, Clone, PartialEq)]
pub struct Gradients {
    /// The points, ascending.
    pub points: Vec<usize>,
    /// ∂y/∂ξ_j in standardized variables: for each input j, one number per entry of `points`.
    pub slopes: Vec<f64>,
}

impl Gradients {
    /// Those of the first points, as many as with a value at each of `samples` points are not more than `most`
    /// equations; `None` if that is all.
    pub fn within(&self, samples: usize, most: usize) -> Option<Self> {
        let count = self.points.len();
        let inputs = self.slopes.len() / count.max(1);
        let kept = most.saturating_sub(samples) / inputs.max(1);
        let first = |j: usize| self.slopes[j * count..j * count + kept].iter().copied();
        (kept < count)
            .then(|| Self { points: self.points[..kept].to_vec(), slopes: (0..inputs).flat_map(first).collect() })
    }
}

/// The numbering of equations: a value at each of N points, then, input by input, derivatives at some of them.
///
/// A model run gives one *block* of equations, which are left out together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Equations {
    samples: usize,
    inputs: usize,
    points: Vec<usize>,
}

impl Equations {
    /// One value per point.
    pub fn values_alone(samples: usize) -> Self {
        Self { samples, inputs: 0, points: Vec::new() }
    }

    /// A value at each point, and derivatives by every input at some `points`, ascending.
    pub fn with_derivatives(samples: usize, inputs: usize, points: Vec<usize>) -> Self {
        Self { samples, inputs, points }
    }

    /// Number of points N.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Number of equations.
    pub fn rows(&self) -> usize {
        self.samples + self.inputs * self.points.len()
    }

    /// Points with derivatives, ascending.
    pub fn points_with_derivatives(&self) -> &[usize] {
        &self.points
    }

    /// The equations of point i, its value first.
    pub fn block(&self, i: usize) -> Vec<usize> {
        let mut rows = vec![i];
        if let Ok(at) = self.points.binary_search(&i) {
            rows.extend((0..self.inputs).map(|j| self.samples + j * self.points.len() + at));
        }
        rows
    }

    /// The equations of the first `samples` points.
    pub fn first(&self, samples: usize) -> Self {
        let samples = samples.min(self.samples);
        let points = self.points.iter().copied().filter(|&i| i < samples).collect();
        Self { samples, inputs: self.inputs, points }
    }

    /// Where the equations of the first `samples` points are among all, in the order of [`Equations::first`].
    pub fn positions_of_first(&self, samples: usize) -> Vec<usize> {
        let few = self.points.iter().take_while(|&&i| i < samples).count();
        let derivatives = (0..self.inputs).flat_map(|j| (0..few).map(move |k| (j, k)));
        let values = 0..samples.min(self.samples);
        values.chain(derivatives.map(|(j, k)| self.samples + j * self.points.len() + k)).collect()
    }
}

/// What the fits without one run each say of that run.
pub struct LeftOut {
    /// The first entry of Δ_i, that of the value, for every run.
    pub residuals: Vec<f64>,
    /// h̃_i = 1 − 1/((I − H_i)⁻¹)₀₀: leverage of the value of run i when the run is left out as a whole; h_i if the run
    /// is one value.
    pub leverages: Vec<f64>,
}

/// Δ_i = (I − H_i)⁻¹ e_i for the residuals e_i of run i and its block H_i = Q_i Q_iᵀ of the hat matrix (Cook and
/// Weisberg 1982, *Residuals and influence in regression*, section 3.6): what the fit without run i misses there. `q`
/// has a row per equation and `residuals` an entry. `None` if a run is not determined by the others.
pub fn leave_runs_out(equations: &Equations, q: &DMatrixView<'_, f64>, residuals: &[f64]) -> Option<LeftOut> {
    let mut left_out = LeftOut { residuals: Vec::new(), leverages: Vec::new() };
    for i in 0..equations.samples() {
        let rows = equations.block(i);
        let of_run = q.select_rows(&rows);
        let determined = DMatrix::identity(rows.len(), rows.len()) - &of_run * of_run.transpose();
        let eigen = SymmetricEigen::try_new(determined, f64::EPSILON, MOST_SWEEPS)?;
        if eigen.eigenvalues.iter().any(|value| value.is_nan() || *value <= LEVERAGE_MARGIN) {
            return None;
        }
        // Row 0 of (I − H_i)⁻¹.
        let first: Vec<f64> = (0..rows.len())
            .map(|k| {
                let parts = (0..rows.len())
                    .map(|m| eigen.eigenvectors[(0, m)] * eigen.eigenvectors[(k, m)] / eigen.eigenvalues[m]);
                parts.sum()
            })
            .collect();
        left_out.residuals.push(rows.iter().zip(&first).map(|(&row, factor)| factor * residuals[row]).sum());
        left_out.leverages.push(1.0 - 1.0 / first[0]);
    }
    Some(left_out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_derivatives_stay_within_a_number_of_equations() {
        let all = Gradients { points: vec![0, 2, 3], slopes: vec![1.0, 2.0, 3.0, 10.0, 20.0, 30.0] };
        let two = Gradients { points: vec![0, 2], slopes: vec![1.0, 2.0, 10.0, 20.0] };
        assert_eq!(all.within(4, 9), Some(two), "four values and two derivatives at two points");
        assert_eq!(all.within(4, 10), None, "all");
        assert_eq!(all.within(4, 3).map(|none| none.points.len()), Some(0));
    }
}
