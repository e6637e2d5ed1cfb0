//! Text to lexemes: numbers, names, functions, operators, parentheses and commas.

use super::error::{Fault, TextError};
use super::excerpt::{excerpt, printable};
use super::name::{LOG, begins_name, continues_name};
use super::operation::{Operation, function};

/// Longest text in characters: a hundred times what people write on a line, and short enough to be read in no time.
pub(super) const LONGEST_TEXT: usize = 10_000;

/// What a lexeme is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Name,
    Function(Operation),
    Plus,
    Minus,
    Times,
    Over,
    Power,
    Open,
    Close,
    Comma,
}

/// A piece of the text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lexeme<'t> {
    pub token: Token,
    pub text: &'t str,
    /// Where it begins, in characters from 1.
    pub column: usize,
}

/// All lexemes of `text`.
pub(super) fn lexemes(text: &str) -> Result<Vec<Lexeme<'_>>, Fault> {
    if text.chars().nth(LONGEST_TEXT).is_some() {
        return Err(Fault { column: LONGEST_TEXT + 1, problem: TextError::TooLong });
    }
    let (mut lexemes, mut rest, mut column) = (Vec::new(), text, 1);
    while let Some(first) = rest.chars().next() {
        let mut length = first.len_utf8();
        if !matches!(first, ' ' | '\t' | '\n' | '\r') {
            let token;
            (token, length) = token_at(rest, first).map_err(|problem| Fault { column, problem })?;
            lexemes.push(Lexeme { token, text: &rest[..length], column });
        }
        column += rest[..length].chars().count();
        rest = &rest[length..];
    }
    Ok(lexemes)
}

/// The token that `rest` begins with, and its length in bytes.
fn token_at(rest: &str, first: char) -> Result<(Token, usize), TextError> {
    let token = match first {
        '+' => Token::Plus,
        '-' => Token::Minus,
        '*' if rest.starts_with("**") => return Err(TextError::DoubleStar),
        '*' => Token::Times,
        '/' => Token::Over,
        '^' => Token::Power,
        '(' => Token::Open,
        ')' => Token::Close,
        ',' => Token::Comma,
        '0'..='9' | '.' => return number(rest),
        _ if begins_name(first) => return word(rest),
        _ => return Err(TextError::Character { character: printable(first), advice: advice(first) }),
    };
    Ok((token, first.len_utf8()))
}

/// A name or a function.
fn word(rest: &str) -> Result<(Token, usize), TextError> {
    let length = rest.find(|character| !continues_name(character)).unwrap_or(rest.len());
    let word = &rest[..length];
    if word == LOG {
        return Err(TextError::AmbiguousLogarithm);
    }
    Ok((function(word).map_or(Token::Name, Token::Function), length))
}

fn number(rest: &str) -> Result<(Token, usize), TextError> {
    let length = number_length(rest);
    match rest[..length].parse() {
        Ok(value) if f64::is_finite(value) => Ok((Token::Number(value), length)),
        _ => Err(TextError::Number { number: excerpt(&rest[..length], 1) }),
    }
}

/// Bytes of digits and points, and of the exponent if digits follow its e: `2e` is the number 2 and the name e.
fn number_length(rest: &str) -> usize {
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let mantissa = rest.bytes().take_while(|byte| byte.is_ascii_digit() || *byte == b'.').count();
    let Some(exponent) = rest[mantissa..].strip_prefix(['e', 'E']) else { return mantissa };
    let unsigned = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
    match digits(unsigned) {
        0 => mantissa,
        digits => rest.len() - unsigned.len() + digits,
    }
}

/// What to write instead of a character that people may take for an operator or a letter.
fn advice(character: char) -> &'static str {
    match character {
        '=' => "; write only what stands right of the equals sign",
        '[' | ']' | '{' | '}' => "; write parentheses ( )",
        '−' | '–' => "; write - for minus",
        '×' | '·' | '⋅' | '∙' | '•' => "; write * for products",
        '÷' | ':' | '∕' => "; write / for quotients",
        '²' => "; write ^2",
        '³' => "; write ^3",
        '√' => "; write sqrt(…)",
        '|' => "; write abs(…)",
        '°' => "; angles are in radians, write *pi/180",
        '%' => "; write /100",
        '\u{b5}' => ", it is the micro sign; write the Greek letter mu or mu in letters",
        '\u{2126}' => ", it is the ohm sign; write the Greek letter Omega or Omega in letters",
        _ if character.is_whitespace() => "; write a plain space",
        _ if character.is_alphabetic() => "; names take Latin letters without accents and Greek ones",
        _ => "; remove it",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(text: &str) -> Vec<Token> {
        lexemes(text).unwrap().iter().map(|lexeme| lexeme.token).collect()
    }

    #[test]
    fn numbers_are_read_as_written() {
        for (text, value) in
            [("1e-3", 1e-3), ("16e6", 16e6), (".5", 0.5), ("2.", 2.0), ("1E+3", 1e3), ("1.e2", 1e2), ("007", 7.0)]
        {
            assert_eq!(tokens(text), [Token::Number(value)], "{text}");
        }
        for text in ["1.2.3", ".", "..", "1e999", ".e5", "1..2"] {
            assert!(matches!(lexemes(text), Err(Fault { problem: TextError::Number { .. }, .. })), "{text}");
        }
        assert_eq!(tokens("2e"), [Token::Number(2.0), Token::Name]);
        assert_eq!(tokens("2e+"), [Token::Number(2.0), Token::Name, Token::Plus]);
    }

    #[test]
    fn names_are_not_torn_into_functions() {
        for text in ["sin_beta", "pi_2", "max_k", "exp1", "e", "E", "k_A", "αβ_1", "minimum", "atan2x", "logarithm"] {
            assert_eq!(tokens(text), [Token::Name], "{text}");
        }
        assert_eq!(tokens("sin"), [Token::Function(Operation::Sine)]);
    }

    #[test]
    fn columns_count_characters() {
        let lexemes = lexemes("γ_1 *\tΩ").unwrap();
        assert_eq!(lexemes.iter().map(|lexeme| lexeme.column).collect::<Vec<_>>(), [1, 5, 7]);
        assert_eq!(lexemes[2].text, "Ω");
    }
}
