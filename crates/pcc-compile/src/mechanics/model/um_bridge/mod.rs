//! Servers as models: an HTTP server that speaks UM-Bridge is asked for the eigenvalues at every point.
//!
//! The protocol, version 1.0, is JSON over HTTP: <https://um-bridge-benchmarks.readthedocs.io/en/docs/>. Before the
//! first run the server says whether it has the model, and how many numbers that takes and answers (`Info`,
//! `ModelInfo`, `InputSizes`, `OutputSizes`). A run is one `Evaluate`:
//!
//! * What goes in are the values of the study's inputs and constants, in the order of [`UmBridgeSettings::arguments`],
//!   divided into as many lists as the model takes.
//! * What comes out are Re λ (1/s) and Im λ (rad/s) of each eigenvalue in turn, over all lists that the model answers.
//!
//! Numbers are written so that they read back with the same bits. Anything but so many finite numbers is an
//! [`UmBridgeError`], never a guess.

mod error;
mod exchange;
mod greeting;
#[cfg(test)]
mod tests;

pub use error::{UmBridgeError, UmBridgeFailure};

use super::{Concurrency, Model, ModelError, printable};
use exchange::Server;
use nalgebra::Complex;
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// What an address must be.
const URL: &str = "an address that begins with http://, like \"http://localhost:4242\"; pcc does not speak https, so a server \
                   elsewhere is reached by a tunnel, as with ssh -L 4242:localhost:4242 HOST";

/// Checks the address of a server.
///
/// # Errors
///
/// What it must be.
pub fn check_url(url: &str) -> Result<(), &'static str> {
    let address = url.parse::<ureq::http::Uri>().map_err(|_| URL)?;
    let is_plain = address.scheme_str() == Some("http") && address.query().is_none();
    let has_host = address.host().is_some_and(|host| !host.is_empty());
    let has_no_user = address.authority().is_some_and(|authority| !authority.as_str().contains('@'));
    // A port that is none is no reason to ask another.
    let port = address.authority().and_then(|authority| authority.as_str().rsplit(']').next()?.split_once(':'));
    let has_port = port.is_none() || address.port_u16().is_some();
    if is_plain && has_host && has_no_user && has_port { Ok(()) } else { Err(URL) }
}

/// What is known about a server's model before it is asked.
#[derive(Debug, Clone, PartialEq)]
pub struct UmBridgeSettings {
    /// Where the server is, as `http://localhost:4242`.
    pub url: String,
    /// Name of the model there.
    pub name: String,
    /// Handed on with every request: a JSON object.
    pub config: Value,
    /// What the model takes, in its order.
    pub arguments: Vec<Argument>,
    /// Number of inputs of the study.
    pub inputs: usize,
    /// Eigenvalues that every run must answer.
    pub eigenvalues: usize,
    /// How many requests go on at once.
    pub jobs: usize,
    /// How long an answer is waited for; `None` for as long as it takes.
    pub timeout: Option<Duration>,
    /// Further attempts after one that failed.
    pub retries: u32,
}

/// A number that the model takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Argument {
    /// Name of the input or constant.
    pub name: String,
    /// Where its value comes from.
    pub value: ArgumentValue,
}

/// Where a number comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ArgumentValue {
    /// The input of this number, from 0.
    Input(usize),
    /// The same at every point.
    Constant(f64),
}

/// A model on a server. Runs may be asked for from several threads at once.
#[derive(Debug)]
pub struct UmBridgeModel {
    settings: UmBridgeSettings,
    server: Server,
    /// How many numbers the model takes in each list, once it has been asked.
    input_sizes: Mutex<Option<Vec<usize>>>,
    is_interrupted: AtomicBool,
}

impl UmBridgeModel {
    /// A model that has not been asked yet; that it does not fit is reported by the first run.
    pub fn new(settings: UmBridgeSettings) -> Self {
        let server = Server::new(&settings.url, settings.timeout);
        Self { settings, server, input_sizes: Mutex::default(), is_interrupted: AtomicBool::new(false) }
    }

    /// The eigenvalues at `point`: one value per input.
    ///
    /// # Errors
    ///
    /// [`UmBridgeError`] of the last attempt.
    pub fn run(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, UmBridgeError> {
        let mut attempts = 1;
        loop {
            match self.attempt(point) {
                Err((failure, _)) if !failure.is_final() && attempts <= self.settings.retries => attempts += 1,
                Err((failure, is_of_run)) => {
                    let url = printable::line(&self.settings.url, printable::MESSAGE_LENGTH);
                    return Err(UmBridgeError { failure, attempts, url, is_of_run });
                }
                Ok(eigenvalues) => return Ok(eigenvalues),
            }
        }
    }

    /// Ends what is going on: its runs fail with [`UmBridgeFailure::Interrupted`], and so do all later ones. What the
    /// server computes it computes in vain.
    pub fn interrupt(&self) {
        self.is_interrupted.store(true, Ordering::SeqCst);
        self.server.interrupt();
    }

    /// One attempt at a run; of one that failed also whether the model was asked.
    fn attempt(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, (UmBridgeFailure, bool)> {
        let if_not_stopped = |failure| match self.is_interrupted.load(Ordering::SeqCst) {
            true => UmBridgeFailure::Interrupted,
            false => failure,
        };
        let request = self.request(point).map_err(|failure| (if_not_stopped(failure), false))?;
        let answer = self.server.post("Evaluate", &request).and_then(|answer| self.eigenvalues(&answer));
        answer.map_err(|failure| {
            let is_of_run = failure.is_of_run();
            (if_not_stopped(failure), is_of_run)
        })
    }

    /// What the server is asked at a point.
    fn request(&self, point: &[f64]) -> Result<Value, UmBridgeFailure> {
        if point.len() != self.settings.inputs {
            return Err(UmBridgeFailure::PointLength { found: point.len(), expected: self.settings.inputs });
        }
        let mut values = Vec::with_capacity(self.settings.arguments.len());
        for Argument { name, value } in &self.settings.arguments {
            let value = match *value {
                ArgumentValue::Input(number) => point[number],
                ArgumentValue::Constant(value) => value,
            };
            if !value.is_finite() {
                let name = printable::line(name, printable::SHOWN_CELL);
                return Err(UmBridgeFailure::ValueNotFinite { name, value: value.to_string() });
            }
            values.push(value);
        }
        let mut values = values.into_iter();
        let sizes = self.input_sizes()?;
        let input: Vec<Vec<f64>> = sizes.iter().map(|&size| values.by_ref().take(size).collect()).collect();
        Ok(json!({ "name": self.settings.name, "input": input, "config": self.settings.config }))
    }

    /// Asks the server once; as long as it cannot answer that, every run asks again.
    fn input_sizes(&self) -> Result<Vec<usize>, UmBridgeFailure> {
        let mut known = self.input_sizes.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(sizes) = &*known {
            return Ok(sizes.clone());
        }
        if self.is_interrupted.load(Ordering::SeqCst) {
            return Err(UmBridgeFailure::Interrupted);
        }
        let sizes = greeting::input_sizes(&self.server, &self.settings)?;
        *known = Some(sizes.clone());
        Ok(sizes)
    }

    /// Re and Im in turn, over all lists of the output.
    fn eigenvalues(&self, answer: &Value) -> Result<Vec<Complex<f64>>, UmBridgeFailure> {
        let lists = answer.get("output").and_then(Value::as_array);
        let lists = lists.and_then(|lists| lists.iter().map(Value::as_array).collect::<Option<Vec<_>>>());
        let missing = UmBridgeFailure::Missing { path: "Evaluate", missing: "list of lists \"output\"" };
        let values: Vec<&Value> = lists.ok_or(missing)?.into_iter().flatten().collect();
        let expected = 2 * self.settings.eigenvalues;
        if values.len() != expected {
            return Err(UmBridgeFailure::Count { found: values.len(), expected });
        }
        let number = |(at, value): (usize, &&Value)| {
            value.as_f64().filter(|value| value.is_finite()).ok_or_else(|| UmBridgeFailure::NotANumber {
                place: at + 1,
                found: printable::line(&value.to_string(), printable::SHOWN_CELL),
            })
        };
        let numbers = values.iter().enumerate().map(number).collect::<Result<Vec<f64>, _>>()?;
        Ok(numbers.chunks_exact(2).map(|pair| Complex::new(pair[0], pair[1])).collect())
    }
}

impl Model for UmBridgeModel {
    fn eigenvalues(&self, point: &[f64]) -> Result<Vec<Complex<f64>>, ModelError> {
        Ok(self.run(point)?)
    }

    fn concurrency(&self) -> Concurrency {
        Concurrency::Jobs(self.settings.jobs)
    }

    fn interrupt(&self) {
        UmBridgeModel::interrupt(self);
    }
}
