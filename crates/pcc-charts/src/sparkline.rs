//! A curve as small as a word, for a cell of a table.

use super::path::Path;
use super::text::escape;

/// Size of the picture.
const WIDTH: f64 = 120.0;
const HEIGHT: f64 = 28.0;

/// Room for lines at the edges.
const MARGIN: f64 = 1.5;

/// A curve over a base line, a part of which has its area filled, with marks where that ends. It has no axes: the table
/// says in words what it is.
///
/// # Examples
///
/// ```
/// use pcc_charts::Sparkline;
/// let triangle = Sparkline {
///     title: "density of x".to_string(),
///     description: "triangular, from 0 to 2".to_string(),
///     curve: vec![[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]],
///     filled: [0.5, 1.0],
/// };
/// let svg = triangle.to_svg();
/// assert!(svg.contains("<title>density of x</title><desc>triangular, from 0 to 2</desc>"));
/// // From one to the other, half as high at the first.
/// assert!(svg.contains("M30.8 26.5L30.8 14L60 1.5L60 26.5z"), "{svg}");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sparkline {
    /// What it is.
    pub title: String,
    /// Text alternative: what the picture shows.
    pub description: String,
    /// Points in ascending order of the first coordinate; heights count from 0. Those that are not finite are skipped.
    pub curve: Vec<[f64; 2]>,
    /// Between which places the area is filled.
    pub filled: [f64; 2],
}

impl Sparkline {
    /// Draws it as an `<svg>` element for an HTML page that carries [`super::STYLE`].
    pub fn to_svg(&self) -> String {
        let curve: Vec<[f64; 2]> =
            self.curve.iter().filter(|point| point.iter().all(|x| x.is_finite())).copied().collect();
        let end = |ends: Option<&[f64; 2]>| ends.map_or(0.0, |point| point[0]);
        let (low, high) = (end(curve.first()), end(curve.last()));
        let top = curve.iter().map(|point| point[1]).fold(0.0, f64::max);
        let share = |value: f64, whole: f64| if whole > 0.0 { (value / whole).clamp(0.0, 1.0) } else { 0.0 };
        let place = |[x, y]: [f64; 2]| {
            let across = MARGIN + share(x - low, high - low) * (WIDTH - 2.0 * MARGIN);
            [across, HEIGHT - MARGIN - share(y, top) * (HEIGHT - 2.0 * MARGIN)]
        };
        let (mut base, mut line, mut area) = (Path::default(), Path::default(), Path::default());
        base.move_to(place([low, 0.0])).line_to(place([high, 0.0]));
        draw(&mut line, &curve, place);
        let filled = self.part_to_fill(&curve);
        if let (Some(first), Some(last)) = (filled.first(), filled.last()) {
            area.move_to(place([first[0], 0.0]));
            for &point in &filled {
                area.line_to(place(point));
            }
            area.line_to(place([last[0], 0.0])).raw("z");
        }
        for end in self.filled.into_iter().filter(|end| low < *end && *end < high) {
            base.move_to(place([end, 0.0])).line_to(place([end, top]));
        }
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart chart-sparkline chart-blue\" role=\"img\" \
             viewBox=\"0 0 {WIDTH} {HEIGHT}\"><title>{}</title><desc>{}</desc>\n{}{}{}</svg>",
            escape(&self.title),
            escape(&self.description),
            base.draw("chart-axis"),
            area.draw("chart-area"),
            line.draw("chart-line")
        )
    }

    /// The curve between the ends of what is filled, which lie on it.
    fn part_to_fill(&self, curve: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let [from, to] = self.filled;
        let mut part = Vec::new();
        for pair in curve.windows(2) {
            let [[x0, y0], [x1, y1]] = [pair[0], pair[1]];
            let (start, end) = (from.max(x0), to.min(x1));
            if start > end {
                continue;
            }
            let height = |x: f64| if x1 > x0 { y0 + (y1 - y0) * (x - x0) / (x1 - x0) } else { y1 };
            let ends = if x1 > x0 { [[start, height(start)], [end, height(end)]] } else { [[x0, y0], [x1, y1]] };
            for point in ends {
                if part.last() != Some(&point) {
                    part.push(point);
                }
            }
        }
        part
    }
}

fn draw(path: &mut Path, curve: &[[f64; 2]], place: impl Fn([f64; 2]) -> [f64; 2]) {
    for (at, &point) in curve.iter().enumerate() {
        match at {
            0 => path.move_to(place(point)),
            _ => path.line_to(place(point)),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn svg(curve: Vec<[f64; 2]>, filled: [f64; 2]) -> String {
        Sparkline { title: "</title>".to_string(), description: "</svg><script>".to_string(), curve, filled }.to_svg()
    }

    #[test]
    fn what_cannot_be_drawn_is_skipped() {
        let nan = f64::NAN;
        for curve in [vec![], vec![[1.0, 1.0]], vec![[0.0, 0.0], [nan, 1.0], [0.0, f64::INFINITY]], vec![[2.0, 0.0]; 3]]
        {
            let svg = svg(curve, [f64::NEG_INFINITY, nan]);
            assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains("<script"), "{svg}");
        }
    }

    #[test]
    fn nothing_is_filled_beyond_the_curve() {
        let all = svg(vec![[0.0, 1.0], [1.0, 1.0]], [-5.0, 7.0]);
        assert!(all.contains("d=\"M1.5 26.5L1.5 1.5L118.5 1.5L118.5 26.5z\""), "{all}");
        assert!(all.contains("class=\"chart-axis\" d=\"M1.5 26.5L118.5 26.5\""), "{all}");
        let none = svg(vec![[0.0, 1.0], [1.0, 1.0]], [2.0, 3.0]);
        assert!(!none.contains("chart-area"), "{none}");
    }

    #[test]
    fn steps_have_both_of_their_heights() {
        let step = svg(vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.5], [2.0, 0.5]], [0.5, 1.5]);
        assert!(step.contains("M30.8 26.5L30.8 1.5M89.3 26.5L89.3 1.5"), "{step}");
        assert!(step.contains("M30.8 26.5L30.8 1.5L60 1.5L60 14L89.3 14L89.3 26.5z"), "{step}");
    }
}
