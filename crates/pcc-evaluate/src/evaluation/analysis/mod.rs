//! Answers that need more than one value per sample: sensitivities, critical values, the self-test.

pub(super) mod bracket;
pub(super) mod correlation;
pub(super) mod critical;
pub(super) mod crossings;
mod domain;
pub(super) mod intervals;
pub(super) mod self_test;
pub(super) mod sensitivity;
pub(super) mod shapley;
pub(super) mod unanswered;
