//! A bound on the parser's recursion, known before it starts.

use super::error::{Fault, TextError};
use super::lexer::{Lexeme, Token};

/// Deepest nesting of parentheses, signs and exponents. Nobody can read ten levels. A level takes up to 2 KB of stack,
/// or 18 KB when nothing is optimized, so that these are half of the 2 MiB of a thread in the worst case.
pub(super) const DEEPEST_NESTING: usize = 64;

/// How deep the parser is in its recursion.
#[derive(Debug, Clone, Copy, Default)]
struct Depth {
    /// Levels outside of the innermost parentheses.
    outer: usize,
    /// Signs and exponents in the innermost parentheses that wait for their operand: `- - x`, `x^y^z`. The next
    /// operator that binds less than they do ends all of them.
    waiting: usize,
}

/// Refuses lexemes that the parser would go too deep for.
pub(super) fn check(lexemes: &[Lexeme]) -> Result<(), Fault> {
    let (mut depth, mut enclosing) = (Depth::default(), Vec::new());
    let mut follows_value = false;
    for lexeme in lexemes {
        match lexeme.token {
            Token::Open => {
                enclosing.push(depth);
                depth = Depth { outer: depth.outer + depth.waiting + 1, waiting: 0 };
            }
            // An unmatched one is for the parser to refuse.
            Token::Close => depth = enclosing.pop().unwrap_or_default(),
            Token::Power => depth.waiting += 1,
            Token::Plus | Token::Minus if !follows_value => depth.waiting += 1,
            Token::Plus | Token::Minus | Token::Times | Token::Over | Token::Comma => depth.waiting = 0,
            Token::Number(_) | Token::Name | Token::Function(_) => {}
        }
        if depth.outer + depth.waiting > DEEPEST_NESTING {
            return Err(Fault { column: lexeme.column, problem: TextError::TooDeep });
        }
        follows_value = matches!(lexeme.token, Token::Number(_) | Token::Name | Token::Close);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::lexer::lexemes;
    use super::*;

    fn is_allowed(text: &str) -> bool {
        check(&lexemes(text).unwrap()).is_ok()
    }

    #[test]
    fn every_way_to_nest_is_counted() {
        for unit in ["(", "-", "x^", "sin(", "min(x, ", "-(x+", "2^-"] {
            let levels = unit.matches(['(', '^']).count() + unit.matches('-').count();
            let most = DEEPEST_NESTING / levels;
            assert!(is_allowed(&unit.repeat(most)), "{unit}");
            assert!(!is_allowed(&unit.repeat(most + 1)), "{unit}");
        }
    }

    #[test]
    fn length_alone_is_no_depth() {
        for unit in ["x-", "x*", "(x)+", "-x*", "x^2+", "-x^-2/", "max(x, -x)+"] {
            assert!(is_allowed(&unit.repeat(800)), "{unit}");
        }
    }
}
