//! Folders of runs.
//!
//! Their names are made of hexadecimal digits and numbers only, whatever inputs are called. A number is never used
//! again while its folder exists: the program of a build that was killed may still be writing in it.

use super::error::CommandFailure;
use super::printable;
use pcc_evaluate::foundation::sha256;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::Duration;
use std::{io, thread};

/// Hexadecimal digits of a name that tell points from each other. Should two share them, they get different numbers.
const DIGITS: usize = 16;

/// How often the folder of all runs may vanish before one is made in it.
const VANISHINGS: usize = 10;

/// Attempts to remove a folder, and the time between them: a process that was killed may be writing its last file.
const REMOVALS: usize = 3;
const BETWEEN_REMOVALS: Duration = Duration::from_millis(10);

/// Creates `<kind>-<digits>-<number>` in `work_folder`, with digits that depend on `points` and the first free number.
pub(super) fn create(work_folder: &Path, kind: &str, points: &[&[f64]]) -> Result<PathBuf, CommandFailure> {
    // Absolute, because the program runs in another folder.
    let work_folder = std::path::absolute(work_folder).map_err(|error| failure(work_folder, &error))?;
    fs::create_dir_all(&work_folder).map_err(|error| failure(&work_folder, &error))?;
    let digits = digits(points);
    let (mut number, mut vanished) = (1_u64, 0);
    loop {
        let folder = work_folder.join(format!("{kind}-{digits}-{number}"));
        match fs::create_dir(&folder) {
            Ok(()) => return Ok(folder),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
            // Another pcc has removed the folder, which was empty for a moment.
            Err(error) if error.kind() == io::ErrorKind::NotFound && vanished < VANISHINGS => {
                vanished += 1;
                fs::create_dir_all(&work_folder).map_err(|error| failure(&work_folder, &error))?;
            }
            Err(error) => return Err(failure(&folder, &error)),
        }
    }
}

/// Removes what can be removed. What cannot is no reason to lose the answer of a run.
pub(super) fn remove(folder: &Path) {
    for _ in 0..REMOVALS {
        match fs::remove_dir_all(folder) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => thread::sleep(BETWEEN_REMOVALS),
            _ => return,
        }
    }
}

/// Opens a file that the program should have written.
pub(super) fn open_results(folder: &Path, file: &'static str) -> Result<File, CommandFailure> {
    let path = folder.join(file);
    open_regular(&path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => CommandFailure::NoResults { file },
        _ => failure(&path, &error),
    })
}

/// Opens a file, but no pipe or device, which might not end.
pub(super) fn open_regular(path: &Path) -> io::Result<File> {
    if fs::metadata(path)?.is_file() {
        File::open(path)
    } else {
        Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a file"))
    }
}

/// Trouble with a folder or a file.
pub(super) fn failure(path: &Path, error: &io::Error) -> CommandFailure {
    CommandFailure::Folder { path: printable::path(path), cause: error.to_string() }
}

fn digits(points: &[&[f64]]) -> String {
    let values = points.iter().flat_map(|point| point.iter());
    let bytes: Vec<u8> = values.flat_map(|value| value.to_bits().to_le_bytes()).collect();
    sha256(&bytes).chars().take(DIGITS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_depend_on_the_bits_of_the_values() {
        assert_eq!(digits(&[&[1.0, 2.0]]), digits(&[&[1.0], &[2.0]]));
        assert_ne!(digits(&[&[0.0]]), digits(&[&[-0.0]]));
        assert_eq!(digits(&[]).len(), DIGITS);
    }

    #[test]
    fn a_file_where_the_folder_should_be_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("work");
        fs::write(&path, "").unwrap();
        assert!(matches!(create(&path, "run", &[]), Err(CommandFailure::Folder { .. })));
    }
}
