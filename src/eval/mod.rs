//! The evaluator: a surrogate, compiled into a plan, at millions of points.
//!
//! Nothing here knows a model, a design or a fit: what is deployed carries no model code.

mod bracket;
mod chunks;
mod correlation;
mod critical;
#[cfg(test)]
mod handmade;
mod monte_carlo;
mod plan;
mod points;
mod self_test;
mod sensitivity;

pub use critical::{CRITICAL_LEVELS, CriticalValues, critical_values};
pub use monte_carlo::{EvalError, monte_carlo};
pub use plan::{LANES, Plan, Workspace};
pub use points::evaluate_points;
pub use self_test::self_test_difference;
pub use sensitivity::{Estimate, SENSITIVITY_LEVEL, Sensitivities, Sensitivity, sensitivities};
