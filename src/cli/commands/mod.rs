//! The list of commands. Each has a file with its options and what it does; commands do not know each other.

use super::{Context, Ending};
use clap::Subcommand;

/// One line per command, in the order of the help: its name, its file, its options and its work.
macro_rules! commands {
    ($($name:ident: $file:ident),+ $(,)?) => {
        $(pub(super) mod $file;)+

        #[derive(Debug, Subcommand)]
        pub(super) enum Command {
            $($name(Box<$file::Options>),)+
        }

        impl Command {
            pub fn run(&self, context: &Context) -> anyhow::Result<Ending> {
                match self {
                    $(Self::$name(options) => $file::run(context, options),)+
                }
            }
        }
    };
}

commands! {
    Run: run,
    Modes: modes,
    Build: build,
    Design: design,
    Ingest: ingest,
    Journal: journal,
    Eval: eval,
    Merge: merge,
    Reference: reference,
    Compare: compare,
    Certify: certify,
    Inspect: inspect,
    Report: report,
    Serve: serve,
    Reproduce: reproduce,
    Convert: convert,
    Completions: completions,
    Man: man,
    Version: version,
}
