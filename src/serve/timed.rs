//! A connection on which nothing takes longer than it may.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How often who waits looks whether the server is to end.
const TICK: Duration = Duration::from_millis(50);

/// A stream, and whether the server is to end.
pub(super) struct Timed<'s> {
    stream: TcpStream,
    is_over: &'s AtomicBool,
}

impl<'s> Timed<'s> {
    /// A connection that was just accepted.
    pub fn new(stream: TcpStream, is_over: &'s AtomicBool) -> io::Result<Self> {
        stream.set_nodelay(true)?;
        Ok(Self { stream, is_over })
    }

    /// Reads what is there, and waits for it until `deadline`. Nothing is the end of what the client sends.
    pub fn read(&mut self, buffer: &mut [u8], deadline: Instant) -> io::Result<usize> {
        loop {
            self.stream.set_read_timeout(Some(self.turn(deadline)?))?;
            match self.stream.read(buffer) {
                Err(error) if is_of_time(&error) => {}
                found => return found,
            }
        }
    }

    /// Writes all of `bytes` until `deadline`. What is answered already goes out even if the server is to end, as far
    /// as the client takes it at once.
    pub fn write_all(&mut self, mut bytes: &[u8], deadline: Instant) -> io::Result<()> {
        self.stream.set_write_timeout(Some(TICK))?;
        while !bytes.is_empty() {
            match self.stream.write(bytes) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(written) => bytes = &bytes[written..],
                Err(error) if is_of_time(&error) => {
                    self.turn(deadline)?;
                }
                Err(error) => return Err(error),
            }
            if Instant::now() >= deadline {
                return Err(ErrorKind::TimedOut.into());
            }
        }
        Ok(())
    }

    /// Says that nothing more is written, and reads over what the client still sends: a connection that is closed with
    /// something unread takes the last answer with it.
    pub fn linger(&mut self, deadline: Instant) {
        let _ = self.stream.shutdown(Shutdown::Write);
        let mut unread = [0; 1 << 14];
        while self.read(&mut unread, deadline).is_ok_and(|length| length > 0) {}
    }

    /// How long to wait before the next look.
    fn turn(&self, deadline: Instant) -> io::Result<Duration> {
        if self.is_over.load(Ordering::Relaxed) {
            return Err(ErrorKind::ConnectionAborted.into());
        }
        match deadline.saturating_duration_since(Instant::now()) {
            Duration::ZERO => Err(ErrorKind::TimedOut.into()),
            left => Ok(left.min(TICK)),
        }
    }
}

/// Systems call it by one of two names when a wait is over.
fn is_of_time(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
