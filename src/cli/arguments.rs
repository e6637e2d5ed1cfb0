//! What can be typed before and after the name of a command; what belongs to one is in its file.

use super::commands::Command;
use clap::Parser;

/// What the help ends with.
const FIRST_STEPS: &str = "\
First steps:
  pcc run                                the built-in clutch study, end to end
  pcc build STUDY.toml                   build a surrogate from a study
  pcc eval SURROGATE.pcc                 stability proportion from the surrogate alone
  pcc help COMMAND                       everything about one command

Exit codes: 0 done, 1 a requested check did not hold, 2 bad usage or input, 130 interrupted.";

/// How likely is this machine to squeal, flutter or whirl, given what is not known about it?
///
/// pcc runs a model of the machine at a few dozen well-chosen points, fits sparse polynomial chaos expansions to smooth
/// functions of its eigenvalues, and writes them to a small file, the surrogate. Millions of samples of the surrogate
/// then tell how often the machine is stable.
#[derive(Debug, Parser)]
#[command(name = "pcc", version, max_term_width = 110, after_help = FIRST_STEPS)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub command: Command,

    /// Print one JSON document on standard output and nothing else there
    #[arg(long, global = true, display_order = 100)]
    pub json: bool,

    /// Show every detail: all modes, inputs and components
    #[arg(long, global = true, display_order = 99)]
    pub details: bool,

    /// Number of threads [default: all processors]; results do not depend on it
    #[arg(
        long,
        global = true,
        value_name = "N",
        display_order = 101,
        value_parser = clap::value_parser!(u16).range(1..=1024)
    )]
    pub threads: Option<u16>,

    /// Show no progress
    #[arg(long, global = true, display_order = 102)]
    pub quiet: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }
}
