//! Modes along an input as a picture: a Campbell diagram above, growth rates below.

use super::charts::{color, short};
use super::modes::{AlongReport, ModeReport, ModesReport};
use pcc_charts::{Axis, Chart, Guide, Marks, Series, sheet};

/// Frequencies and growth rates over the input that varies, as an SVG file; nothing where none does.
pub fn modes_chart(report: &ModesReport) -> String {
    let Some(along) = &report.along else { return String::new() };
    let charts = [
        chart(along, "Frequencies", "Im λ/2π in Hz", |mode| mode.frequency_hz, |mode| mode.im != 0.0, Vec::new()),
        chart(
            along,
            "Growth rates",
            "Re λ in 1/s",
            |mode| mode.re,
            |_| true,
            vec![Guide::Horizontal(0.0, "stability limit".to_owned())],
        ),
    ];
    sheet(&format!("Modes of {}", report.study), &report.verdict, &charts, 1)
}

fn chart(
    along: &AlongReport,
    title: &str,
    axis: &str,
    part: fn(&ModeReport) -> f64,
    is_drawn: fn(&ModeReport) -> bool,
    guides: Vec<Guide>,
) -> Chart {
    let line = |(number, name): (usize, &String)| {
        let of_mode = along.points.iter().filter_map(|point| {
            let mode = point.modes.iter().flatten().find(|mode| mode.name == *name && is_drawn(mode))?;
            Some([short(point.value), short(part(mode))])
        });
        let points: Vec<[f64; 2]> = of_mode.collect();
        let title = if name.starts_with("real_") { name.clone() } else { format!("mode {name}") };
        (!points.is_empty()).then(|| Series::new(title, color(number), Marks::Line(points)))
    };
    let title = format!("{title} over {}", along.input);
    Chart {
        description: format!("{title}, of the model; modes are followed by their eigenvectors."),
        title,
        x: Axis::linear(along.title.clone()),
        y: Axis::linear(axis),
        series: along.names().iter().enumerate().filter_map(line).collect(),
        guides,
    }
}
