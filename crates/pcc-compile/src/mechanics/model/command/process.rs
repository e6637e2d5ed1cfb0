//! One process: started, waited for, and ended if it takes too long.
//!
//! A program has a process group of its own, so that whatever it starts can be ended with it.

use super::error::CommandFailure;
use super::settings::CommandSettings;
use super::{captured, command_line, printable};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use std::{io, thread};

/// Sleeps between looks at a process: one part in 64 of the time it has taken, within these bounds. Short runs lose
/// less than a hundredth of their time, and long ones cost nothing.
const SHORTEST_PAUSE: Duration = Duration::from_millis(1);
const LONGEST_PAUSE: Duration = Duration::from_millis(20);
const PAUSES_PER_TIME: u32 = 64;

/// How long a killed process is waited for: one that hangs in the kernel, on a network drive say, cannot be ended.
const PATIENCE: Duration = Duration::from_secs(5);

/// Runs the program in `folder`; returns once it has ended, and fails unless it ended well.
pub(super) fn run(settings: &CommandSettings, folder: &Path, interrupted: &AtomicBool) -> Result<(), CommandFailure> {
    let mut command = command_line::command(settings, folder)?;
    let (output, error) = captured::create(folder)?;
    command.stdin(Stdio::null()).stdout(output).stderr(error);
    own_group(&mut command);
    let mut child = command.spawn().map_err(|error| not_started(&command, &error))?;
    match wait(&mut child, settings.timeout, interrupted) {
        Ok(status) => check(status),
        Err(failure) => {
            end(&mut child);
            Err(failure)
        }
    }
}

fn wait(child: &mut Child, timeout: Option<Duration>, interrupted: &AtomicBool) -> Result<ExitStatus, CommandFailure> {
    let start = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Ok(status),
            Ok(None) => {}
            Err(error) => return Err(CommandFailure::Lost { cause: error.to_string() }),
        }
        if interrupted.load(Ordering::Relaxed) {
            return Err(CommandFailure::Interrupted);
        }
        let elapsed = start.elapsed();
        let left = timeout.map_or(Duration::MAX, |limit| limit.saturating_sub(elapsed));
        match timeout {
            Some(limit) if left.is_zero() => return Err(CommandFailure::TimedOut { limit }),
            _ => thread::sleep(pause(elapsed).min(left)),
        }
    }
}

fn pause(elapsed: Duration) -> Duration {
    (elapsed / PAUSES_PER_TIME).clamp(SHORTEST_PAUSE, LONGEST_PAUSE)
}

fn check(status: ExitStatus) -> Result<(), CommandFailure> {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return Err(CommandFailure::Signal { signal });
    }
    match status.code() {
        Some(0) => Ok(()),
        Some(code) => Err(CommandFailure::ExitStatus { code }),
        None => Err(CommandFailure::Lost { cause: status.to_string() }),
    }
}

fn not_started(command: &Command, error: &io::Error) -> CommandFailure {
    let path = Path::new(command.get_program());
    let program = printable::path(path);
    if error.kind() != io::ErrorKind::NotFound {
        CommandFailure::NotStarted { program, cause: error.to_string() }
    } else if path.is_absolute() && path.exists() {
        CommandFailure::NotStarted { program, cause: "the interpreter in its first line is not found".to_owned() }
    } else {
        CommandFailure::NotFound { program }
    }
}

#[cfg(unix)]
fn own_group(command: &mut Command) {
    std::os::unix::process::CommandExt::process_group(command, 0);
}

#[cfg(not(unix))]
fn own_group(_: &mut Command) {}

/// Kills the process with its group, and reaps it. It has not been waited for yet, so its number still is its own.
fn end(child: &mut Child) {
    // Killing fails if all is over already: nothing is left to do then.
    #[cfg(unix)]
    let _ = rustix::process::kill_process_group(rustix::process::Pid::from_child(child), rustix::process::Signal::KILL);
    let _ = child.kill();
    let start = Instant::now();
    while start.elapsed() < PATIENCE && matches!(child.try_wait(), Ok(None)) {
        thread::sleep(pause(start.elapsed()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_grow_with_time_within_bounds() {
        let milliseconds = |elapsed| pause(Duration::from_millis(elapsed)).as_secs_f64() * 1e3;
        assert_eq!([0, 50, 128, 320, 640, 3_600_000].map(milliseconds), [1.0, 1.0, 2.0, 5.0, 10.0, 20.0]);
    }
}
