//! Uncertain inputs: their laws, and the map between physical and standardized variables.

mod description;
mod extremes;
mod germ;
mod law;
mod log_uniform;
mod marginal;
mod normal;
mod normal_quantile;
mod parameters;
mod random_point;
mod space;
mod uniform;

pub use description::{Description, DescriptionError};
pub use extremes::{Exponential, Gumbel, Weibull};
pub use germ::{Cut, Germ};
pub use log_uniform::LogUniform;
pub use marginal::Marginal;
pub use normal::{LogNormal, Normal, TruncatedNormal};
pub use parameters::Parameters;
pub use random_point::{random_point, random_points};
pub use space::{Input, InputError, InputSpace};
pub use uniform::{MarginalError, Uniform};
