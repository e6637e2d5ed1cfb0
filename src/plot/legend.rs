//! The legend above the plot area.

use super::marks::{class, symbol};
use super::path::Path;
use super::text::{Label, shortened, width};
use super::{Color, Marks, Series, Symbol};

const SIZE: f64 = 12.0;
const ROW: f64 = 20.0;
/// Room for the sample of a line or of another mark, and its distance to the name.
const LINE_SAMPLE: f64 = 22.0;
const MARK_SAMPLE: f64 = 11.0;
const DISTANCE: f64 = 6.0;
const GAP: f64 = 20.0;
const LONGEST_NAME: f64 = 220.0;

/// The entries and their places.
pub(super) struct Legend<'a> {
    entries: Vec<Entry<'a>>,
    rows: usize,
}

struct Entry<'a> {
    name: &'a str,
    color: Color,
    marks: Vec<&'a Marks>,
    left: f64,
    row: usize,
}

impl<'a> Legend<'a> {
    /// The legend of the named series, wrapped to `limit`; empty unless there are names to tell apart.
    pub(super) fn new(series: &'a [Series], limit: f64) -> Self {
        let mut entries: Vec<Entry> = Vec::new();
        for Series { name, color, marks } in series.iter().filter(|series| !series.name.is_empty()) {
            match entries.iter_mut().find(|entry| entry.name == name && entry.color == *color) {
                Some(entry) => entry.marks.push(marks),
                None => entries.push(Entry { name, color: *color, marks: vec![marks], left: 0.0, row: 0 }),
            }
        }
        if entries.len() < 2 {
            return Self { entries: Vec::new(), rows: 0 };
        }
        let (mut left, mut row) = (0.0, 0);
        for entry in &mut entries {
            let room = entry.width();
            if left > 0.0 && left + room > limit {
                (left, row) = (0.0, row + 1);
            }
            (entry.left, entry.row) = (left, row);
            left += room + GAP;
        }
        Self { entries, rows: row + 1 }
    }

    pub(super) fn height(&self) -> f64 {
        self.rows as f64 * ROW
    }

    pub(super) fn draw(&self, left: f64, top: f64) -> String {
        self.entries.iter().map(|entry| entry.draw(left + entry.left, top + (entry.row as f64 + 0.5) * ROW)).collect()
    }
}

impl Entry<'_> {
    fn sample_width(&self) -> f64 {
        let long = self.marks.iter().any(|marks| matches!(marks, Marks::Line(_) | Marks::Area(_)));
        if long { LINE_SAMPLE } else { MARK_SAMPLE }
    }

    fn width(&self) -> f64 {
        let name = shortened(self.name, SIZE, LONGEST_NAME);
        self.sample_width() + DISTANCE + width(name.as_deref().unwrap_or(self.name), SIZE)
    }

    fn draw(&self, left: f64, middle: f64) -> String {
        let samples: String =
            self.marks.iter().map(|marks| sample(marks, [left, middle], self.sample_width())).collect();
        let name = Label {
            class: "chart-name",
            text: self.name,
            size: SIZE,
            anchor: "start",
            at: [left + self.sample_width() + DISTANCE, middle + 4.0],
            limit: LONGEST_NAME,
            angle: 0.0,
        };
        format!("<g class=\"{}\">\n{samples}{}</g>\n", class(self.color), name.draw())
    }
}

/// What the marks look like, from a place on the left.
fn sample(marks: &Marks, [left, middle]: [f64; 2], width: f64) -> String {
    let (centre, right) = ([left + width / 2.0, middle], [left + width, middle]);
    let mut path = Path::default();
    match marks {
        Marks::Points(_) => symbol(&mut path, centre, Symbol::Circle).draw("chart-symbols"),
        Marks::Symbols(_, shape) => symbol(&mut path, centre, *shape).draw("chart-symbols"),
        Marks::Line(_) => path.move_to([left, middle]).line_to(right).draw("chart-line"),
        Marks::Area(_) => {
            let filling = path.rectangle([left, middle - 4.0], width, 9.0).draw("chart-area");
            let mut edge = Path::default();
            filling + &edge.move_to([left, middle - 4.0]).line_to([right[0], middle - 4.0]).draw("chart-line")
        }
        Marks::Bars(_) => path.rectangle([left, middle - 5.0], width, 10.0).draw("chart-bars"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(names: &[&str]) -> Vec<Series> {
        names.iter().map(|name| Series::new(*name, Color::Blue, Marks::Line(Vec::new()))).collect()
    }

    #[test]
    fn a_legend_appears_where_names_differ() {
        assert_eq!(Legend::new(&named(&["one"]), 500.0).rows, 0);
        assert_eq!(Legend::new(&named(&["one", "one", ""]), 500.0).rows, 0);
        assert_eq!(Legend::new(&named(&["one", "other"]), 500.0).rows, 1);
    }

    #[test]
    fn entries_wrap_and_stay_inside() {
        let series = named(&["a name of some length", "another name of some length", "x", &"long ".repeat(40)]);
        let legend = Legend::new(&series, 300.0);
        assert!(legend.rows >= 2);
        let right = |entry: &Entry| entry.left + entry.width();
        assert!(legend.entries.iter().all(|entry| right(entry) <= 300.0));
    }
}
