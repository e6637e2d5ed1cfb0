//! Several charts as the panels of one file.

use super::frame::{self, Panel};
use super::layout::{Insets, Layout, WIDTH};
use super::path::Path;
use super::text::{Label, escape};
use super::{Chart, STYLE};

const MARGIN: f64 = 24.0;
const COLUMN_GAP: f64 = 40.0;
const ROW_GAP: f64 = 30.0;
const TITLE_SIZE: f64 = 18.0;
/// Plot areas further in than this, because of long names, do not move the others of their column.
const ALIGNED: f64 = 110.0;

/// Draws charts as panels (a), (b), … of an SVG file that stands alone, row by row in `columns` (at least one); a
/// single chart has no letter.
///
/// The file carries [`STYLE`] and follows light and dark by itself. `title` stands above the panels (an empty one takes
/// no room); `description` is the text alternative of the whole.
pub fn sheet(title: &str, description: &str, charts: &[Chart], columns: usize) -> String {
    let columns = columns.clamp(1, charts.len().max(1));
    let panels = panels(charts, columns);
    let width = 2.0 * MARGIN + columns as f64 * (WIDTH + COLUMN_GAP) - COLUMN_GAP;
    let mut top = MARGIN + if title.is_empty() { 0.0 } else { 38.0 };
    let mut body = String::new();
    for (row, panels) in panels.chunks(columns).enumerate() {
        for (column, panel) in panels.iter().enumerate() {
            let (letter, left) = (letters(row * columns + column), MARGIN + column as f64 * (WIDTH + COLUMN_GAP));
            body.push_str(&format!(
                "<g role=\"img\" aria-labelledby=\"panel-{letter}-title panel-{letter}-desc\" \
                 transform=\"translate({left} {top})\">\n{}</g>\n",
                panel.body
            ));
        }
        top += panels.iter().map(|panel| panel.height.ceil()).fold(0.0, f64::max) + ROW_GAP;
    }
    let height = if charts.is_empty() { top } else { top - ROW_GAP + MARGIN };
    wrap(title, description, [width, height], &body)
}

/// Draws the panels, their plot areas aligned in rows and columns.
fn panels(charts: &[Chart], columns: usize) -> Vec<Panel> {
    let insets = |chart: &Chart, left| Layout::new(chart, true, Insets { left, top: 0.0 }).insets();
    let mut lefts = vec![0.0f64; columns];
    for (index, chart) in charts.iter().enumerate() {
        let left = insets(chart, 0.0).left;
        if left <= ALIGNED {
            lefts[index % columns] = lefts[index % columns].max(left);
        }
    }
    let mut panels = Vec::with_capacity(charts.len());
    for row in charts.chunks(columns) {
        let tops = row.iter().zip(&lefts).map(|(chart, &left)| insets(chart, left).top);
        let top = tops.fold(0.0, f64::max);
        for (chart, &left) in row.iter().zip(&lefts) {
            let letter = letters(panels.len());
            let least = Insets { left, top };
            let prefix = if charts.len() > 1 { format!("({letter}) ") } else { String::new() };
            panels.push(frame::draw(chart, &format!("panel-{letter}"), &prefix, least));
        }
    }
    panels
}

/// The file around the panels.
fn wrap(title: &str, description: &str, [width, height]: [f64; 2], body: &str) -> String {
    let at = [MARGIN, MARGIN + 16.0];
    let limit = (width - 2.0 * MARGIN) / 1.08;
    let heading = Label { class: "chart-title", text: title, size: TITLE_SIZE, anchor: "start", at, limit, angle: 0.0 };
    let background = Path::default().rectangle([0.0, 0.0], width, height).draw("chart-paper");
    [
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_string(),
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart\" role=\"group\" \
             aria-labelledby=\"sheet-title sheet-desc\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\">\n"
        ),
        format!("<title id=\"sheet-title\">{}</title>\n", escape(title)),
        format!("<desc id=\"sheet-desc\">{}</desc>\n", escape(description)),
        format!("<style>\n{STYLE}</style>\n{background}"),
        if title.is_empty() { String::new() } else { heading.draw() },
        format!("{body}</svg>\n"),
    ]
    .concat()
}

/// a, b, …, z, aa, ab, …
fn letters(index: usize) -> String {
    let last = char::from(b'a' + (index % 26) as u8);
    if index < 26 { last.to_string() } else { format!("{}{last}", letters(index / 26 - 1)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_have_distinct_letters() {
        assert_eq!([0, 25, 26, 51, 52, 701, 702].map(letters), ["a", "z", "aa", "az", "ba", "zz", "aaa"]);
    }
}
