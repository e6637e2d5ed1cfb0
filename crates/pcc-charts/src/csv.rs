//! The data of a chart as comma-separated values.

use super::{Axis, Chart, Marks, Scale};

/// One line per point, bar or cell, after a header.
pub(super) fn write(chart: &Chart) -> String {
    let has_interval =
        |marks: &Marks| matches!(marks, Marks::Bars(bars) if bars.iter().any(|bar| bar.interval.is_some()));
    let intervals = chart.series.iter().any(|series| has_interval(&series.marks));
    let shares = chart.series.iter().any(|series| matches!(series.marks, Marks::Cells(_)));
    let written = [true, true, true, shares, intervals, intervals];
    let mut writer = csv::WriterBuilder::new().terminator(csv::Terminator::CRLF).from_writer(Vec::new());
    // Writing to memory cannot fail.
    let mut push_row = |fields: [&str; 6]| {
        let fields = fields.into_iter().zip(written).filter_map(|(field, written)| written.then_some(field));
        drop(writer.write_record(fields));
    };
    push_row(["series", "x", "y", "value", "lower", "upper"]);
    for series in &chart.series {
        let name = series.name.as_str();
        let mut push = |x: String, y: String, interval: Option<(f64, f64)>| {
            let [lower, upper] = interval.map_or_else(Default::default, |(lower, upper)| [lower, upper].map(number));
            push_row([name, &x, &y, "", &lower, &upper]);
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
            Marks::Cells(cells) => {
                let rows = cells.values.chunks(cells.x.len().max(1));
                for (centre, row) in cells.y.iter().zip(rows) {
                    let y = value(&chart.y, *centre);
                    for (x, share) in cells.x.iter().zip(row) {
                        push_row([name, &value(&chart.x, *x), &y, &number(*share), "", ""]);
                    }
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
    use super::super::{Bar, Cells, Color, Series};
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
    fn every_cell_that_has_a_value_has_a_line() {
        let cells = Cells { x: vec![1.0, 2.0], y: vec![0.0, 1.0, 2.0], values: vec![0.25, f64::NAN, 1.0] };
        let chart = Chart {
            title: String::new(),
            description: String::new(),
            x: Axis::linear(""),
            y: Axis::categories("", vec!["a".to_string(), "b".to_string()]),
            series: vec![
                Series::new("s", Color::Red, Marks::Cells(cells)),
                Series::new("p", Color::Red, Marks::Points(vec![[3.0, 1.0]])),
            ],
            guides: Vec::new(),
        };
        let expected = "series,x,y,value\r\ns,1,a,0.25\r\ns,2,a,NaN\r\ns,1,b,1\r\np,3,b,\r\n";
        assert_eq!(write(&chart), expected);
    }

    #[test]
    fn numbers_read_back_as_they_were() {
        for value in [0.1 + 0.2, -0.0, 1e300, 5e-324, f64::MAX, 123_456.789, f64::INFINITY] {
            assert_eq!(number(value).parse(), Ok(value));
        }
    }
}
