//! `pcc completions`

use crate::cli::arguments::Arguments;
use crate::cli::{Context, Ending, print};
use clap::{Args, CommandFactory};
use clap_complete::Shell;

/// Print a completion script for a shell
///
/// For example: pcc completions bash > ~/.local/share/bash-completion/completions/pcc
#[derive(Debug, Args)]
pub(in crate::cli) struct Options {
    /// The shell
    shell: Shell,
}

pub(super) fn run(_: &Context, options: &Options) -> anyhow::Result<Ending> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut Arguments::command(), "pcc", &mut script);
    print(&String::from_utf8_lossy(&script))?;
    Ok(Ending::Done)
}
