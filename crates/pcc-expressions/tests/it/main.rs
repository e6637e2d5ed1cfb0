//! Expressions against what they mean, in one program.

mod arithmetic;
mod random_expressions;
