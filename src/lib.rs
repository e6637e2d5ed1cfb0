//! pcc
pub mod build;
pub mod design;
pub mod eval;
pub mod fit;
pub mod index_set;
pub mod input;
pub mod model;
pub mod numerics;
pub mod polynomial;
pub mod progress;
pub mod random;
pub mod reference;
pub mod regression;
pub mod spectrum;
pub mod statistics;
pub mod study;
pub mod surrogate;
