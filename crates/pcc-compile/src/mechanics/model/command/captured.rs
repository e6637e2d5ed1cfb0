//! What a program wrote to its standard streams.
//!
//! They are files in the folder of the run, not pipes: a pipe that nobody empties stops the program, and one that a
//! grandchild keeps open never ends.

use super::error::CommandFailure;
use super::{folder, printable};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

const STANDARD_OUTPUT: &str = "stdout.txt";
const STANDARD_ERROR: &str = "stderr.txt";

/// What an error shows at most: enough for the end of a traceback.
const LINES: usize = 20;
const CHARACTERS: usize = printable::MESSAGE_LENGTH;

/// Bytes read from the end of a file: more than the characters that are shown can have.
const LAST_BYTES: u64 = 16 << 10;

/// Creates the files for standard output and standard error.
pub(super) fn create(folder: &Path) -> Result<(File, File), CommandFailure> {
    let create = |name| {
        let path = folder.join(name);
        File::create_new(&path).map_err(|error| folder::failure(&path, &error))
    };
    Ok((create(STANDARD_OUTPUT)?, create(STANDARD_ERROR)?))
}

/// The end of the program's standard error, or of its standard output if that is empty.
pub(super) fn end(folder: &Path) -> String {
    let streams = [STANDARD_ERROR, STANDARD_OUTPUT];
    let ends = streams.iter().filter_map(|name| last_bytes(&folder.join(name)).ok());
    let texts = ends.map(|bytes| printable::last_lines(&String::from_utf8_lossy(&bytes), LINES, CHARACTERS));
    texts.into_iter().find(|text| !text.is_empty()).unwrap_or_default()
}

fn last_bytes(path: &Path) -> io::Result<Vec<u8>> {
    let mut file = folder::open_regular(path)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(LAST_BYTES)))?;
    let mut bytes = Vec::new();
    // The limit: something may still be writing.
    file.take(LAST_BYTES).read_to_end(&mut bytes)?;
    Ok(bytes)
}
