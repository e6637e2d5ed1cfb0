//! What the data span, which gives the axes their range.

use super::{Axis, Bar, Chart, Marks, Scale, cells};

/// The least and the greatest value on one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    pub low: f64,
    pub high: f64,
    /// Whether lengths start at zero, so that zero has to be in the picture.
    pub from_zero: bool,
    /// The least and the greatest edge of what fills its place and needs no margin, such as cells.
    pub filled: Option<[f64; 2]>,
}

impl Extent {
    fn include(extent: &mut Option<Self>, value: f64, from_zero: bool) {
        let old = extent.unwrap_or(Self { low: value, high: value, from_zero, filled: None });
        let from_zero = old.from_zero || from_zero;
        *extent = Some(Self { low: old.low.min(value), high: old.high.max(value), from_zero, ..old });
    }

    /// Includes all between two edges of what fills its place.
    fn fill(extent: &mut Option<Self>, [low, high]: [f64; 2]) {
        Self::include(extent, low, false);
        Self::include(extent, high, false);
        if let Some(extent) = extent {
            let old = extent.filled.unwrap_or([low, high]);
            extent.filled = Some([old[0].min(low), old[1].max(high)]);
        }
    }

    /// Whether nothing needs room beyond one of the ends.
    pub(super) fn is_edge(&self, end: f64) -> bool {
        self.from_zero && end == 0.0 || self.filled.is_some_and(|edges| edges.contains(&end))
    }
}

/// Whether the axis has a place for `value`.
pub(super) fn drawable(axis: &Axis, value: f64) -> bool {
    value.is_finite() && (axis.scale != Scale::Logarithmic || value > 0.0)
}

/// Whether the vertical axis has a place for the bar.
pub(super) fn drawable_bar(chart: &Chart, bar: &Bar) -> bool {
    let known = matches!(&chart.y.scale, Scale::Categories(names) if bar.category < names.len());
    known && drawable(&chart.x, bar.value)
}

/// The spans of all that can be drawn; nothing on either axis if there is nothing.
pub(super) fn extents(chart: &Chart) -> [Option<Extent>; 2] {
    let [mut x, mut y] = [None, None];
    for series in &chart.series {
        match &series.marks {
            Marks::Points(points) | Marks::Symbols(points, _) | Marks::Line(points) | Marks::Area(points) => {
                let filled = matches!(series.marks, Marks::Area(_));
                for point in points.iter().filter(|at| drawable(&chart.x, at[0]) && drawable(&chart.y, at[1])) {
                    Extent::include(&mut x, point[0], false);
                    Extent::include(&mut y, point[1], filled);
                }
            }
            Marks::Bars(bars) => {
                for bar in bars.iter().filter(|bar| drawable_bar(chart, bar)) {
                    let (lower, upper) = bar.interval.unwrap_or((bar.value, bar.value));
                    for value in [bar.value, lower, upper].into_iter().filter(|value| drawable(&chart.x, *value)) {
                        Extent::include(&mut x, value, true);
                    }
                    Extent::include(&mut y, bar.category as f64, false);
                }
            }
            Marks::Cells(all) => {
                if let Some([across, along]) = cells::spans(chart, all) {
                    Extent::fill(&mut x, across);
                    Extent::fill(&mut y, along);
                }
            }
        }
    }
    [x, y]
}
