//! Guide lines, and the labels of the horizontal ones.

use super::layout::{Plane, Rectangle};
use super::notes::{ROW, draw_label, label_width};
use super::path::Path;
use super::{Axis, Chart, Guide, Marks, Scale};

/// Distance of a label to the ends of its line.
const DISTANCE: f64 = 5.0;

/// The guide lines.
pub(super) fn lines(chart: &Chart, plane: &Plane) -> String {
    let area = plane.area;
    let mut path = Path::default();
    for guide in &chart.guides {
        match guide {
            Guide::Vertical(value, _) => {
                if let Some(x) = plane.across(*value) {
                    path.move_to([x, area.top]).line_to([x, area.bottom()]);
                }
            }
            Guide::Horizontal(value, _) => {
                if let Some(y) = plane.along(*value) {
                    path.move_to([area.left, y]).line_to([area.right(), y]);
                }
            }
            Guide::Diagonal => diagonal(&mut path, chart, plane),
        }
    }
    let over_cells = chart.series.iter().any(|series| matches!(series.marks, Marks::Cells(_)));
    let halo = if over_cells { path.draw("chart-halo") } else { String::new() };
    halo + &path.draw("chart-guide")
}

/// The labels of horizontal lines, at an end where they hide the fewest data.
pub(super) fn labels(chart: &Chart, plane: &Plane) -> String {
    let mut taken: Vec<Rectangle> = Vec::new();
    let mut text = String::new();
    for guide in &chart.guides {
        let Guide::Horizontal(value, label) = guide else { continue };
        let visible = |y: &f64| *y >= plane.area.top && *y <= plane.area.bottom();
        let Some(y) = plane.along(*value).filter(visible).filter(|_| !label.is_empty()) else { continue };
        let hidden = |place: &Rectangle| {
            let labels = taken.iter().filter(|other| place.overlaps(other)).count();
            (labels, hidden_data(chart, plane, place))
        };
        let inside = |place: &Rectangle| place.top >= plane.area.top && place.bottom() <= plane.area.bottom();
        if let Some(place) = places(y, label, plane).into_iter().filter(inside).min_by_key(hidden) {
            text.push_str(&draw_label(label, [place.left, place.bottom() - 4.0]));
            taken.push(place);
        }
    }
    text
}

/// Above and below the line, at its right and at its left end.
fn places(y: f64, label: &str, plane: &Plane) -> [Rectangle; 4] {
    let width = label_width(label);
    let [left, right] = [plane.area.left + DISTANCE, plane.area.right() - DISTANCE - width];
    let place = |left, top| Rectangle { left, top, width, height: ROW };
    let [above, below] = [y - ROW - 1.0, y + 1.0];
    [place(right, above), place(right, below), place(left, above), place(left, below)]
}

/// How many points a label would hide.
fn hidden_data(chart: &Chart, plane: &Plane, place: &Rectangle) -> usize {
    let points = chart.series.iter().flat_map(|series| match &series.marks {
        Marks::Points(points) | Marks::Symbols(points, _) | Marks::Line(points) | Marks::Area(points) => {
            points.as_slice()
        }
        // A label hides cells wherever it is.
        Marks::Bars(_) | Marks::Cells(_) => &[],
    });
    points.filter_map(|point| plane.point(*point)).filter(|point| place.contains(*point)).count()
}

/// The line of equal values, which is curved where the scales differ.
fn diagonal(path: &mut Path, chart: &Chart, plane: &Plane) {
    let has_values = |axis: &Axis| !matches!(axis.scale, Scale::Categories(_));
    if !has_values(&chart.x) || !has_values(&chart.y) {
        return;
    }
    let steps = if chart.x.scale == chart.y.scale { 1 } else { 64 };
    let values = (0..=steps).map(|step| plane.x.value(f64::from(step) / f64::from(steps)));
    let mut started = false;
    for point in values.filter_map(|value| plane.point([value, value])) {
        if started {
            path.line_to(point)
        } else {
            path.move_to(point)
        };
        started = true;
    }
}

#[cfg(test)]
mod tests {
    use super::super::layout::{Insets, Layout};
    use super::super::{Color, Series};
    use super::*;

    #[test]
    fn labels_keep_out_of_the_data() {
        let cloud = (0..100).map(|index| [9.0 + f64::from(index % 10) / 10.0, f64::from(index) / 50.0 - 1.0]).collect();
        let chart = Chart {
            title: String::new(),
            description: String::new(),
            x: Axis::linear("").between(0.0, 10.0),
            y: Axis::linear("").between(-10.0, 10.0),
            series: vec![Series::new("", Color::Blue, Marks::Points(cloud))],
            guides: vec![Guide::Horizontal(0.0, "limit".to_string())],
        };
        let layout = Layout::new(&chart, false, Insets::default());
        let left = format!("x=\"{}\"", super::super::path::coordinate(layout.plane.area.left + DISTANCE));
        assert!(labels(&chart, &layout.plane).contains(&left));
    }
}
