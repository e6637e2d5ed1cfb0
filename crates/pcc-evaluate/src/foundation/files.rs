//! Files that appear whole or not at all.

#[cfg(unix)]
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;
use thiserror::Error;

/// A file that could not be written.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{path} cannot be written: {message}")]
pub struct FileError {
    /// Where.
    pub path: String,
    /// What kind of failure it is.
    pub kind: io::ErrorKind,
    /// Why, in words.
    pub message: String,
}

/// Writes `path` through a temporary file beside it: synced, renamed over the old file, folder synced. A reader sees
/// the old content or the new, never a part.
///
/// # Errors
///
/// [`FileError`]; an existing file is then unchanged.
pub fn save(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    save_with(path, |file| file.write_all(bytes))
}

/// The same for content that is produced piece by piece.
///
/// # Errors
///
/// [`FileError`], also for an error that `write` returns; an existing file is then unchanged.
pub fn save_with(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), FileError> {
    target(path).and_then(|target| replace(&target, write)).map_err(|error| failed(path, &error))
}

/// Whether [`save`] could write `path` now: asked before long work whose result would have no place.
///
/// # Errors
///
/// [`FileError`].
pub fn check_writable(path: &Path) -> Result<(), FileError> {
    target(path).and_then(|target| temporary(&target)).map(drop).map_err(|error| failed(path, &error))
}

fn failed(path: &Path, error: &io::Error) -> FileError {
    FileError { path: path.display().to_string(), kind: error.kind(), message: error.to_string() }
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Where the content goes: the file itself, or what a symbolic link points to.
fn target(path: &Path) -> io::Result<PathBuf> {
    let Ok(metadata) = std::fs::metadata(path) else {
        if path.is_symlink() {
            return Err(io::Error::new(
                io::ErrorKind::NotFound,
                "it is a link to a file that does not exist; name the file",
            ));
        }
        return Ok(path.to_owned());
    };
    if metadata.is_dir() {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder; name a file"));
    }
    if !metadata.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a device or a pipe; name a file"));
    }
    path.canonicalize()
}

fn temporary(path: &Path) -> io::Result<NamedTempFile> {
    if !folder(path).is_dir() {
        return Err(io::Error::new(io::ErrorKind::NotFound, "its folder does not exist; create it first"));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".pcc-").suffix(".partial");
    #[cfg(unix)]
    {
        // What any new file gets: the user's mask takes away from this.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder(path)).map_err(|error| match error.kind() {
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            io::Error::new(error.kind(), "its folder is not writable; choose another")
        }
        _ => error,
    })
}

fn replace(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut file = temporary(path)?;
    let mut buffered = io::BufWriter::new(file.as_file_mut());
    write(&mut buffered)?;
    buffered.flush()?;
    drop(buffered);
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| error.error)?;
    #[cfg(unix)]
    File::open(folder(path))?.sync_all()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        save(&path, b"old").unwrap();
        let result = save_with(&path, |file| {
            file.write_all(b"half")?;
            Err(io::Error::other("stopped"))
        });
        assert!(result.is_err_and(|error| error.kind == io::ErrorKind::Other));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        save(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_devices_are_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        std::fs::write(&file, b"old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        save(&link, b"new").unwrap();
        assert!(link.is_symlink());
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
        let dangling = folder.path().join("dangling");
        std::os::unix::fs::symlink(folder.path().join("missing"), &dangling).unwrap();
        assert!(save(&dangling, b"new").is_err() && dangling.is_symlink());
        assert!(check_writable(Path::new("/dev/null")).is_err());
        assert!(save(Path::new("/dev/null"), b"new").is_err());
    }

    #[test]
    fn folders_and_missing_folders_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert!(check_writable(folder.path()).is_err());
        assert!(check_writable(&folder.path().join("missing").join("file")).is_err());
        assert!(check_writable(&folder.path().join("file")).is_ok());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
