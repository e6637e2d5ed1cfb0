//! A whole chart: grid, marks, axes, labels and legend, one above the other.

use super::layout::{Insets, Layout, NAME_GAP, NAME_WIDTH, SLANT, TICK_SIZE, WIDTH, slanted_limit, widest};
use super::path::Path;
use super::text::{Label, escape, width};
use super::{Axis, Chart, Marks, Scale, guides, marks};

const LABEL_SIZE: f64 = 13.0;
const HEADING_SIZE: f64 = 14.0;
/// Lengths of labelled and of minor ticks.
const MAJOR: f64 = 5.0;
const MINOR: f64 = 3.0;
/// Least distance between slanted names.
const NAME_HEIGHT: f64 = 17.0;

/// What is inside the element of a chart, and its size.
pub(super) struct Panel {
    pub width: f64,
    pub height: f64,
    pub body: String,
}

/// Draws a chart; `prefix` comes before its title in the heading. `id` has to be an identifier.
pub(super) fn draw(chart: &Chart, id: &str, prefix: &str, least: Insets) -> Panel {
    let heading = format!("{prefix}{}", chart.title);
    let layout = Layout::new(chart, !heading.is_empty(), least);
    let area = layout.plane.area;
    let notes_top = area.top - 2.0 - layout.notes.height();
    let mut clip = Path::default();
    clip.rectangle([area.left, area.top], area.width, area.height);
    let body = [
        format!("<title id=\"{id}-title\">{}</title>\n", escape(&heading)),
        format!("<desc id=\"{id}-desc\">{}</desc>\n", escape(&chart.description)),
        format!("<clipPath id=\"{id}-clip\">{}</clipPath>\n", clip.draw("chart-clip").trim_end()),
        grid(chart, &layout),
        format!("<g clip-path=\"url(#{id}-clip)\">\n"),
        marks::draw(chart, &layout.plane),
        guides::lines(chart, &layout.plane),
        "</g>\n".to_string(),
        axes(chart, &layout),
        guides::labels(chart, &layout.plane),
        layout.notes.draw(area.top - 2.0),
        x_labels(chart, &layout),
        y_labels(chart, &layout),
        titles(chart, &layout, &heading),
        layout.legend.draw(area.left, notes_top - 4.0 - layout.legend.height()),
    ];
    Panel { width: WIDTH, height: layout.height, body: body.concat() }
}

fn is_categories(axis: &Axis) -> bool {
    matches!(axis.scale, Scale::Categories(_))
}

/// Light lines at the labelled ticks.
fn grid(chart: &Chart, layout: &Layout) -> String {
    let (plane, area) = (&layout.plane, layout.plane.area);
    let mut path = Path::default();
    for tick in layout.x_ticks.iter().filter(|tick| tick.label.is_some() && !is_categories(&chart.x)) {
        let x = plane.x_at(tick.fraction);
        path.move_to([x, area.top]).line_to([x, area.bottom()]);
    }
    for tick in layout.y_ticks.iter().filter(|tick| tick.label.is_some() && !is_categories(&chart.y)) {
        let y = plane.y_at(tick.fraction);
        path.move_to([area.left, y]).line_to([area.right(), y]);
    }
    path.draw("chart-grid")
}

/// The two axes with their ticks, which point outwards, and the line bars start from.
fn axes(chart: &Chart, layout: &Layout) -> String {
    let (plane, area) = (&layout.plane, layout.plane.area);
    let mut path = Path::default();
    path.move_to([area.left, area.top]).line_to([area.left, area.bottom()]).line_to([area.right(), area.bottom()]);
    let length = |label: &Option<String>| if label.is_some() { MAJOR } else { MINOR };
    for tick in layout.x_ticks.iter().filter(|_| !is_categories(&chart.x)) {
        let x = plane.x_at(tick.fraction);
        path.move_to([x, area.bottom()]).line_to([x, area.bottom() + length(&tick.label)]);
    }
    for tick in layout.y_ticks.iter().filter(|_| !is_categories(&chart.y)) {
        let y = plane.y_at(tick.fraction);
        path.move_to([area.left, y]).line_to([area.left - length(&tick.label), y]);
    }
    let bars = chart.series.iter().any(|series| matches!(series.marks, Marks::Bars(_)));
    if let Some(zero) = plane.across(0.0).filter(|zero| bars && *zero > area.left && *zero < area.right()) {
        path.move_to([zero, area.top]).line_to([zero, area.bottom()]);
    }
    path.draw("chart-axis")
}

/// Labels under the horizontal axis; those without room between their neighbours are left out.
fn x_labels(chart: &Chart, layout: &Layout) -> String {
    let area = layout.plane.area;
    let categories = is_categories(&chart.x);
    let (class, size) = ("chart-tick", TICK_SIZE);
    // All take the room of the widest, so that the remaining ones keep a regular distance.
    let room = if layout.slanted { NAME_HEIGHT } else { widest(&layout.x_ticks) + NAME_GAP };
    let mut last = f64::NEG_INFINITY;
    let mut labels = String::new();
    for tick in &layout.x_ticks {
        let (Some(text), x) = (&tick.label, layout.plane.x_at(tick.fraction)) else { continue };
        if x - last < room - 0.01 {
            continue;
        }
        last = x;
        let label = if layout.slanted {
            let limit = slanted_limit(x);
            Label { class, text, size, anchor: "end", at: [x + 4.0, area.bottom() + 14.0], limit, angle: SLANT }
        } else {
            let limit = if categories { NAME_WIDTH } else { f64::INFINITY };
            Label { class, text, size, anchor: "middle", at: [x, area.bottom() + 18.0], limit, angle: 0.0 }
        };
        labels.push_str(&label.draw());
    }
    labels
}

fn y_labels(chart: &Chart, layout: &Layout) -> String {
    let area = layout.plane.area;
    let categories = is_categories(&chart.y);
    let limit = if categories { NAME_WIDTH } else { f64::INFINITY };
    let left = area.left - if categories { 8.0 } else { 9.0 };
    let labelled = layout.y_ticks.iter().filter_map(|tick| Some((tick.fraction, tick.label.as_ref()?)));
    let label = |(fraction, text): (f64, &String)| {
        let at = [left, layout.plane.y_at(fraction) + 4.0];
        Label { class: "chart-tick", text, size: TICK_SIZE, anchor: "end", at, limit, angle: 0.0 }.draw()
    };
    labelled.map(label).collect()
}

/// The heading, what the axes show, and a word where there are no data.
fn titles(chart: &Chart, layout: &Layout, heading: &str) -> String {
    let area = layout.plane.area;
    let (middle, centre) = (area.left + area.width / 2.0, area.top + area.height / 2.0);
    let label = |class, text, size, at, limit| Label { class, text, size, anchor: "middle", at, limit, angle: 0.0 };
    let x = label("chart-label", &chart.x.label, LABEL_SIZE, [middle, layout.height - 8.0], area.width);
    let y = Label { angle: -90.0, ..label("chart-label", &chart.y.label, LABEL_SIZE, [12.0, centre], area.height) };
    // Headings are bold and therefore wider than estimated.
    let limit = WIDTH / 1.08;
    let heading = Label { anchor: "start", ..label("chart-heading", heading, HEADING_SIZE, [0.0, 15.0], limit) };
    let empty = if layout.empty { "no data" } else { "" };
    let empty = label("chart-empty", empty, LABEL_SIZE, [middle, centre + 4.0], width("no data", LABEL_SIZE));
    [x, y, heading, empty].iter().filter(|label| !label.text.is_empty()).map(Label::draw).collect()
}
