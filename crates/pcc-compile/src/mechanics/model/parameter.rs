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
    /// Whether `value` is in range. Magnitudes beyond 10^±30 of any unit are mistakes that would overflow.
    pub fn contains(self, value: f64) -> bool {
        let smallest = match self {
            Self::Positive => 1.0 / LARGEST,
            Self::NonNegative => 0.0,
        };
        (smallest..=LARGEST).contains(&value)
    }

    /// The range in words, to follow "must be".
    pub fn describe(self) -> &'static str {
        match self {
            Self::Positive => "greater than zero (1e-30 to 1e30)",
            Self::NonNegative => "zero or greater (up to 1e30)",
        }
    }
}

/// No quantity of a machine is larger in SI units.
const LARGEST: f64 = 1e30;

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
