//! What can be wrong with a surrogate file, in the order in which it is found.

use super::version::{MAJOR, MINOR};
use crate::foundation::FileError;
use std::io;
use thiserror::Error;

/// Why a file is not a usable surrogate.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ReadError {
    /// The operating system refused.
    #[error("cannot be read: {message}")]
    Io {
        /// What kind of failure it is.
        kind: io::ErrorKind,
        /// Why, in words.
        message: String,
    },
    /// Shorter than the smallest surrogate.
    #[error("is not a surrogate: it has {length} bytes, fewer than the {smallest} of an empty one; build it again")]
    TooShort {
        /// Bytes found.
        length: usize,
        /// Bytes of header and checksum.
        smallest: usize,
    },
    /// The first bytes are those of something else.
    #[error(
        "is not a surrogate: it starts neither like a binary surrogate nor like JSON; give a file that pcc build wrote"
    )]
    NotASurrogate,
    /// Larger than any sensible surrogate.
    #[error("has {length} bytes; surrogates have at most {limit}")]
    TooLarge {
        /// Bytes found.
        length: u64,
        /// Most bytes read.
        limit: u64,
    },
    /// A major version this code does not read.
    #[error("has format {major}.{minor}, but this pcc reads format {MAJOR}; use a pcc that reads format {major}")]
    Version {
        /// Major version found.
        major: u16,
        /// Minor version found.
        minor: u16,
    },
    /// An encoding of section bodies this code does not read.
    #[error("encodes its sections with codec {codec}, but this pcc reads codec 1 only; update pcc")]
    Codec {
        /// Codec found.
        codec: u32,
    },
    /// The header announces another length.
    #[error(
        "has {found} bytes, but its header announces {announced}; it was cut off or damaged: copy or build it again"
    )]
    Length {
        /// Bytes found.
        found: u64,
        /// Bytes announced.
        announced: u64,
    },
    /// The checksum does not match.
    #[error("is damaged: its checksum does not match its content; copy or build it again")]
    Checksum,
    /// The sections are not in order, overlap or leave holes.
    #[error("is damaged: {0}")]
    SectionTable(String),
    /// A section that must be understood is unknown.
    #[error(
        "needs section {kind} version {version}, which this pcc (format {MAJOR}.{MINOR}) does not know; use a pcc that \
         reads format {major}.{minor}"
    )]
    UnknownSection {
        /// Kind of the section.
        kind: u16,
        /// Version of the section.
        version: u16,
        /// Major version of the file.
        major: u16,
        /// Minor version of the file.
        minor: u16,
    },
    /// A section is missing.
    #[error("has no section \"{section}\"")]
    MissingSection {
        /// Name of the section.
        section: &'static str,
    },
    /// A section does not decode.
    #[error("section \"{section}\" cannot be decoded: {message}{}", newer(*.minor))]
    Decode {
        /// Name of the section.
        section: &'static str,
        /// What the decoder said.
        message: String,
        /// Minor version of the file.
        minor: u16,
    },
    /// A section has bytes that nothing describes.
    #[error("section \"{section}\" has {bytes} bytes too many")]
    TrailingBytes {
        /// Name of the section.
        section: &'static str,
        /// Number of bytes.
        bytes: usize,
    },
    /// JSON that is not a surrogate.
    #[error("is not a surrogate in JSON: {message}{}; give a file that pcc build wrote", newer(*.minor))]
    Json {
        /// What the parser said, with line and column.
        message: String,
        /// Minor version of the file.
        minor: u16,
    },
    /// The content could not be encoded again to check its hash.
    #[error(transparent)]
    Encode(#[from] WriteError),
    /// The content does not have the hash the file gives.
    #[error("was changed after it was written: its content does not match its content_id; build it again")]
    ContentId,
    /// Numbers that contradict each other or make no sense.
    #[error("section \"{section}\" makes no sense: {message}")]
    Meaning {
        /// Name of the section.
        section: &'static str,
        /// What is wrong.
        message: String,
    },
    /// A kind that a later version may support.
    #[error("uses {what}, which this pcc (format {MAJOR}.{MINOR}) cannot evaluate; update pcc")]
    Unsupported {
        /// What it uses.
        what: String,
    },
}

/// A hint for files of a later minor version.
fn newer(minor: u16) -> String {
    if minor > MINOR {
        format!(" (the file has format {MAJOR}.{minor}, this pcc reads up to {MAJOR}.{MINOR}; update pcc)")
    } else {
        String::new()
    }
}

/// Why a surrogate was not written.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum WriteError {
    /// A number is NaN or infinite, which neither form may hold.
    #[error("section \"{section}\" holds a number that is not finite; the surrogate is not written")]
    NotFinite {
        /// Name of the section.
        section: &'static str,
    },
    /// A section could not be encoded.
    #[error("section \"{section}\" cannot be encoded: {message}")]
    Encode {
        /// Name of the section.
        section: &'static str,
        /// What the encoder said.
        message: String,
    },
}

/// Why this version does not write a surrogate that it has read.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum LossError {
    /// It has a section that this version does not know.
    #[error("has a section of kind {kind} that this pcc does not know and would lose; use the pcc that wrote it")]
    Section {
        /// Kind of the section.
        kind: u16,
    },
    /// Its format is newer.
    #[error("has format {major}.{minor}, which this pcc would write as an older one; use the pcc that wrote it")]
    NewerMinor {
        /// Major version.
        major: u16,
        /// Minor version.
        minor: u16,
    },
    /// Another program has arranged it otherwise.
    #[error(
        "is arranged in another way than pcc writes it, so writing it again would change its content_id; use the program that \
         wrote it"
    )]
    Arrangement,
}

/// Why a surrogate was not saved.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SaveError {
    /// It could not be encoded.
    #[error(transparent)]
    Encode(#[from] WriteError),
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
}
