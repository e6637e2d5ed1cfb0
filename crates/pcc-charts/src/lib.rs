//! Charts as SVG text.
//!
//! A [`Chart`] is plain data: two axes, some series, some guide lines. [`Chart::to_svg`] draws it for inlining into
//! an HTML page that carries [`STYLE`]; [`sheet`] draws several charts as the panels of one file that stands alone.
//! [`Chart::to_csv`] gives the numbers behind the picture.
//!
//! Besides points, lines and bars there are [`Cells`]: a share over two parameters, such as a stability map. They are
//! shaded in ten levels, whose hue changes at one half, and the legend has a scale for them.
//!
//! A [`Sparkline`] is a curve as small as a word, for a cell of a table.
//!
//! Colours, line widths and fonts are left to the style sheet, so one picture follows light and dark; the markup holds
//! geometry only. The output has no scripts and no references to other files, and depends on nothing but the input.
//! No input makes it panic: numbers that cannot be drawn are skipped, and names of any kind become plain text.

#![forbid(unsafe_code)]

mod cells;
mod csv;
mod extent;
mod frame;
mod guides;
mod layout;
mod legend;
mod levels;
mod marks;
mod notes;
mod numbers;
mod path;
mod scale;
mod sheet;
mod sparkline;
mod style;
#[cfg(test)]
mod tests;
mod text;
mod ticks;

pub use sheet::sheet;
pub use sparkline::Sparkline;
pub use style::STYLE;
pub use text::escape;

/// A chart: two axes, the series drawn between them, and guide lines.
///
/// ```
/// # use pcc_charts as plot;
/// use plot::{Axis, Chart, Color, Guide, Marks, Series};
///
/// let chart = Chart {
///     title: "Eigenvalues against friction".to_string(),
///     description: "The real part crosses zero at a friction coefficient of 0.3.".to_string(),
///     x: Axis::linear("Friction coefficient μ"),
///     y: Axis::linear("Re λ in 1/s"),
///     series: vec![Series::new("Mode 1", Color::Blue, Marks::Line(vec![[0.2, -4.0], [0.3, 0.0], [0.4, 3.0]]))],
///     guides: vec![Guide::Horizontal(0.0, "Stability limit".to_string())],
/// };
/// assert!(chart.to_svg("friction").contains("<title id=\"friction-title\">Eigenvalues against friction</title>"));
/// assert_eq!(chart.to_csv().lines().nth(1), Some("Mode 1,0.2,-4"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Heading above the chart and name for assistive technology; an empty one leaves no heading.
    pub title: String,
    /// Text alternative: what the picture shows, in a sentence or two.
    pub description: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// What is drawn, later series above earlier ones. Series with the same name and colour share a legend entry.
    pub series: Vec<Series>,
    /// Reference lines, drawn above the series. They do not widen the range of an axis.
    pub guides: Vec<Guide>,
}

/// One axis of a [`Chart`].
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity and unit; may be empty.
    pub label: String,
    /// How values become positions.
    pub scale: Scale,
    /// Ends of the axis, in either order; without them the range follows from the data, with a small margin.
    /// Ends the scale cannot show are ignored, and so is the range of a scale of categories.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// A linear axis whose range follows from the data.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None }
    }

    /// A logarithmic axis whose range follows from the data.
    pub fn logarithmic(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Logarithmic, range: None }
    }

    /// An axis with one place for each name.
    pub fn categories(label: impl Into<String>, names: Vec<String>) -> Self {
        Self { label: label.into(), scale: Scale::Categories(names), range: None }
    }

    /// The same axis from one end to the other.
    #[must_use]
    pub fn between(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }
}

/// How the values on an axis become positions.
#[derive(Clone, Debug, PartialEq)]
pub enum Scale {
    /// Equal differences have equal lengths.
    Linear,
    /// Equal ratios have equal lengths; values that are not positive are skipped.
    Logarithmic,
    /// Named places at 0, 1, 2, …: from the left on a horizontal axis, from the top on a vertical one.
    Categories(Vec<String>),
}

/// Data of one kind under one name.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend; a series without a name has no entry there.
    pub name: String,
    /// Colour of all its marks; cells have those of their levels instead.
    pub color: Color,
    /// The data and their shape.
    pub marks: Marks,
}

impl Series {
    /// A series of marks under a name.
    pub fn new(name: impl Into<String>, color: Color, marks: Marks) -> Self {
        Self { name: name.into(), color, marks }
    }
}

/// Colour of a series: a name which [`STYLE`] gives one value for light and one for dark surroundings.
///
/// The hues are those of Okabe and Ito, with lightnesses that keep them apart for colour-blind readers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Color {
    Blue,
    Red,
    Green,
    Orange,
    Purple,
    Teal,
    Gray,
}

impl Color {
    /// All colours, in the order in which to hand them out.
    pub const ALL: [Self; 7] = [Self::Blue, Self::Red, Self::Green, Self::Orange, Self::Purple, Self::Teal, Self::Gray];
}

/// The data of a [`Series`] and the shape they are drawn in.
#[derive(Clone, Debug, PartialEq)]
pub enum Marks {
    /// Small dots, for thousands of points.
    Points(Vec<[f64; 2]>),
    /// Larger markers, for a few points.
    Symbols(Vec<[f64; 2]>, Symbol),
    /// A line through the points in their order; a point that cannot be drawn interrupts it.
    Line(Vec<[f64; 2]>),
    /// A line with a translucent filling down to the axis, such as a density.
    Area(Vec<[f64; 2]>),
    /// Horizontal bars from zero. They need [`Scale::Categories`] on the vertical axis; several series of bars share
    /// the place of a category.
    Bars(Vec<Bar>),
    /// Rectangles shaded by a share, such as a stability map. They hide the series before them; a name gives them a
    /// scale in the legend.
    Cells(Cells),
}

/// Shape of a larger marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Symbol {
    Circle,
    Square,
    Triangle,
    Diamond,
}

/// One horizontal bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Index into the categories of the vertical axis.
    pub category: usize,
    /// Where the bar ends.
    pub value: f64,
    /// Lower and upper end of the whisker, such as a confidence interval.
    pub interval: Option<(f64, f64)>,
}

/// A share for every cell of a grid.
///
/// Cells reach half way to the neighbouring centres (on a logarithmic axis as it shows them), the outermost ones as far
/// to the other side, and fill the axes: ranges that follow from the data have no margin beyond them. Cells finer than
/// the resolution of the picture are drawn as the mean of those in one place.
///
/// ```
/// # use pcc_charts as plot;
/// use plot::{Axis, Cells, Chart, Color, Marks, Series};
///
/// let share = Cells { x: vec![0.2, 0.3, 0.4], y: vec![1.0, 2.0], values: vec![1.0, 0.7, 0.2, 0.9, 0.4, f64::NAN] };
/// let chart = Chart {
///     title: "Stability map".to_string(),
///     description: "Less is stable where friction and damping ratio are large.".to_string(),
///     x: Axis::linear("Friction coefficient μ"),
///     y: Axis::linear("Damping ratio"),
///     series: vec![Series::new("Proportion stable", Color::Blue, Marks::Cells(share))],
///     guides: Vec::new(),
/// };
/// assert!(chart.to_svg("map").contains("<path class=\"chart-level-7\""));
/// assert_eq!(chart.to_csv().lines().nth(2), Some("Proportion stable,0.3,1,0.7"));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cells {
    /// Centres on the horizontal axis, usually ascending: they are taken in the order in which they lie there. Those
    /// the axis has no place for are skipped, and of equal ones all but the first.
    pub x: Vec<f64>,
    /// Centres on the vertical axis, likewise.
    pub y: Vec<f64>,
    /// Shares from 0 to 1, row by row: first those at the first `y`, one for each `x`. Shares beyond are drawn as the
    /// nearer end. Those that are not finite or missing leave a gap; surplus ones are ignored.
    pub values: Vec<f64>,
}

/// A reference line across the plot area, with a small label (which may be empty).
#[derive(Clone, Debug, PartialEq)]
pub enum Guide {
    /// Vertical line at a value of the horizontal axis.
    Vertical(f64, String),
    /// Horizontal line at a value of the vertical axis.
    Horizontal(f64, String),
    /// Where both axes have the same value.
    Diagonal,
}

impl Chart {
    /// Draws the chart as an `<svg>` element for an HTML page that carries [`STYLE`].
    ///
    /// `id` starts the identifiers inside and has to be unique in the page; characters other than ASCII letters,
    /// digits, `-` and `_` become `-`. The element has a `viewBox` but no width: it fills the place it is given.
    pub fn to_svg(&self, id: &str) -> String {
        let id = text::identifier(id);
        let panel = frame::draw(self, &id, "", layout::Insets::default());
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart\" role=\"img\" \
             aria-labelledby=\"{id}-title {id}-desc\" viewBox=\"0 0 {} {}\">\n{}</svg>\n",
            panel.width.ceil(),
            panel.height.ceil(),
            panel.body
        )
    }

    /// All data of the chart as comma-separated values (RFC 4180), also those that could not be drawn.
    ///
    /// The columns are `series`, `x`, `y`, where there are cells `value`, and where a bar has an interval `lower`,
    /// `upper`. Categories have their names; cells without a value have no line.
    pub fn to_csv(&self) -> String {
        csv::write(self)
    }
}
