//! Clients: accepted, counted, served in a thread each, and ended.

use super::Limits;
use super::http::{Request, Response, converse};
use super::timed::Timed;
use std::io;
use std::io::{Read, Write};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::thread::{self, Scope};
use std::time::Duration;

/// How often it is asked whether the server is to end.
const LOOK: Duration = Duration::from_millis(20);

/// How long nobody is accepted after that failed: then the system has no files or memory left.
const RECOVERY: Duration = Duration::from_millis(50);

/// What is read of a client that is refused, so that it sees why.
const READ_OF_REFUSED: usize = 1 << 16;

/// An address that clients can connect to.
pub(crate) struct Server {
    listener: TcpListener,
    address: SocketAddr,
    limits: Limits,
}

/// What the threads of a server share.
struct Shared<'s, A> {
    limits: Limits,
    answer: &'s A,
    is_over: AtomicBool,
    connections: AtomicUsize,
    answered: AtomicU64,
}

impl Server {
    /// Listens at `address`; port 0 is any that is free.
    pub fn bind(address: SocketAddr, limits: Limits) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        Ok(Self { address: listener.local_addr()?, listener, limits })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Serves clients until `is_over`, and lets those that are being answered have their answer. Returns how many
    /// requests were answered.
    pub fn run(self, answer: impl Fn(&Request) -> Response + Sync, is_over: impl Fn() -> bool) -> u64 {
        let shared = Shared {
            limits: self.limits,
            answer: &answer,
            is_over: AtomicBool::new(false),
            connections: AtomicUsize::new(0),
            answered: AtomicU64::new(0),
        };
        thread::scope(|scope| {
            let accepting = scope.spawn(|| accept(&self.listener, scope, &shared));
            while !is_over() && !accepting.is_finished() {
                thread::sleep(LOOK);
            }
            shared.is_over.store(true, Ordering::SeqCst);
            // It waits for a client: this is the last one.
            while !accepting.is_finished() {
                let _ = TcpStream::connect_timeout(&reachable(self.address), LOOK);
                thread::sleep(LOOK);
            }
        });
        shared.answered.into_inner()
    }
}

/// An address that means all of this machine is none to connect to.
fn reachable(address: SocketAddr) -> SocketAddr {
    let ip = match address.ip() {
        IpAddr::V4(Ipv4Addr::UNSPECIFIED) => IpAddr::V4(Ipv4Addr::LOCALHOST),
        IpAddr::V6(Ipv6Addr::UNSPECIFIED) => IpAddr::V6(Ipv6Addr::LOCALHOST),
        other => other,
    };
    SocketAddr::new(ip, address.port())
}

fn accept<'scope, 'env, A: Fn(&Request) -> Response + Sync>(
    listener: &TcpListener,
    scope: &'scope Scope<'scope, 'env>,
    shared: &'env Shared<'env, A>,
) {
    loop {
        let accepted = listener.accept();
        if shared.is_over.load(Ordering::SeqCst) {
            return;
        }
        let Ok((stream, _)) = accepted else {
            thread::sleep(RECOVERY);
            continue;
        };
        if shared.connections.load(Ordering::SeqCst) >= shared.limits.connections {
            refuse(stream, shared.limits.connections);
            continue;
        }
        shared.connections.fetch_add(1, Ordering::SeqCst);
        let place = Place(&shared.connections);
        let work = move || {
            let _place = place;
            if let Ok(stream) = Timed::new(stream, &shared.is_over) {
                let answered = converse(stream, &shared.limits, shared.answer);
                shared.answered.fetch_add(answered, Ordering::SeqCst);
            }
        };
        // Without a thread, the client sees its connection end.
        let _ = thread::Builder::new().spawn_scoped(scope, work);
    }
}

/// A place among the connections, free again when it is dropped.
struct Place<'c>(&'c AtomicUsize);

impl Drop for Place<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Tells a client that there are too many, without waiting for anything.
fn refuse(mut stream: TcpStream, connections: usize) {
    let message =
        format!("{connections} clients are served at once; close connections that are not used, or ask later");
    let response = Response::error(503, "ServerBusy", message);
    if stream.set_nonblocking(true).is_ok() {
        let _ = stream.write_all(&response.to_bytes(false, true));
        let mut unread = [0; READ_OF_REFUSED];
        let _ = stream.read(&mut unread);
    }
}
