//! Bits to the open unit interval.

/// Bits of resolution of a uniform number: the midpoints of 2⁵² equal cells are exact in double precision.
pub const UNIT_BITS: u32 = 52;

/// The midpoint (cell + ½)/2⁵² of a cell: exact, never 0 and never 1, symmetric about ½.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::random::{UNIT_BITS, unit_interval};
/// assert!(unit_interval(0) > 0.0);
/// assert!(unit_interval((1 << UNIT_BITS) - 1) < 1.0);
/// ```
#[inline]
pub fn unit_interval(cell: u64) -> f64 {
    // 1 + cell/2⁵² by its bits, less 1 − 2⁻⁵³: both are exact, and vector instructions on every processor.
    f64::from_bits(1f64.to_bits() | cell) - (1.0 - 0.5 * f64::EPSILON)
}
