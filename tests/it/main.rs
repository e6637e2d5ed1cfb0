//! The tests of the whole, in one program: the library as its users see it, and the command line as they type it.

mod support;

mod answers;
mod certificates;
mod closed_groups;
mod clusters;
mod clutch_reference;
mod command_line;
mod coverage;
mod defaults;
mod dependence;
mod derivatives;
mod described;
mod determinism;
mod documents;
mod endings;
mod evaluation;
mod extrapolation;
mod field;
mod full_expansions;
mod golden_file;
mod gradient_fits;
mod help;
mod invariants;
mod judgement;
mod kills;
mod laws;
mod layers;
mod matrices;
mod openturns;
mod overwriting;
mod programs;
mod questions;
mod shipped;
mod table2;
mod wide;
