//! Uncertain inputs: their distributions, and the map between physical and standardized variables; boxes of
//! them, for expansions of elements.

mod marginal;
mod mesh;
mod monte_carlo;
mod space;

pub use marginal::{Marginal, MarginalError, Uniform};
pub use mesh::{Branch, Element, Mesh, MeshError, Split};
pub use monte_carlo::{random_point, random_points};
pub use space::{Input, InputError, InputSpace};
