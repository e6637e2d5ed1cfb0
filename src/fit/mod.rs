//! Fitting methods: from values on a design to one sparse expansion.

pub mod stepwise;

use crate::index_set::{IndexSet, MultiIndex};
use crate::progress::Interrupted;
use crate::regression::{ActiveBasis, ErrorMeasures};

/// Why a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stop {
    /// S² reached its target.
    Accurate,
    /// The highest degree was reached.
    HighestDegree,
    /// The design could not grow, and N < 2 card(A) at the next degree.
    DesignExhausted,
    /// The values do not vary: the mean is exact.
    Constant,
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
    /// Differences between values and their leave-one-out predictions, if determined.
    pub leave_one_out_residuals: Option<Vec<f64>>,
    /// Degree p at which the search ended.
    pub degree: u16,
    /// Why it ended.
    pub stop: Stop,
}

impl Fitted {
    fn new(basis: &ActiveBasis<'_>, degree: u16, stop: Stop) -> Result<Self, Interrupted> {
        let mut terms: Vec<(MultiIndex, f64)> = basis.indices().iter().cloned().zip(basis.coefficients()).collect();
        terms.sort_by(|a, b| a.0.cmp(&b.0));
        let (indices, coefficients) = terms.into_iter().unzip();
        Ok(Self {
            indices: IndexSet::from_unsorted(indices),
            coefficients,
            errors: Some(basis.errors()?),
            leave_one_out_residuals: basis.leave_one_out_residuals(),
            degree,
            stop,
        })
    }

    /// The mean of values that do not vary.
    fn constant(inputs: usize, values: &[f64]) -> Self {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        Self {
            indices: IndexSet::from_unsorted(vec![MultiIndex::constant(inputs)]),
            coefficients: vec![mean],
            errors: None,
            leave_one_out_residuals: Some(values.iter().map(|value| value - mean).collect()),
            degree: 0,
            stop: Stop::Constant,
        }
    }
}
