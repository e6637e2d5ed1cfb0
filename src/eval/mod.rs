//! The evaluator: a surrogate, compiled into a plan, at millions of points.
//!
//! Nothing here knows a model, a design or a fit: what is deployed carries no model code.

mod bracket;
mod chunks;
mod correlation;
mod critical;
mod findings;
#[cfg(test)]
mod handmade;
mod histogram;
mod kernel;
mod lanes;
mod layout;
mod monte_carlo;
mod pilot;
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

pub use critical::{CRITICAL_LEVELS, CriticalValues, critical_values, critical_values_in};
pub use findings::{Answer, Cell, Findings};
pub use histogram::Histogram;
pub use lanes::{LANES, Lanes};
pub use layout::Layout;
pub use monte_carlo::{EvalError, monte_carlo};
pub use pilot::{Pilot, PilotError};
pub use plan::{Plan, Results, Workspace};
pub use points::evaluate_points;
pub use quantity::Quantity;
pub use question::{Bins, Condition, Event, Question, Sampler, Sweep};
pub use region::{Region, Regions};
pub use self_test::self_test_difference;
pub use sensitivity::{Estimate, SENSITIVITY_LEVEL, Sensitivities, Sensitivity, sensitivities, sensitivities_in};
pub use survey::{Progress, Survey};
pub use survey_error::SurveyError;
pub use tally::Tally;
