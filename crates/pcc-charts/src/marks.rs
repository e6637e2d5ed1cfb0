//! The data themselves.

use super::extent::drawable_bar;
use super::layout::Plane;
use super::path::{Path, tenths};
use super::{Bar, Chart, Color, Marks, Symbol, cells};
use std::collections::HashSet;

/// Marks this far outside of the plot area would not be seen.
const OUTSIDE: f64 = 8.0;
/// Part of the place of a category that its bars take, and the thickest bar.
const BAND: f64 = 0.72;
const THICKEST: f64 = 18.0;
/// Half the length of the end of a whisker.
const WHISKER: f64 = 3.0;

/// Class of a colour in the style sheet.
pub(super) fn class(color: Color) -> &'static str {
    match color {
        Color::Blue => "chart-blue",
        Color::Red => "chart-red",
        Color::Green => "chart-green",
        Color::Orange => "chart-orange",
        Color::Purple => "chart-purple",
        Color::Teal => "chart-teal",
        Color::Gray => "chart-gray",
    }
}

/// All series of a chart.
pub(super) fn draw(chart: &Chart, plane: &Plane) -> String {
    let groups = chart.series.iter().filter(|series| matches!(series.marks, Marks::Bars(_))).count();
    let mut group = 0;
    let mut over_cells = false;
    let mut text = String::new();
    for series in &chart.series {
        let marks = match &series.marks {
            Marks::Points(points) => dots(points, plane),
            Marks::Symbols(points, shape) => symbols(points, *shape, plane),
            Marks::Line(points) => line(points, plane, over_cells),
            Marks::Area(points) => area(points, plane) + &line(points, plane, over_cells),
            Marks::Bars(all) => {
                group += 1;
                bars(chart, all, plane, [group, groups])
            }
            Marks::Cells(all) => cells::draw(chart, all, plane),
        };
        if !marks.is_empty() {
            let over = if over_cells { " chart-over" } else { "" };
            text.push_str(&format!("<g class=\"{}{over}\">\n{marks}</g>\n", class(series.color)));
            over_cells |= matches!(series.marks, Marks::Cells(_));
        }
    }
    text
}

/// Adds a marker around a place.
pub(super) fn symbol(path: &mut Path, [x, y]: [f64; 2], shape: Symbol) -> &mut Path {
    let (offset, commands) = match shape {
        Symbol::Circle => ([-3.7, 0.0], "a3.7 3.7 0 1 0 7.4 0a3.7 3.7 0 1 0-7.4 0z"),
        Symbol::Square => ([-3.3, -3.3], "h6.6v6.6h-6.6z"),
        Symbol::Triangle => ([0.0, -4.6], "l4.4 7.6h-8.8z"),
        Symbol::Diamond => ([0.0, -4.8], "l4.8 4.8-4.8 4.8-4.8-4.8z"),
    };
    path.move_to([x + offset[0], y + offset[1]]).raw(commands)
}

fn visible<'a>(points: &'a [[f64; 2]], plane: &'a Plane) -> impl Iterator<Item = [f64; 2]> + 'a {
    let area = plane.area;
    points.iter().filter_map(|&point| plane.point(point)).filter(move |[x, y]| {
        let across = *x > area.left - OUTSIDE && *x < area.right() + OUTSIDE;
        across && *y > area.top - OUTSIDE && *y < area.bottom() + OUTSIDE
    })
}

fn dots(points: &[[f64; 2]], plane: &Plane) -> String {
    let mut path = Path::default();
    // A dot on top of an equal one changes nothing in the picture, but clouds of points are full of them.
    let mut seen = HashSet::new();
    for point in visible(points, plane) {
        if seen.insert(point.map(tenths)) {
            path.dot(point);
        }
    }
    path.draw("chart-points")
}

fn symbols(points: &[[f64; 2]], shape: Symbol, plane: &Plane) -> String {
    let mut path = Path::default();
    for point in visible(points, plane) {
        symbol(&mut path, point, shape);
    }
    path.draw("chart-symbols")
}

/// The parts of a line between points that cannot be drawn.
fn parts(points: &[[f64; 2]], plane: &Plane) -> Vec<Vec<[f64; 2]>> {
    let placed: Vec<Option<[f64; 2]>> = points.iter().map(|&point| plane.point(point)).collect();
    let parts = placed.split(Option::is_none).map(|part| part.iter().flatten().copied().collect());
    parts.filter(|part: &Vec<_>| !part.is_empty()).collect()
}

fn line(points: &[[f64; 2]], plane: &Plane, over_cells: bool) -> String {
    let (mut path, mut single) = (Path::default(), Path::default());
    for mut part in parts(points, plane) {
        part.dedup_by_key(|point| point.map(tenths));
        if let [point] = part[..] {
            single.dot(point);
        } else {
            follow(&mut path, &part);
        }
    }
    let halo = if over_cells { path.draw("chart-halo") } else { String::new() };
    halo + &path.draw("chart-line") + &single.draw("chart-points")
}

fn area(points: &[[f64; 2]], plane: &Plane) -> String {
    let bottom = plane.area.bottom();
    let mut path = Path::default();
    for mut part in parts(points, plane) {
        let (first, last) = (part[0], part[part.len() - 1]);
        part.push([last[0], bottom]);
        part.insert(0, [first[0], bottom]);
        follow(&mut path, &part).raw("z");
    }
    path.draw("chart-area")
}

fn follow<'a>(path: &'a mut Path, points: &[[f64; 2]]) -> &'a mut Path {
    for (index, point) in points.iter().enumerate() {
        if index == 0 {
            path.move_to(*point)
        } else {
            path.line_to(*point)
        };
    }
    path
}

/// The bars of one series, which is number `group` of `groups` (from 1) in the place of each category.
fn bars(chart: &Chart, bars: &[Bar], plane: &Plane, [group, groups]: [usize; 2]) -> String {
    let place = plane.y_at(plane.y.fraction(1.0).unwrap_or(1.0)) - plane.y_at(plane.y.fraction(0.0).unwrap_or(0.0));
    let height = (place * BAND / groups as f64).min(THICKEST);
    // On a logarithmic axis zero is nowhere, and bars start at the edge.
    let zero = plane.across(0.0).unwrap_or(plane.area.left);
    let (mut bodies, mut whiskers) = (Path::default(), Path::default());
    for bar in bars.iter().filter(|bar| drawable_bar(chart, bar)) {
        let (Some(end), Some(centre)) = (plane.across(bar.value), plane.along(bar.category as f64)) else { continue };
        let top = centre + height * (group as f64 - 1.0 - groups as f64 / 2.0);
        bodies.rectangle([zero.min(end), top + 0.5], (end - zero).abs(), height - 1.0);
        let Some((lower, upper)) = bar.interval else { continue };
        if let (Some(lower), Some(upper)) = (plane.across(lower), plane.across(upper)) {
            let middle = top + height / 2.0;
            whiskers.move_to([lower, middle]).line_to([upper, middle]);
            for end in [lower, upper] {
                whiskers.move_to([end, middle - WHISKER]).line_to([end, middle + WHISKER]);
            }
        }
    }
    bodies.draw("chart-bars") + &whiskers.draw("chart-whiskers")
}
