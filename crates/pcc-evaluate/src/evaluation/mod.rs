//! The evaluator: a surrogate, compiled into a plan, at millions of points.
//!
//! `kernel` evaluates one block of points; `questions` draws samples, asks questions about them and sums up what it
//! finds; `analysis` finds what needs several values per sample. Nothing here knows a model, a design or a fit: what is
//! deployed carries no model code.

mod analysis;
mod error;
mod kernel;
mod questions;
#[cfg(test)]
mod test_surrogates;

pub use analysis::critical::{CRITICAL_LEVELS, CriticalValues, critical_values, critical_values_in};
pub use analysis::crossings::Crossing;
pub use analysis::intervals::{IntervalLevel, PointIntervals, point_intervals};
pub use analysis::self_test::self_test_difference;
pub use analysis::sensitivity::{
    Estimate, SENSITIVITY_LEVEL, Sensitivities, Sensitivity, sensitivities, sensitivities_in,
};
pub use analysis::shapley::{ShapleyEffects, shapley_effects, shapley_effects_in};
pub use analysis::unanswered::Unanswered;
pub(crate) use analysis::unanswered::unanswered_in;
pub use error::EvalError;
pub use kernel::lanes::{BLOCK_POINTS, Lanes};
pub use kernel::plan::{Plan, Workspace};
pub use kernel::points::evaluate_points;
pub use kernel::results::Results;
pub use questions::division::Division;
pub use questions::extrapolated::Extrapolated;
pub use questions::findings::{Answer, Cell, Findings};
pub use questions::given_points::{GivenPoints, PointError};
pub use questions::histogram::Histogram;
pub use questions::monte_carlo::monte_carlo;
pub use questions::pilot::{Pilot, PilotError};
pub use questions::quantity::Quantity;
pub use questions::question::{Bins, Condition, Event, Question, Sampler, Sweep};
pub use questions::region::{Region, Regions};
pub use questions::survey::{Survey, Surveyed};
pub use questions::survey_error::SurveyError;
pub use questions::tally::Tally;
