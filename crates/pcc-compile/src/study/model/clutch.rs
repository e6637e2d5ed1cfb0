//! The built-in clutch: names and values of its parameters.

use crate::mechanics::model::{CLUTCH_PARAMETERS, Parameter};
use crate::study::error::StudyError;
use crate::study::validate::Lines;
use pcc_evaluate::probability::inputs::InputSpace;
use std::fmt::Write;
use toml::Spanned;

impl Lines<'_> {
    /// The parameter of the clutch with this name.
    pub(super) fn parameter<T>(
        &self,
        table: &str,
        name: &str,
        value: &Spanned<T>,
    ) -> Result<&'static Parameter, StudyError> {
        CLUTCH_PARAMETERS.iter().find(|parameter| parameter.name == name).ok_or_else(|| StudyError::UnknownParameter {
            place: self.place(format!("{table}.{name}"), value),
            known: CLUTCH_PARAMETERS.map(|parameter| parameter.name).join(", "),
        })
    }
}

/// The unit of a parameter.
pub(super) fn unit_of(name: &str) -> &'static str {
    CLUTCH_PARAMETERS.iter().find(|parameter| parameter.name == name).map_or("", |parameter| parameter.unit)
}

/// All constants, with the nominal values that the study left alone.
pub(super) fn identify(text: &mut String, constants: &[(String, f64)], inputs: &InputSpace) {
    for parameter in CLUTCH_PARAMETERS {
        if inputs.names().all(|input| input != parameter.name) {
            let given = constants.iter().find(|(name, _)| name == parameter.name).map(|(_, value)| *value);
            let _ = writeln!(text, "constant {} {:?}", parameter.name, given.unwrap_or(parameter.nominal));
        }
    }
}
