//! Polynomials that are orthonormal under a probability density: recurrences, their Gauss rules, the sets of
//! multi-indices that span spaces of them, and the elements on which they are local.

mod index_set;
mod mesh;
mod own;
mod quadrature;
mod recurrence;

pub use index_set::{Hyperbolic, IndexSet, IndexSetError, MultiIndex};
pub use mesh::{Branch, Element, Mesh, MeshError, Split};
pub use own::OwnPolynomials;
pub use quadrature::gauss;
pub use recurrence::{Family, Recurrence};
