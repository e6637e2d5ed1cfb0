//! Users' text in messages: short, on one line, harmless to a terminal.

/// Characters of users' text that a message quotes at most: what fits a line beside the message.
const LONGEST_EXCERPT: usize = 60;

/// `text` around the character number `column`, counted from 1, with … where something is left out. Characters that do
/// not print are escaped.
pub(super) fn excerpt(text: &str, column: usize) -> String {
    let length = text.chars().count();
    if length <= LONGEST_EXCERPT {
        return text.chars().map(printable).collect();
    }
    let first = column.saturating_sub(LONGEST_EXCERPT / 2).min(length - LONGEST_EXCERPT);
    let before = if first > 0 { "…" } else { "" };
    let after = if first + LONGEST_EXCERPT < length { "…" } else { "" };
    let shown: String = text.chars().skip(first).take(LONGEST_EXCERPT).map(printable).collect();
    format!("{before}{shown}{after}")
}

/// A character as it is, or escaped if it does not print.
pub(super) fn printable(character: char) -> String {
    match character {
        '"' | '\'' | '\\' => character.to_string(),
        _ => character.escape_debug().to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_texts_are_shown_around_the_column() {
        let text: String = ('a'..='z').cycle().take(100).collect();
        assert_eq!(excerpt(&text, 1), format!("{}…", &text[..60]));
        assert_eq!(excerpt(&text, 50), format!("…{}…", &text[20..80]));
        assert_eq!(excerpt(&text, 101), format!("…{}", &text[40..]));
        assert_eq!(excerpt(&text[..60], 1), text[..60]);
    }

    #[test]
    fn what_does_not_print_is_escaped() {
        assert_eq!(excerpt("a\n\u{1b}[2J\u{202e}\"'\\μ", 1), "a\\n\\u{1b}[2J\\u{202e}\"'\\μ");
    }
}
