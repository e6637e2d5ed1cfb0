//! Uncertain inputs: their laws, and the map between physical and standardized variables.

mod description;
mod marginal;
mod random_point;
mod space;
mod uniform;

pub use description::{Description, DescriptionError};
pub use marginal::Marginal;
pub use random_point::{random_point, random_points};
pub use space::{Input, InputError, InputSpace};
pub use uniform::{MarginalError, Uniform};
