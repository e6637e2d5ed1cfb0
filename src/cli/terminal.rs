//! Progress bars on a terminal, and Ctrl-C.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use pcc_evaluate::foundation::Observer;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

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

/// Shows progress on standard error if that is a terminal.
#[derive(Debug)]
pub(super) struct Terminal {
    bar: ProgressBar,
    interrupt: Interrupt,
}

impl Terminal {
    pub fn new(quiet: bool, interrupt: Interrupt) -> Self {
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(0), target);
        if let Ok(style) = ProgressStyle::with_template("{msg:20} {wide_bar} {human_pos}/{human_len}  {eta}") {
            bar.set_style(style);
        }
        Self { bar, interrupt }
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

    fn interrupted(&self) -> bool {
        self.interrupt.0.load(Ordering::SeqCst)
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
