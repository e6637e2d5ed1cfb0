//! Named parameters of a model.

use pcc_evaluate::probability::inputs::Marginal;

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

    /// Whether a law gives such values: all of an interval, of others all but a billionth on either side.
    pub fn holds_nearly_all_of(self, marginal: &Marginal) -> bool {
        const ALMOST_ALL: f64 = 1.0 - 2e-9;
        let ends = match marginal {
            Marginal::Uniform(law) => [law.lower(), law.upper()],
            _ => [-ALMOST_ALL, ALMOST_ALL].map(|centred| marginal.at_centred_probability(centred)),
        };
        ends.into_iter().all(|end| self.contains(end))
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
