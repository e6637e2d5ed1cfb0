//! Progress bars on a terminal, and Ctrl-C.

use super::messages::remark;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use pcc_evaluate::foundation::{Observer, count};
use std::fmt::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Where nobody looks at a terminal, remarks come no more often than this.
const PAUSE: Duration = Duration::from_secs(10);

/// Whether Ctrl-C was pressed.
#[derive(Debug, Clone)]
pub(super) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Watches for Ctrl-C: the work is asked to stop, and ends without leaving anything half-written.
    ///
    /// A process has one such watch, however often it runs the command line.
    pub fn install() -> anyhow::Result<Self> {
        static FLAG: Mutex<Option<Arc<AtomicBool>>> = Mutex::new(None);
        let mut installed = FLAG.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(flag) = &*installed {
            flag.store(false, Ordering::SeqCst);
            return Ok(Self(flag.clone()));
        }
        let flag = Arc::new(AtomicBool::new(false));
        let seen = flag.clone();
        ctrlc::set_handler(move || seen.store(true, Ordering::SeqCst))?;
        *installed = Some(flag.clone());
        Ok(Self(flag))
    }
}

/// Shows progress on standard error if that is a terminal, and tells how long work gets on.
#[derive(Debug)]
pub(super) struct Terminal {
    bar: ProgressBar,
    is_quiet: bool,
    /// When there was a remark last, or the work began.
    last_remark: Mutex<Instant>,
    takes_what_there_is: AtomicBool,
    interrupt: Interrupt,
}

impl Terminal {
    pub fn new(quiet: bool, interrupt: Interrupt) -> Self {
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(0), target);
        if let Ok(style) = ProgressStyle::with_template("{msg:18} {wide_bar} {done}  {rate}  {left}") {
            bar.set_style(with_numbers(style));
        }
        Self {
            bar,
            is_quiet: quiet,
            last_remark: Mutex::new(Instant::now()),
            takes_what_there_is: AtomicBool::new(false),
            interrupt,
        }
    }

    /// Whether interrupted work is to give what it has.
    pub fn take_what_there_is(&self, takes: bool) {
        self.takes_what_there_is.store(takes, Ordering::SeqCst);
    }
}

impl Observer for Terminal {
    fn begin(&self, stage: &str, total: u64) {
        // Message and length first: `reset` is what draws.
        self.bar.update(|state| state.set_len(total));
        self.bar.set_message(stage.to_owned());
        self.bar.reset();
    }

    fn advance(&self, steps: u64) {
        self.bar.inc(steps);
    }

    fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn remark(&self, text: &str) {
        if self.is_quiet {
            return;
        }
        if !self.bar.is_hidden() {
            self.bar.suspend(|| remark(text));
            return;
        }
        let mut last = self.last_remark.lock().unwrap_or_else(PoisonError::into_inner);
        if last.elapsed() >= PAUSE {
            *last = Instant::now();
            remark(text);
        }
    }

    fn takes_what_there_is(&self) -> bool {
        self.takes_what_there_is.load(Ordering::SeqCst)
    }

    fn interrupted(&self) -> bool {
        self.interrupt.0.load(Ordering::SeqCst)
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// What bars show in numbers, written as reports write them. A number that cannot be written is left out.
fn with_numbers(style: ProgressStyle) -> ProgressStyle {
    style
        .with_key("done", |state: &ProgressState, text: &mut dyn Write| {
            let of = state.len().unwrap_or(0);
            let _ = write!(text, "{} of {}", count(state.pos()), count(of));
        })
        .with_key("rate", |state: &ProgressState, text: &mut dyn Write| {
            let _ = text.write_str(&rate(state.per_sec()));
        })
        .with_key("left", |state: &ProgressState, text: &mut dyn Write| {
            let begun = state.pos() > 0;
            let _ = text.write_str(&if begun { left(state.eta()) } else { String::new() });
        })
}

/// `1 234/s`, `2.5/s`, or `12/min` for what is slower than one in two seconds.
fn rate(per_second: f64) -> String {
    /// Below this, numbers per second say little.
    const SLOW: f64 = 0.5;
    match per_second {
        unknown if !unknown.is_finite() => String::new(),
        fast if fast >= 10.0 => format!("{}/s", count(fast as u64)),
        slow if slow < SLOW => format!("{:.1}/min", 60.0 * slow.max(0.0)),
        other => format!("{other:.1}/s"),
    }
}

/// `12 s left`, `3 min 20 s left`, `2 h 5 min left`.
fn left(time: Duration) -> String {
    let seconds = time.as_secs();
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, seconds) => format!("{seconds} s left"),
        (0, minutes, seconds) => format!("{minutes} min {seconds} s left"),
        (hours, minutes, _) => format!("{} h {minutes} min left", count(hours)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_and_times_are_written_as_reports_write_numbers() {
        assert_eq!([1.7e7, 12.3, 2.54, 0.2, f64::NAN].map(rate), ["17 000 000/s", "12/s", "2.5/s", "12.0/min", ""]);
        let times = [0, 12, 200, 7500].map(|seconds| left(Duration::from_secs(seconds)));
        assert_eq!(times, ["0 s left", "12 s left", "3 min 20 s left", "2 h 5 min left"]);
    }
}
