//! The dependence of inputs: correlations of pairs, by rank or of the values, to a Gaussian copula.

use super::error::{Place, StudyError};
use super::raw;
use super::validate::{Lines, alternatives};
use crate::numerics::nearest_correlation::{nearest_correlation, smallest_eigenvalue};
use nalgebra::DMatrix;
use pcc_evaluate::probability::dependence::{CopulaError, GaussianCopula, LEAST_LEFT};
use pcc_evaluate::probability::inputs::{InputSpace, PearsonError, pearson_of_scores, scores_of_pearson};
use std::f64::consts::PI;
use thiserror::Error;
use toml::Spanned;

/// The kind of dependence there is.
pub(super) const KIND: &str = "gaussian-copula";

/// The smallest eigenvalue of the matrix that is proposed: what rounding to [`DIGITS`] takes is much less.
const PROPOSED: f64 = 1e-3;

/// Decimals of the correlations that are proposed.
const DIGITS: i32 = 5;

/// Inputs for which a matrix is proposed, at most: more pairs nobody pastes.
const MOST_PROPOSED: usize = 30;

/// What the correlations of a study are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Of the ranks of values: Spearman's ρ_s.
    Spearman,
    /// Of the values: Pearson's.
    Pearson,
}

impl Measure {
    /// Its key in study files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Spearman => "spearman",
            Self::Pearson => "pearson",
        }
    }

    /// The correlation of normal scores of two inputs, by position, that gives `value`.
    ///
    /// Of ranks of continuous variables it is 2 sin(π ρ_s/6), whatever their laws are (Kruskal 1958,
    /// <https://doi.org/10.1080/01621459.1958.10501481>).
    fn of_scores(self, inputs: &InputSpace, [one, other]: [usize; 2], value: f64) -> Result<f64, PearsonError> {
        let law = |input: usize| &inputs.inputs()[input].marginal;
        match self {
            Self::Spearman => Ok(2.0 * (PI * value / 6.0).sin()),
            Self::Pearson => scores_of_pearson(law(one), law(other), value),
        }
    }

    /// The way back.
    fn of_inputs(self, inputs: &InputSpace, [one, other]: [usize; 2], value: f64) -> f64 {
        let law = |input: usize| &inputs.inputs()[input].marginal;
        match self {
            Self::Spearman => 6.0 / PI * (0.5 * value).asin(),
            Self::Pearson => pearson_of_scores(law(one), law(other), value),
        }
    }
}

/// A Gaussian copula as a study gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct DependenceSettings {
    /// What its correlations are of.
    pub measure: Measure,
    /// Positions of two inputs and their correlation, in the order of the inputs; none is zero.
    pub pairs: Vec<(usize, usize, f64)>,
}

/// Why correlations of a study cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DependenceError {
    /// Two lists of correlations, or none.
    #[error("give one list of correlations, spearman (of ranks) or pearson (of values), like [[\"k\", \"c\", 0.6]]")]
    Lists,
    /// A name that no input has.
    #[error("there is no input {name}; the study has {known}")]
    UnknownInput {
        /// The name.
        name: String,
        /// The inputs.
        known: String,
    },
    /// An input with itself.
    #[error("{name} is correlated with itself; name two inputs")]
    WithItself {
        /// Its name.
        name: String,
    },
    /// A pair that stands twice.
    #[error("the correlation of {one} and {other} is given twice; keep one of them")]
    Twice {
        /// One input.
        one: String,
        /// The other.
        other: String,
    },
    /// No correlation.
    #[error("the correlation of {one} and {other} is {value:?}, but must be above -1 and below 1")]
    Value {
        /// One input.
        one: String,
        /// The other.
        other: String,
        /// Its value.
        value: f64,
    },
    /// A correlation that inputs with these laws cannot have.
    #[error(
        "the correlation of {one} and {other} is {value:?}, but with their laws it can only be between {least:.4} and \
         {largest:.4}; choose one in between, or give the correlation of ranks (spearman)"
    )]
    Impossible {
        /// One input.
        one: String,
        /// The other.
        other: String,
        /// Its value.
        value: f64,
        /// The least possible.
        least: f64,
        /// The largest possible.
        largest: f64,
    },
    /// Laws whose variance lies where values practically never are.
    #[error(
        "the correlation of {one} and {other} cannot be computed, because one of their laws is too wide; give the \
         correlation of ranks (spearman)"
    )]
    TooWide {
        /// One input.
        one: String,
        /// The other.
        other: String,
    },
    /// An input of single values, whose ranks have ties.
    #[error(
        "{name} takes single values, which have no such correlation; correlate inputs that take all values between"
    )]
    SingleValues {
        /// The input.
        name: String,
    },
    /// Correlations that contradict each other.
    #[error(
        "these correlations cannot hold together: the smallest eigenvalue of their matrix{}, but must be at least \
         {LEAST_LEFT:e}{}",
        found(eigenvalue),
        proposal(nearest)
    )]
    NotPositiveDefinite {
        /// The smallest eigenvalue of the matrix of normal scores; `None` if it was not found.
        eigenvalue: Option<f64>,
        /// The nearest that can, as the line of the study; `None` for very many inputs.
        nearest: Option<String>,
    },
    /// Too many inputs depend on each other.
    #[error("{0}")]
    TooMany(CopulaError),
    /// A method that takes inputs as independent.
    #[error(
        "fit.method \"{method}\" by quadrature takes inputs to be independent; choose a method by regression \
         (minimum-norm, stepwise, omp, auto, or gpc with solver = \"least-squares\"), or remove [dependence]"
    )]
    Quadrature {
        /// The method.
        method: &'static str,
    },
}

fn found(eigenvalue: &Option<f64>) -> String {
    let short = |value: f64| if value.abs() < 1e-3 { format!(" is {value:.1e}") } else { format!(" is {value:.4}") };
    eigenvalue.map_or_else(String::new, short)
}

fn proposal(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |line| format!(". The nearest that can: {line}"))
}

impl Lines<'_> {
    /// What the study says of dependence, if anything, and the inputs with it.
    pub(super) fn dependence(
        &self,
        raw: &Spanned<raw::Dependence>,
        inputs: InputSpace,
    ) -> Result<(Option<DependenceSettings>, InputSpace), StudyError> {
        let place = self.place("dependence", raw);
        let raw::Dependence { kind, spearman, pearson } = raw.get_ref();
        self.word("dependence.kind", kind, &[(KIND, ())])?;
        let (measure, list) = match (spearman, pearson) {
            (Some(list), None) => (Measure::Spearman, list),
            (None, Some(list)) => (Measure::Pearson, list),
            _ => return Err(StudyError::Dependence { place, cause: DependenceError::Lists.into() }),
        };
        let (mut pairs, mut of_scores) = (Vec::new(), Vec::new());
        for raw in list.get_ref() {
            let refused = |cause: DependenceError| StudyError::Dependence {
                place: self.place(format!("dependence.{}", measure.name()), raw),
                cause: cause.into(),
            };
            let (pair, score) = pair(measure, raw.get_ref(), &inputs, &pairs).map_err(refused)?;
            pairs.push(pair);
            of_scores.push((pair.0, pair.1, score));
        }
        pairs.retain(|pair| pair.2 != 0.0);
        if pairs.is_empty() {
            return Ok((None, inputs));
        }
        pairs.sort_by_key(|pair| (pair.0, pair.1));
        let place = self.place(format!("dependence.{}", measure.name()), list);
        let refused = |cause: DependenceError| StudyError::Dependence { place, cause: cause.into() };
        let inputs = with_copula(measure, inputs, &of_scores).map_err(refused)?;
        Ok((Some(DependenceSettings { measure, pairs }), inputs))
    }
}

/// Positions of the inputs of a pair in order, with their correlation and that of their scores. `known` are those
/// before it.
fn pair(
    measure: Measure,
    raw: &raw::Pair,
    inputs: &InputSpace,
    known: &[(usize, usize, f64)],
) -> Result<((usize, usize, f64), f64), DependenceError> {
    let raw::Pair(one, other, value) = raw;
    let position = |name: &String| {
        let names: Vec<String> = inputs.names().map(str::to_owned).collect();
        let unknown = || DependenceError::UnknownInput { name: name.clone(), known: alternatives(&names) };
        inputs.names().position(|known| known == name).ok_or_else(unknown)
    };
    let (first, second) = (position(one)?, position(other)?);
    if first == second {
        return Err(DependenceError::WithItself { name: one.clone() });
    }
    let (first, second) = (first.min(second), first.max(second));
    let (one, other) = (one.clone(), other.clone());
    if known.iter().any(|pair| (pair.0, pair.1) == (first, second)) {
        return Err(DependenceError::Twice { one, other });
    }
    // False for what is no number.
    let is_correlation = value.abs() < 1.0;
    if !is_correlation {
        return Err(DependenceError::Value { one, other, value: *value });
    }
    if let Some(input) = [first, second].map(|at| &inputs.inputs()[at]).into_iter().find(|it| it.marginal.is_discrete())
    {
        return Err(DependenceError::SingleValues { name: input.name.clone() });
    }
    match measure.of_scores(inputs, [first, second], *value) {
        Ok(score) => Ok(((first, second, *value), score)),
        Err(PearsonError::Impossible { least, largest }) => {
            Err(DependenceError::Impossible { one, other, value: *value, least, largest })
        }
        Err(PearsonError::TooWide) => Err(DependenceError::TooWide { one, other }),
    }
}

fn with_copula(
    measure: Measure,
    inputs: InputSpace,
    of_scores: &[(usize, usize, f64)],
) -> Result<InputSpace, DependenceError> {
    match GaussianCopula::new(inputs.dimension(), of_scores.iter().copied()) {
        Ok(copula) => Ok(inputs.clone().with_dependence(copula).unwrap_or(inputs)),
        Err(error @ CopulaError::TooMany { .. }) => Err(DependenceError::TooMany(error)),
        Err(_) => Err(contradiction(measure, &inputs, of_scores)),
    }
}

/// What is wrong with correlations that cannot hold together, and what could.
fn contradiction(measure: Measure, inputs: &InputSpace, of_scores: &[(usize, usize, f64)]) -> DependenceError {
    let mut members: Vec<usize> = of_scores.iter().flat_map(|pair| [pair.0, pair.1]).collect();
    members.sort_unstable();
    members.dedup();
    let position = |input: usize| members.partition_point(|&member| member < input);
    let mut matrix = DMatrix::identity(members.len(), members.len());
    for &(one, other, value) in of_scores {
        let (i, k) = (position(one), position(other));
        (matrix[(i, k)], matrix[(k, i)]) = (value, value);
    }
    let near = (members.len() <= MOST_PROPOSED).then(|| nearest_correlation(&matrix, PROPOSED)).flatten();
    let line = |near: DMatrix<f64>| {
        let scale = 10f64.powi(DIGITS);
        let names: Vec<&str> = inputs.names().collect();
        let mut pairs = Vec::new();
        for (i, &one) in members.iter().enumerate() {
            for (k, &other) in members.iter().enumerate().skip(i + 1) {
                let value = measure.of_inputs(inputs, [one, other], near[(i, k)]);
                let rounded = (value * scale).round() / scale;
                if rounded != 0.0 {
                    pairs.push(format!("[\"{}\", \"{}\", {rounded:?}]", names[one], names[other]));
                }
            }
        }
        format!("{} = [{}]", measure.name(), pairs.join(", "))
    };
    DependenceError::NotPositiveDefinite { eigenvalue: smallest_eigenvalue(&matrix), nearest: near.map(line) }
}

/// Refuses a fit by quadrature.
pub(super) fn refuse_quadrature(place: Place, method: &'static str) -> StudyError {
    StudyError::Dependence { place, cause: DependenceError::Quadrature { method }.into() }
}

#[cfg(test)]
mod tests;
