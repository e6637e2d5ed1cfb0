//! One request, one answer: JSON over HTTP.

use super::error::UmBridgeFailure;
use crate::mechanics::model::{not_numbers, printable};
use serde_json::Value;
use std::io::ErrorKind;
use std::time::Duration;
use ureq::http::Response;
use ureq::{Agent, Body, Error, Timeout};

/// Bytes of an answer that are read: a million eigenvalues.
const LARGEST_ANSWER: u64 = 64 << 20;

/// A server that is there answers a call for a connection at once, however long its model takes.
const CONNECTING: Duration = Duration::from_secs(30);

/// Characters of an answer that says nothing of the protocol.
const SHOWN_BODY: usize = 200;

/// A server, asked by several threads at once. Every request has a connection of its own: those that are kept for hours
/// while a model computes are cut by somebody.
#[derive(Debug)]
pub(super) struct Server {
    agent: Agent,
    url: String,
    limit: Option<Duration>,
}

impl Server {
    /// The server at `url`; each answer is waited for until `limit`.
    pub fn new(url: &str, limit: Option<Duration>) -> Self {
        let config = Agent::config_builder()
            .http_status_as_error(false)
            .max_redirects(0)
            // Servers of models run on this machine or beside it, where no proxy leads to.
            .proxy(None)
            .timeout_resolve(Some(CONNECTING))
            .timeout_connect(Some(CONNECTING))
            .timeout_global(limit)
            .max_idle_connections(0)
            .max_idle_connections_per_host(0)
            .build();
        Self { agent: config.new_agent(), url: url.trim_end_matches('/').to_owned(), limit }
    }

    /// What the server says of itself at `path`.
    pub fn get(&self, path: &'static str) -> Result<Value, UmBridgeFailure> {
        self.read(path, self.agent.get(self.address(path)).call())
    }

    /// The answer to `request` at `path`.
    pub fn post(&self, path: &'static str, request: &Value) -> Result<Value, UmBridgeFailure> {
        let post = self.agent.post(self.address(path)).header("Content-Type", "application/json");
        self.read(path, post.send(request.to_string()))
    }

    /// Ends requests that are going on, and lets later ones fail.
    pub fn interrupt(&self) {
        self.agent.clone().shutdown();
    }

    fn address(&self, path: &str) -> String {
        format!("{}/{path}", self.url)
    }

    fn read(&self, path: &'static str, response: Result<Response<Body>, Error>) -> Result<Value, UmBridgeFailure> {
        let mut response = response.map_err(|error| self.failure(path, error))?;
        let body = response.body_mut().with_config().limit(LARGEST_ANSWER).read_to_vec();
        let body = body.map_err(|error| self.failure(path, error))?;
        let status = response.status().as_u16();
        let is_success = response.status().is_success();
        match serde_json::from_slice::<Value>(&body) {
            Ok(answer) if answer.get("error").is_some_and(Value::is_object) => Err(reported(&answer["error"])),
            Ok(answer) if is_success => Ok(answer),
            Err(error) if is_success => Err(not_json(path, &body, &error)),
            _ => {
                let text = String::from_utf8_lossy(&body);
                Err(UmBridgeFailure::Status { path, status, text: printable::line(text.trim(), SHOWN_BODY) })
            }
        }
    }

    fn failure(&self, path: &'static str, error: Error) -> UmBridgeFailure {
        let cause = printable::line(&error.to_string(), SHOWN_BODY);
        match error {
            Error::Timeout(Timeout::Resolve | Timeout::Connect) | Error::HostNotFound | Error::ConnectionFailed => {
                UmBridgeFailure::NotReached { cause }
            }
            Error::Timeout(_) => UmBridgeFailure::TimedOut { limit: self.limit.unwrap_or(CONNECTING) },
            Error::BodyExceedsLimit(limit) => UmBridgeFailure::TooLarge { path, limit },
            Error::Io(error) => match error.kind() {
                ErrorKind::ConnectionRefused
                | ErrorKind::HostUnreachable
                | ErrorKind::NetworkUnreachable
                | ErrorKind::NetworkDown
                | ErrorKind::AddrNotAvailable => UmBridgeFailure::NotReached { cause },
                _ => UmBridgeFailure::Closed { cause },
            },
            _ => UmBridgeFailure::NotHttp { cause },
        }
    }
}

/// The protocol's own errors.
fn reported(error: &Value) -> UmBridgeFailure {
    let text = |key: &str, absent: &str, length| {
        let text = error.get(key).and_then(Value::as_str).map(str::trim).filter(|text| !text.is_empty());
        printable::line(text.unwrap_or(absent), length)
    };
    UmBridgeFailure::Reported {
        kind: text("type", "an error without a type", printable::SHOWN_CELL),
        text: text("message", "without a message", printable::MESSAGE_LENGTH),
    }
}

fn not_json(path: &'static str, body: &[u8], error: &serde_json::Error) -> UmBridgeFailure {
    if body.trim_ascii().is_empty() {
        return UmBridgeFailure::NotJson { path, cause: "it is empty".to_owned() };
    }
    match not_numbers::bare(&String::from_utf8_lossy(body)) {
        // A page has words, too.
        Some(word) if body.trim_ascii_start().starts_with(b"{") => UmBridgeFailure::HoldsNan { path, word },
        _ => UmBridgeFailure::NotJson { path, cause: error.to_string() },
    }
}
