//! Arithmetic expressions in named inputs: compiled once, evaluated and differentiated millions of times.
//!
//! A study writes the entries of its matrices as text, `r^2*(k_A + k_B + 4*k_f)`, with constants and helpers such as
//! `k_A = "gamma_1*k_p/4"`. A [`Compiler`] takes the names and the texts and makes one [`Program`] of all entries: a
//! list of elementary operations without branches, in which what several entries share is computed once. The program
//! also holds the derivative of every entry by every input it depends on, found symbolically, so that derivatives cost
//! little more than values and are as accurate.
//!
//! # Syntax
//!
//! | | |
//! |---|---|
//! | numbers | `4`, `0.25`, `.5`, `2.`, `16e6`, `1E-3` |
//! | names | a letter or underscore, then letters, digits, underscores; letters are `a`–`z`, `A`–`Z` and Greek ones |
//! | operators | `+ - * /`, `^` for powers; signs `-` and `+` |
//! | functions | `sin cos tan asin acos atan sinh cosh tanh exp ln log10 sqrt abs` |
//! | of two arguments | `atan2(y, x)`, `min(a, b)`, `max(a, b)` |
//! | constant | `pi` |
//!
//! Precedence is that of mathematics and of Python: powers before signs before products before sums; powers associate
//! to the right, all else to the left. So `-x^2` is −(x²), `2^3^2` is 2⁹, `2^-1` is 0.5 and `a/b/c` is (a/b)/c. Every
//! product needs its `*`, every function its parentheses. Names of functions, `pi` and `log` (is it `ln` or `log10`?)
//! are reserved.
//!
//! # Arithmetic
//!
//! All operations are those of IEEE double precision, in the same order every time. Simplifications keep every result,
//! with three exceptions. What is multiplied by a constant zero is zero, even if it is infinite or not a number, and so
//! is a constant zero divided by anything: a damping constant of zero leaves structural zeros in the matrices, of which
//! [`Compiler::value_if_constant`] tells. Where a constant zero is added or subtracted, a result of zero may have the
//! other sign. A power whose exponent is a constant integer from −16 to 16 is a product, accurate to some
//! [`f64::EPSILON`] times the exponent.
//!
//! `min` and `max` of NaN are NaN. At a kink the derivative is that of one side: of the first argument where those of
//! `min` and `max` are equal, 0 for `abs` at 0. Powers are differentiated as b aᵇ⁻¹, so x² has derivative 0 at 0, and
//! only an exponent that depends on an input brings a logarithm. Results outside a function's domain are infinite or
//! NaN, for the caller to check; so may derivatives at its edge, such as that of `sqrt(x^2)` at 0.
//!
//! # Layers
//!
//! Text becomes lexemes (`lexer`), checked for depth (`nesting`) and put into postfix order (`parser`); the
//! [`Compiler`] gives names their meaning and builds a graph without duplicates (`graph`, `simplify`); `derivative`
//! adds the derivatives; `listing` lists what is needed as a [`Program`]. Only [`winnow`]'s Pratt parser recurses, to a
//! limited depth.
//!
//! # Examples
//!
//! ```
//! use pcc_expressions::Compiler;
//!
//! let mut compiler = Compiler::new(&["gamma_1", "k_p"])?;
//! compiler.constant("k_f", 7e6)?;
//! compiler.define("k_A", "gamma_1*k_p/4")?;
//! compiler.expression("k_A + 2*k_f")?;
//! let program = compiler.finish()?;
//!
//! let mut workspace = program.workspace();
//! assert_eq!(program.evaluate(&[0.9, 16e6], &mut workspace), [17.6e6]);
//! assert_eq!(program.differentiate(&[0.9, 16e6], &mut workspace).derivatives, [4e6, 0.225]);
//! # Ok::<(), pcc_expressions::ExpressionError>(())
//! ```

#![forbid(unsafe_code)]

mod compiler;
mod derivative;
mod error;
mod excerpt;
mod graph;
mod lexer;
mod listing;
mod name;
mod nesting;
mod operation;
mod parser;
mod program;
mod simplify;

pub use compiler::{Compiler, Output};
pub use error::{ExpressionError, TextError};
pub use program::{Derivative, Evaluated, Program, Workspace};

#[cfg(test)]
mod tests;
