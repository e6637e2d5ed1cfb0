//! Which part of a picture is the plot area, and where values are in it.

use super::extent::extents;
use super::legend::Legend;
use super::notes::Notes;
use super::scale::Mapping;
use super::text::width as text_width;
use super::ticks::{Tick, ticks};
use super::{Chart, Marks, Scale};

/// Width of a chart in user units.
pub(super) const WIDTH: f64 = 640.0;
/// Font size of the labels at ticks.
pub(super) const TICK_SIZE: f64 = 12.0;
/// Longest name of a category beside or under an axis, and the least distance between two under it.
pub(super) const NAME_WIDTH: f64 = 170.0;
pub(super) const NAME_GAP: f64 = 10.0;
/// Angle in degrees of names that would collide if they were level.
pub(super) const SLANT: f64 = -35.0;

const PLOT_HEIGHT: f64 = 300.0;
/// Height of the place of a category, with one series of bars and for each further one.
const CATEGORY_HEIGHT: f64 = 26.0;
const BAR_HEIGHT: f64 = 12.0;

/// A rectangle with its top left corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rectangle {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

impl Rectangle {
    pub(super) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(super) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    pub(super) fn contains(&self, [x, y]: [f64; 2]) -> bool {
        x >= self.left && x <= self.right() && y >= self.top && y <= self.bottom()
    }

    pub(super) fn overlaps(&self, other: &Self) -> bool {
        let across = self.left < other.right() && other.left < self.right();
        across && self.top < other.bottom() && other.top < self.bottom()
    }
}

/// The plot area with its two axes.
pub(super) struct Plane {
    pub area: Rectangle,
    pub x: Mapping,
    pub y: Mapping,
    /// Whether the vertical axis starts at the top, as categories do.
    downwards: bool,
}

impl Plane {
    /// Where a value of the horizontal axis is.
    pub(super) fn across(&self, value: f64) -> Option<f64> {
        self.x.fraction(value).map(|fraction| self.x_at(fraction))
    }

    /// Where a value of the vertical axis is.
    pub(super) fn along(&self, value: f64) -> Option<f64> {
        self.y.fraction(value).map(|fraction| self.y_at(fraction))
    }

    /// Where a point is, if both axes have a place for it.
    pub(super) fn point(&self, point: [f64; 2]) -> Option<[f64; 2]> {
        Some([self.across(point[0])?, self.along(point[1])?])
    }

    /// A fraction of the horizontal axis.
    pub(super) fn x_at(&self, fraction: f64) -> f64 {
        self.area.left + fraction * self.area.width
    }

    /// A fraction of the vertical axis.
    pub(super) fn y_at(&self, fraction: f64) -> f64 {
        self.area.top + self.area.height * if self.downwards { fraction } else { 1.0 - fraction }
    }
}

/// Room before the plot area, by which the panels of a sheet are aligned.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Insets {
    pub left: f64,
    pub top: f64,
}

/// Everything that has to be known before anything is drawn.
pub(super) struct Layout<'a> {
    pub plane: Plane,
    pub x_ticks: Vec<Tick>,
    pub y_ticks: Vec<Tick>,
    pub legend: Legend<'a>,
    pub notes: Notes<'a>,
    /// Whether the names under the horizontal axis are slanted, for want of room.
    pub slanted: bool,
    pub height: f64,
    pub empty: bool,
}

impl<'a> Layout<'a> {
    /// Arranges a chart, with or without room for a heading, the plot area no nearer to the edges than `least`.
    pub(super) fn new(chart: &'a Chart, heading: bool, least: Insets) -> Self {
        let [x_extent, y_extent] = extents(chart);
        let (x, y) = (Mapping::new(&chart.x, x_extent), Mapping::new(&chart.y, y_extent));
        let (x_ticks, y_ticks) = (ticks(&chart.x, &x), ticks(&chart.y, &y));
        let left = widest(&y_ticks).min(NAME_WIDTH) + if chart.y.label.is_empty() { 12.0 } else { 36.0 };
        let left = left.max(least.left);
        let last = x_ticks.iter().rev().find_map(|tick| tick.label.as_ref());
        let right = last.map_or(0.0, |label| text_width(label, TICK_SIZE) / 2.0).clamp(14.0, 40.0);
        let width = WIDTH - left - right;
        let legend = Legend::new(&chart.series, width);
        let notes = Notes::new(&chart.guides, &x, left, width);
        let top = if heading { 36.0 } else { 12.0 } + legend.height() + notes.height();
        let area = Rectangle { left, top: top.max(least.top), width, height: plot_height(chart) };
        let place = width / x_ticks.len().max(1) as f64;
        let slanted = matches!(chart.x.scale, Scale::Categories(_)) && widest(&x_ticks) > place - NAME_GAP;
        let plane = Plane { area, x, y, downwards: matches!(chart.y.scale, Scale::Categories(_)) };
        let names = if slanted { slanted_height(&x_ticks, &plane) } else { 0.0 };
        let height = area.bottom() + names + if chart.x.label.is_empty() { 28.0 } else { 48.0 };
        Self { plane, x_ticks, y_ticks, legend, notes, slanted, height, empty: x_extent.is_none() }
    }

    /// The room before the plot area.
    pub(super) fn insets(&self) -> Insets {
        Insets { left: self.plane.area.left, top: self.plane.area.top }
    }
}

/// Width of the widest label.
pub(super) fn widest(ticks: &[Tick]) -> f64 {
    let labels = ticks.iter().filter_map(|tick| tick.label.as_ref());
    labels.map(|label| text_width(label, TICK_SIZE)).fold(0.0, f64::max)
}

/// Longest slanted name that ends at `x`: it reaches to the left, where the picture ends.
pub(super) fn slanted_limit(x: f64) -> f64 {
    NAME_WIDTH.min(x / SLANT.to_radians().cos())
}

fn slanted_height(ticks: &[Tick], plane: &Plane) -> f64 {
    let labelled = ticks.iter().filter_map(|tick| Some((plane.x_at(tick.fraction), tick.label.as_ref()?)));
    let lengths = labelled.map(|(x, label)| text_width(label, TICK_SIZE).min(slanted_limit(x)));
    lengths.fold(0.0, f64::max) * SLANT.to_radians().sin().abs()
}

/// High enough for every category to be readable.
fn plot_height(chart: &Chart) -> f64 {
    let Scale::Categories(names) = &chart.y.scale else { return PLOT_HEIGHT };
    let groups = chart.series.iter().filter(|series| matches!(series.marks, Marks::Bars(_))).count();
    let place = CATEGORY_HEIGHT + BAR_HEIGHT * groups.saturating_sub(1) as f64;
    (names.len() as f64 * place).max(PLOT_HEIGHT)
}
