//! Words for what is not a number, where some languages write them into JSON.

/// In lower case.
const WORDS: [&str; 3] = ["nan", "infinity", "inf"];

/// The first word outside of strings that means what is not a number.
pub(super) fn bare(text: &str) -> Option<String> {
    let mut outside = String::with_capacity(text.len());
    let (mut is_inside, mut is_escaped) = (false, false);
    for character in text.chars() {
        match character {
            '"' if !is_escaped => is_inside = !is_inside,
            _ if !is_inside => outside.push(character),
            _ => {}
        }
        is_escaped = is_inside && character == '\\' && !is_escaped;
    }
    let mut words = outside.split(|character: char| !character.is_alphanumeric());
    words.find(|word| WORDS.iter().any(|name| word.eq_ignore_ascii_case(name))).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_in_strings_are_not_numbers() {
        assert_eq!(bare(r#"{"NaN": "\"NaN", "x": [1, -Infinity"#).as_deref(), Some("Infinity"));
        assert_eq!(bare(r#"{"NaN": "inf", "x": nanometre"#), None);
        assert_eq!(bare(r#"{"\\": nan"#).as_deref(), Some("nan"));
    }
}
