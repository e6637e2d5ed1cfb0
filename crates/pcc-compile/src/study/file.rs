//! Studies in files.

use super::{DataOptions, Study, StudyError};
use pcc_evaluate::artifact::looks_like_a_surrogate;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use thiserror::Error;

/// Bytes of a study file that are read at most.
const LARGEST_STUDY: u64 = 1 << 24;

/// Why a file is no study.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum StudyFileError {
    /// The operating system refused.
    #[error("{path} cannot be read: {message}")]
    Unreadable {
        /// The file.
        path: String,
        /// What kind of failure it is.
        kind: io::ErrorKind,
        /// Why, in words.
        message: String,
    },
    /// A surrogate was named in place of its study.
    #[error("{path}: is a surrogate; give the study, a .toml file")]
    Surrogate {
        /// The file.
        path: String,
    },
    /// It is too large.
    #[error("{path}: is larger than {LARGEST_STUDY} bytes, which no study is")]
    TooLarge {
        /// The file.
        path: String,
    },
    /// It is not UTF-8.
    #[error("{path}: is not text; give a study, a .toml file")]
    NotText {
        /// The file.
        path: String,
    },
    /// Something in it is wrong.
    #[error("{path}: {cause}")]
    Study {
        /// The file.
        path: String,
        /// What.
        #[source]
        cause: StudyError,
    },
}

impl Study {
    /// Reads a study file. Files that it names are looked for in its folder.
    ///
    /// # Errors
    ///
    /// [`StudyFileError`] names the file, and as far as it is a study, key and line.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, StudyFileError> {
        Self::read_with(path, &DataOptions::default())
    }

    /// The same with given runs that a command line names.
    ///
    /// # Errors
    ///
    /// As [`Study::read`].
    pub fn read_with(path: impl AsRef<Path>, options: &DataOptions) -> Result<Self, StudyFileError> {
        let file = path.as_ref();
        let path = file.display().to_string();
        let mut bytes = Vec::new();
        let read = File::open(file).and_then(|file| file.take(LARGEST_STUDY + 1).read_to_end(&mut bytes));
        if let Err(error) = read {
            return Err(StudyFileError::Unreadable { path, kind: error.kind(), message: error.to_string() });
        }
        if looks_like_a_surrogate(&bytes) {
            return Err(StudyFileError::Surrogate { path });
        }
        if bytes.len() as u64 > LARGEST_STUDY {
            return Err(StudyFileError::TooLarge { path });
        }
        let Ok(text) = String::from_utf8(bytes) else { return Err(StudyFileError::NotText { path }) };
        let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Self::from_toml_with(&text, folder, options).map_err(|cause| StudyFileError::Study { path, cause })
    }
}
