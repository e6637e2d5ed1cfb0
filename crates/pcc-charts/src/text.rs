//! Text in SVG: escaping, widths, and labels that are shortened to fit.

use super::path::coordinate;

/// `text` as character data or attribute value of XML or HTML: nothing in it is markup, line ends are spaces, and what
/// XML cannot hold is dropped.
///
/// ```
/// assert_eq!(pcc_charts::escape("<b> & 'c'"), "&lt;b&gt; &amp; &#39;c&#39;");
/// ```
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\t' | '\n' | '\r' => escaped.push(' '),
            '\u{fffe}' | '\u{ffff}' => {}
            control if control.is_control() => {}
            other => escaped.push(other),
        }
    }
    escaped
}

/// `id` as the start of an XML identifier.
pub(super) fn identifier(id: &str) -> String {
    let allowed = |character: char| character.is_ascii_alphanumeric() || matches!(character, '-' | '_');
    let name: String = id.chars().map(|character| if allowed(character) { character } else { '-' }).collect();
    if name.starts_with(|first: char| first.is_ascii_alphabetic()) { name } else { format!("chart{name}") }
}

/// Estimated width of `text` in a sans-serif font of `size`.
///
/// Which font the reader has is unknown; the factors are those of a wide one, so that labels rather keep a distance.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let factor = |character: char| match character {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | ' ' | '\u{2009}' => 0.33,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '-' | '/' | '"' => 0.42,
        '⁰'..='⁹' | '⁻' | '¹' | '²' | '³' => 0.42,
        'm' | 'w' | 'M' | 'W' | '@' | '%' | '…' => 0.98,
        'A'..='Z' | '×' | '−' | '+' | '=' | '<' | '>' => 0.75,
        '\u{300}'..='\u{36f}' | '\u{200b}'..='\u{200f}' => 0.0,
        wide if wide >= '\u{2e80}' => 1.05,
        _ => 0.62,
    };
    text.chars().map(factor).sum::<f64>() * size
}

/// `text` cut to `limit` with an ellipsis, or nothing if it fits as it is.
pub(super) fn shortened(text: &str, size: f64, limit: f64) -> Option<String> {
    if width(text, size) <= limit {
        return None;
    }
    let mut room = limit - width("…", size);
    let fits = |character: &char| {
        room -= width(character.encode_utf8(&mut [0; 4]), size);
        room >= 0.0
    };
    let kept: String = text.chars().take_while(fits).collect();
    Some(format!("{}…", kept.trim_end()))
}

/// A line of text at a place.
pub(super) struct Label<'a> {
    /// Class in the style sheet.
    pub class: &'static str,
    /// What it says, not yet escaped.
    pub text: &'a str,
    /// Font size; has to agree with the class.
    pub size: f64,
    /// Which part of the text is at the place: `start`, `middle` or `end`.
    pub anchor: &'static str,
    /// Horizontal place and baseline.
    pub at: [f64; 2],
    /// Longest extent; longer text is shortened and becomes a tooltip.
    pub limit: f64,
    /// Turn in degrees, against the clock where negative.
    pub angle: f64,
}

impl Label<'_> {
    /// The `<text>` element.
    pub(super) fn draw(&self) -> String {
        let [x, y] = self.at.map(coordinate);
        let place = if self.angle == 0.0 {
            format!("x=\"{x}\" y=\"{y}\"")
        } else {
            format!("transform=\"translate({x} {y})rotate({})\"", coordinate(self.angle))
        };
        let content = match shortened(self.text, self.size, self.limit) {
            Some(short) => format!("<title>{}</title>{}", escape(self.text), escape(&short)),
            None => escape(self.text),
        };
        format!("<text class=\"{}\" {place} text-anchor=\"{}\">{content}</text>\n", self.class, self.anchor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_becomes_text_and_control_characters_vanish() {
        assert_eq!(escape("<b a=\"1\">'&'\u{0}\u{1b}\u{7f}\u{ffff}\n"), "&lt;b a=&quot;1&quot;&gt;&#39;&amp;&#39; ");
    }

    #[test]
    fn identifiers_start_with_a_letter_and_hold_no_markup() {
        assert_eq!(identifier("fig-1_a"), "fig-1_a");
        assert_eq!(identifier("1\" onload=\"x"), "chart1--onload--x");
        assert_eq!(identifier(""), "chart");
    }

    #[test]
    fn shortened_text_fits() {
        assert_eq!(shortened("gamma_1", 12.0, 100.0), None);
        for limit in [0.0, 20.0, 60.0] {
            let short = shortened("a rather long name of a series", 12.0, limit).unwrap();
            assert!(short.ends_with('…') && width(&short, 12.0) <= limit.max(12.0));
        }
    }
}
