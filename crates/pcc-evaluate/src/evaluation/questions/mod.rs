//! What is asked about samples, and what was found: a question becomes a survey, a survey findings.

pub(super) mod division;
pub(super) mod extrapolated;
pub(super) mod findings;
pub(super) mod given_points;
pub(super) mod histogram;
pub(super) mod monte_carlo;
pub(super) mod pilot;
pub(super) mod quantity;
pub(super) mod question;
pub(super) mod region;
pub(super) mod source;
pub(super) mod survey;
pub(super) mod survey_error;
pub(super) mod tally;
