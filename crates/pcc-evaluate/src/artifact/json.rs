//! The JSON form: the same sections, by name.

use super::binary::SECTION_NAMES;
use super::error::{ReadError, WriteError};
use super::v1::{Document, FormatVersion};
use super::version::{Compatibility, compatibility};
use serde::Deserialize;

pub(super) fn encode(document: &Document) -> Result<Vec<u8>, WriteError> {
    let mut bytes = serde_json::to_vec(document)
        .map_err(|error| WriteError::Encode { section: SECTION_NAMES[0], message: error.to_string() })?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// The version decides how the rest is read, so it is read first.
#[derive(Deserialize)]
struct Versioned {
    format: FormatVersion,
}

pub(super) fn decode(bytes: &[u8]) -> Result<(Document, (u16, u16)), ReadError> {
    let wrong = |minor| move |error: serde_json::Error| ReadError::Json { message: error.to_string(), minor };
    let Versioned { format: FormatVersion { major, minor } } = serde_json::from_slice(bytes).map_err(wrong(0))?;
    if compatibility(major, minor) == Compatibility::OtherMajor {
        return Err(ReadError::Version { major, minor });
    }
    let document = serde_json::from_slice(bytes).map_err(wrong(minor))?;
    Ok((document, (major, minor)))
}
