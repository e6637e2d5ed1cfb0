//! The command line: arguments in, reports out, exit codes as promised.

#![allow(rustdoc::invalid_html_tags, reason = "comments on options are their help texts")]

mod answers;
mod arguments;
mod commands;
mod context;
mod hints;
mod inputs;
mod messages;
mod old_spellings;
mod overwrite;
mod points;
mod question_options;
#[cfg(feature = "schema")]
mod schemas;
mod shared_options;
mod study_of;
mod terminal;

#[cfg(feature = "schema")]
pub use schemas::schemas;

use crate::error::{CHECK_FAILED, DONE, FAILED, INTERRUPTED};
use arguments::Arguments;
use clap::Parser;
use clap::error::ErrorKind;
use context::Context;
use messages::{complain, remark};
use pcc_evaluate::foundation::is_interruption;
use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::Mutex;
use terminal::{Interrupt, Terminal};

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

/// Runs pcc with these arguments, the first of them the program's name.
pub fn run<A: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = A>) -> ExitCode {
    ExitCode::from(exit_code_of(arguments))
}

/// The same for programs that end themselves: 0 done, 1 a requested check did not hold, 2 bad usage or input, 130
/// interrupted.
pub fn exit_code_of<A: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = A>) -> u8 {
    let (arguments, remarks) = old_spellings::modern(arguments.into_iter().map(Into::into));
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            remarks.iter().for_each(|text| remark(text));
            let _ = error.print();
            let asked = matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion);
            return if asked { DONE } else { FAILED };
        }
    };
    run_command(&arguments, &remarks)
}

/// Says what went wrong; the exit code that goes with it.
fn failed(error: &anyhow::Error) -> u8 {
    complain(&message(error));
    if is_interruption(&**error) { INTERRUPTED } else { FAILED }
}

/// An error of long work on `what`; an interruption says nothing of that, since nothing is wrong with it.
fn about<E: std::error::Error + Send + Sync + 'static>(what: &str, error: E) -> anyhow::Error {
    let is_failure = !is_interruption(&error);
    let error = anyhow::Error::from(error);
    if is_failure { error.context(what.to_owned()) } else { error }
}

/// What went wrong, from the outside in. Errors of the library say their causes themselves; nothing is said twice.
fn message(error: &anyhow::Error) -> String {
    error.chain().map(ToString::to_string).fold(String::new(), |said, cause| match said.contains(&cause) {
        true => said,
        false if said.is_empty() => cause,
        false => format!("{said}: {cause}"),
    })
}

fn run_command(arguments: &Arguments, remarks: &[String]) -> u8 {
    let (pool, context) = match prepare(arguments) {
        Ok(prepared) => prepared,
        Err(error) => return failed(&error),
    };
    remarks.iter().for_each(|text| context.say(text));
    let code = match pool.install(|| arguments.command.run(&context)) {
        Ok(Ending::Done) => DONE,
        Ok(Ending::CheckFailed) => CHECK_FAILED,
        Ok(Ending::Interrupted) => INTERRUPTED,
        Err(error) => failed(&error),
    };
    context.say_afterwards();
    code
}

fn prepare(arguments: &Arguments) -> anyhow::Result<(rayon::ThreadPool, Context)> {
    let threads = arguments.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let context = Context {
        json: arguments.json,
        details: arguments.details,
        quiet: arguments.quiet,
        terminal: Terminal::new(arguments.quiet, Interrupt::install()?),
        afterwards: Mutex::default(),
    };
    Ok((pool, context))
}
