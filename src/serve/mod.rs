//! A surrogate as models that other programs ask over HTTP, by the protocol UM-Bridge, version 1.0:
//! <https://um-bridge-benchmarks.readthedocs.io/en/docs/>.
//!
//! `models` are what is offered, `protocol` makes an answer of a request, `http` reads requests and writes answers
//! within limits, `connections` accepts clients, bounds their number and ends them. HTTP is written here because small
//! crates for it leave open what a client may cost: how long its lines are, how long it waits, how many there are.

mod connections;
mod http;
mod models;
mod protocol;
#[cfg(test)]
mod tests;
mod timed;

pub(crate) use connections::Server;
pub(crate) use models::{Models, Offered};
pub(crate) use protocol::answer;

use std::time::Duration;

/// What a client may cost.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Clients that are served at once.
    pub connections: usize,
    /// Bytes of the head of a request.
    pub head: usize,
    /// Bytes of its body.
    pub body: usize,
    /// How long a head, a body, and an answer may take on their way.
    pub patience: Duration,
}

impl Limits {
    /// A thousand inputs in full precision take a fiftieth of the body; a client library sends at once what it sends.
    pub const DEFAULT: Self =
        Self { connections: 256, head: 16 << 10, body: 1 << 20, patience: Duration::from_secs(10) };
}
