//! Requests and answers of HTTP/1.1, within limits.

use super::Limits;
use super::timed::Timed;
use serde_json::{Value, json};
use std::io::{self, ErrorKind};
use std::time::{Duration, Instant};

/// Headers that are read.
const MOST_HEADERS: usize = 64;

/// How long a client that was refused may go on sending before the connection ends.
const LINGERING: Duration = Duration::from_secs(2);

/// A request, read whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Request {
    /// In upper case.
    pub method: String,
    /// Without slashes at its ends, and without what follows a question mark.
    pub path: String,
    /// The body.
    pub body: Vec<u8>,
    /// Whether the client may ask again on the same connection.
    keeps_connection: bool,
}

/// An answer: a status, and JSON.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Response {
    /// 200 for success.
    pub status: u16,
    /// What is said.
    pub body: Value,
}

impl Response {
    /// An answer.
    pub fn new(body: Value) -> Self {
        Self { status: 200, body }
    }

    /// An error as the protocol writes it.
    pub fn error(status: u16, kind: &str, message: impl Into<String>) -> Self {
        Self { status, body: json!({ "error": { "type": kind, "message": message.into() } }) }
    }

    /// What goes over the wire.
    pub fn to_bytes(&self, keeps_connection: bool, has_body: bool) -> Vec<u8> {
        let body = self.body.to_string();
        let connection = if keeps_connection { "keep-alive" } else { "close" };
        let head = format!(
            "HTTP/1.1 {} {}\r\nContent-Type: application/json\r\nContent-Length: {}\r\nConnection: {connection}\r\n\r\n",
            self.status,
            reason(self.status),
            body.len(),
        );
        (if has_body { head + &body } else { head }).into_bytes()
    }
}

fn reason(status: u16) -> &'static str {
    match status {
        200 => "OK",
        400 => "Bad Request",
        404 => "Not Found",
        405 => "Method Not Allowed",
        408 => "Request Timeout",
        411 => "Length Required",
        413 => "Content Too Large",
        431 => "Request Header Fields Too Large",
        503 => "Service Unavailable",
        505 => "HTTP Version Not Supported",
        _ => "Internal Server Error",
    }
}

/// Why there is no request.
enum NoRequest {
    /// The client is gone, or the server ends.
    Gone,
    /// Nothing more is read after this answer.
    Refused(Response),
}

impl From<io::Error> for NoRequest {
    fn from(_: io::Error) -> Self {
        Self::Gone
    }
}

impl NoRequest {
    fn new(status: u16, message: impl Into<String>) -> Self {
        Self::Refused(Response::error(status, "InvalidInput", message))
    }
}

/// What the head of a request says.
struct Head {
    request: Request,
    /// Bytes of the head.
    length: usize,
    /// Bytes of the body.
    body: usize,
    /// Whether the client waits until it may send the body.
    waits: bool,
}

/// Answers requests of one client, one after the other, until it goes. Returns their number.
pub(super) fn converse(stream: Timed<'_>, limits: &Limits, answer: impl Fn(&Request) -> Response) -> u64 {
    let (mut connection, mut answered) = (Connection { stream, unread: Vec::new() }, 0);
    loop {
        let written = match connection.request(limits) {
            Ok(request) => {
                let bytes = answer(&request).to_bytes(request.keeps_connection, request.method != "HEAD");
                connection.stream.write_all(&bytes, Instant::now() + limits.patience).map(|()| request.keeps_connection)
            }
            Err(NoRequest::Gone) => return answered,
            Err(NoRequest::Refused(response)) => {
                let bytes = response.to_bytes(false, true);
                connection.stream.write_all(&bytes, Instant::now() + limits.patience).map(|()| false)
            }
        };
        answered += u64::from(written.is_ok());
        match written {
            Ok(true) => {}
            Ok(false) => {
                connection.stream.linger(Instant::now() + LINGERING.min(limits.patience));
                return answered;
            }
            Err(_) => return answered,
        }
    }
}

struct Connection<'s> {
    stream: Timed<'s>,
    /// What was read and belongs to no request yet.
    unread: Vec<u8>,
}

impl Connection<'_> {
    fn request(&mut self, limits: &Limits) -> Result<Request, NoRequest> {
        let Head { mut request, length, body, waits } = self.head(limits)?;
        self.unread.drain(..length);
        let deadline = Instant::now() + limits.patience;
        if waits && self.unread.len() < body {
            self.stream.write_all(b"HTTP/1.1 100 Continue\r\n\r\n", deadline)?;
        }
        while self.unread.len() < body {
            self.more(deadline, || format!("the body did not come within {} s", limits.patience.as_secs_f64()))?;
        }
        let rest = self.unread.split_off(body);
        request.body = std::mem::replace(&mut self.unread, rest);
        Ok(request)
    }

    fn head(&mut self, limits: &Limits) -> Result<Head, NoRequest> {
        let deadline = Instant::now() + limits.patience;
        loop {
            if let Some(head) = parse(&self.unread, limits)? {
                return Ok(head);
            }
            if self.unread.len() > limits.head {
                return Err(NoRequest::new(431, format!("the head of a request has at most {} bytes", limits.head)));
            }
            if self.unread.is_empty() {
                // A client that says nothing is not answered.
                self.more(deadline, String::new).map_err(|_| NoRequest::Gone)?;
                continue;
            }
            self.more(deadline, || format!("the head did not come within {} s", limits.patience.as_secs_f64()))?;
        }
    }

    /// Reads more; what is said if that takes too long.
    fn more(&mut self, deadline: Instant, too_late: impl Fn() -> String) -> Result<(), NoRequest> {
        let mut buffer = [0; 1 << 13];
        match self.stream.read(&mut buffer, deadline) {
            Ok(0) => Err(NoRequest::Gone),
            Ok(length) => {
                self.unread.extend_from_slice(&buffer[..length]);
                Ok(())
            }
            Err(error) if error.kind() == ErrorKind::TimedOut => Err(NoRequest::new(408, too_late())),
            Err(error) => Err(error.into()),
        }
    }
}

/// The head that `bytes` begin with, if it is complete.
fn parse(bytes: &[u8], limits: &Limits) -> Result<Option<Head>, NoRequest> {
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut head = httparse::Request::new(&mut headers);
    let length = match head.parse(bytes) {
        Ok(httparse::Status::Complete(length)) => length,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(httparse::Error::TooManyHeaders) => {
            return Err(NoRequest::new(431, format!("a request has at most {MOST_HEADERS} headers")));
        }
        Err(httparse::Error::Version) => return Err(NoRequest::new(505, "this server speaks HTTP/1.0 and HTTP/1.1")),
        Err(error) => return Err(NoRequest::new(400, format!("this is no request of HTTP: {error}"))),
    };
    let values = |name: &'static str| {
        let of_name = head.headers.iter().filter(move |header| header.name.eq_ignore_ascii_case(name));
        of_name.map(|header| String::from_utf8_lossy(header.value).trim().to_ascii_lowercase())
    };
    if values("transfer-encoding").next().is_some() {
        return Err(NoRequest::new(411, "bodies in chunks are not read; say their length in Content-Length"));
    }
    let mut lengths = values("content-length");
    let body = match (lengths.next(), lengths.next()) {
        (None, _) => 0,
        (Some(text), None) => body_length(&text, limits)?,
        (Some(_), Some(_)) => return Err(NoRequest::new(400, "there is more than one Content-Length")),
    };
    let is_modern = head.version == Some(1);
    let path = head.path.unwrap_or_default();
    let request = Request {
        method: head.method.unwrap_or_default().to_ascii_uppercase(),
        path: path.split(['?', '#']).next().unwrap_or_default().trim_matches('/').to_owned(),
        body: Vec::new(),
        keeps_connection: is_modern && !values("connection").any(|value| value.contains("close")),
    };
    let waits = is_modern && values("expect").any(|value| value == "100-continue");
    Ok(Some(Head { request, length, body, waits }))
}

fn body_length(text: &str, limits: &Limits) -> Result<usize, NoRequest> {
    if text.is_empty() || !text.bytes().all(|byte| byte.is_ascii_digit()) {
        return Err(NoRequest::new(400, "Content-Length is not a number of bytes"));
    }
    // So many digits that they are no number are too many bytes.
    match text.parse::<usize>() {
        Ok(length) if length <= limits.body => Ok(length),
        _ => Err(NoRequest::new(413, format!("bodies have at most {} bytes; one point takes far less", limits.body))),
    }
}
