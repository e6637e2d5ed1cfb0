//! Linear algebra and quadrature that know nothing of mechanics or probability.

pub mod eigenvalues;
pub mod qr;
pub mod quadrature;
