//! Why there is no such law.

use std::borrow::Cow;
use thiserror::Error;

/// Why a distribution's parameters are unusable.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MarginalError {
    /// A bound is NaN or infinite.
    #[error("bounds [{}, {}] must be finite numbers", plain(lower), plain(upper))]
    NotFinite {
        /// Lower bound found.
        lower: f64,
        /// Upper bound found.
        upper: f64,
    },
    /// The interval is empty.
    #[error("lower ({}) is not below upper ({}); swap or widen them", plain(lower), plain(upper))]
    Inverted {
        /// Lower bound found.
        lower: f64,
        /// Upper bound found.
        upper: f64,
    },
    /// The interval is too narrow for its position, or too wide, to be told apart in double precision.
    #[error("the interval [{}, {}] is too narrow or too wide for double precision", plain(lower), plain(upper))]
    Unresolved {
        /// Lower bound found.
        lower: f64,
        /// Upper bound found.
        upper: f64,
    },
    /// A parameter is not what it has to be.
    #[error("{name} is {}, but must be {expected}", plain(value))]
    Parameter {
        /// Its name in study files.
        name: &'static str,
        /// What was found.
        value: f64,
        /// What it has to be.
        expected: Cow<'static, str>,
    },
    /// Parameters that follow from those that a study gives are not what they have to be.
    #[error("with {given}, {cause}")]
    Following {
        /// What the study gives, like `mean = 1 and cv = 0.1`.
        given: String,
        /// What is wrong.
        cause: Box<MarginalError>,
    },
    /// There is no such law.
    #[error("{found:?} is not known; choose one of {known}")]
    Unknown {
        /// Its name.
        found: String,
        /// Names of those there are.
        known: String,
    },
    /// A law has other parameters.
    #[error("a {law} law has {expected}")]
    Form {
        /// Its name.
        law: &'static str,
        /// What its parameters can be.
        expected: &'static str,
    },
    /// A share of nothing.
    #[error("{name} = {} is a share of {of}, which is 0; give {instead} instead", plain(value))]
    NoScatter {
        /// The key of the share.
        name: &'static str,
        /// The share.
        value: f64,
        /// The key of what it is a share of.
        of: &'static str,
        /// The keys to give.
        instead: &'static str,
    },
    /// Values without weights of their own.
    #[error("there are {values} values and {weights} weights; give one for each, or none")]
    Weights {
        /// Number of values.
        values: usize,
        /// Number of weights.
        weights: usize,
    },
    /// Levels that do not differ.
    #[error("all values are equal; an uncertain input has at least two that differ, and a certain one is a constant")]
    OneLevel,
    /// Too many single values.
    #[error("there are {found} different values, more than {most}; smooth them, or give their law")]
    Levels {
        /// What was found.
        found: usize,
        /// Most of them.
        most: usize,
    },
    /// Too few measured values.
    #[error("there are {found} values, but a law takes at least {least}; give a law with its parameters")]
    FewValues {
        /// What was found.
        found: usize,
        /// Least of them.
        least: usize,
    },
    /// A measured value beyond the bounds of its law.
    #[error("{} was measured, but lies beyond lower or upper; move the bound or remove the value", plain(value))]
    BeyondBounds {
        /// The value.
        value: f64,
    },
    /// A law has one kind of polynomials.
    #[error("a {law} law leaves no choice of polynomials; remove the key")]
    NoChoice {
        /// Its name.
        law: &'static str,
    },
    /// A law's quantiles cannot be computed to all digits.
    #[error("{} cannot be resolved in double precision; {}", unresolved(law)[0], unresolved(law)[1])]
    Shape {
        /// Its name.
        law: &'static str,
    },
    /// The bounds of a truncated law leave next to nothing.
    #[error("lower and upper leave {share:e} of the probability; move them, or the law")]
    NothingLeft {
        /// What is left.
        share: f64,
    },
}

impl MarginalError {
    /// A parameter that is not what it has to be.
    pub(super) fn parameter(name: &'static str, value: f64, expected: impl Into<Cow<'static, str>>) -> Self {
        Self::Parameter { name, value, expected: expected.into() }
    }
}

/// What is not resolved, and what to do.
fn unresolved(law: &str) -> [String; 2] {
    match law {
        "data" => ["the law of these values".to_owned(), "leave out values far from all others".to_owned()],
        "discrete" => ["a law of these values".to_owned(), "bring them and their weights closer together".to_owned()],
        law => [format!("a {law} law with these parameters"), "move them away from extremes".to_owned()],
    }
}

/// A number as short as people write it.
pub(super) fn plain(value: &f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}
