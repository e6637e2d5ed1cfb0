//! Parts of an evaluation, kept in files until all are there.
//!
//! A part says what was found in a range of chunks of a question's samples, and holds the question and the surrogate
//! with it: parts can be computed anywhere, in any order, and [`merge`] needs nothing but the parts. Parts of the same
//! question are merged to the same bytes, whatever the samples were divided into.
//!
//! # File format 2
//!
//! Two lines of JSON. The first is `{"pcc_part": 2, "length": …, "sha256": …}` with length in bytes and SHA-256 of the
//! second, which holds the version of pcc, the surrogate as in a JSON surrogate file, the question and the findings.

use crate::artifact::{self, Format, ReadError, WriteError};
use crate::evaluation::{Findings, Question, Survey, SurveyError};
use crate::foundation::{InstructionSet, sha256};
use crate::surrogate::Surrogate;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{self, Read};
use std::ops::Range;
use std::path::Path;
use thiserror::Error;

/// Version of the file format.
const VERSION: u64 = 2;

/// Version of this program.
const PROGRAM: &str = env!("CARGO_PKG_VERSION");

/// What every part file starts with.
pub const MARK: &str = "{\"pcc_part\":";

/// Bytes of a part file that are read at most: the most points of sweeps take a quarter of that.
const LARGEST: u64 = 1 << 29;

/// Bytes that the first line has at most.
const LONGEST_HEADER: usize = 256;

/// A range of an evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// What was evaluated.
    pub surrogate: Surrogate,
    /// What was asked.
    pub question: Question,
    /// What was found.
    pub findings: Findings,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    pcc_part: u64,
    length: u64,
    sha256: String,
}

/// The second line, as it is written.
#[derive(Debug, Serialize)]
struct Content<'a> {
    program: &'a str,
    surrogate: &'a str,
    question: &'a Question,
    findings: &'a Findings,
}

/// The same, as it is read.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Body {
    /// Version of the program: another may draw or sum otherwise.
    program: String,
    surrogate: String,
    question: Question,
    findings: Findings,
}

/// Why a part cannot be read or written, or parts not be merged.
#[derive(Debug, Error)]
pub enum PartError {
    /// The file cannot be read.
    #[error("cannot be read: {message}")]
    Unreadable {
        /// What kind of failure it is.
        kind: io::ErrorKind,
        /// Why, in words.
        message: String,
    },
    /// Something else.
    #[error("is no part of an evaluation; give files that pcc eval --part has written")]
    NotAPart,
    /// Larger than any part.
    #[error("has more than {most} bytes, which no part has")]
    TooLarge {
        /// The limit.
        most: u64,
    },
    /// Written by another version.
    #[error("has part format {found}, and this pcc reads format {VERSION}; evaluate and merge with the same version")]
    Version {
        /// Its version.
        found: u64,
    },
    /// Evaluated by another version of the program.
    #[error("was evaluated by pcc {found}, and this is pcc {PROGRAM}; evaluate and merge with the same version")]
    Program {
        /// Its version.
        found: String,
    },
    /// Shorter or longer than it says.
    #[error(
        "has {found} bytes after its first line instead of {expected}: it was cut off or changed; evaluate the shard again"
    )]
    Length {
        /// Bytes there are.
        found: u64,
        /// Bytes there should be.
        expected: u64,
    },
    /// Changed.
    #[error("does not match its checksum: it was changed; evaluate the shard again")]
    Checksum,
    /// The checksum is right, the content is not.
    #[error("holds something else than an evaluation: {0}; evaluate and merge with the same version of pcc")]
    Content(String),
    /// The surrogate inside.
    #[error("holds a surrogate that cannot be read")]
    Surrogate(#[from] ReadError),
    /// The question does not fit the surrogate.
    #[error("holds a question that does not fit its surrogate")]
    Question(#[from] SurveyError),
    /// The surrogate cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Moments beyond double precision.
    #[error("some moment is not a finite number, and cannot be kept in a file")]
    NotFinite,
    /// Nothing to merge.
    #[error("there are no parts; give the files of all shards")]
    Empty,
    /// Parts of different evaluations.
    #[error("{second} is of another {what} than {first}; merge parts of one evaluation")]
    Different {
        /// What differs.
        what: &'static str,
        /// A part.
        first: String,
        /// A part that differs from it.
        second: String,
    },
    /// Samples that no part has.
    #[error(
        "samples {place} are missing, chunks {} to {} of {chunks}; give the parts of all shards",
        missing.start + 1,
        missing.end
    )]
    Gap {
        /// Between which parts.
        place: String,
        /// The missing chunks.
        missing: Range<u64>,
        /// Number of all chunks.
        chunks: u64,
    },
    /// A part that comes twice.
    #[error("{name} is given twice; give every shard once")]
    Twice {
        /// The part.
        name: String,
    },
    /// Samples that two parts have.
    #[error("{first} and {second} have samples in common; give every shard once")]
    Overlap {
        /// A part.
        first: String,
        /// The other.
        second: String,
    },
}

impl Part {
    /// The content of the part's file.
    ///
    /// # Errors
    ///
    /// [`PartError::NotFinite`], [`PartError::Write`].
    pub fn to_bytes(&self) -> Result<Vec<u8>, PartError> {
        let surrogate = String::from_utf8_lossy(&artifact::encode(&self.surrogate, Format::Json)?).into_owned();
        // NaN and infinity would be written as null, which is not read as a number.
        if !self.findings.is_finite() {
            return Err(PartError::NotFinite);
        }
        let Self { question, findings, .. } = self;
        let content = Content { program: PROGRAM, surrogate: &surrogate, question, findings };
        let text = serde_json::to_string(&content).map_err(|_| PartError::NotFinite)?;
        let header = Header { pcc_part: VERSION, length: text.len() as u64, sha256: sha256(text.as_bytes()) };
        let header = serde_json::to_string(&header).map_err(|_| PartError::NotFinite)?;
        Ok(format!("{header}\n{text}").into_bytes())
    }

    /// Reads and checks a part's file.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    pub fn read(path: &Path) -> Result<Self, PartError> {
        let mut bytes = Vec::new();
        File::open(path)
            .and_then(|file| file.take(LARGEST + 1).read_to_end(&mut bytes))
            .map_err(|error| PartError::Unreadable { kind: error.kind(), message: error.to_string() })?;
        Self::from_bytes(&bytes)
    }

    /// Parses and checks the content of a part's file.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PartError> {
        if bytes.len() as u64 > LARGEST {
            return Err(PartError::TooLarge { most: LARGEST });
        }
        let body = checked_body(bytes)?;
        let Body { program, surrogate, question, findings } =
            serde_json::from_slice(body).map_err(|error| PartError::Content(error.to_string()))?;
        if program != PROGRAM {
            return Err(PartError::Program { found: program });
        }
        let part = Self { surrogate: artifact::decode(surrogate.as_bytes())?.surrogate, question, findings };
        if !part.findings.fits(part.survey()?.division()) {
            return Err(PartError::Content("counts that do not fit the question".to_owned()));
        }
        Ok(part)
    }

    /// The evaluation it is a part of.
    ///
    /// # Errors
    ///
    /// [`SurveyError`] if the question does not fit the surrogate.
    pub fn survey(&self) -> Result<Survey<'_>, SurveyError> {
        Survey::new(&self.surrogate, &self.question, InstructionSet::best())
    }

    /// Samples that were evaluated.
    ///
    /// # Errors
    ///
    /// [`SurveyError`] if the question does not fit the surrogate.
    pub fn samples(&self) -> Result<u64, SurveyError> {
        Ok(self.survey()?.division().samples_in(&self.findings.chunks()))
    }

    /// Fails if the first or the last shards are missing; between the others none is, once they are merged.
    ///
    /// # Errors
    ///
    /// [`PartError::Gap`].
    pub fn check_complete(&self) -> Result<(), PartError> {
        let (found, all) = (self.findings.chunks(), self.survey()?.division().chunks());
        let (place, missing) = match found.start {
            0 if found.end == all => return Ok(()),
            0 => ("after those of all parts", found.end..all),
            start => ("before those of all parts", 0..start),
        };
        Err(PartError::Gap { place: place.to_owned(), missing, chunks: all })
    }

    /// Whether it is all of the evaluation.
    pub fn is_complete(&self) -> bool {
        self.check_complete().is_ok()
    }
}

/// The second line, if the first speaks the truth about it.
fn checked_body(bytes: &[u8]) -> Result<&[u8], PartError> {
    if !bytes.starts_with(MARK.as_bytes()) {
        return Err(PartError::NotAPart);
    }
    let end = bytes.iter().take(LONGEST_HEADER).position(|&byte| byte == b'\n').ok_or(PartError::NotAPart)?;
    let (header, body) = (&bytes[..end], &bytes[end + 1..]);
    let version = serde_json::from_slice::<serde_json::Value>(header).map_err(|_| PartError::NotAPart)?;
    match version["pcc_part"].as_u64() {
        Some(VERSION) => {}
        Some(found) => return Err(PartError::Version { found }),
        None => return Err(PartError::NotAPart),
    }
    let header: Header = serde_json::from_slice(header).map_err(|_| PartError::NotAPart)?;
    if body.len() as u64 != header.length {
        return Err(PartError::Length { found: body.len() as u64, expected: header.length });
    }
    if sha256(body) != header.sha256 {
        return Err(PartError::Checksum);
    }
    Ok(body)
}

/// Puts parts together, given with names for messages, in any order.
///
/// # Errors
///
/// [`PartError::Empty`], [`PartError::Different`], [`PartError::Overlap`], and [`PartError::Gap`] between parts.
/// Whether the first and the last chunks are there is for [`Part::is_complete`] to say.
pub fn merge(mut parts: Vec<(String, Part)>) -> Result<Part, PartError> {
    parts.sort_by_key(|(_, part)| (part.findings.chunks().start, part.findings.chunks().end));
    let mut parts = parts.into_iter();
    let Some((first_name, mut whole)) = parts.next() else { return Err(PartError::Empty) };
    let (surrogate, question) = (whole.surrogate.clone(), whole.question.clone());
    let survey = Survey::new(&surrogate, &question, InstructionSet::best())?;
    let mut before = first_name.clone();
    for (name, part) in parts {
        if name == before {
            return Err(PartError::Twice { name });
        }
        let different = |what| PartError::Different { what, first: first_name.clone(), second: name.clone() };
        if part.surrogate != surrogate {
            return Err(different("surrogate"));
        }
        if let Some(what) = difference(&part.question, &question) {
            return Err(different(what));
        }
        let (end, next) = (whole.findings.chunks().end, part.findings.chunks());
        if next.is_empty() {
            continue; // the shard of more shards than chunks
        }
        if whole.findings.chunks().is_empty() {
            (whole, before) = (part, name);
            continue;
        }
        if next.start > end {
            let place = format!("between {before} and {name}");
            return Err(PartError::Gap { place, missing: end..next.start, chunks: survey.division().chunks() });
        }
        if next.start < end || !whole.findings.append(part.findings, survey.division()) {
            return Err(PartError::Overlap { first: before, second: name });
        }
        before = name;
    }
    Ok(whole)
}

/// What two questions differ in.
fn difference(a: &Question, b: &Question) -> Option<&'static str> {
    let parts = [
        (a.seed != b.seed, "seed"),
        (a.samples != b.samples, "number of samples"),
        (a.sampler != b.sampler || a.replicates != b.replicates, "sampler"),
        (a.conditions != b.conditions, "condition (--where)"),
        (a.sweeps != b.sweeps, "sweep"),
        (a.events != b.events, "list of events"),
        (a.histograms != b.histograms, "list of histograms"),
        (a.quantile_levels != b.quantile_levels || a.quantile_bins != b.quantile_bins, "list of quantiles"),
    ];
    parts.into_iter().find(|(differs, _)| *differs).map(|(_, what)| what)
}

#[cfg(test)]
mod tests;
