//! The labels of vertical guide lines, in rows of their own above the plot area, where no data are.

use super::Guide;
use super::layout::WIDTH;
use super::scale::Mapping;
use super::text::{Label, shortened, width};

pub(super) const SIZE: f64 = 11.5;
pub(super) const ROW: f64 = 15.0;
/// Longest label of a guide line.
pub(super) const LIMIT: f64 = 240.0;
const GAP: f64 = 6.0;

/// The labels and their places.
pub(super) struct Notes<'a> {
    placed: Vec<Note<'a>>,
    rows: usize,
}

struct Note<'a> {
    text: &'a str,
    left: f64,
    width: f64,
    row: usize,
}

impl<'a> Notes<'a> {
    /// Places the labels of the lines that are in the picture, above a plot area from `left` with the given width.
    pub(super) fn new(guides: &'a [Guide], x: &Mapping, left: f64, area_width: f64) -> Self {
        let line = |guide: &'a Guide| match guide {
            Guide::Vertical(value, text) if !text.is_empty() => {
                let fraction = x.fraction(*value).filter(|fraction| (0.0..=1.0).contains(fraction))?;
                Some((left + fraction * area_width, text.as_str()))
            }
            _ => None,
        };
        let mut lines: Vec<(f64, &str)> = guides.iter().filter_map(line).collect();
        lines.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut notes = Self { placed: Vec::new(), rows: 0 };
        for (index, &(x, text)) in lines.iter().enumerate() {
            let near = |other: Option<&(f64, &str)>| {
                other.is_some_and(|other| (other.0 - x).abs() < (label_width(text) + label_width(other.1)) / 2.0 + GAP)
            };
            let preferred =
                match (near(index.checked_sub(1).and_then(|before| lines.get(before))), near(lines.get(index + 1))) {
                    (false, true) => Side::Left,
                    (true, false) => Side::Right,
                    _ => Side::Middle,
                };
            notes.place(x, text, preferred);
        }
        notes
    }

    fn place(&mut self, x: f64, text: &'a str, preferred: Side) {
        let width = label_width(text);
        let left = |side: Side| match side {
            Side::Left => x - width,
            Side::Middle => x - width / 2.0,
            Side::Right => x,
        };
        let sides = [preferred, Side::Middle, Side::Right, Side::Left];
        let places = (0..=self.rows).flat_map(|row| sides.map(|side| (left(side).clamp(0.0, WIDTH - width), row)));
        let free = |(left, row): &(f64, usize)| {
            let clear = |note: &Note| *left > note.left + note.width + GAP || left + width + GAP < note.left;
            self.placed.iter().filter(|note| note.row == *row).all(clear)
        };
        if let Some((left, row)) = places.into_iter().find(free) {
            self.placed.push(Note { text, left, width, row });
            self.rows = self.rows.max(row + 1);
        }
    }

    pub(super) fn height(&self) -> f64 {
        self.rows as f64 * ROW
    }

    /// Draws the rows upwards from `bottom`.
    pub(super) fn draw(&self, bottom: f64) -> String {
        let draw = |note: &Note| draw_label(note.text, [note.left, bottom - note.row as f64 * ROW - 4.0]);
        self.placed.iter().map(draw).collect()
    }
}

/// Where a label is relative to its line.
#[derive(Clone, Copy)]
enum Side {
    Left,
    Middle,
    Right,
}

/// The width of a label as it is drawn.
pub(super) fn label_width(text: &str) -> f64 {
    shortened(text, SIZE, LIMIT).map_or(width(text, SIZE), |short| width(&short, SIZE))
}

/// A label from a place on its baseline.
pub(super) fn draw_label(text: &str, at: [f64; 2]) -> String {
    Label { class: "chart-note", text, size: SIZE, anchor: "start", at, limit: LIMIT, angle: 0.0 }.draw()
}

#[cfg(test)]
mod tests {
    use super::super::Axis;
    use super::*;

    #[test]
    fn labels_of_neighbouring_lines_do_not_collide() {
        let guides: Vec<Guide> =
            (0..9).map(|index| Guide::Vertical(f64::from(index), format!("line {index}"))).collect();
        let mapping = Mapping::new(&Axis::linear("").between(0.0, 60.0), None);
        let notes = Notes::new(&guides, &mapping, 50.0, 500.0);
        assert_eq!(notes.placed.len(), 9);
        for (index, note) in notes.placed.iter().enumerate() {
            let same_row = notes.placed[index + 1..].iter().filter(|other| other.row == note.row);
            let apart = |other: &Note| other.left > note.left + note.width || note.left > other.left + other.width;
            assert!(same_row.into_iter().all(apart));
        }
    }
}
