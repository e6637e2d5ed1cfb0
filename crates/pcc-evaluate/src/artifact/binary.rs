//! Bodies of binary sections: bincode 2, little-endian, fixed-width integers. The only file that uses bincode.

use super::certificates::AnyCertificates;
use super::error::{ReadError, WriteError};
use super::v1::Document;
use super::v2::AnyOutputs;
use crate::foundation::sha256;
use bincode::config::{Configuration, Fixint, Limit, LittleEndian, standard};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Most bytes that decoding one section may claim, so that a forged length cannot exhaust memory.
const DECODE_LIMIT: usize = super::LARGEST_FILE as usize;

fn configuration() -> Configuration<LittleEndian, Fixint, Limit<DECODE_LIMIT>> {
    standard().with_little_endian().with_fixed_int_encoding().with_limit::<DECODE_LIMIT>()
}

/// A section: kind, version, whether readers must understand it, and its body.
pub(super) struct Section {
    pub kind: u16,
    pub version: u16,
    pub required: bool,
    pub body: Vec<u8>,
}

impl Section {
    /// Appends header and body: kind u16, version u16, flags u16, reserved u16, length u64, body.
    pub fn write(&self, bytes: &mut Vec<u8>) {
        for field in [self.kind, self.version, u16::from(self.required), 0] {
            bytes.extend(field.to_le_bytes());
        }
        bytes.extend((self.body.len() as u64).to_le_bytes());
        bytes.extend(&self.body);
    }
}

/// Names of the sections of kind 1, 2, ….
pub(super) const SECTION_NAMES: [&str; 14] = [
    "meta",
    "inputs",
    "outputs",
    "elements",
    "expansions",
    "training",
    "decision",
    "self_test",
    "certificates",
    "verdict",
    "coverage",
    "descriptions",
    "domain",
    "left_out",
];

/// Kind of the section of outputs, which has two versions.
pub(super) const OUTPUTS: u16 = 3;

/// Kind of the optional section of certificates, which has two versions.
pub(super) const CERTIFICATES: u16 = 9;

/// Kind of the section of the verdict, which readers must understand where it is there.
pub(super) const VERDICT: u16 = 10;

/// Kind of the optional section of runs that failed.
pub(super) const COVERAGE: u16 = 11;

/// Kind of the optional section of units and labels, which change no number.
pub(super) const DESCRIPTIONS: u16 = 12;

/// Kind of the optional section of the box that the model runs spanned.
pub(super) const DOMAIN: u16 = 13;

/// Kind of the optional section of residuals at runs left out.
pub(super) const LEFT_OUT: u16 = 14;

/// Whether readers need not understand a section.
pub(super) fn is_optional(kind: u16) -> bool {
    [CERTIFICATES, COVERAGE, DESCRIPTIONS, DOMAIN, LEFT_OUT].contains(&kind)
}

/// Sections 2 to 8 and 10, those that determine what a surrogate computes.
fn content_sections(document: &Document) -> Result<Vec<Section>, WriteError> {
    let mut sections = vec![
        section(2, &document.inputs)?,
        match &document.outputs {
            AnyOutputs::V1(outputs) => section(OUTPUTS, outputs)?,
            AnyOutputs::V2(outputs) => Section { version: 2, ..section(OUTPUTS, outputs)? },
        },
        section(4, &document.elements)?,
        section(5, &document.expansions)?,
        section(6, &document.training)?,
        section(7, &document.decision)?,
        section(8, &document.self_test)?,
    ];
    if let Some(verdict) = &document.verdict {
        sections.push(section(VERDICT, verdict)?);
    }
    Ok(sections)
}

/// All sections in order.
pub(super) fn sections(document: &Document) -> Result<Vec<Section>, WriteError> {
    let mut sections = vec![section(1, &document.meta)?];
    sections.append(&mut content_sections(document)?);
    if let Some(certificates) = &document.certificates {
        sections.push(match certificates {
            AnyCertificates::V1(certificates) => section(CERTIFICATES, certificates)?,
            AnyCertificates::V2(certificates) => Section { version: 2, ..section(CERTIFICATES, certificates)? },
        });
    }
    if let Some(coverage) = &document.coverage {
        sections.push(section(COVERAGE, coverage)?);
    }
    if let Some(descriptions) = &document.descriptions {
        sections.push(section(DESCRIPTIONS, descriptions)?);
    }
    if let Some(domain) = &document.domain {
        sections.push(section(DOMAIN, domain)?);
    }
    if let Some(left_out) = &document.left_out {
        sections.push(section(LEFT_OUT, left_out)?);
    }
    sections.sort_by_key(|section| section.kind);
    Ok(sections)
}

/// Hexadecimal SHA-256 of sections 2 to 8, and 10 if there is one.
pub(super) fn content_id(document: &Document) -> Result<String, WriteError> {
    let mut bytes = Vec::new();
    for section in content_sections(document)? {
        section.write(&mut bytes);
    }
    Ok(sha256(&bytes))
}

fn section<T: Serialize>(kind: u16, content: &T) -> Result<Section, WriteError> {
    let body = bincode::serde::encode_to_vec(content, configuration()).map_err(|error| WriteError::Encode {
        section: SECTION_NAMES[usize::from(kind) - 1],
        message: error.to_string(),
    })?;
    Ok(Section { kind, version: 1, required: !is_optional(kind), body })
}

/// Decodes the body of section `kind`; every byte must be used.
pub(super) fn decode_body<T: DeserializeOwned>(kind: u16, body: &[u8], minor: u16) -> Result<T, ReadError> {
    let section = SECTION_NAMES[usize::from(kind) - 1];
    let (content, used) = bincode::serde::decode_from_slice(body, configuration())
        .map_err(|error| ReadError::Decode { section, message: error.to_string(), minor })?;
    if used < body.len() {
        return Err(ReadError::TrailingBytes { section, bytes: body.len() - used });
    }
    Ok(content)
}
