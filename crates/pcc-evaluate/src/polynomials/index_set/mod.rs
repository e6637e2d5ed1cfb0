//! Multi-indices α ∈ ℕʳ and the sets of them that span polynomial spaces.

mod hyperbolic;
mod multi_index;

pub use hyperbolic::{Hyperbolic, IndexSetError};
pub use multi_index::{IndexSet, MultiIndex};
