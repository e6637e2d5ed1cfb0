//! `pcc inspect`

use crate::cli::inputs::read_surrogate;
use crate::cli::messages::complain;
use crate::cli::{Context, Ending};
use crate::report::InspectReport;
use clap::Args;
use std::path::PathBuf;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc inspect belt.pcc           inputs, components, degrees, errors
  pcc inspect belt.pcc --check   fails if this program computes it otherwise";

/// Show what is inside a surrogate file
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Surrogate file
    pub surrogate: PathBuf,

    /// Exit with code 1 if this evaluator does not find the values of the self-test, or the model did not answer in a
    /// part of the domain
    #[arg(long)]
    pub check: bool,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let artifact = read_surrogate(&options.surrogate)?;
    let bytes = std::fs::metadata(&options.surrogate)?.len();
    let report = InspectReport::new(&artifact, options.surrogate.display().to_string(), bytes);
    context.print(&report)?;
    if options.check && !report.self_test_holds() {
        complain(&format!(
            "the self-test is off by {:e}, more than its tolerance {:e}",
            report.self_test_difference, report.self_test_tolerance
        ));
        return Ok(Ending::CheckFailed);
    }
    if options.check && artifact.surrogate.coverage.is_some() {
        complain("the model did not answer in a part of the domain");
        return Ok(Ending::CheckFailed);
    }
    Ok(Ending::Done)
}
