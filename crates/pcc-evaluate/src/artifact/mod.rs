//! Surrogate files: format 1, binary and JSON.
//!
//! Both carry the same sections, defined in [`v1`]; the binary form frames them with lengths and a checksum
//! (`container.rs`), JSON names them. Reading goes through the same steps in the same order, one error each, and ends
//! with a surrogate in which everything holds. Equal surrogates give equal bytes.

mod binary;
pub mod certificates;
mod certified;
mod container;
mod descriptions;
mod domain;
mod error;
mod from_v1;
mod inputs;
mod json;
mod left_out;
mod meaning;
#[cfg(feature = "schema")]
mod schema;
#[cfg(test)]
mod tests;
mod to_v1;
pub mod v1;
pub mod v2;
pub mod version;

pub use error::{LossError, ReadError, SaveError, WriteError};

#[cfg(feature = "schema")]
pub use schema::schema;

use crate::foundation::save;
use crate::surrogate::Surrogate;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use version::{Compatibility, compatibility};

/// Files above this size are refused before they are decoded: the largest sensible surrogates have some megabytes.
const LARGEST_FILE: u64 = 1 << 28;

/// The two forms of a surrogate file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Compact and checksummed, `.pcc`.
    Binary,
    /// Readable, `.json`.
    Json,
}

impl Format {
    /// The form that a file name asks for: JSON if it ends in `.json`, else binary.
    pub fn of_path(path: &Path) -> Self {
        let is_json = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
        if is_json { Self::Json } else { Self::Binary }
    }

    /// File name extension.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Binary => "pcc",
            Self::Json => "json",
        }
    }
}

/// A surrogate as read, with what a reader should know of its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Artifact {
    /// The surrogate.
    pub surrogate: Surrogate,
    /// Form of the file.
    pub format: Format,
    /// Version of the file, (major, minor).
    pub version: (u16, u16),
    /// Hash over the sections that determine what the surrogate computes. Hexadecimal SHA-256.
    pub content_id: String,
    /// Whether writing the surrogate again gives the same content; another writer may have arranged it differently.
    pub is_canonical: bool,
    /// Kinds of optional sections this version does not know; they were skipped.
    pub unknown_sections: Vec<u16>,
}

impl Artifact {
    /// Whether this version can write the surrogate again without changing more than it should.
    ///
    /// # Errors
    ///
    /// [`LossError`] names what would be lost.
    pub fn check_lossless(&self) -> Result<(), LossError> {
        if let [kind, ..] = self.unknown_sections[..] {
            return Err(LossError::Section { kind });
        }
        let (major, minor) = self.version;
        if compatibility(major, minor) == Compatibility::NewerMinor {
            return Err(LossError::NewerMinor { major, minor });
        }
        if self.is_canonical { Ok(()) } else { Err(LossError::Arrangement) }
    }
}

/// Encodes a surrogate.
///
/// # Errors
///
/// [`WriteError`] if it holds a number that is not finite.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::artifact::{decode, encode, Format};
/// let surrogate = decode(include_bytes!("../../../../surrogates/clutch-r1-eigenvalues.pcc"))?.surrogate;
/// let binary = encode(&surrogate, Format::Binary)?;
/// let json = encode(&decode(&binary)?.surrogate, Format::Json)?;
/// assert_eq!(encode(&decode(&json)?.surrogate, Format::Binary)?, binary);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn encode(surrogate: &Surrogate, format: Format) -> Result<Vec<u8>, WriteError> {
    let document = to_v1::document(surrogate)?;
    match format {
        Format::Binary => container::encode(&document),
        Format::Json => json::encode(&document),
    }
}

/// Decodes a surrogate of either form, recognised by its first bytes.
///
/// # Errors
///
/// [`ReadError`], one variant per thing that can be wrong.
pub fn decode(bytes: &[u8]) -> Result<Artifact, ReadError> {
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(ReadError::TooLarge { length: bytes.len() as u64, limit: LARGEST_FILE });
    }
    let (document, format, version, unknown_sections) = if starts_like_json(bytes) {
        let (document, version) = json::decode(bytes)?;
        (document, Format::Json, version, Vec::new())
    } else {
        let decoded = container::decode(bytes)?;
        (decoded.document, Format::Binary, decoded.version, decoded.unknown_sections)
    };
    let content_id = document.meta.content_id.clone();
    if binary::content_id(&document)? != content_id {
        return Err(ReadError::ContentId);
    }
    let surrogate = from_v1::surrogate(document)?;
    let is_canonical = to_v1::document(&surrogate)?.meta.content_id == content_id;
    Ok(Artifact { surrogate, format, version, content_id, is_canonical, unknown_sections })
}

fn starts_like_json(bytes: &[u8]) -> bool {
    bytes.iter().find(|byte| !byte.is_ascii_whitespace()) == Some(&b'{')
}

/// Whether a file that starts with `bytes` looks like a surrogate of either form: the magic, or JSON whose first key is
/// `format` with a version.
pub fn looks_like_a_surrogate(bytes: &[u8]) -> bool {
    const JSON_START: &[u8] = b"{\"format\":{";
    let start = bytes.iter().copied().filter(|byte| !byte.is_ascii_whitespace());
    bytes.starts_with(&container::MAGIC) || start.take(JSON_START.len()).eq(JSON_START.iter().copied())
}

/// Reads a surrogate file.
///
/// # Errors
///
/// [`ReadError::Io`] if the file cannot be read, else as [`decode`].
pub fn read(path: &Path) -> Result<Artifact, ReadError> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(LARGEST_FILE + 1).read_to_end(&mut bytes))
        .map_err(|error| ReadError::Io { kind: error.kind(), message: error.to_string() })?;
    decode(&bytes)
}

impl Surrogate {
    /// Reads a surrogate file of either form.
    ///
    /// # Errors
    ///
    /// As [`read`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        read(path.as_ref()).map(|artifact| artifact.surrogate)
    }

    /// Writes a surrogate file, whole or not at all: JSON if its name ends in `.json`, else binary.
    ///
    /// # Errors
    ///
    /// [`SaveError`]; an existing file is then unchanged.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), SaveError> {
        let path = path.as_ref();
        Ok(save(path, &encode(self, Format::of_path(path))?)?)
    }
}
