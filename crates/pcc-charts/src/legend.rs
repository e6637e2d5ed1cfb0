//! The legend above the plot area.

use super::levels::Ramp;
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

/// The entries and their places, below the scales of cells.
pub(super) struct Legend<'a> {
    ramps: Vec<Ramp<'a>>,
    limit: f64,
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
    /// The legend of the named series, wrapped to `limit`; without cells empty unless there are names to tell apart.
    pub(super) fn new(series: &'a [Series], limit: f64) -> Self {
        let (mut entries, mut ramps): (Vec<Entry>, Vec<Ramp>) = Default::default();
        for Series { name, color, marks } in series.iter().filter(|series| !series.name.is_empty()) {
            if matches!(marks, Marks::Cells(_)) {
                if ramps.iter().all(|ramp| ramp.name != name) {
                    ramps.push(Ramp { name });
                }
                continue;
            }
            match entries.iter_mut().find(|entry| entry.name == name && entry.color == *color) {
                Some(entry) => entry.marks.push(marks),
                None => entries.push(Entry { name, color: *color, marks: vec![marks], left: 0.0, row: 0 }),
            }
        }
        if entries.len() + ramps.len() < 2 {
            entries.clear();
        }
        if entries.is_empty() {
            return Self { ramps, limit, entries, rows: 0 };
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
        Self { ramps, limit, entries, rows: row + 1 }
    }

    fn ramps_height(&self) -> f64 {
        self.ramps.len() as f64 * Ramp::HEIGHT
    }

    pub(super) fn height(&self) -> f64 {
        self.ramps_height() + self.rows as f64 * ROW
    }

    pub(super) fn draw(&self, left: f64, top: f64) -> String {
        let place = |row: usize| [left, top + row as f64 * Ramp::HEIGHT];
        let ramps = self.ramps.iter().enumerate().map(|(row, ramp)| ramp.draw(place(row), self.limit));
        let top = top + self.ramps_height();
        let middle = |entry: &Entry| top + (entry.row as f64 + 0.5) * ROW;
        ramps.chain(self.entries.iter().map(|entry| entry.draw(left + entry.left, middle(entry)))).collect()
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
        // Cells have a scale instead.
        Marks::Cells(_) => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::Cells;
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
    fn cells_have_a_scale_whatever_else_there_is() {
        let cells = |name: &str| Series::new(name, Color::Blue, Marks::Cells(Cells::default()));
        let lone = [cells("share")];
        assert_eq!(Legend::new(&lone, 500.0).height(), Ramp::HEIGHT);
        let same = [cells("share"), cells(""), cells("share")];
        assert_eq!(Legend::new(&same, 500.0).height(), Ramp::HEIGHT);
        let with_line = [vec![cells("share")], named(&["limit"])].concat();
        assert_eq!(Legend::new(&with_line, 500.0).height(), Ramp::HEIGHT + ROW);
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
