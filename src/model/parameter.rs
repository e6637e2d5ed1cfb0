//! Named parameters of a model.

/// Which values make physical sense.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Range {
    /// Greater than zero.
    Positive,
    /// Zero or greater.
    NonNegative,
}

impl Range {
    /// Whether `value` is finite and in range.
    pub fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Positive => value > 0.0,
                Self::NonNegative => value >= 0.0,
            }
    }

    /// The range in words, to follow "must be".
    pub fn describe(self) -> &'static str {
        match self {
            Self::Positive => "greater than zero",
            Self::NonNegative => "zero or greater",
        }
    }
}

/// One parameter of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name in study files.
    pub name: &'static str,
    /// Unit, empty if dimensionless.
    pub unit: &'static str,
    /// Nominal value, in `unit`.
    pub nominal: f64,
    /// Values that make sense.
    pub range: Range,
    /// What it is.
    pub meaning: &'static str,
}
