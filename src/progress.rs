//! How long work tells what it does and learns that it should stop.

/// Watches long work. Calls come from several threads.
pub trait Observer: Sync {
    /// A stage of `total` steps begins: "model runs", "samples" and so on.
    fn begin(&self, stage: &str, total: u64);

    /// `steps` more steps of the stage are done.
    fn advance(&self, steps: u64);

    /// The stage ended.
    fn finish(&self);

    /// Whether the user asked to stop. Work that sees this returns an error soon and leaves nothing behind.
    fn interrupted(&self) -> bool;
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
