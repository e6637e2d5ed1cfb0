//! The levels by which cells are shaded, and the scale in the legend that tells what they mean.

use super::path::Blocks;
use super::text::{Label, shortened, width};

/// Classes of the levels in the style sheet, from the least to the greatest.
pub(super) const CLASSES: [&str; 10] = [
    "chart-level-0",
    "chart-level-1",
    "chart-level-2",
    "chart-level-3",
    "chart-level-4",
    "chart-level-5",
    "chart-level-6",
    "chart-level-7",
    "chart-level-8",
    "chart-level-9",
];

/// The level of a share: a tenth each, with its lower end and without the upper one, but for 1.
///
/// A half thus begins a level, so that the border between less and more can be seen.
pub(super) fn of(share: f64) -> usize {
    let levels = CLASSES.len();
    ((share.clamp(0.0, 1.0) * levels as f64) as usize).min(levels - 1)
}

const SIZE: f64 = 12.0;
const LONGEST_NAME: f64 = 220.0;
/// Size of the sample of a level.
const SAMPLE: [f64; 2] = [17.0, 11.0];
const DISTANCE: f64 = 8.0;
/// What is written under the samples, and after how many of them.
const MARKS: [(&str, f64); 3] = [("0 %", 0.0), ("50 %", 5.0), ("100 %", 10.0)];

/// The scale of a series of cells: its name, a sample of each level, and shares in per cent.
pub(super) struct Ramp<'a> {
    pub name: &'a str,
}

impl Ramp<'_> {
    pub(super) const HEIGHT: f64 = 34.0;

    /// Room the name takes, so that the rest stays within `limit`.
    fn name_width(&self, limit: f64) -> f64 {
        let longest = name_limit(limit);
        width(shortened(self.name, SIZE, longest).as_deref().unwrap_or(self.name), SIZE)
    }

    /// Draws the scale from its top left corner, not wider than `limit`.
    pub(super) fn draw(&self, [left, top]: [f64; 2], limit: f64) -> String {
        let label = |class, text, anchor, at| {
            Label { class, text, size: SIZE, anchor, at, limit: name_limit(limit), angle: 0.0 }.draw()
        };
        let name = label("chart-name", self.name, "start", [left, top + 13.0]);
        let start = left + self.name_width(limit) + DISTANCE + overhang(MARKS[0].0);
        let sample = |(number, class): (usize, &&'static str)| {
            let corner = [start + number as f64 * SAMPLE[0], top + 3.0];
            let mut block = Blocks::default();
            block.push(corner, [corner[0] + SAMPLE[0], corner[1] + SAMPLE[1]]);
            block.draw(class)
        };
        let samples: String = CLASSES.iter().enumerate().map(sample).collect();
        let under = |(text, after)| label("chart-tick", text, "middle", [start + after * SAMPLE[0], top + 26.0]);
        format!("{name}{}{}", Blocks::group(&samples), MARKS.map(under).concat())
    }
}

/// How far a mark reaches beyond its place.
fn overhang(mark: &str) -> f64 {
    width(mark, SIZE) / 2.0
}

/// The longest name that leaves room for the samples.
fn name_limit(limit: f64) -> f64 {
    let [first, .., last] = MARKS.map(|(text, _)| overhang(text));
    let samples = SAMPLE[0] * CLASSES.len() as f64;
    (limit - DISTANCE - first - samples - last).clamp(0.0, LONGEST_NAME)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tenth_begins_its_level() {
        for level in 0..10 {
            let start = level as f64 / 10.0;
            assert_eq!(of(start), level);
            assert_eq!(of(start - 1e-9), level.saturating_sub(1));
        }
        assert_eq!([1.0, 7.0, f64::INFINITY, -1.0].map(of), [9, 9, 9, 0]);
    }

    #[test]
    fn long_names_leave_room_for_the_samples() {
        for limit in [250.0, 394.0, 600.0] {
            for name in ["", "Share", &"a long name ".repeat(9)] {
                let svg = Ramp { name }.draw([0.0, 0.0], limit);
                let last = svg.split("<text").last().and_then(|text| text.split("x=\"").nth(1)).unwrap();
                let place: f64 = last.split('"').next().unwrap().parse().unwrap();
                assert!(place + overhang("100 %") <= limit + 0.1, "{name} in {limit}: {place}");
            }
        }
    }
}
