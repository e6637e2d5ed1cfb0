//! The command line: arguments in, reports out, exit codes as promised.

mod arguments;
mod commands;
mod eval_arguments;
mod points;
mod progress;
mod question;
mod recording;
mod run_arguments;

use arguments::{Arguments, Command};
use clap::Parser;
use clap::error::ErrorKind;
use pcc_evaluate::foundation::Interrupted;
use progress::{Interrupt, Terminal};
use serde::Serialize;
use std::fmt::Display;
use std::io::{self, Write};
use std::process::ExitCode;

/// How a command ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ending {
    /// Done.
    Done,
    /// A check the user asked for did not hold.
    CheckFailed,
    /// The user asked to stop, and what there was is printed.
    Interrupted,
}

/// What every command is given.
struct Context {
    json: bool,
    quiet: bool,
    terminal: Terminal,
}

impl Context {
    /// A remark on standard error, beside a report.
    fn say(&self, remark: &str) {
        if !self.quiet {
            complain(remark);
        }
    }

    /// Prints a report: text for people, or one JSON document.
    fn print<R: Serialize + Display>(&self, report: &R) -> anyhow::Result<()> {
        print(&if self.json { format!("{}\n", serde_json::to_string_pretty(report)?) } else { report.to_string() })
    }
}

/// Runs pcc with the arguments of the process: 0 done, 1 a requested check did not hold, 2 bad usage or input, 130
/// interrupted.
pub fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            let _ = error.print();
            let asked = matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion);
            return ExitCode::from(if asked { 0 } else { 2 });
        }
    };
    match run(arguments) {
        Ok(Ending::Done) => ExitCode::SUCCESS,
        Ok(Ending::CheckFailed) => ExitCode::from(1),
        Ok(Ending::Interrupted) => ExitCode::from(130),
        Err(error) => {
            complain(&format!("{error:#}"));
            ExitCode::from(if error.downcast_ref::<Interrupted>().is_some() { 130 } else { 2 })
        }
    }
}

/// A message on standard error; there is nobody to tell if that fails.
fn complain(message: &str) {
    let _ = writeln!(io::stderr(), "pcc: {message}");
}

/// Text on standard output. A reader like `head` that has seen enough is no error.
fn print(text: &str) -> anyhow::Result<()> {
    match io::stdout().write_all(text.as_bytes()).and_then(|()| io::stdout().flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => Ok(result?),
    }
}

fn run(arguments: Arguments) -> anyhow::Result<Ending> {
    let threads = arguments.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let context = Context {
        json: arguments.json,
        quiet: arguments.quiet,
        terminal: Terminal::new(arguments.quiet, Interrupt::install()?),
    };
    pool.install(|| match arguments.command {
        Command::Run(options) => commands::run(&context, &options),
        Command::Build(options) => commands::build(&context, &options),
        Command::Eval(options) => commands::eval(&context, &options),
        Command::Design(options) => commands::design(&context, &options),
        Command::Ingest(options) => commands::ingest(&context, &options),
        Command::Journal(options) => commands::journal(&context, &options),
        Command::Reference(options) => commands::reference(&context, &options),
        Command::Compare(options) => commands::compare(&context, &options),
        Command::Certify(options) => commands::certify(&context, &options),
        Command::Merge(options) => commands::merge(&context, &options),
        Command::Inspect(options) => commands::inspect(&context, &options),
        Command::Report(options) => commands::report(&context, &options),
        Command::Reproduce(options) => commands::reproduce(&context, &options),
        Command::Convert(options) => commands::convert(&context, &options),
        Command::Completions { shell } => commands::completions(shell),
    })
}
