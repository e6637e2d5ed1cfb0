//! The data of a chart as comma-separated values.

use super::{Axis, Chart, Marks, Scale};

/// One line per point or bar, after a header.
pub(super) fn write(chart: &Chart) -> String {
    let has_interval =
        |marks: &Marks| matches!(marks, Marks::Bars(bars) if bars.iter().any(|bar| bar.interval.is_some()));
    let intervals = chart.series.iter().any(|series| has_interval(&series.marks));
    let columns = if intervals { 5 } else { 3 };
    let mut writer = csv::WriterBuilder::new().terminator(csv::Terminator::CRLF).from_writer(Vec::new());
    // Writing to memory cannot fail.
    let mut push_row = |fields: [&str; 5]| drop(writer.write_record(&fields[..columns]));
    push_row(["series", "x", "y", "lower", "upper"]);
    for series in &chart.series {
        let mut push = |x: String, y: String, interval: Option<(f64, f64)>| {
            let [lower, upper] = interval.map_or_else(Default::default, |(lower, upper)| [lower, upper].map(number));
            push_row([series.name.as_str(), &x, &y, &lower, &upper]);
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
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
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
