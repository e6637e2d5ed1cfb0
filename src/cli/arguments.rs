//! What can be typed before and after the name of a command; what belongs to one is in its file.

use super::commands::Command;
use super::messages::STYLES;
use clap::{CommandFactory, Parser, ValueHint};

/// What the help ends with.
const FIRST_STEPS: &str = "\
First steps:
  pcc run                                the built-in clutch study, end to end
  pcc build STUDY.toml                   build a surrogate from a study
  pcc eval SURROGATE.pcc                 stability proportion from the surrogate alone
  pcc help COMMAND                       everything about one command

Exit codes: 0 done, 1 a requested check did not hold, 2 bad usage or input, 130 interrupted.";

/// The group of options that all commands have.
const GENERAL: &str = "All commands";

/// How likely is this machine to squeal, flutter or whirl, given what is not known about it?
///
/// pcc runs a model of the machine at a few dozen well-chosen points, fits sparse polynomial chaos expansions to smooth
/// functions of its eigenvalues, and writes them to a small file, the surrogate. Millions of samples of the surrogate
/// then tell how often the machine is stable.
#[derive(Debug, Parser)]
#[command(name = "pcc", version, styles = STYLES, max_term_width = 110, after_help = FIRST_STEPS)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub command: Command,

    /// Print one JSON document on standard output and nothing else there
    #[arg(long, global = true, help_heading = GENERAL, display_order = 100)]
    pub json: bool,

    /// Show every detail: all modes, inputs and components
    #[arg(long, global = true, help_heading = GENERAL, display_order = 99)]
    pub details: bool,

    /// Number of threads [default: all processors]; results do not depend on it
    #[arg(
        long,
        global = true,
        help_heading = GENERAL,
        value_name = "N",
        display_order = 101,
        value_parser = clap::value_parser!(u16).range(1..=1024)
    )]
    pub threads: Option<u16>,

    /// Show no progress, no remarks and no hints
    #[arg(long, global = true, help_heading = GENERAL, display_order = 102)]
    pub quiet: bool,
}

/// The command line as scripts and pages are made from it: with what shells need to complete values.
pub(super) fn commands() -> clap::Command {
    let is_folder = |argument: &clap::Arg| argument.get_value_names().is_some_and(|names| names == ["DIR"]);
    let hinted = |argument: clap::Arg| match argument.get_value_hint() {
        ValueHint::AnyPath if is_folder(&argument) => argument.value_hint(ValueHint::DirPath),
        ValueHint::AnyPath => argument.value_hint(ValueHint::FilePath),
        _ => argument,
    };
    Arguments::command().mut_subcommands(|command| command.mut_args(hinted))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_and_folders_are_completed() {
        for command in commands().get_subcommands().filter(|command| command.get_name() != "completions") {
            let unclear = command.get_arguments().find(|argument| argument.get_value_hint() == ValueHint::AnyPath);
            assert!(unclear.is_none(), "{}: {unclear:?} is a file or a folder", command.get_name());
        }
        let hint = |command: &str, argument: &str| {
            let commands = commands();
            let mut of_command = commands.find_subcommand(command).unwrap().get_arguments();
            of_command.find(|known| known.get_id() == argument).unwrap().get_value_hint()
        };
        assert_eq!((hint("eval", "surrogate"), hint("run", "output")), (ValueHint::FilePath, ValueHint::DirPath));
    }

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    /// What the help shows can be typed: two examples or more per command, each of that command.
    #[test]
    fn examples_in_the_help_are_understood() {
        for command in Arguments::command().get_subcommands() {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let examples: Vec<&str> = help.lines().filter(|line| line.starts_with("  pcc ")).collect();
            assert!(examples.len() >= 2, "{} has {} examples", command.get_name(), examples.len());
            for example in examples {
                let typed = example.trim_start().split("  ").next().unwrap().split(" > ").next().unwrap();
                let understood = Arguments::try_parse_from(typed.split(' '));
                assert!(understood.is_ok(), "{example}: {}", understood.unwrap_err());
                assert_eq!(typed.split(' ').nth(1), Some(command.get_name()), "{example}");
            }
        }
    }

    #[test]
    fn more_than_six_options_are_in_groups() {
        for command in Arguments::command().get_subcommands() {
            let (mut alone, mut all) = (0, 0);
            for option in command.get_opts() {
                alone += usize::from(option.get_help_heading().is_none());
                all += 1;
            }
            assert!(alone <= 8 && (all <= 6 || alone < all), "{}: {alone} of {all} in no group", command.get_name());
        }
    }
}
