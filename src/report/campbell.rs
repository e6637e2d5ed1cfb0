//! A Campbell diagram: frequencies of modes over an input, such as a speed, with the bands that the others leave open.

use super::charts::short;
use pcc_charts::{Axis, Chart, Color, Marks, Series, Symbol, sheet};
use pcc_evaluate::probability::inputs::Input;
use std::f64::consts::TAU;

/// A mode along the input.
#[derive(Debug, Clone, PartialEq)]
pub struct CampbellMode {
    /// Its number.
    pub mode: usize,
    /// One for each value of the input.
    pub points: Vec<CampbellPoint>,
}

/// A mode at one value of the input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CampbellPoint {
    /// Lower end of the band, median and upper end of its frequency, in Hz; not finite where it does not oscillate.
    pub frequency: [f64; 3],
    /// Share of samples in which it is unstable.
    pub unstable_share: f64,
}

/// Units of a speed of rotation, and what one of them is in Hz.
const SPEEDS: [(&str, f64); 5] =
    [("rpm", 1.0 / 60.0), ("1/min", 1.0 / 60.0), ("rad/s", 1.0 / TAU), ("Hz", 1.0), ("1/s", 1.0)];

/// Red and gray say something else.
const COLORS: [Color; 5] = [Color::Blue, Color::Green, Color::Orange, Color::Purple, Color::Teal];

/// Frequencies of modes over `values` of `input`, as an SVG file. If the unit of the input is one of speed, a line
/// shows where modes meet the frequency of rotation.
pub fn campbell_chart(study: &str, input: &Input, values: &[f64], modes: &[CampbellMode]) -> String {
    let over = |mode: &CampbellMode, part: &dyn Fn(&CampbellPoint) -> f64| -> Vec<[f64; 2]> {
        values.iter().zip(&mode.points).map(|(&x, point)| [short(x), short(part(point))]).collect()
    };
    let mut series = Vec::new();
    for (number, mode) in modes.iter().enumerate() {
        let lines = [0, 1, 2].map(|k| Marks::Line(over(mode, &|point| point.frequency[k])));
        let name = format!("mode {}", mode.mode);
        series.extend(lines.map(|line| Series::new(name.clone(), COLORS[number % COLORS.len()], line)));
    }
    let of_speed = SPEEDS.iter().find(|(unit, _)| input.description.unit() == Some(*unit));
    if let Some((_, hertz)) = of_speed {
        let line = values.iter().map(|&x| [short(x), short(x * hertz)]).collect();
        series.push(Series::new("once per revolution", Color::Gray, Marks::Line(line)));
    }
    let is_marked = |point: &CampbellPoint| point.unstable_share > 0.5;
    let marked = |mode| over(mode, &|point| if is_marked(point) { point.frequency[1] } else { f64::NAN });
    let marked: Vec<[f64; 2]> = modes.iter().flat_map(marked).filter(|[_, y]| y.is_finite()).collect();
    if !marked.is_empty() {
        let name = "mostly unstable";
        series.push(Series::new(name, Color::Red, Marks::Symbols(marked, Symbol::Circle)));
    }
    let highest = modes.iter().flat_map(|mode| &mode.points).map(|point| point.frequency[2]).fold(0.0, f64::max);
    // The line of rotation begins at zero, and may leave the modes far below.
    let is_bounded = of_speed.is_some() && highest > 0.0 && highest.is_finite();
    let y = Axis::linear("frequency, Hz");
    let chart = Chart {
        title: format!("{study}: frequencies over {}", input.name),
        description: format!(
            "Frequency of each mode over {}: its median, and the band that the other inputs leave open.",
            input.name
        ),
        x: Axis::linear(input.title()),
        y: if is_bounded { y.between(0.0, 1.05 * highest) } else { y },
        series,
        guides: Vec::new(),
    };
    sheet("", &chart.description.clone(), &[chart], 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::probability::inputs::{Description, Marginal, Uniform};

    fn drawn(unit: Option<&str>, unstable_share: f64) -> String {
        let mut input = Input::new("n", Marginal::Uniform(Uniform::new(0.0, 6000.0).unwrap()));
        if let Some(unit) = unit {
            input.description = Description::default().with_unit(unit).unwrap();
        }
        let point = |hertz: f64| CampbellPoint { frequency: [hertz - 1.0, hertz, hertz + 1.0], unstable_share };
        let overdamped = CampbellPoint { frequency: [f64::NAN; 3], unstable_share };
        let modes = [
            CampbellMode { mode: 1, points: vec![point(20.0), point(18.0)] },
            CampbellMode { mode: 7, points: vec![point(40.0), overdamped] },
        ];
        campbell_chart("rotor", &input, &[0.0, 6000.0], &modes)
    }

    #[test]
    fn modes_have_bands_and_rotation_a_line_where_the_unit_is_one_of_speed() {
        for (unit, has_line) in [(Some("rpm"), true), (Some("rad/s"), true), (Some("N/m"), false), (None, false)] {
            let svg = drawn(unit, 0.0);
            assert_eq!(svg.contains("once per revolution"), has_line, "{unit:?}");
            assert!(svg.contains("mode 1") && svg.contains("mode 7") && !svg.contains("mostly unstable"));
        }
    }

    #[test]
    fn points_are_marked_where_more_than_half_is_unstable() {
        assert!(drawn(None, 0.51).contains("mostly unstable") && !drawn(None, 0.5).contains("mostly unstable"));
    }
}
