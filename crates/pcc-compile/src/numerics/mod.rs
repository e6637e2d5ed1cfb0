//! Linear algebra, quadrature and minimisation that know nothing of mechanics or probability.

pub mod accuracy;
pub mod assignment;
pub mod eigenvalues;
pub mod invariant_subspace;
pub mod minimize;
pub mod nearest_correlation;
pub mod positive_definite;
pub mod qr;
pub mod quadrature;
pub mod twofold;
pub mod zero_eigenvalues;
