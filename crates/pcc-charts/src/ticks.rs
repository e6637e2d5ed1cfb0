//! Where an axis has ticks, and what they say.

use super::numbers::{decimal, power_of_ten, scientific};
use super::scale::Mapping;
use super::{Axis, Scale};

/// A tick on an axis.
#[derive(Debug, PartialEq)]
pub(super) struct Tick {
    /// Place as a fraction of the axis.
    pub fraction: f64,
    /// What it says; minor ticks say nothing.
    pub label: Option<String>,
}

/// The ticks of an axis, from its low end to its high one.
pub(super) fn ticks(axis: &Axis, mapping: &Mapping) -> Vec<Tick> {
    let mut ticks = match &axis.scale {
        _ if !mapping.known => Vec::new(),
        Scale::Linear => linear(mapping.low, mapping.high).into_iter().map(|tick| tick.on(mapping)).collect(),
        Scale::Logarithmic => logarithmic(mapping),
        Scale::Categories(names) => {
            let place = |index: usize| mapping.fraction(index as f64).unwrap_or_default();
            let tick = |(index, name): (usize, &String)| Tick { fraction: place(index), label: Some(name.clone()) };
            names.iter().enumerate().map(tick).collect()
        }
    };
    ticks.retain(|tick| (-1e-9..=1.0 + 1e-9).contains(&tick.fraction));
    ticks.sort_by(|one, other| one.fraction.total_cmp(&other.fraction));
    ticks
}

/// A round value and how it is written.
#[derive(Debug, PartialEq)]
struct Round {
    value: f64,
    label: String,
}

impl Round {
    fn on(self, mapping: &Mapping) -> Tick {
        Tick { fraction: mapping.fraction(self.value).unwrap_or(f64::NAN), label: Some(self.label) }
    }
}

/// Multiples of 1, 2 or 5 × 10^k between the ends: four to seven where such steps allow it, else near that.
fn linear(low: f64, high: f64) -> Vec<Round> {
    let rough = high / 5.0 - low / 5.0;
    if !(rough.is_finite() && rough > f64::MIN_POSITIVE) {
        return Vec::new();
    }
    let power = rough.log10().floor() as i32;
    let steps = [(5.0, power - 1), (1.0, power), (2.0, power), (5.0, power), (1.0, power + 1)];
    // A little slack, so that an end which is a tick but for rounding counts as one.
    let first_and_last = |(digit, power): (f64, i32)| {
        let step = digit * 10f64.powi(power);
        ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor())
    };
    let off_target = |step: &(f64, i32)| {
        let (first, last) = first_and_last(*step);
        ((last - first + 1.0) - 5.5).abs()
    };
    let best = steps.into_iter().min_by(|one, other| off_target(one).total_cmp(&off_target(other)));
    let Some((digit, power)) = best else { return Vec::new() };
    let (first, last) = first_and_last((digit, power));
    let count = (last - first) as usize + 1;
    let multiples: Vec<f64> = (0..count.min(12)).map(|index| (first + index as f64) * digit).collect();
    written(&multiples, power)
}

/// The numbers `multiples` × 10^`power`, all with the same decimals and the same power of ten.
fn written(multiples: &[f64], power: i32) -> Vec<Round> {
    let largest = multiples.iter().fold(0.0f64, |largest, multiple| largest.max(multiple.abs()));
    // The slack keeps 1000 from having the logarithm 2.999….
    let top = if largest > 0.0 { (largest.log10() + 1e-12).floor() as i32 + power } else { power };
    let label = |multiple: f64| {
        if (-3..6).contains(&top) {
            decimal(multiple * 10f64.powi(power), usize::try_from(-power).unwrap_or(0))
        } else {
            scientific(multiple * 10f64.powi(power - top), usize::try_from(top - power).unwrap_or(0), top)
        }
    };
    multiples.iter().map(|&multiple| Round { value: multiple * 10f64.powi(power), label: label(multiple) }).collect()
}

/// Powers of ten; over less than three of them also their doubles and fivefolds; over a part of one linear ticks.
fn logarithmic(mapping: &Mapping) -> Vec<Tick> {
    let inside = |position: f64| position > mapping.low - 1e-9 && position < mapping.high + 1e-9;
    let powers = mapping.low.floor() as i32..=mapping.high.ceil() as i32;
    let decades: Vec<i32> = powers.clone().filter(|&power| inside(f64::from(power))).collect();
    let detailed = powers.clone().flat_map(|power| [1, 2, 5].map(|digit| (digit, power)));
    let stride = stride(decades.len());
    let labelled: Vec<(i32, i32)> = if decades.len() >= 3 {
        decades.iter().filter(|&power| power % stride == 0).map(|&power| (1, power)).collect()
    } else {
        detailed.filter(|&(digit, power)| inside(logarithm(digit, power))).collect()
    };
    if decades.len() < 3 && labelled.len() < 3 {
        let rounds = linear(mapping.value(0.0), mapping.value(1.0));
        return rounds.into_iter().map(|round| round.on(mapping)).collect();
    }
    // Minor ticks show that the scale is logarithmic; between labels some decades apart they are the decades.
    let digits: &[i32] = match stride {
        1 => &[1, 2, 3, 4, 5, 6, 7, 8, 9],
        2..=10 => &[1],
        _ => &[],
    };
    let minor = powers.flat_map(|power| digits.iter().map(move |&digit| (digit, power)));
    let minor = minor.filter(|tick| !labelled.contains(tick)).map(|(digit, power)| (digit, power, None));
    let plain = decades.len() < 3 && labelled.iter().all(|(_, power)| (-3..6).contains(power));
    let major = labelled.iter().map(|&(digit, power)| (digit, power, Some(power_label(digit, power, plain))));
    let tick = |(digit, power, label)| Tick { fraction: mapping.fraction_of_position(logarithm(digit, power)), label };
    major.chain(minor).map(tick).collect()
}

/// The round number of decades between labels that leaves at most seven of them.
fn stride(decades: usize) -> i32 {
    [1, 2, 5, 10, 20, 50].into_iter().find(|&stride| decades <= 7 * stride).unwrap_or(100) as i32
}

fn logarithm(digit: i32, power: i32) -> f64 {
    f64::from(digit).log10() + f64::from(power)
}

fn power_label(digit: i32, power: i32, plain: bool) -> String {
    match digit {
        _ if plain => decimal(f64::from(digit) * 10f64.powi(power), usize::try_from(-power).unwrap_or(0)),
        1 => power_of_ten(power),
        _ => scientific(f64::from(digit), 0, power),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        ticks(axis, &Mapping::new(axis, None)).into_iter().filter_map(|tick| tick.label).collect()
    }

    #[test]
    fn ticks_are_round_numbers_inside_the_range() {
        let ends = [0.0, 1.0, -7.3, 0.037, 12_345.6, -9.9e8, 3e-7, 1e300, -1e300, f64::MAX, 1e-300];
        for (low, high) in ends.iter().flat_map(|&low| ends.map(|high| (low, high))).filter(|(low, high)| low < high) {
            let rounds = linear(low, high);
            assert!((3..=8).contains(&rounds.len()), "{low} to {high}: {rounds:?}");
            let step = rounds[1].value / 2.0 - rounds[0].value / 2.0;
            let digit = format!("{:.0e}", step * 2.0);
            assert!(["1e", "2e", "5e"].iter().any(|start| digit.starts_with(start)), "{low} to {high}: {digit}");
            let slack = step * 1e-6;
            assert!(rounds.iter().all(|round| round.value >= low - slack && round.value <= high + slack));
        }
    }

    #[test]
    fn labels_have_no_rounding_noise() {
        assert_eq!(labels(&Axis::linear("").between(0.0, 0.55)), ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(labels(&Axis::linear("").between(-21.0, 21.0)), ["−20", "−10", "0", "10", "20"]);
        let large = labels(&Axis::linear("").between(0.0, 3.1e6));
        assert_eq!(large[..2], ["0", "0.5\u{2009}×\u{2009}10⁶"]);
    }

    #[test]
    fn logarithmic_axes_have_powers_and_minor_ticks() {
        let axis = Axis::logarithmic("").between(1e-3, 1.0);
        assert_eq!(labels(&axis), ["10⁻³", "10⁻²", "10⁻¹", "10⁰"]);
        let all = ticks(&axis, &Mapping::new(&axis, None));
        assert_eq!(all.iter().filter(|tick| tick.label.is_none()).count(), 3 * 8);
        assert!(all.is_sorted_by(|one, other| one.fraction < other.fraction));
    }

    #[test]
    fn short_logarithmic_axes_have_labels_too() {
        assert_eq!(labels(&Axis::logarithmic("").between(0.9, 21.0)), ["1", "2", "5", "10", "20"]);
        assert_eq!(labels(&Axis::logarithmic("").between(2.0, 2.5)), ["2.0", "2.1", "2.2", "2.3", "2.4", "2.5"]);
        assert!((3..=7).contains(&labels(&Axis::logarithmic("").between(1e-300, 1e300)).len()));
    }
}
