//! Lexemes to postfix order.
//!
//! Operators are sorted by precedence by the Pratt parser of the crate winnow, as published by Pratt (1973),
//! <https://doi.org/10.1145/512927.512931>. It calls what combines operands in just the order of postfix notation, so
//! nothing but the list of items is built: `-(a + 2)` becomes a, 2, add, negate.

use super::error::{Fault, TextError};
use super::excerpt::excerpt;
use super::lexer::{Lexeme, Token, lexemes};
use super::nesting;
use super::operation::Operation;
use winnow::Parser;
use winnow::combinator::{Infix, Prefix, cut_err, expression, fail};
use winnow::error::{ErrMode, ParserError};
use winnow::stream::Stateful;
use winnow::token::any;

/// Binding powers. A sign binds less than a power and more than a product, also in an exponent: `2^-x^2`.
const SUM: i64 = 1;
const PRODUCT: i64 = 3;
const SIGN: i64 = 5;
const POWER: i64 = 7;

/// One item of an expression in postfix order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Item<'t> {
    Number(f64),
    Name {
        name: &'t str,
        /// Where it stands, in characters from 1.
        column: usize,
    },
    /// Takes as many of the last results as it has operands.
    Apply(Operation),
}

/// What the parser has found so far.
#[derive(Debug)]
struct Found<'t> {
    postfix: Vec<Item<'t>>,
    /// Column after the last character.
    end: usize,
}

type Input<'l, 't> = Stateful<&'l [Lexeme<'t>], Found<'t>>;
type Parsed<T> = Result<T, ErrMode<Fault>>;

/// The items of `text` in postfix order: every operation finds its operands, and one result is left.
pub(super) fn parse(text: &str) -> Result<Vec<Item<'_>>, Fault> {
    let lexemes = lexemes(text)?;
    if lexemes.is_empty() {
        return Err(Fault { column: 1, problem: TextError::Empty });
    }
    nesting::check(&lexemes)?;
    let state = Found { postfix: Vec::with_capacity(lexemes.len()), end: text.chars().count() + 1 };
    let mut input = Input { input: &lexemes, state };
    match whole(&mut input) {
        Ok(()) => Ok(input.state.postfix),
        Err(ErrMode::Backtrack(fault) | ErrMode::Cut(fault)) => Err(fault),
        // Only of streams that are still being read.
        Err(ErrMode::Incomplete(_)) => Err(Fault::from_input(&input)),
    }
}

/// A sum and nothing behind it.
fn whole(input: &mut Input) -> Parsed<()> {
    sum(input)?;
    match input.input.first() {
        None => Ok(()),
        Some(&behind) => Err(unexpected(behind)),
    }
}

/// Operands and operators up to something that can be neither.
fn sum(input: &mut Input) -> Parsed<()> {
    expression(operand).prefix(sign).infix(operator).parse_next(input)
}

fn operand(input: &mut Input) -> Parsed<()> {
    let lexeme = any.parse_next(input)?;
    match lexeme.token {
        Token::Number(value) => input.state.postfix.push(Item::Number(value)),
        Token::Name if next_is(input, Token::Open) => {
            return Err(refuse(lexeme, TextError::NotAFunction { name: excerpt(lexeme.text, 1) }));
        }
        Token::Name => input.state.postfix.push(Item::Name { name: lexeme.text, column: lexeme.column }),
        Token::Function(function) => {
            arguments(input, lexeme, function.arity())?;
            input.state.postfix.push(Item::Apply(function));
        }
        Token::Open => {
            cut_err(sum).parse_next(input)?;
            close(input, unexpected)?;
        }
        _ => return fail.parse_next(input),
    }
    Ok(())
}

/// `count` sums in parentheses, separated by commas.
fn arguments(input: &mut Input, function: Lexeme, count: usize) -> Parsed<()> {
    if !next_is(input, Token::Open) {
        return Err(refuse(function, TextError::MissingArguments { function: function.text.to_owned() }));
    }
    any.parse_next(input)?;
    let wrong_count = |at: Lexeme| match at.token {
        Token::Comma | Token::Close => {
            refuse(at, TextError::ArgumentCount { function: function.text.to_owned(), expected: count })
        }
        _ => unexpected(at),
    };
    for position in 1..=count {
        cut_err(sum).parse_next(input)?;
        if position < count {
            pass(input, Token::Comma, wrong_count)?;
        }
    }
    close(input, wrong_count)
}

fn close(input: &mut Input, otherwise: impl Fn(Lexeme) -> ErrMode<Fault>) -> Parsed<()> {
    pass(input, Token::Close, otherwise)
}

/// Passes `expected`, inside of parentheses.
fn pass(input: &mut Input, expected: Token, otherwise: impl Fn(Lexeme) -> ErrMode<Fault>) -> Parsed<()> {
    match input.input.split_first() {
        None => Err(ErrMode::Cut(Fault { column: input.state.end, problem: TextError::MissingClosing })),
        Some((&lexeme, _)) if lexeme.token != expected => Err(otherwise(lexeme)),
        Some((_, rest)) => {
            input.input = rest;
            Ok(())
        }
    }
}

fn next_is(input: &Input, token: Token) -> bool {
    input.input.first().is_some_and(|lexeme| lexeme.token == token)
}

fn sign<'l, 't>(input: &mut Input<'l, 't>) -> Parsed<Prefix<Input<'l, 't>, (), ErrMode<Fault>>> {
    any.verify_map(|lexeme: Lexeme| match lexeme.token {
        Token::Minus => Some(Prefix(SIGN, |input, ()| push(input, Operation::Negate))),
        Token::Plus => Some(Prefix(SIGN, |_, ()| Ok(()))),
        _ => None,
    })
    .parse_next(input)
}

fn operator<'l, 't>(input: &mut Input<'l, 't>) -> Parsed<Infix<Input<'l, 't>, (), ErrMode<Fault>>> {
    any.verify_map(|lexeme: Lexeme| match lexeme.token {
        Token::Plus => Some(Infix::Left(SUM, |input, (), ()| push(input, Operation::Add))),
        Token::Minus => Some(Infix::Left(SUM, |input, (), ()| push(input, Operation::Subtract))),
        Token::Times => Some(Infix::Left(PRODUCT, |input, (), ()| push(input, Operation::Multiply))),
        Token::Over => Some(Infix::Left(PRODUCT, |input, (), ()| push(input, Operation::Divide))),
        Token::Power => Some(Infix::Right(POWER, |input, (), ()| push(input, Operation::Power))),
        _ => None,
    })
    .parse_next(input)
}

fn push(input: &mut Input, operation: Operation) -> Parsed<()> {
    input.state.postfix.push(Item::Apply(operation));
    Ok(())
}

/// The error that ends the parse at `lexeme`.
fn refuse(lexeme: Lexeme, problem: TextError) -> ErrMode<Fault> {
    ErrMode::Cut(Fault { column: lexeme.column, problem })
}

/// The error of something else than an operator behind a value.
fn unexpected(lexeme: Lexeme) -> ErrMode<Fault> {
    let problem = match lexeme.token {
        Token::Close => TextError::UnmatchedClosing,
        Token::Comma => TextError::StrayComma,
        _ => TextError::MissingOperator { before: excerpt(lexeme.text, 1) },
    };
    refuse(lexeme, problem)
}

/// Where no rule applies, a value is missing: everything else has an error of its own.
impl<'l, 't> ParserError<Input<'l, 't>> for Fault {
    type Inner = Self;

    fn from_input(input: &Input<'l, 't>) -> Self {
        let (column, before) = match input.input.first() {
            Some(lexeme) => (lexeme.column, excerpt(lexeme.text, 1)),
            None => (input.state.end, "the end".to_owned()),
        };
        Self { column, problem: TextError::MissingValue { before } }
    }

    fn into_inner(self) -> Result<Self::Inner, Self> {
        Ok(self)
    }
}
