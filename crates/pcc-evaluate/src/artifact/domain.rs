//! Section 13: the box that the model runs spanned.

use super::error::ReadError;
use super::meaning::ensure;
use super::v2;
use crate::probability::inputs::InputSpace;
use crate::surrogate::{Surrogate, TrainedDomain};

/// The section, if the box is known.
pub(super) fn section(surrogate: &Surrogate) -> Option<v2::Domain> {
    let side = |side: &Option<[f64; 2]>| side.map(|[lower, upper]| v2::TrainedInterval { lower, upper });
    let trained = surrogate.trained_domain.as_ref()?;
    Some(v2::Domain { inputs: trained.sides().iter().map(side).collect() })
}

/// The box of a section, if it fits the inputs.
pub(super) fn trained(inputs: &InputSpace, section: Option<v2::Domain>) -> Result<Option<TrainedDomain>, ReadError> {
    let Some(section) = section else { return Ok(None) };
    let sides = section.inputs.into_iter().map(|side| side.map(|side| [side.lower, side.upper])).collect();
    let found = TrainedDomain::new(inputs, sides);
    ensure("domain", found.is_some(), || {
        "it needs one interval between finite values for each input whose standardized variable is not uniform, and \
         intervals inside [−1, 1] or null for the others"
            .to_owned()
    })?;
    Ok(found)
}
