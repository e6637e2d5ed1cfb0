//! Direct computations on many points: the paper's MCIM, and surrogates judged and certified against it.

mod certify;
mod compare;
mod direct_computations;
mod matching;
mod modes;
mod points;
mod sample;
mod strata;
mod verdicts;

pub use certify::{LEAST_RUNS, RunsForWidth, RunsNeeded, certify_with_model, runs_for_width};
pub use compare::{Comparison, ComponentError, compare_with_model};
pub use direct_computations::{Reference, ReferenceError, check_problem, monte_carlo};
pub use modes::{ModeAtPoint, ModesAlong, modes_along};
pub use points::{PointAnswer, PointReference};
pub use sample::ModelSample;
