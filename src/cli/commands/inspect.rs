//! `pcc inspect`

use super::super::arguments::Inspect;
use super::super::{Context, Ending, complain};
use super::read_surrogate;
use crate::report::InspectReport;

pub(in super::super) fn inspect(context: &Context, options: &Inspect) -> anyhow::Result<Ending> {
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
    Ok(Ending::Done)
}
