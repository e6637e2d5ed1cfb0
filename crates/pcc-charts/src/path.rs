//! Coordinates and the data of `<path>` elements.

/// Coordinates beyond this lie outside every picture; renderers mistreat larger ones.
const FARTHEST: f64 = 1e5;

/// `value` with at most one decimal.
pub(super) fn coordinate(value: f64) -> String {
    let mut text = String::new();
    push(&mut text, value);
    text
}

fn push(text: &mut String, value: f64) {
    let tenths = tenths(value);
    if tenths < 0 {
        text.push('-');
    }
    text.push_str(&(tenths.abs() / 10).to_string());
    if tenths % 10 != 0 {
        text.push('.');
        text.push(char::from(b'0' + (tenths.abs() % 10) as u8));
    }
}

/// `value` in the resolution of the picture.
pub(super) fn tenths(value: f64) -> i64 {
    (value.clamp(-FARTHEST, FARTHEST) * 10.0).round() as i64
}

/// The data of a `<path>` element, grown command by command.
#[derive(Default)]
pub(super) struct Path(String);

impl Path {
    /// Begins a new part.
    pub(super) fn move_to(&mut self, point: [f64; 2]) -> &mut Self {
        self.command('M', point)
    }

    /// Straight on to a point.
    pub(super) fn line_to(&mut self, point: [f64; 2]) -> &mut Self {
        self.command('L', point)
    }

    /// A part without length, which round line caps turn into a dot.
    pub(super) fn dot(&mut self, point: [f64; 2]) -> &mut Self {
        self.move_to(point).raw("h0")
    }

    /// An axis-parallel rectangle, from a corner.
    pub(super) fn rectangle(&mut self, corner: [f64; 2], width: f64, height: f64) -> &mut Self {
        let [left, top] = corner;
        let [right, bottom] = [left + width, top + height];
        self.move_to(corner).line_to([right, top]).line_to([right, bottom]).line_to([left, bottom]).raw("z")
    }

    /// Further commands in relative coordinates.
    pub(super) fn raw(&mut self, commands: &str) -> &mut Self {
        self.0.push_str(commands);
        self
    }

    /// The `<path>` element, or nothing if there is nothing to draw.
    pub(super) fn draw(&self, class: &str) -> String {
        if self.0.is_empty() { String::new() } else { format!("<path class=\"{class}\" d=\"{}\"/>\n", self.0) }
    }

    fn command(&mut self, letter: char, point: [f64; 2]) -> &mut Self {
        self.0.push(letter);
        push(&mut self.0, point[0]);
        self.0.push(' ');
        push(&mut self.0, point[1]);
        self
    }
}

/// The data of a `<path>` element that is full of axis-parallel rectangles, for a [`Blocks::group`].
///
/// Relative coordinates keep it short. They are tenths, because sums of whole numbers are exact: edges that are reached
/// in different ways are equal, and no gap opens between neighbours.
#[derive(Default)]
pub(super) struct Blocks {
    path: Path,
    /// Where the last rectangle has left the pen, in tenths.
    pen: [i64; 2],
}

impl Blocks {
    /// Adds a rectangle from its top left to its bottom right corner; neighbours with the same edge meet exactly.
    pub(super) fn push(&mut self, from: [f64; 2], to: [f64; 2]) {
        let ([left, top], [right, bottom]) = (from.map(tenths), to.map(tenths));
        if left >= right || top >= bottom {
            return;
        }
        let height = bottom - top;
        // A filled part needs no closing line; without it the pen stays where the next cell of a row begins.
        let steps = [('m', left - self.pen[0]), (' ', top - self.pen[1]), ('v', height), ('h', right - left)];
        for (command, length) in steps.into_iter().chain([('v', -height)]) {
            // A minus sign separates numbers by itself.
            if command != ' ' || length >= 0 {
                self.path.0.push(command);
            }
            self.path.raw(&length.to_string());
        }
        self.pen = [right, top];
    }

    /// The `<path>` element, or nothing if there is nothing to draw.
    pub(super) fn draw(&self, class: &str) -> String {
        self.path.draw(class)
    }

    /// Some of these elements at their place, or nothing if there are none.
    pub(super) fn group(elements: &str) -> String {
        if elements.is_empty() {
            return String::new();
        }
        format!("<g class=\"chart-cells\" transform=\"scale(0.1)\">\n{elements}</g>\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_have_one_decimal_at_most() {
        let texts = [0.04, -0.04, -0.25, 12.0, 12.34, -7.96].map(coordinate);
        assert_eq!(texts, ["0", "0", "-0.3", "12", "12.3", "-8"]);
        assert_eq!([f64::NAN, f64::INFINITY, -1e300].map(coordinate), ["0", "100000", "-100000"]);
    }

    #[test]
    fn blocks_are_relative_to_the_one_before() {
        let mut blocks = Blocks::default();
        for (from, to) in [([10.0, 5.0], [12.0, 8.04]), ([12.0, 5.0], [13.5, 8.0]), ([1.0, 2.0], [1.02, 4.0])] {
            blocks.push(from, to);
        }
        blocks.push([3.0, 0.0], [4.0, 5.0]);
        let expected = "m100 50v30h20v-30m0 0v30h15v-30m-105-50v50h10v-50";
        assert_eq!(blocks.draw("c"), format!("<path class=\"c\" d=\"{expected}\"/>\n"));
    }
}
