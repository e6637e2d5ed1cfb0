//! Linear algebra and quadrature that know nothing of mechanics or probability.

pub mod eigenvalues;
mod instructions;
pub mod invariant_subspace;
pub mod minimize;
pub mod positive_definite;
pub mod qr;
pub mod quadrature;
pub mod roots;

pub use instructions::InstructionSet;
