//! `pcc completions`

use crate::cli::arguments::commands;
use crate::cli::messages::print;
use crate::cli::{Context, Ending};
use clap::Args;
use clap_complete::Shell;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc completions bash > ~/.local/share/bash-completion/completions/pcc
  pcc completions zsh > ~/.zfunc/_pcc";

/// Print a completion script for a shell
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// The shell
    shell: Shell,
}

pub(super) fn run(_: &Context, options: &Options) -> anyhow::Result<Ending> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut commands(), "pcc", &mut script);
    print(&String::from_utf8_lossy(&script))?;
    Ok(Ending::Done)
}
