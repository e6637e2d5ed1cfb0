//! Text of others, made safe to print on a terminal.

use std::path::Path;

/// Characters of a foreign cell, name or value in a message.
pub(super) const SHOWN_CELL: usize = 60;
/// Characters of a foreign message.
pub(super) const MESSAGE_LENGTH: usize = 2000;
/// Characters of a path, as long as systems allow.
const PATH_LENGTH: usize = 4096;

/// `path` on one line.
pub(super) fn path(path: &Path) -> String {
    line(&path.to_string_lossy(), PATH_LENGTH)
}

/// `text` on one line: control characters and line ends are escaped, and what exceeds `length` characters is cut.
pub(super) fn line(text: &str, length: usize) -> String {
    // Escapes only make it longer: no more than this can be needed.
    let beginning: String = text.chars().take(length + 1).collect();
    let escaped = escaped(&beginning, false);
    if escaped.chars().count() <= length {
        return escaped;
    }
    escaped.chars().take(length).chain(['…']).collect()
}

/// The last `lines` lines of `text`, and of these the last `length` characters. Control characters other than line ends
/// are escaped.
pub(super) fn last_lines(text: &str, lines: usize, length: usize) -> String {
    let escaped = escaped(text.replace("\r\n", "\n").trim_end(), true);
    let start = escaped.rmatch_indices('\n').nth(lines - 1).map_or(0, |(newline, _)| newline + 1);
    let kept = &escaped[start..];
    match kept.char_indices().rev().nth(length - 1) {
        Some((cut, _)) if cut > 0 => format!("…{}", &kept[cut..]),
        _ => kept.to_owned(),
    }
}

fn escaped(text: &str, keeps_newlines: bool) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        if is_dangerous(character) && !(keeps_newlines && character == '\n') {
            escaped.extend(character.escape_default());
        } else {
            escaped.push(character);
        }
    }
    escaped
}

/// Characters that move the cursor, colour the terminal, or let text appear in another order than it is written.
fn is_dangerous(character: char) -> bool {
    character.is_control()
        || matches!(character, '\u{200e}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_escaped() {
        assert_eq!(line("a\u{1b}[31m\tb\nc\u{202e}é", 60), "a\\u{1b}[31m\\tb\\nc\\u{202e}é");
        assert_eq!(last_lines("a\r\n\u{7}b\rc\n\n", 20, 2000), "a\n\\u{7}b\\rc");
    }

    #[test]
    fn long_text_is_cut_at_the_right_end() {
        assert_eq!(line("ééééé", 5), "ééééé");
        assert_eq!(line("ééééé", 4), "éééé…");
        assert_eq!(last_lines("1\n2\n3\n", 2, 100), "2\n3");
        assert_eq!(last_lines("1\n2\n3", 3, 100), "1\n2\n3");
        assert_eq!(last_lines("ééééé", 3, 5), "ééééé");
        assert_eq!(last_lines("ééééé", 3, 4), "…éééé");
        assert_eq!(last_lines("", 3, 4), "");
    }
}
