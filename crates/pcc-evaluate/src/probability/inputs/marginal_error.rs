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
    #[error("{} has {expected}; {complaint}", a_law(law))]
    Form {
        /// Its name.
        law: &'static str,
        /// What its parameters can be.
        expected: &'static str,
        /// Which of those that are given do not belong to it, or which are missing.
        complaint: String,
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
    #[error("{} leaves no choice of polynomials; remove the key", a_law(law))]
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
    /// A law's values do not differ in enough digits.
    #[error(
        "the standard deviation of {} is {share:.1e} of {of}, less than double precision resolves ({least:.1e}); {}",
        if *law == "data" { "these values".to_owned() } else { format!("this {law} law") },
        nearer(law)
    )]
    Narrow {
        /// Its name.
        law: &'static str,
        /// Standard deviation, as a share of what is told next.
        share: f64,
        /// The mean, or its distance from a bound.
        of: &'static str,
        /// The least share that is resolved.
        least: f64,
    },
    /// The bounds of a truncated law leave next to nothing.
    #[error(
        "{given} leave{} {} of the probability, but at least {least:e} must be left; move the bound, or the law",
        if given.contains(" and ") { "" } else { "s" },
        if *share > 0.0 { format!("{share:.1e}") } else { "nothing".to_owned() }
    )]
    NothingLeft {
        /// The bounds that are given, like `lower = 5`.
        given: String,
        /// What is left.
        share: f64,
        /// What must be left at least.
        least: f64,
    },
}

impl MarginalError {
    /// A parameter that is not what it has to be.
    pub(super) fn parameter(name: &'static str, value: f64, expected: impl Into<Cow<'static, str>>) -> Self {
        Self::Parameter { name, value, expected: expected.into() }
    }
}

/// The law with its article.
pub(super) fn a_law(name: &str) -> String {
    format!("{} {name} law", if name.starts_with(['a', 'e', 'i', 'o']) { "an" } else { "a" })
}

/// What is not resolved, and what to do.
fn unresolved(law: &str) -> [String; 2] {
    match law {
        "data" => ["the law of these values".to_owned(), "leave out values far from all others".to_owned()],
        "discrete" => ["a law of these values".to_owned(), "bring them and their weights closer together".to_owned()],
        law => [format!("{} with these parameters", a_law(law)), "move them away from extremes".to_owned()],
    }
}

/// What to do with a law that is too far from zero.
fn nearer(law: &str) -> String {
    let what = if law == "data" { "them" } else { "its values" };
    let constant = format!("subtract a constant from {what}, which the model adds");
    match law {
        "data" => constant,
        "normal" => format!("leave out the bounds, or {constant}"),
        _ => format!("take a normal law, or {constant}"),
    }
}

/// A number as short as people write it.
pub(super) fn plain(value: &f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}
