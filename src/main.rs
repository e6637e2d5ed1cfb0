//! The `pcc` program: everything is in the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    pcc::cli::run(std::env::args_os())
}
