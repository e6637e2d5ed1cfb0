//! A session with a surrogate: from a request in words to one answer, which every face prints.
//!
//! A [`Request`] becomes a question, with bins laid by a pilot of a few samples where it leaves them open. A
//! [`Session`] puts the question to a surrogate: it samples, then estimates sensitivities and critical values, as far
//! as there is time. An [`Evaluation`] is what it found.

mod answer;
mod error;
mod request;
#[cfg(test)]
mod tests;

pub use answer::{Evaluation, Session};
pub use error::SessionError;
pub use request::{HistogramRequest, Request};
