//! Section 14: what components miss at runs left out.

use super::error::ReadError;
use super::meaning::ensure;
use super::v2;
use crate::surrogate::{LeftOut, Surrogate};

/// The section, if residuals are known.
pub(super) fn section(surrogate: &Surrogate) -> Option<v2::LeftOut> {
    surrogate.left_out.as_ref().map(|left_out| v2::LeftOut { runs: left_out.runs().to_vec() })
}

/// The residuals of a section, if they are those of so many `components`, on one element.
pub(super) fn residuals(
    section: Option<v2::LeftOut>,
    components: usize,
    elements: usize,
) -> Result<Option<LeftOut>, ReadError> {
    let Some(v2::LeftOut { runs }) = section else { return Ok(None) };
    let count = runs.len();
    let fits = elements == 1 && runs.iter().all(|run| run.len() == components);
    let found = LeftOut::new(runs).filter(|left_out| fits && left_out.runs().len() == count);
    ensure("left_out", found.is_some(), || {
        format!("it needs 1 to 200 runs with {components} residuals each, and belongs to surrogates of one element")
    })?;
    Ok(found)
}
