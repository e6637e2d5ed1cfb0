//! Fitting methods: from values on a design, perhaps with derivatives, to one sparse expansion.

pub mod auto;
mod covariance;
mod covariance_of_many;
mod cross_validation;
pub mod gpc;
pub mod method;
pub mod minimum_norm;
pub mod multi_element;
pub mod omp;
mod prior;
mod prior_search;
mod pursuit_path;
mod regularized;
pub mod stepwise;

pub use method::{FitMethod, Smooth};
pub use prior::Prior;

use crate::fitting::regression::{ActiveBasis, BasisTables, ErrorMeasures, Response};
use pcc_evaluate::foundation::{Interrupted, Observer};
use pcc_evaluate::polynomials::{IndexSet, MultiIndex};
use pcc_evaluate::surrogate::StopReason;

/// Weights of derivatives beside values that fits try: as good as values, less and less to be trusted, not used.
pub(crate) const WEIGHTS: [f64; 4] = [1.0, 0.1, 0.01, 0.0];

/// How much smaller leave-one-out residuals look at points on which a fit was tuned, about.
pub(crate) const FLATTERY: f64 = 2.0;

/// Leave-one-out residuals at points on which the fit was not tuned, so that they flatter it little or not at all: for
/// the minimum-norm fit, points that its prior has not seen; for matching pursuit, points outside the folds, which only
/// chose degree, norm and number of terms; for stepwise regression all, because its terms are chosen by R².
#[derive(Debug, Clone, PartialEq)]
pub struct BlindResiduals {
    /// The first of these points; they are the last of the design.
    pub first: usize,
    /// One residual per point from there on.
    pub values: Vec<f64>,
}

/// A fitted expansion of one component, with its error measures.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The index set A, in canonical order.
    pub indices: IndexSet,
    /// Coefficients, one per index.
    pub coefficients: Vec<f64>,
    /// R², S² and corrected S²; `None` for constant values, which have no variance to compare with.
    pub errors: Option<ErrorMeasures>,
    /// Differences between values and their predictions without the run they come from, if determined.
    pub leave_one_out_residuals: Option<Vec<f64>>,
    /// The same at points on which the fit was not tuned; `None` if it was tuned on all.
    pub blind_residuals: Option<BlindResiduals>,
    /// Weight of derivatives beside values, from 0, not used, to 1, trusted as much; `None` if there were none. Least
    /// squares multiplies their equations by it; in the minimum-norm fit their ν is larger by its inverse square.
    pub derivative_weight: Option<f64>,
    /// Degree p at which a stepwise search ended; the highest total degree of the terms for the other methods.
    pub degree: u16,
    /// Why it ended.
    pub stop: StopReason,
}

impl Fitted {
    /// The root mean square of the residuals at runs left out, in the unit of the component; `None` if they are not
    /// determined.
    pub fn left_out_error(&self) -> Option<f64> {
        let residuals = self.leave_one_out_residuals.as_ref()?;
        Some((residuals.iter().map(|rest| rest * rest).sum::<f64>() / residuals.len() as f64).sqrt())
    }

    /// A least-squares fit.
    fn new(basis: &ActiveBasis<'_>, degree: u16, stop: StopReason) -> Result<Self, Interrupted> {
        let mut terms: Vec<(MultiIndex, f64)> = basis.indices().iter().cloned().zip(basis.coefficients()).collect();
        terms.sort_by(|a, b| a.0.cmp(&b.0));
        let (indices, coefficients) = terms.into_iter().unzip();
        let left_out = basis.leave_one_out_residuals();
        Ok(Self {
            indices: IndexSet::from_unsorted(indices),
            coefficients,
            errors: Some(basis.errors()?),
            blind_residuals: left_out.clone().map(|values| BlindResiduals { first: 0, values }),
            leave_one_out_residuals: left_out,
            derivative_weight: None,
            degree,
            stop,
        })
    }

    /// The mean of values that vary, with its errors: S² below zero.
    ///
    /// # Errors
    ///
    /// [`Interrupted`] soon after the observer asks to stop.
    pub fn mean_of(tables: &BasisTables, response: Response<'_>, observer: &dyn Observer) -> Result<Self, Interrupted> {
        match response.variance() {
            Some(variance) => Self::mean(tables, response, variance, observer),
            None => Ok(Self::constant(tables.inputs(), response.values)),
        }
    }

    /// The mean of values that vary but could not be fitted: S² below zero says so.
    fn mean(
        tables: &BasisTables,
        response: Response<'_>,
        variance: f64,
        observer: &dyn Observer,
    ) -> Result<Self, Interrupted> {
        let values = Response::of(response.values, response.resolution);
        let basis = ActiveBasis::constant(tables, values, variance, 0.0, observer)?;
        let weight = response.gradients.map(|_| 0.0);
        Ok(Self { derivative_weight: weight, ..Self::new(&basis, 0, StopReason::DesignExhausted)? })
    }

    /// The mean of values that do not vary.
    fn constant(inputs: usize, values: &[f64]) -> Self {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let residuals: Vec<f64> = values.iter().map(|value| value - mean).collect();
        Self {
            indices: IndexSet::from_unsorted(vec![MultiIndex::constant(inputs)]),
            coefficients: vec![mean],
            errors: None,
            blind_residuals: Some(BlindResiduals { first: 0, values: residuals.clone() }),
            leave_one_out_residuals: Some(residuals),
            derivative_weight: None,
            degree: 0,
            stop: StopReason::Constant,
        }
    }
}
