//! From values to places on an axis.

use super::extent::Extent;
use super::{Axis, Scale};

/// Part of the range left free at each end that follows from the data.
const MARGIN: f64 = 0.04;

/// A range narrower than this, or than this part of its ends, has no distinct ticks.
const NARROWEST: f64 = 1e-305;
const NARROWEST_PART: f64 = 1e-12;

/// The smallest positive number.
const SMALLEST: f64 = 5e-324;

/// The range of an axis. On a logarithmic one the ends are decimal logarithms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mapping {
    pub low: f64,
    pub high: f64,
    logarithmic: bool,
    /// Whether the ends mean anything: neither data nor caller may have said.
    pub known: bool,
}

impl Mapping {
    /// The range the axis asks for, or else the one of the data.
    pub(super) fn new(axis: &Axis, extent: Option<Extent>) -> Self {
        let logarithmic = axis.scale == Scale::Logarithmic;
        let (found, (low, high)) = match &axis.scale {
            Scale::Categories(names) => (true, (-0.5, names.len().max(1) as f64 - 0.5)),
            Scale::Linear => (extent.is_some(), linear_range(axis.range, extent)),
            Scale::Logarithmic => (extent.is_some(), logarithmic_range(axis.range, extent)),
        };
        Self { low, high, logarithmic, known: found || axis.range.is_some() }
    }

    /// Where `value` is: 0 at the low end, 1 at the high one.
    pub(super) fn fraction(&self, value: f64) -> Option<f64> {
        let value = match self.logarithmic {
            true if value > 0.0 => value.log10(),
            true => return None,
            false => value,
        };
        value.is_finite().then(|| self.fraction_of_position(value))
    }

    /// As [`Mapping::fraction`], for a value that is already a logarithm where the axis has them.
    pub(super) fn fraction_of_position(&self, position: f64) -> f64 {
        // Differences of the ends themselves could overflow.
        let unit = self.low.abs().max(self.high.abs());
        (position / unit - self.low / unit) / (self.high / unit - self.low / unit)
    }

    /// The value at a fraction of the axis.
    pub(super) fn value(&self, fraction: f64) -> f64 {
        let position = self.low * (1.0 - fraction) + self.high * fraction;
        if self.logarithmic { 10f64.powf(position) } else { position }
    }
}

fn linear_range(wanted: Option<(f64, f64)>, extent: Option<Extent>) -> (f64, f64) {
    if let Some((one, other)) = wanted.filter(|(one, other)| one.is_finite() && other.is_finite()) {
        return widened(one.min(other), one.max(other));
    }
    let Some(extent) = extent else { return (0.0, 1.0) };
    let Extent { mut low, mut high, .. } = extent;
    if extent.from_zero {
        (low, high) = (low.min(0.0), high.max(0.0));
    }
    let (wide_low, wide_high) = widened(low, high);
    if (wide_low, wide_high) != (low, high) {
        return (wide_low, wide_high);
    }
    let margin = high * MARGIN - low * MARGIN;
    (
        if extent.is_edge(low) { low } else { (low - margin).max(f64::MIN) },
        if extent.is_edge(high) { high } else { (high + margin).min(f64::MAX) },
    )
}

/// The range itself, or a wider one around it if it is too narrow to draw.
pub(super) fn widened(low: f64, high: f64) -> (f64, f64) {
    let size = low.abs().max(high.abs());
    let half = high / 2.0 - low / 2.0;
    if half > size * NARROWEST_PART && half > NARROWEST {
        return (low, high);
    }
    let padding = if size > 1e-290 { size * 0.1 } else { 1.0 };
    ((low - padding).max(f64::MIN), (high + padding).min(f64::MAX))
}

fn logarithmic_range(wanted: Option<(f64, f64)>, extent: Option<Extent>) -> (f64, f64) {
    let positive = |value: f64| value.is_finite() && value > 0.0;
    let (low, high, margins) = match (wanted.filter(|(one, other)| positive(*one) && positive(*other)), extent) {
        (Some((one, other)), _) => (one.min(other), one.max(other), [0.0; 2]),
        (None, Some(extent)) => {
            let margin = |end| if extent.is_edge(end) { 0.0 } else { MARGIN };
            (extent.low, extent.high, [extent.low, extent.high].map(margin))
        }
        (None, None) => (1.0, 10.0, [0.0; 2]),
    };
    let (low, high) = (low.log10(), high.log10());
    let padding = |margin| if high - low < 1e-9 { 0.5 } else { (high - low) * margin };
    // Powers of ten beyond these are no numbers.
    ((low - padding(margins[0])).max(SMALLEST.log10()), (high + padding(margins[1])).min(f64::MAX.log10()))
}

/// Where the axis has `value`: its decimal logarithm on a logarithmic one.
pub(super) fn position(axis: &Axis, value: f64) -> f64 {
    if axis.scale == Scale::Logarithmic { value.log10() } else { value }
}

/// The position itself, or the nearest one of a number.
pub(super) fn limited(axis: &Axis, position: f64) -> f64 {
    match axis.scale {
        Scale::Logarithmic => position.clamp(SMALLEST.log10(), f64::MAX.log10()),
        _ => position.clamp(f64::MIN, f64::MAX),
    }
}

/// The value at a position, which the axis has a place for.
pub(super) fn value(axis: &Axis, position: f64) -> f64 {
    match axis.scale {
        Scale::Logarithmic => 10f64.powf(position).clamp(SMALLEST, f64::MAX),
        _ => position,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extent(low: f64, high: f64) -> Option<Extent> {
        Some(Extent { low, high, from_zero: false, filled: None })
    }

    #[test]
    fn equal_values_still_have_a_range() {
        for value in [0.0, 3.0, -3.0, 1e300, f64::MAX, f64::MIN, 1e-300, 5e-324] {
            for axis in [Axis::linear(""), Axis::logarithmic("")] {
                if value > 0.0 || axis.scale == Scale::Linear {
                    let mapping = Mapping::new(&axis, extent(value, value));
                    let fraction = mapping.fraction(value).unwrap();
                    assert!(mapping.low < mapping.high && (0.0..=1.0).contains(&fraction), "{value}: {mapping:?}");
                }
            }
        }
    }

    #[test]
    fn extreme_ranges_do_not_overflow() {
        let mapping = Mapping::new(&Axis::linear(""), extent(f64::MIN, f64::MAX));
        assert_eq!([f64::MIN, 0.0, f64::MAX].map(|value| mapping.fraction(value)), [Some(0.0), Some(0.5), Some(1.0)]);
        let tiny = Mapping::new(&Axis::linear("").between(0.0, 1e-300), None);
        assert_eq!(tiny.fraction(5e-301), Some(0.5));
    }

    #[test]
    fn ranges_work_in_either_order_and_impossible_ones_are_ignored() {
        let data = extent(1.0, 100.0);
        let [given, reversed] =
            [(2.0, 8.0), (8.0, 2.0)].map(|(a, b)| Mapping::new(&Axis::linear("").between(a, b), data));
        assert_eq!(given, reversed);
        assert_eq!(given.fraction(5.0), Some(0.5));
        let impossible = Mapping::new(&Axis::logarithmic("").between(0.0, 10.0), data);
        assert_eq!(impossible, Mapping::new(&Axis::logarithmic(""), data));
        assert_eq!(impossible.fraction(-1.0), None);
    }

    #[test]
    fn what_fills_its_place_has_no_margin() {
        let filled = Some([1.0, 9.0]);
        for axis in [Axis::linear(""), Axis::logarithmic("")] {
            let exact = Mapping::new(&axis, Some(Extent { low: 1.0, high: 9.0, from_zero: false, filled }));
            assert_eq!([1.0, 9.0].map(|end| exact.fraction(end)), [Some(0.0), Some(1.0)]);
            let beyond = Mapping::new(&axis, Some(Extent { low: 1.0, high: 10.0, from_zero: false, filled }));
            assert!(beyond.fraction(1.0) == Some(0.0) && beyond.fraction(10.0) < Some(1.0));
        }
    }

    #[test]
    fn values_and_fractions_are_inverse() {
        for axis in [Axis::linear(""), Axis::logarithmic("")] {
            let mapping = Mapping::new(&axis, extent(0.02, 500.0));
            for value in [0.02, 1.0, 30.0] {
                assert!((mapping.value(mapping.fraction(value).unwrap()) / value - 1.0).abs() < 1e-12);
            }
        }
    }
}
