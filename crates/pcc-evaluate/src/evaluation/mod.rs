//! The evaluator: a surrogate, compiled into a plan, at millions of points.
//!
//! `kernel` evaluates one block of points; `survey` draws samples, asks questions about them and sums up what it finds;
//! `analysis` finds what needs several values per sample. Nothing here knows a model, a design or a fit: what is
//! deployed carries no model code.

mod analysis;
mod error;
mod kernel;
mod survey;
#[cfg(test)]
mod test_surrogates;

pub use analysis::critical::{CRITICAL_LEVELS, CriticalValues, critical_values, critical_values_in};
pub use analysis::self_test::self_test_difference;
pub use analysis::sensitivity::{
    Estimate, SENSITIVITY_LEVEL, Sensitivities, Sensitivity, sensitivities, sensitivities_in,
};
pub use error::EvalError;
pub use kernel::lanes::{BLOCK_POINTS, Lanes};
pub use kernel::plan::{Plan, Workspace};
pub use kernel::points::evaluate_points;
pub use kernel::results::Results;
pub use survey::division::Division;
pub use survey::findings::{Answer, Cell, Findings};
pub use survey::histogram::Histogram;
pub use survey::monte_carlo::monte_carlo;
pub use survey::pilot::{Pilot, PilotError};
pub use survey::quantity::Quantity;
pub use survey::question::{Bins, Condition, Event, Question, Sampler, Sweep};
pub use survey::region::{Region, Regions};
pub use survey::survey::{Survey, Surveyed};
pub use survey::survey_error::SurveyError;
pub use survey::tally::Tally;
