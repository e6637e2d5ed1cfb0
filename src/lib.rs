//! temporary
#![forbid(unsafe_code)]

pub mod cli;
pub mod report;
pub mod reproduce;
