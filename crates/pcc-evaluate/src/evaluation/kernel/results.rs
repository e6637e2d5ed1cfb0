//! What a plan finds at the points of a block.

use super::lanes::Lanes;

/// Results at the points of a block, one lane per point.
#[derive(Debug, Clone, PartialEq)]
pub struct Results {
    /// Values of all components, by id.
    pub components: Vec<Lanes>,
    /// Re λ of every eigenvalue, in the order of [`crate::surrogate::Surrogate::labels`], in 1/s.
    pub growth_rates: Vec<Lanes>,
    /// Im λ of every eigenvalue, in rad/s.
    pub angular_frequencies: Vec<Lanes>,
    /// max Re λ, in 1/s; NaN where a part of an eigenvalue is not finite.
    pub max_re: Lanes,
    /// The largest excess ([`crate::components::Margin`]), in 1/s: max Re λ without a margin; 0 where it cannot be told
    /// from zero.
    pub excess: Lanes,
    /// Im λ of the eigenvalue with the largest excess, in rad/s: 0 where it is real. Of surrogates whose eigenvalues
    /// are all modes that oscillate it is not looked for, and not 0.
    pub top_frequency: Lanes,
}
