//! `pcc version`

use crate::cli::{Context, Ending};
use clap::Args;
use pcc_evaluate::artifact::version::{MAJOR, MINOR};
use pcc_evaluate::foundation::InstructionSet;
use serde::Serialize;
use std::fmt;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc version             the version alone, like pcc --version
  pcc version --verbose   what belongs into a report of a fault";

/// Show the version of pcc, and what it finds of this machine
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Also show what may matter where something goes wrong: processor, threads, operating system, version of files
    #[arg(long)]
    pub verbose: bool,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let names = |sets: Vec<InstructionSet>| sets.into_iter().map(InstructionSet::name).collect();
    let machine = options.verbose.then(|| Machine {
        instruction_sets: names(InstructionSet::available()),
        instruction_set: InstructionSet::best().name(),
        threads: rayon::current_num_threads(),
        processors: std::thread::available_parallelism().ok().map(usize::from),
        operating_system: std::env::consts::OS,
        architecture: std::env::consts::ARCH,
        file_format: format!("{MAJOR}.{MINOR}"),
        build: if cfg!(debug_assertions) { "debug" } else { "release" },
    });
    context.print(&Version { version: env!("CARGO_PKG_VERSION"), machine })?;
    Ok(Ending::Done)
}

/// The program, and the machine that it runs on.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(in crate::cli) struct Version {
    version: &'static str,
    #[serde(flatten)]
    machine: Option<Machine>,
}

/// What may matter where something goes wrong.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(in crate::cli) struct Machine {
    /// Vector instructions that this processor has, and those that are used.
    instruction_sets: Vec<&'static str>,
    instruction_set: &'static str,
    /// Threads that are used, and processors that are there for pcc.
    threads: usize,
    processors: Option<usize>,
    operating_system: &'static str,
    architecture: &'static str,
    /// Version of surrogate files that is written at most.
    file_format: String,
    build: &'static str,
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "pcc {}", self.version)?;
        let Some(machine) = &self.machine else { return Ok(()) };
        writeln!(f, "  build             {}", machine.build)?;
        writeln!(f, "  surrogate files   format {}", machine.file_format)?;
        writeln!(f, "  instructions      {}, of {}", machine.instruction_set, machine.instruction_sets.join(", "))?;
        let processors = machine.processors.map_or("unknown".to_owned(), |count| count.to_string());
        writeln!(f, "  threads           {}, of {processors} processors", machine.threads)?;
        writeln!(f, "  operating system  {}, {}", machine.operating_system, machine.architecture)
    }
}
