//! What can be wrong with names and texts.

use super::excerpt::excerpt;
use super::graph::MOST_NODES;
use super::lexer::LONGEST_TEXT;
use super::nesting::DEEPEST_NESTING;
use super::operation::FUNCTIONS;
use thiserror::Error;

/// Why names and texts do not make a program.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ExpressionError {
    /// A name is not made of letters, digits and underscores.
    #[error("\"{name}\" is no name; write a Latin or Greek letter or _ first, then letters, digits or _")]
    InvalidName {
        /// The name, shortened and escaped.
        name: String,
    },
    /// A name has a meaning in all expressions.
    #[error("{name} is a word of all expressions, a function or pi; choose another name")]
    ReservedName {
        /// The name.
        name: String,
    },
    /// A name is given to two inputs, constants or helpers.
    #[error("{name} is given twice; inputs, constants and definitions need different names")]
    RepeatedName {
        /// The name, shortened.
        name: String,
    },
    /// A constant is infinite or not a number.
    #[error("constant {name} is {value}; give it a finite value")]
    NotFinite {
        /// The name, shortened.
        name: String,
        /// Its value.
        value: f64,
    },
    /// The expressions need more memory than is sensible.
    #[error("the expressions and their derivatives take more than {MOST_NODES} operations; use fewer or shorter ones")]
    TooManyOperations,
    /// A text is no expression.
    #[error("\"{excerpt}\": {problem} (column {column})")]
    Text {
        /// The text, shortened around the column and escaped.
        excerpt: String,
        /// Where the problem is, in characters from 1.
        column: usize,
        /// What it is.
        problem: TextError,
    },
}

/// Why a text is no expression.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TextError {
    /// There is nothing but blanks.
    #[error("the expression is empty; write a number, a name or a formula")]
    Empty,
    /// The text is longer than any formula.
    #[error("the expression has more than {LONGEST_TEXT} characters; name parts of it in definitions")]
    TooLong,
    /// Parentheses, signs and exponents are nested too deeply.
    #[error(
        "parentheses, signs and exponents are nested more than {DEEPEST_NESTING} deep; name parts of it in definitions"
    )]
    TooDeep,
    /// A character has no meaning in expressions.
    #[error("{character} has no meaning here{advice}")]
    Character {
        /// The character, escaped.
        character: String,
        /// What to write instead, to follow the sentence; or nothing.
        advice: &'static str,
    },
    /// A number is misspelt or too large.
    #[error("{number} is no number; write digits with at most one point, and at most 1.8e308")]
    Number {
        /// What stands there, shortened.
        number: String,
    },
    /// `**` instead of `^`.
    #[error("** has no meaning here; write ^ for powers")]
    DoubleStar,
    /// `log`, which means ln to some and log10 to others.
    #[error("log is ambiguous; write ln or log10")]
    AmbiguousLogarithm,
    /// Where a number, name, function or parenthesis must stand, there is something else.
    #[error("a value is missing before {before}")]
    MissingValue {
        /// What stands there instead.
        before: String,
    },
    /// Two values follow each other.
    #[error("an operator is missing before {before}; write every product with *")]
    MissingOperator {
        /// The second value, shortened.
        before: String,
    },
    /// A parenthesis is not closed.
    #[error("a closing parenthesis is missing")]
    MissingClosing,
    /// A parenthesis was not opened.
    #[error("this closing parenthesis has no opening one; remove it or add the other")]
    UnmatchedClosing,
    /// A comma that does not separate arguments.
    #[error("a comma only separates the two arguments of atan2, min and max; decimals take a point")]
    StrayComma,
    /// A function without its parentheses.
    #[error("{function} needs its argument in parentheses, {function}(…)")]
    MissingArguments {
        /// Name of the function.
        function: String,
    },
    /// Too many or too few arguments.
    #[error("{function} takes {}", if *expected == 1 { "one argument" } else { "two arguments, separated by a comma" })]
    ArgumentCount {
        /// Name of the function.
        function: String,
        /// How many arguments it takes.
        expected: usize,
    },
    /// A name that is no function stands before a parenthesis.
    #[error("{name} is no function; functions are {}; write * for products", function_names())]
    NotAFunction {
        /// The name, shortened.
        name: String,
    },
    /// A name without a meaning.
    #[error("unknown name {name}{}; known are {known}", perhaps(closest))]
    UnknownName {
        /// The name, shortened.
        name: String,
        /// A known name that looks like it.
        closest: Option<String>,
        /// The known names, or the first of them.
        known: String,
    },
}

fn perhaps(closest: &Option<String>) -> String {
    closest.as_ref().map_or(String::new(), |closest| format!(", perhaps {closest}"))
}

fn function_names() -> String {
    FUNCTIONS.map(|(name, _)| name).join(", ")
}

/// A problem and its place, before the text is quoted.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    /// In characters from 1.
    pub column: usize,
    pub problem: TextError,
}

impl Fault {
    /// The error that quotes `text`.
    pub fn in_text(self, text: &str) -> ExpressionError {
        let Self { column, problem } = self;
        ExpressionError::Text { excerpt: excerpt(text, column), column, problem }
    }
}
