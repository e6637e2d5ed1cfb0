//! What of a surrogate is offered as a model.

use pcc_evaluate::components::Label;
use pcc_evaluate::evaluation::{Plan, evaluate_points};
use pcc_evaluate::probability::inputs::{InputError, InputSpace};
use pcc_evaluate::surrogate::Surrogate;
use thiserror::Error;

/// A model by which the surrogate is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Offered {
    /// Re λ and Im λ of every eigenvalue in turn, with both of each conjugate pair.
    Eigenvalues,
    /// max Re λ.
    MaxRe,
    /// What is said of stability, as a number.
    Verdict,
}

impl Offered {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Eigenvalues, Self::MaxRe, Self::Verdict];

    /// Its name in the protocol.
    pub fn name(self) -> &'static str {
        match self {
            Self::Eigenvalues => "eigenvalues",
            Self::MaxRe => "max_re",
            Self::Verdict => "verdict",
        }
    }

    /// What it answers, in words.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Eigenvalues => "Re λ (1/s) and Im λ (rad/s) of each eigenvalue in turn",
            Self::MaxRe => "max Re λ, in 1/s",
            Self::Verdict => "0 stable, 1 marginal, 2 flutter, 3 divergence",
        }
    }
}

/// Why a point has no value.
#[derive(Debug, Clone, PartialEq, Error)]
pub(super) enum NoValue {
    /// It lies outside the domain.
    #[error("{0}; move the point, or send \"config\": {{\"extrapolate\": true}} to evaluate it all the same")]
    Outside(InputError),
    /// The surrogate overflows, or the point lies where a law ends, infinitely far from all model runs.
    #[error("the surrogate has no finite value at {point}; move the point to where the model was run")]
    NotFinite { point: String },
}

/// A surrogate, ready to be asked by several threads.
pub(crate) struct Models<'s> {
    surrogate: &'s Surrogate,
    plan: Plan,
    labels: Vec<Label>,
}

impl<'s> Models<'s> {
    /// The models that a surrogate has.
    pub fn new(surrogate: &'s Surrogate) -> Self {
        Self { surrogate, plan: Plan::new(surrogate), labels: surrogate.labels() }
    }

    /// What all of them take: one value per input.
    pub fn inputs(&self) -> &'s InputSpace {
        &self.surrogate.inputs
    }

    /// How many numbers a model answers.
    pub fn output_size(&self, model: Offered) -> usize {
        match model {
            Offered::Eigenvalues => {
                2 * self.labels.iter().map(|&label| 1 + usize::from(self.is_half(label))).sum::<usize>()
            }
            Offered::MaxRe | Offered::Verdict => 1,
        }
    }

    /// Whether a label stands for a conjugate pair.
    fn is_half(&self, label: Label) -> bool {
        label.mode().is_some_and(|mode| !self.labels.contains(&Label::Second(mode)))
    }

    /// What a model answers at a point in physical units, which has as many finite numbers as there are inputs.
    pub(super) fn evaluate(&self, model: Offered, point: &[f64], extrapolates: bool) -> Result<Vec<f64>, NoValue> {
        let inputs = self.inputs();
        if !extrapolates {
            inputs.check(point).map_err(NoValue::Outside)?;
        }
        let block = evaluate_points(self.surrogate, &self.plan, &[&inputs.standardized(point)]);
        let top = block.top(0);
        let values = match model {
            Offered::Eigenvalues => self.pairs(|at| block.eigenvalues[at][0]),
            Offered::MaxRe => vec![top.max_re],
            Offered::Verdict => vec![f64::from(top.verdict() as u8)],
        };
        match top.max_re.is_finite() && values.iter().all(|value| value.is_finite()) {
            true => Ok(values),
            false => Err(NoValue::NotFinite { point: inputs.describe(point) }),
        }
    }

    /// Re and Im of each eigenvalue in turn: mode by mode, then those that are real everywhere.
    fn pairs(&self, lambda: impl Fn(usize) -> num_complex::Complex<f64>) -> Vec<f64> {
        let mut order: Vec<usize> = (0..self.labels.len()).collect();
        order.sort_by_key(|&at| self.labels[at].column());
        let of_label = |at: usize| {
            let lambda = lambda(at);
            let conjugate = self.is_half(self.labels[at]).then_some(lambda.conj());
            [Some(lambda), conjugate].into_iter().flatten().flat_map(|lambda| [lambda.re, lambda.im])
        };
        order.into_iter().flat_map(of_label).collect()
    }
}
