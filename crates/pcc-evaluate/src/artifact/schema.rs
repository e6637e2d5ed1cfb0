//! The JSON schema of format 1, generated from the sections themselves.

use super::v1::Document;

/// The schema as text, the content of `schemas/surrogate.v1.schema.json`.
///
/// # Examples
///
/// ```
/// assert_eq!(pcc_evaluate::artifact::schema(), include_str!("../../../../schemas/surrogate.v1.schema.json"));
/// ```
pub fn schema() -> String {
    format!("{:#}\n", schemars::schema_for!(Document).to_value())
}
