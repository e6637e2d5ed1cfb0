//! How long work tells what it does and learns that it should stop.

use std::error::Error;

/// The user asked long work to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("interrupted")]
pub struct Interrupted;

/// Whether the user asked to stop, and that is why something failed: whether [`Interrupted`] is among the causes of
/// `error`.
pub fn is_interruption(error: &(dyn Error + 'static)) -> bool {
    let mut cause = Some(error);
    while let Some(error) = cause {
        if error.is::<Interrupted>() {
            return true;
        }
        cause = error.source();
    }
    false
}

/// Watches long work. Calls come from several threads.
pub trait Observer: Sync {
    /// A stage of `total` steps begins: "model runs", "samples" and so on.
    fn begin(&self, stage: &str, total: u64);

    /// `steps` more steps of the stage are done.
    fn advance(&self, steps: u64);

    /// The stage ended.
    fn finish(&self);

    /// Something worth a line is known that the end result does not tell: what a level of a build has shown.
    fn remark(&self, _: &str) {}

    /// Whether work that the user stops is to give what it has, where that is of use.
    fn takes_what_there_is(&self) -> bool {
        false
    }

    /// Whether the user asked to stop.
    fn interrupted(&self) -> bool;

    /// Asked again and again by long work, so that it ends soon after the user asked to stop.
    ///
    /// # Errors
    ///
    /// [`Interrupted`] if the user asked to stop.
    fn check(&self) -> Result<(), Interrupted> {
        if self.interrupted() { Err(Interrupted) } else { Ok(()) }
    }
}

/// Neither shows nor stops anything.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Observer for Silent {
    fn begin(&self, _: &str, _: u64) {}
    fn advance(&self, _: u64) {}
    fn finish(&self) {}
    fn interrupted(&self) -> bool {
        false
    }
}
