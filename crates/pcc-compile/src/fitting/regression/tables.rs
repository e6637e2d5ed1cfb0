//! Univariate polynomials on a design, and the multivariate ones that are products of them.

use super::equations::Equations;
use crate::fitting::design::Samples;
use nalgebra::{DMatrix, DMatrixView};
use pcc_evaluate::polynomials::{MultiIndex, Recurrence};

/// Univariate polynomials, and perhaps their derivatives, at every point of a design: what multivariate ones are
/// products of.
#[derive(Debug, Clone)]
pub struct BasisTables {
    samples: usize,
    inputs: usize,
    degrees: usize,
    values: Univariate,
    slopes: Option<Univariate>,
    /// 1/φ_1′ per input: makes the derivative of a linear term as large as the term.
    slope_units: Vec<f64>,
}

/// For input j and degree k, one number per point from (j × degrees + k) × samples on.
type Univariate = Vec<f64>;

impl BasisTables {
    /// φ_k(ξ_ij) for all points i, inputs j and degrees k up to `degree`, with one recurrence per input.
    pub fn new(samples: &Samples, recurrences: &[Recurrence], degree: usize) -> Self {
        let values =
            tabulate(samples, recurrences, degree, |recurrence, xi, at_point| recurrence.evaluate(xi, at_point));
        let slope_units = recurrences.iter().map(|recurrence| recurrence.off_diagonal.first().copied().unwrap_or(1.0));
        Self {
            samples: samples.len(),
            inputs: recurrences.len(),
            degrees: degree + 1,
            values,
            slopes: None,
            slope_units: slope_units.collect(),
        }
    }

    /// The same with φ′_k(ξ_ij).
    pub fn with_slopes(samples: &Samples, recurrences: &[Recurrence], degree: usize) -> Self {
        let mut values = vec![0.0; degree + 1];
        let slopes = tabulate(samples, recurrences, degree, |recurrence, xi, at_point| {
            recurrence.evaluate_with_slopes(xi, &mut values, at_point);
        });
        Self { slopes: Some(slopes), ..Self::new(samples, recurrences, degree) }
    }

    /// Number of points N.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Number of inputs r.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// √b_1 = 1/φ_1′ of an input's family: derivatives times this are comparable with values.
    pub fn slope_unit(&self, input: usize) -> f64 {
        self.slope_units[input]
    }

    /// The matrix with the column φ_k(ξ_ij) for each degree k = 1…`degree` of input j, one row per point i.
    pub fn powers(&self, input: usize, degree: u16) -> DMatrixView<'_, f64> {
        self.view(&self.values, input, degree)
    }

    /// The same for φ′_k(ξ_ij); `None` for tables without derivatives.
    pub fn power_slopes(&self, input: usize, degree: u16) -> Option<DMatrixView<'_, f64>> {
        self.slopes.as_ref().map(|slopes| self.view(slopes, input, degree))
    }

    fn view<'a>(&self, numbers: &'a Univariate, input: usize, degree: u16) -> DMatrixView<'a, f64> {
        let start = (input * self.degrees + 1) * self.samples;
        let end = start + usize::from(degree) * self.samples;
        DMatrixView::from_slice(&numbers[start..end], self.samples, degree.into())
    }

    fn univariate<'a>(&self, numbers: &'a Univariate, input: usize, degree: u16) -> &'a [f64] {
        let start = (input * self.degrees + usize::from(degree)) * self.samples;
        &numbers[start..start + self.samples]
    }

    /// The matrix Ψ with the column ψ_α(ξ_i) = Π_j φ_{α_j}(ξ_ij) for each α.
    pub fn columns(&self, indices: &[MultiIndex]) -> DMatrix<f64> {
        self.stacked(indices, &Equations::values_alone(self.samples))
    }

    /// The matrix with one row per equation, values first, and a column for each α: ψ_α(ξ_i), then ∂ψ_α/∂ξ_j at the
    /// points that have derivatives, input by input.
    ///
    /// # Panics
    ///
    /// If there are equations of derivatives, but the tables have none.
    pub fn stacked(&self, indices: &[MultiIndex], equations: &Equations) -> DMatrix<f64> {
        let rows = equations.rows();
        let mut matrix = DMatrix::from_element(rows, indices.len(), 1.0);
        for (alpha, column) in indices.iter().zip(matrix.as_mut_slice().chunks_exact_mut(rows)) {
            let (values, derivatives) = column.split_at_mut(self.samples);
            for (j, &degree) in alpha.iter().enumerate().filter(|&(_, &degree)| degree > 0) {
                for (entry, factor) in values.iter_mut().zip(self.univariate(&self.values, j, degree)) {
                    *entry *= factor;
                }
            }
            if !derivatives.is_empty() {
                self.differentiate(alpha, equations, derivatives);
            }
        }
        matrix
    }

    /// ∂ψ_α/∂ξ_j for every input j and every point with derivatives.
    fn differentiate(&self, alpha: &MultiIndex, equations: &Equations, column: &mut [f64]) {
        let slopes = self.slopes.as_ref().expect("tables with derivatives");
        let points = equations.points_with_derivatives();
        for (by, part) in column.chunks_exact_mut(points.len()).enumerate() {
            if alpha[by] == 0 {
                part.fill(0.0);
                continue;
            }
            for (j, &degree) in alpha.iter().enumerate().filter(|&(_, &degree)| degree > 0) {
                let factors = self.univariate(if j == by { slopes } else { &self.values }, j, degree);
                part.iter_mut().zip(points).for_each(|(entry, &i)| *entry *= factors[i]);
            }
        }
    }
}

/// One number per input, degree and point, from the numbers of all degrees at one coordinate.
fn tabulate(
    samples: &Samples,
    recurrences: &[Recurrence],
    degree: usize,
    mut evaluate: impl FnMut(&Recurrence, f64, &mut [f64]),
) -> Univariate {
    let (count, degrees) = (samples.len(), degree + 1);
    let mut numbers = vec![0.0; recurrences.len() * degrees * count];
    let mut at_point = vec![0.0; degrees];
    for (i, point) in samples.points().enumerate() {
        for (j, (recurrence, &xi)) in recurrences.iter().zip(point).enumerate() {
            evaluate(recurrence, xi, &mut at_point);
            for (k, &number) in at_point.iter().enumerate() {
                numbers[(j * degrees + k) * count + i] = number;
            }
        }
    }
    numbers
}
