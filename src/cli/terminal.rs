//! Progress bars on a terminal, and Ctrl-C.

use super::complain;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use pcc_evaluate::foundation::Observer;
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
    pub fn install() -> anyhow::Result<Self> {
        let flag = Arc::new(AtomicBool::new(false));
        let seen = flag.clone();
        ctrlc::set_handler(move || seen.store(true, Ordering::SeqCst))?;
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
        if let Ok(style) = ProgressStyle::with_template("{msg:20} {wide_bar} {human_pos}/{human_len}  {eta}") {
            bar.set_style(style);
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
            self.bar.suspend(|| complain(text));
            return;
        }
        let mut last = self.last_remark.lock().unwrap_or_else(PoisonError::into_inner);
        if last.elapsed() >= PAUSE {
            *last = Instant::now();
            complain(text);
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
