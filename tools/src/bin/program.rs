//! The program `pcc`, for the tests of this package: cargo gives tests the programs of their own package only.

use std::process::ExitCode;

fn main() -> ExitCode {
    pcc::cli::run(std::env::args_os())
}
