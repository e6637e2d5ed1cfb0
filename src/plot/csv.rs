//! The data of a chart as comma-separated values.

use super::{Axis, Chart, Marks, Scale};
use std::borrow::Cow;

/// One line per point or bar, after a header.
pub(super) fn write(chart: &Chart) -> String {
    let has_interval =
        |marks: &Marks| matches!(marks, Marks::Bars(bars) if bars.iter().any(|bar| bar.interval.is_some()));
    let intervals = chart.series.iter().any(|series| has_interval(&series.marks));
    let mut text = String::new();
    push_row(&mut text, &["series", "x", "y", "lower", "upper"][..if intervals { 5 } else { 3 }]);
    for series in &chart.series {
        let mut push = |x: String, y: String, interval: Option<(f64, f64)>| {
            let [lower, upper] = interval.map_or_else(Default::default, |(lower, upper)| [lower, upper].map(number));
            push_row(&mut text, &[series.name.as_str(), &x, &y, &lower, &upper][..if intervals { 5 } else { 3 }]);
        };
        match &series.marks {
            Marks::Points(points) | Marks::Symbols(points, _) | Marks::Line(points) | Marks::Area(points) => {
                for point in points {
                    push(value(&chart.x, point[0]), value(&chart.y, point[1]), None);
                }
            }
            Marks::Bars(bars) => {
                for bar in bars {
                    push(value(&chart.x, bar.value), value(&chart.y, bar.category as f64), bar.interval);
                }
            }
        }
    }
    text
}

/// The name of a category, or else the number.
fn value(axis: &Axis, value: f64) -> String {
    let whole = value >= 0.0 && value.fract() == 0.0;
    match &axis.scale {
        Scale::Categories(names) if whole => names.get(value as usize).cloned().unwrap_or_else(|| number(value)),
        _ => number(value),
    }
}

/// The shortest text that reads back as the same number.
fn number(value: f64) -> String {
    let plain = value == 0.0 || !value.is_finite() || (1e-5..1e16).contains(&value.abs());
    if plain { value.to_string() } else { format!("{value:e}") }
}

fn push_row(text: &mut String, fields: &[&str]) {
    for (index, field) in fields.iter().enumerate() {
        if index > 0 {
            text.push(',');
        }
        text.push_str(&quoted(field));
    }
    text.push_str("\r\n");
}

fn quoted(field: &str) -> Cow<'_, str> {
    if field.contains([',', '"', '\r', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\"")).into()
    } else {
        field.into()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Bar, Color, Series};
    use super::*;

    #[test]
    fn bars_have_category_names_and_intervals() {
        let bar = |category, interval| Bar { category, value: 0.5, interval };
        let chart = Chart {
            title: String::new(),
            description: String::new(),
            x: Axis::linear(""),
            y: Axis::categories("", vec!["a, \"b\"".to_string()]),
            series: vec![Series::new("s", Color::Red, Marks::Bars(vec![bar(0, Some((0.25, 1e300))), bar(7, None)]))],
            guides: Vec::new(),
        };
        let expected = "series,x,y,lower,upper\r\ns,0.5,\"a, \"\"b\"\"\",0.25,1e300\r\ns,0.5,7,,\r\n";
        assert_eq!(write(&chart), expected);
    }

    #[test]
    fn numbers_read_back_as_they_were() {
        for value in [0.1 + 0.2, -0.0, 1e300, 5e-324, f64::MAX, 123_456.789, f64::INFINITY] {
            assert_eq!(number(value).parse(), Ok(value));
        }
    }
}
