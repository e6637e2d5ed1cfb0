//! Text in a given width.
//!
//! `{report}` is the answer, `{report:#}` has every detail, `{report:120}` takes so many columns: without a width it is
//! [`WIDTH`].

use std::fmt;

/// Columns of a terminal of which nothing is known.
pub(crate) const WIDTH: usize = 80;

/// Narrower than this nothing is readable.
const LEAST: usize = 40;

/// Columns of the names of facts at least.
const NAME: usize = 17;

/// Spaces between columns.
const GAP: &str = "  ";

/// The columns there are.
pub(crate) fn width(f: &fmt::Formatter<'_>) -> usize {
    f.width().unwrap_or(WIDTH).max(LEAST)
}

/// Words in lines of at most `width` columns, later lines indented by so many. Words are not divided.
pub(super) fn wrapped(text: &str, width: usize, indent: usize) -> String {
    text.split('\n').map(|paragraph| flowing(paragraph, width, 0, indent)).collect::<Vec<_>>().join("\n")
}

/// The same of one paragraph, whose first line has so many columns before it.
fn flowing(text: &str, width: usize, before: usize, indent: usize) -> String {
    let (mut lines, mut length, mut is_first) = (String::new(), before, true);
    for word in text.split(' ') {
        let own = word.chars().count();
        if !is_first && length + 1 + own > width {
            lines.truncate(lines.trim_end().len());
            lines.push('\n');
            lines.push_str(&" ".repeat(indent));
            length = indent;
        } else if !is_first {
            lines.push(' ');
            length += 1;
        }
        lines.push_str(word);
        length += own;
        is_first = false;
    }
    lines.truncate(lines.trim_end().len());
    lines
}

/// What to know first.
pub(super) fn write_warnings(f: &mut fmt::Formatter<'_>, warnings: &[String]) -> fmt::Result {
    let columns = width(f);
    warnings.iter().try_for_each(|warning| writeln!(f, "{}", wrapped(&format!("warning: {warning}"), columns, 9)))?;
    if warnings.is_empty() { Ok(()) } else { writeln!(f) }
}

/// The answer in a sentence or two.
pub(super) fn write_verdict(f: &mut fmt::Formatter<'_>, verdict: &str) -> fmt::Result {
    let columns = width(f);
    writeln!(f, "{}\n", wrapped(verdict, columns, 0))
}

/// Lines of a name, a value and words on it.
#[derive(Debug, Default)]
pub(super) struct Facts(Vec<[String; 3]>);

impl Facts {
    pub fn add(&mut self, name: &str, value: impl Into<String>, words: impl Into<String>) {
        self.0.push([name.to_owned(), value.into(), words.into()]);
    }

    /// Names, and all there is to say of each, for other faces than the terminal.
    pub fn pairs(&self) -> Vec<(&str, String)> {
        fn pair([name, value, words]: &[String; 3]) -> (&str, String) {
            match words.is_empty() {
                true => (name.as_str(), value.clone()),
                false => (name.as_str(), format!("{value}; {words}")),
            }
        }
        self.0.iter().map(pair).collect()
    }
}

impl fmt::Display for Facts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = width(f);
        let length = |text: &str| text.chars().count();
        let values = self.0.iter().filter(|[_, _, words]| !words.is_empty()).map(|[_, value, _]| length(value)).max();
        let values = values.unwrap_or(0);
        let names = self.0.iter().map(|[name, ..]| length(name)).max().unwrap_or(0).max(NAME);
        let before = GAP.len() + names + GAP.len();
        for [name, value, words] in &self.0 {
            let start = format!("{GAP}{name:<names$}{GAP}");
            let line = match words.is_empty() {
                true => format!("{start}{value}"),
                false => format!("{start}{value:<values$}{GAP}{words}"),
            };
            let indent = if words.is_empty() { before } else { before + values + GAP.len() };
            // Where little would stand beside the value, words go on below it.
            let indent = if columns < indent + LEAST / 2 { before } else { indent };
            writeln!(f, "{}", wrapped_after(&line, columns, indent))?;
        }
        Ok(())
    }
}

/// The same of a line whose beginning is aligned.
fn wrapped_after(line: &str, width: usize, indent: usize) -> String {
    if line.chars().count() <= width {
        return line.trim_end().to_owned();
    }
    let split = line.char_indices().nth(indent).map_or(line.len(), |(at, _)| at);
    let (start, rest) = line.split_at(split);
    // A value that reaches beyond its column has words after it.
    let before = start.chars().count();
    format!("{start}{}", flowing(rest, width, before, indent))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_keep_the_width_and_lose_no_word() {
        let text = "one two three four five six seven";
        for width in 5..40 {
            let found = wrapped(text, width, 2);
            assert!(found.lines().all(|line| line.chars().count() <= width.max(7)), "{found}");
            assert_eq!(found.split_whitespace().collect::<Vec<_>>(), text.split(' ').collect::<Vec<_>>());
        }
    }

    #[test]
    fn facts_stand_in_columns() {
        let mut facts = Facts::default();
        facts.add("stable", "19.978 %", "judged by modes 1 to 4");
        facts.add("sampling interval", "19.899 to 20.056 %", "95 %, what the number of samples leaves open, and more");
        facts.add("verified bound", "none yet", "");
        assert_eq!(
            facts.to_string(),
            "  stable             19.978 %            judged by modes 1 to 4\n\
             \x20 sampling interval  19.899 to 20.056 %  95 %, what the number of samples leaves\n\
             \x20                                        open, and more\n\
             \x20 verified bound     none yet\n"
        );
    }
}
