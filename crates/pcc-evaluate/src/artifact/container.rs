//! The binary container: magic, version, codec, length, sections, checksum. Little-endian, no holes, no trailing bytes.

use super::binary::{
    CERTIFICATES, COVERAGE, DESCRIPTIONS, DOMAIN, LEFT_OUT, OUTPUTS, SECTION_NAMES, VERDICT, decode_body, is_optional,
    sections,
};
use super::certificates::AnyCertificates;
use super::error::{ReadError, WriteError};
use super::v1::{Document, FormatVersion};
use super::v2::AnyOutputs;
use super::version::{Compatibility, MAJOR, compatibility};
use serde::de::DeserializeOwned;

/// As in PNG, the first byte exposes transfers that clear the eighth bit, and the line ends those that translate them.
pub(super) const MAGIC: [u8; 8] = [0x89, b'P', b'C', b'C', 0x0D, 0x0A, 0x1A, 0x0A];

/// Section bodies by bincode 2, fixed-width integers, little-endian.
const CODEC: u32 = 1;

/// Bytes before the first section.
const HEADER: usize = 24;

/// Bytes of the CRC-32 at the end.
const CHECKSUM: usize = 4;

/// What a container held.
pub(super) struct Decoded {
    pub document: Document,
    pub version: (u16, u16),
    pub unknown_sections: Vec<u16>,
}

pub(super) fn encode(document: &Document) -> Result<Vec<u8>, WriteError> {
    let mut body = Vec::new();
    for section in sections(document)? {
        section.write(&mut body);
    }
    let mut bytes = MAGIC.to_vec();
    bytes.extend(MAJOR.to_le_bytes());
    bytes.extend(document.format.minor.to_le_bytes());
    bytes.extend(CODEC.to_le_bytes());
    bytes.extend((body.len() as u64).to_le_bytes());
    bytes.append(&mut body);
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    Ok(bytes)
}

pub(super) fn decode(bytes: &[u8]) -> Result<Decoded, ReadError> {
    let mut reader = Reader { bytes };
    let too_short = ReadError::TooShort { length: bytes.len(), smallest: HEADER + CHECKSUM };
    if bytes.len() < HEADER + CHECKSUM {
        return Err(if bytes.starts_with(&MAGIC) { too_short } else { ReadError::NotASurrogate });
    }
    let fields = (reader.array(), reader.u16(), reader.u16(), reader.u32(), reader.u64());
    let (Some(magic), Some(major), Some(minor), Some(codec), Some(announced)) = fields else { return Err(too_short) };
    if magic != MAGIC {
        return Err(ReadError::NotASurrogate);
    }
    if compatibility(major, minor) == Compatibility::OtherMajor {
        return Err(ReadError::Version { major, minor });
    }
    if codec != CODEC {
        return Err(ReadError::Codec { codec });
    }
    let (found, announced) = (bytes.len() as u64, announced.saturating_add((HEADER + CHECKSUM) as u64));
    if found != announced {
        return Err(ReadError::Length { found, announced });
    }
    let (content, checksum) = bytes.split_at(bytes.len() - CHECKSUM);
    if crc32fast::hash(content).to_le_bytes() != checksum {
        return Err(ReadError::Checksum);
    }
    document(&content[HEADER..], (major, minor))
}

fn document(bytes: &[u8], version: (u16, u16)) -> Result<Decoded, ReadError> {
    let sections = Sections::new(bytes, version)?;
    let document = Document {
        format: FormatVersion { major: version.0, minor: version.1 },
        meta: sections.required(1)?,
        inputs: sections.required(2)?,
        outputs: match sections.version_of(OUTPUTS) {
            2 => AnyOutputs::V2(sections.required(OUTPUTS)?),
            _ => AnyOutputs::V1(sections.required(OUTPUTS)?),
        },
        elements: sections.required(4)?,
        expansions: sections.required(5)?,
        training: sections.required(6)?,
        decision: sections.required(7)?,
        self_test: sections.required(8)?,
        certificates: match sections.version_of(CERTIFICATES) {
            2 => sections.optional(CERTIFICATES)?.map(AnyCertificates::V2),
            _ => sections.optional(CERTIFICATES)?.map(AnyCertificates::V1),
        },
        verdict: sections.optional(VERDICT)?,
        coverage: sections.optional(COVERAGE)?,
        descriptions: sections.optional(DESCRIPTIONS)?,
        domain: sections.optional(DOMAIN)?,
        left_out: sections.optional(LEFT_OUT)?,
    };
    Ok(Decoded { document, version, unknown_sections: sections.skipped })
}

/// The latest version of a section that this code knows.
fn latest_version(kind: u16) -> u16 {
    if kind == OUTPUTS || kind == CERTIFICATES { 2 } else { 1 }
}

/// The sections of a file by kind.
struct Sections<'a> {
    /// Kinds, versions and bodies of those this code knows.
    known: Vec<(u16, u16, &'a [u8])>,
    /// Kinds of those it may skip.
    skipped: Vec<u16>,
    /// Minor version of the file.
    minor: u16,
}

impl<'a> Sections<'a> {
    fn new(bytes: &'a [u8], (major, minor): (u16, u16)) -> Result<Self, ReadError> {
        let mut reader = Reader { bytes };
        let (mut known, mut skipped, mut before) = (Vec::new(), Vec::new(), 0);
        while !reader.bytes.is_empty() {
            let damaged = |what: &str| ReadError::SectionTable(format!("{what} after section {before}"));
            let header = [reader.u16(), reader.u16(), reader.u16(), reader.u16()];
            let ([Some(kind), Some(version), Some(flags), Some(reserved)], Some(length)) = (header, reader.u64())
            else {
                return Err(damaged("a section header is cut off"));
            };
            if kind <= before {
                return Err(damaged(&format!("section {kind} is out of order")));
            }
            if reserved != 0 || flags > 1 {
                return Err(damaged(&format!("section {kind} has unknown flags")));
            }
            let body = usize::try_from(length).ok().and_then(|length| reader.take(length));
            let body = body.ok_or_else(|| damaged(&format!("section {kind} is cut off")))?;
            let is_known = usize::from(kind) <= SECTION_NAMES.len() && (1..=latest_version(kind)).contains(&version);
            if is_known && (flags == 1) == is_optional(kind) {
                return Err(damaged(&format!("section {kind} has the wrong flags")));
            }
            if is_known {
                known.push((kind, version, body));
            } else if flags & 1 == 1 {
                return Err(ReadError::UnknownSection { kind, version, major, minor });
            } else {
                skipped.push(kind);
            }
            before = kind;
        }
        Ok(Self { known, skipped, minor })
    }

    /// The version in which a section is there; 1 if it is not.
    fn version_of(&self, kind: u16) -> u16 {
        self.known.iter().find(|(known, ..)| *known == kind).map_or(1, |&(_, version, _)| version)
    }

    fn optional<T: DeserializeOwned>(&self, kind: u16) -> Result<Option<T>, ReadError> {
        let found = self.known.iter().find(|(known, ..)| *known == kind);
        found.map(|(.., body)| decode_body(kind, body, self.minor)).transpose()
    }

    fn required<T: DeserializeOwned>(&self, kind: u16) -> Result<T, ReadError> {
        let section = SECTION_NAMES[usize::from(kind) - 1];
        self.optional(kind)?.ok_or(ReadError::MissingSection { section })
    }
}

/// Takes little-endian fields from the front of a slice; `None` if there are too few bytes.
struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let (front, rest) = self.bytes.split_at_checked(length)?;
        self.bytes = rest;
        Some(front)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }
}
