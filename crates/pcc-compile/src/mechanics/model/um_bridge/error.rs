//! What can go wrong with a run on a server, in the order in which it happens.

use std::fmt;
use std::time::Duration;
use thiserror::Error;

/// Why a point has no eigenvalues.
#[derive(Debug, Clone, PartialEq, Error)]
pub struct UmBridgeError {
    /// What went wrong in the last attempt.
    pub failure: UmBridgeFailure,
    /// Attempts that were made.
    pub attempts: u32,
    /// The server.
    pub url: String,
    /// Whether the server was asked for the point: what went wrong before that is no fault of the model.
    pub is_of_run: bool,
}

impl fmt::Display for UmBridgeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {}", self.url, self.failure)?;
        if self.attempts > 1 {
            write!(formatter, "; {} attempts were made", self.attempts)?;
        }
        Ok(())
    }
}

/// What went wrong in an attempt. Texts of the server have their control characters escaped.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum UmBridgeFailure {
    /// A point of another space.
    #[error("a point has {found} values, but there are {expected} inputs; give one value for each")]
    PointLength {
        /// Values of the point.
        found: usize,
        /// Number of inputs.
        expected: usize,
    },
    /// A value that JSON cannot hold.
    #[error("{name} is {value}, but servers are given finite numbers only; correct the input or the constant")]
    ValueNotFinite {
        /// Name of the input or constant.
        name: String,
        /// Its value, as text.
        value: String,
    },
    /// [`UmBridgeModel::interrupt`](super::UmBridgeModel::interrupt) was called.
    #[error("the run was interrupted")]
    Interrupted,
    /// Nobody listens there.
    #[error("the server cannot be reached: {cause}; is it running, and is model.url right?")]
    NotReached {
        /// What the operating system said.
        cause: String,
    },
    /// The server took too long.
    #[error("the server did not answer within {} s; allow more time with model.timeout if it needs it", .limit.as_secs_f64())]
    TimedOut {
        /// Time allowed.
        limit: Duration,
    },
    /// The connection ended without an answer.
    #[error("the server ended the connection without an answer: {cause}; what it prints may say why")]
    Closed {
        /// What the operating system said.
        cause: String,
    },
    /// What answers there is no web server.
    #[error("what answers there does not speak HTTP: {cause}; is model.url right?")]
    NotHttp {
        /// What is wrong.
        cause: String,
    },
    /// The answer is not read.
    #[error("the answer to {path} is longer than {limit} bytes, which are read at most; is this the right model?")]
    TooLarge {
        /// What was asked.
        path: &'static str,
        /// Most bytes read.
        limit: u64,
    },
    /// The server says why there is no answer.
    #[error("the server reports {kind}: {text}")]
    Reported {
        /// The protocol's name for it.
        kind: String,
        /// Its words.
        text: String,
    },
    /// The server failed, and says nothing that the protocol knows.
    #[error("the server ended {path} with HTTP status {status}{}", words(.text))]
    Status {
        /// What was asked.
        path: &'static str,
        /// The status; 200 would mean success.
        status: u16,
        /// The beginning of what it sent.
        text: String,
    },
    /// The answer is not JSON because it holds the words of some languages for what is not a number.
    #[error("the answer to {path} holds {word}, which is not a number; a model without an answer must raise an error")]
    HoldsNan {
        /// What was asked.
        path: &'static str,
        /// The word.
        word: String,
    },
    /// The answer is not JSON.
    #[error("the answer to {path} is not JSON: {cause}; is this a server of UM-Bridge?")]
    NotJson {
        /// What was asked.
        path: &'static str,
        /// What and where.
        cause: String,
    },
    /// The answer lacks what the protocol promises.
    #[error("the answer to {path} has no {missing}; is this a server of UM-Bridge?")]
    Missing {
        /// What was asked.
        path: &'static str,
        /// What should be there.
        missing: &'static str,
    },
    /// The server speaks another protocol.
    #[error(
        "the server speaks version {found} of the UM-Bridge protocol, but pcc speaks 1.0; update the older of them"
    )]
    Version {
        /// The version, as JSON.
        found: String,
    },
    /// The server has no such model.
    #[error("the server has no model {name:?}; it has {known}; correct model.name")]
    NoModel {
        /// Name in the study.
        name: String,
        /// Names that exist.
        known: String,
    },
    /// The model cannot be evaluated.
    #[error(
        "the server says that its model {name:?} does not support Evaluate, which pcc needs; choose another in model.name"
    )]
    NoEvaluate {
        /// Name of the model.
        name: String,
    },
    /// The model takes another number of parameters.
    #[error(
        "the model takes {found} numbers, in lists of {sizes}, but the study has {expected}: {names}; list what it takes in \
         model.parameters, inputs and constants in its order"
    )]
    InputSizes {
        /// Numbers that it takes.
        found: u64,
        /// Lists of how many.
        sizes: String,
        /// Numbers that there are.
        expected: usize,
        /// Their names.
        names: String,
    },
    /// The model answers another number of numbers.
    #[error(
        "the model answers {found} numbers, in lists of {sizes}, but {eigenvalues} eigenvalues are {} numbers, Re and Im of each \
         in turn; correct model.eigenvalues, or what the model answers",
        2 * .eigenvalues
    )]
    OutputSizes {
        /// Numbers that it answers.
        found: u64,
        /// Lists of how many.
        sizes: String,
        /// Eigenvalues that the study asks for.
        eigenvalues: usize,
    },
    /// The answer has another length than was announced.
    #[error(
        "the answer to Evaluate has {found} numbers, but must have {expected}, Re and Im of each eigenvalue in turn"
    )]
    Count {
        /// Numbers found.
        found: usize,
        /// Numbers asked for.
        expected: usize,
    },
    /// Something in the answer is no number.
    #[error("the answer to Evaluate: value {place} is {found}, which is not a finite number")]
    NotANumber {
        /// Its place, from 1, over all lists.
        place: usize,
        /// Its JSON.
        found: String,
    },
}

/// The protocol's names for errors that no point causes.
const OF_SERVER: [&str; 2] = ["ModelNotFound", "UnsupportedFeature"];

impl UmBridgeFailure {
    /// Whether the model failed at a point that it was asked for, and not the way to it.
    pub(super) fn is_of_run(&self) -> bool {
        match self {
            Self::NotReached { .. } => false,
            Self::Reported { kind, .. } => !OF_SERVER.contains(&kind.as_str()),
            _ => true,
        }
    }

    /// Whether another attempt must end in the same way.
    pub(super) fn is_final(&self) -> bool {
        matches!(
            self,
            Self::PointLength { .. }
                | Self::ValueNotFinite { .. }
                | Self::Interrupted
                | Self::Version { .. }
                | Self::NoModel { .. }
                | Self::NoEvaluate { .. }
                | Self::InputSizes { .. }
                | Self::OutputSizes { .. }
        )
    }
}

/// A text after a status, if there is one.
fn words(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!(": {text}") }
}
