//! Section 12: units and labels of the inputs.

use super::error::ReadError;
use super::meaning::ensure;
use super::v2;
use crate::probability::inputs::{Description, DescriptionError, InputSpace};

/// Name of the section.
const SECTION: &str = "descriptions";

/// The section, if there is a unit or a label.
pub(super) fn section(inputs: &InputSpace) -> Option<v2::Descriptions> {
    let text = |text: Option<&str>| text.map(str::to_owned);
    let descriptions = inputs.inputs().iter().map(|input| &input.description);
    inputs.has_descriptions().then(|| v2::Descriptions {
        inputs: descriptions.map(|one| v2::Description { unit: text(one.unit()), label: text(one.label()) }).collect(),
    })
}

/// `inputs` with the units and labels of a section.
pub(super) fn described(inputs: InputSpace, section: Option<v2::Descriptions>) -> Result<InputSpace, ReadError> {
    let Some(section) = section else { return Ok(inputs) };
    let (found, expected) = (section.inputs.len(), inputs.dimension());
    ensure(SECTION, found == expected, || format!("it describes {found} inputs, but there are {expected}"))?;
    let mut descriptions = Vec::with_capacity(found);
    for (stored, name) in section.inputs.iter().zip(inputs.names()) {
        let wrong = |what: &str, cause: DescriptionError| ReadError::Meaning {
            section: SECTION,
            message: format!("the {what} of {name} {cause}"),
        };
        let mut description = Description::default();
        if let Some(unit) = &stored.unit {
            description = description.with_unit(unit).map_err(|cause| wrong("unit", cause))?;
        }
        if let Some(label) = &stored.label {
            description = description.with_label(label).map_err(|cause| wrong("label", cause))?;
        }
        let is_trimmed = (description.unit(), description.label()) == (stored.unit.as_deref(), stored.label.as_deref());
        ensure(SECTION, is_trimmed, || format!("a text of {name} begins or ends with a space"))?;
        descriptions.push(description);
    }
    let inputs = inputs.described(descriptions);
    ensure(SECTION, inputs.has_descriptions(), || "it has neither a unit nor a label".to_owned())?;
    Ok(inputs)
}
