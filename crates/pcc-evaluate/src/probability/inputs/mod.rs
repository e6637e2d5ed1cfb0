//! Uncertain inputs: their laws, and the map between physical and standardized variables.

mod beta;
mod density;
mod description;
mod extremes;
mod gamma;
mod germ;
mod law;
mod log_uniform;
mod lognormal;
mod marginal;
mod normal;
mod normal_quantile;
mod normal_tail;
mod own_variable;
mod parameters;
mod pieces;
mod random_point;
mod root;
mod shaped;
mod space;
mod triangular;
mod uniform;

pub use description::{Description, DescriptionError};
pub use germ::Germ;
pub(crate) use law::Transform;
pub use marginal::{Marginal, Other, Polynomials};
pub use own_variable::OwnVariable;
pub use parameters::Parameters;
pub(crate) use parameters::Stored;
pub(crate) use pieces::Pieces;
pub use random_point::{random_point, random_points};
pub use space::{Input, InputError, InputSpace};
pub use uniform::{MarginalError, Uniform};
