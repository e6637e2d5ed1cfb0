//! Model runs: which are asked for, which are known, how they are recorded, and what came of them.

pub mod journal;
mod ledger;
mod match_answers;
mod recording;
mod rigid_body_motion;
mod run;

pub use ledger::{Campaign, DesignPoint, Failure, Ledger};
pub use match_answers::{MatchedAnswers, RowProblem, match_answers, match_runs};
pub use recording::{Books, Note, Recording, RecordingError, journal_here, journal_of_build, notes_on};
pub use rigid_body_motion::agree_on_rigid_body_motion;
pub use run::{Run, RunError, Runner};
