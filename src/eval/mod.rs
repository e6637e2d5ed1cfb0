//! The evaluator: a surrogate, compiled into a plan, at millions of points.
//!
//! Nothing here knows a model, a design or a fit: what is deployed carries no model code.

mod bracket;
mod chunks;
mod correlation;
mod critical;
#[cfg(test)]
mod handmade;
mod histogram;
mod kernel;
mod lanes;
mod monte_carlo;
mod plan;
mod points;
mod program;
mod quantity;
mod question;
mod recombination;
mod region;
mod self_test;
mod sensitivity;
mod source;
mod survey;
mod survey_error;
mod tally;

pub use critical::{CRITICAL_LEVELS, CriticalValues, critical_values};
pub use histogram::Histogram;
pub use lanes::{LANES, Lanes};
pub use monte_carlo::{EvalError, monte_carlo};
pub use plan::{Plan, Results, Workspace};
pub use points::evaluate_points;
pub use quantity::Quantity;
pub use question::{Bins, Condition, Event, Question, Sampler, Sweep};
pub use region::Region;
pub use self_test::self_test_difference;
pub use sensitivity::{Estimate, SENSITIVITY_LEVEL, Sensitivities, Sensitivity, sensitivities};
pub use survey::{Findings, Progress, Survey};
pub use survey_error::SurveyError;
pub use tally::Tally;
