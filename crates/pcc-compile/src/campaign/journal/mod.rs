//! The journal of model runs: what an expensive model has answered is never lost and never asked for again.
//!
//! A journal is a file that only grows. It begins with a magic number and a version, then one [`Record`] follows the
//! other, each with its length and checksum. A record is on the disk (`fdatasync`) before its run counts, so a build
//! that dies, whatever kills it, leaves all runs that counted and at most one torn record behind, which is cut off when
//! the journal is opened again. Should bytes in the middle have been damaged later, the sound records after them are
//! found and kept.
//!
//! Records name the model by a hash and the point by the bits of its inputs: a study that changes its distributions or
//! its fit, not its model, finds the runs that it has in common with the former one.
//!
//! An advisory lock on the file keeps two builds from one journal. It belongs to the open file, so it ends with the
//! process that holds it and cannot become stale.

mod record;

use record::LARGEST_BODY;
pub use record::{HASH_BYTES, Record, RunOutcome};

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use thiserror::Error;

/// The first bytes of a journal. The high bit, line ends and the end-of-file character reveal transfers as text.
pub const MAGIC: [u8; 8] = *b"\x89PCJ\r\n\x1a\n";

/// Version 2: records as described in `record`. Version 1 had other derivatives; what it recorded is read, and a
/// journal that is opened for more becomes one of version 2.
const VERSION: u32 = 2;

const HEADER_BYTES: usize = MAGIC.len() + 4;

/// Why a journal cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum JournalError {
    /// The file system refused.
    #[error("{path}: {cause}")]
    Io {
        /// The journal.
        path: String,
        /// What kind of failure it is.
        kind: io::ErrorKind,
        /// What the system said.
        cause: String,
    },
    /// Another process has it open.
    #[error("{path}: is in use by another pcc; wait until it ends, stop it, or give another --journal")]
    Locked {
        /// The journal.
        path: String,
    },
    /// The file is something else.
    #[error("{path}: exists and is no journal of model runs; give another --journal, or remove it first")]
    NotAJournal {
        /// The file.
        path: String,
    },
    /// A record would be too long to be read again.
    #[error(
        "{path}: a run of this model would take more than {most} bytes; carry fewer modes in spectrum.modes, or record nothing (--no-journal)"
    )]
    TooLarge {
        /// The journal.
        path: String,
        /// Bytes of the longest record.
        most: usize,
    },
    /// It comes from a later pcc.
    #[error("{path}: is a journal of version {found}, but this pcc knows version {VERSION}; update pcc")]
    Version {
        /// The journal.
        path: String,
        /// Its version.
        found: u32,
    },
}

/// What was found in a journal.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Contents {
    /// The sound records, in the order they were written.
    pub records: Vec<Record>,
    /// Bytes at the end that are no whole record: a run that did not count.
    pub torn_bytes: u64,
    /// Bytes between sound records that are none: damage.
    pub damaged_bytes: u64,
}

/// A journal that is open for further records; no other process can open it so.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: Mutex<Tail>,
}

/// The file, and where its last sound record ends.
#[derive(Debug)]
struct Tail {
    file: File,
    end: u64,
    /// Whether nobody will want it: it was begun by this process and has no records yet, or was discarded.
    is_worthless: bool,
}

impl Journal {
    /// Opens the journal at `path`, or begins one, and cuts off a torn record at its end.
    ///
    /// # Errors
    ///
    /// [`JournalError`]; the file is then as it was.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_compile::campaign::journal::{Journal, RunOutcome, Record};
    /// # let folder = tempfile::tempdir()?;
    /// # let path = folder.path().join("clutch.journal");
    /// let failed = RunOutcome::Failed { attempts: 1, cause: "exit status 1".to_owned(), by_circumstances: false };
    /// let record = Record { model: [0; 32], point: vec![0.25], outcome: failed, seconds: 3.5 };
    /// let (journal, before) = Journal::open(&path)?;
    /// assert!(before.records.is_empty());
    /// journal.append(&[&record])?;
    /// drop(journal);
    /// let (_, found) = Journal::open(&path)?;
    /// assert_eq!(found.records, [record]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn open(path: &Path) -> Result<(Self, Contents), JournalError> {
        let failed = |cause: io::Error| io_error(path, &cause);
        if path.exists() && !path.is_file() {
            return Err(JournalError::NotAJournal { path: path.display().to_string() });
        }
        let mut file = locked(path)?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(failed)?;
        let (contents, end) = contents(path, &bytes)?;
        let is_blank = bytes.len() < HEADER_BYTES;
        if !is_blank && bytes[..HEADER_BYTES] != header(VERSION) {
            renew_header(&mut file).map_err(failed)?;
        }
        if is_blank {
            begin(&mut file).and_then(|()| sync_folder(path)).map_err(failed)?;
        } else if end < bytes.len() as u64 {
            file.set_len(end).and_then(|()| file.sync_all()).map_err(failed)?;
        }
        let file = Mutex::new(Tail { file, end, is_worthless: is_blank });
        Ok((Self { path: path.to_owned(), file }, contents))
    }

    /// The records of a journal, without opening it for more: also while a build writes it. A journal that does not
    /// exist has none.
    ///
    /// # Errors
    ///
    /// [`JournalError`].
    pub fn read(path: &Path) -> Result<Contents, JournalError> {
        // Opening a pipe would wait, and a device has no end.
        if path.exists() && !path.is_file() {
            return Err(JournalError::NotAJournal { path: path.display().to_string() });
        }
        let bytes = std::fs::read(path).map_err(|cause| io_error(path, &cause))?;
        contents(path, &bytes).map(|(contents, _)| contents)
    }

    /// Adds records and waits until they are on the disk.
    ///
    /// # Errors
    ///
    /// [`JournalError::Io`]; what was written of them is then taken back.
    pub fn append(&self, records: &[&Record]) -> Result<(), JournalError> {
        let mut bytes = Vec::new();
        for record in records {
            let too_large = || JournalError::TooLarge { path: self.path.display().to_string(), most: LARGEST_BODY };
            bytes.extend(record.frame().ok_or_else(too_large)?);
        }
        let mut tail = self.tail();
        let written = tail.append(&bytes);
        if written.is_err() {
            // A part of a record would be cut off later anyway; nothing more can be done if this fails, too.
            let end = tail.end;
            let _ = tail.file.set_len(end);
        }
        written.map_err(|cause| io_error(&self.path, &cause))
    }

    /// Whether it was begun by this process and has no records yet.
    pub fn is_blank(&self) -> bool {
        self.tail().end == HEADER_BYTES as u64
    }

    /// Removes the file once the journal is closed.
    pub fn discard(&self) {
        self.tail().is_worthless = true;
    }

    fn tail(&self) -> MutexGuard<'_, Tail> {
        self.file.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A journal that was begun for nothing is not left behind. It is removed while it is locked.
impl Drop for Journal {
    fn drop(&mut self) {
        let tail = self.tail();
        if tail.is_worthless && is_at(&tail.file, &self.path).unwrap_or(false) {
            // If it stays, it does no harm.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

impl Tail {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(self.end))?;
        self.file.write_all(bytes)?;
        self.file.sync_data()?;
        self.end += bytes.len() as u64;
        self.is_worthless &= bytes.is_empty();
        Ok(())
    }
}

/// A program that is being started by another thread has this process's files open, and locked, until it runs: so a
/// lock that was given back may be held for some more milliseconds.
const LOCK_WAITS: usize = 20;
const LOCK_WAIT: Duration = Duration::from_millis(5);

/// Opens the file and locks it. Another process may remove its journal between the two: then the file that is locked is
/// no longer the one at the path, and what is written there would be lost.
fn locked(path: &Path) -> Result<File, JournalError> {
    let failed = |cause: io::Error| io_error(path, &cause);
    let mut waits = LOCK_WAITS;
    loop {
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(failed)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) if waits > 0 => {
                waits -= 1;
                std::thread::sleep(LOCK_WAIT);
                continue;
            }
            Err(TryLockError::WouldBlock) => return Err(JournalError::Locked { path: path.display().to_string() }),
            Err(TryLockError::Error(cause)) => return Err(failed(cause)),
            Ok(()) => {}
        }
        if is_at(&file, path).map_err(failed)? {
            return Ok(file);
        }
    }
}

#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let own = file.metadata()?;
    match std::fs::metadata(path) {
        Ok(found) => Ok((own.dev(), own.ino()) == (found.dev(), found.ino())),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

/// Elsewhere an open file cannot be removed.
#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> io::Result<bool> {
    Ok(true)
}

fn io_error(path: &Path, cause: &io::Error) -> JournalError {
    JournalError::Io { path: path.display().to_string(), kind: cause.kind(), cause: cause.to_string() }
}

fn header(version: u32) -> [u8; HEADER_BYTES] {
    let mut header = [0; HEADER_BYTES];
    header[..MAGIC.len()].copy_from_slice(&MAGIC);
    header[MAGIC.len()..].copy_from_slice(&version.to_le_bytes());
    header
}

/// Writes the header of this version over that of an older one.
fn renew_header(file: &mut File) -> io::Result<()> {
    file.rewind()?;
    file.write_all(&header(VERSION))?;
    file.sync_data()
}

fn begin(file: &mut File) -> io::Result<()> {
    file.set_len(0)?;
    file.rewind()?;
    file.write_all(&header(VERSION))?;
    file.sync_all()
}

/// A new file is safe once its folder is.
fn sync_folder(path: &Path) -> io::Result<()> {
    #[cfg(unix)]
    {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        match File::open(folder)?.sync_all() {
            // Some network file systems cannot.
            Err(error) if matches!(error.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => {}
            result => result?,
        }
    }
    #[cfg(not(unix))]
    let _ = path;
    Ok(())
}

/// The records in `bytes`, and where the last sound one ends.
fn contents(path: &Path, bytes: &[u8]) -> Result<(Contents, u64), JournalError> {
    let known = (1..=VERSION).map(header);
    if bytes.len() < HEADER_BYTES {
        // A header that was not yet whole.
        return match known.clone().any(|header| header.starts_with(bytes)) {
            true => Ok((Contents::default(), HEADER_BYTES as u64)),
            false => Err(JournalError::NotAJournal { path: path.display().to_string() }),
        };
    }
    if bytes[..MAGIC.len()] != MAGIC {
        return Err(JournalError::NotAJournal { path: path.display().to_string() });
    }
    if !known.clone().any(|header| bytes[..HEADER_BYTES] == header) {
        let found = bytes[MAGIC.len()..HEADER_BYTES].iter().rev().fold(0, |all, &byte| all << 8 | u32::from(byte));
        return Err(JournalError::Version { path: path.display().to_string(), found });
    }
    let mut contents = Contents::default();
    let (mut at, mut end) = (HEADER_BYTES, HEADER_BYTES);
    while at < bytes.len() {
        match Record::read(&bytes[at..]) {
            Some((record, length)) => {
                contents.records.push(record);
                contents.damaged_bytes += (at - end) as u64;
                at += length;
                end = at;
            }
            // Usually the torn end; but a sound record may follow damaged bytes.
            None => at += 1,
        }
    }
    contents.torn_bytes = (bytes.len() - end) as u64;
    Ok((contents, end as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(x: f64) -> Record {
        let outcome = RunOutcome::Failed { attempts: 1, cause: "none".to_owned(), by_circumstances: false };
        Record { model: [1; HASH_BYTES], point: vec![x], outcome, seconds: 1.0 }
    }

    fn journal() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.journal");
        let (journal, found) = Journal::open(&path).unwrap();
        assert_eq!(found, Contents::default());
        (0..3).for_each(|i| journal.append(&[&record(f64::from(i))]).unwrap());
        (folder, path)
    }

    #[test]
    fn every_torn_end_is_cut_and_nothing_before_it() {
        let (_folder, path) = journal();
        let whole = std::fs::read(&path).unwrap();
        let frame = (whole.len() - HEADER_BYTES) / 3;
        for end in 0..=whole.len() {
            std::fs::write(&path, &whole[..end]).unwrap();
            let (journal, found) = Journal::open(&path).unwrap();
            let expected = end.saturating_sub(HEADER_BYTES) / frame;
            assert_eq!(found.records, (0..expected).map(|i| record(i as f64)).collect::<Vec<_>>(), "{end} bytes");
            journal.append(&[&record(9.0)]).unwrap();
            drop(journal);
            let again = Journal::read(&path).unwrap();
            assert_eq!((again.records.len(), again.torn_bytes, again.damaged_bytes), (expected + 1, 0, 0));
        }
    }

    #[test]
    fn damage_in_the_middle_loses_the_damaged_record_alone() {
        let (_folder, path) = journal();
        let mut bytes = std::fs::read(&path).unwrap();
        let frame = (bytes.len() - HEADER_BYTES) / 3;
        bytes[HEADER_BYTES + frame + 20] ^= 1;
        std::fs::write(&path, &bytes).unwrap();
        let (_, found) = Journal::open(&path).unwrap();
        assert_eq!(found.records, [record(0.0), record(2.0)]);
        assert_eq!((found.damaged_bytes, found.torn_bytes), (frame as u64, 0));
        assert_eq!(std::fs::read(&path).unwrap(), bytes, "nothing was cut");
    }

    #[test]
    fn a_journal_has_one_writer_and_any_number_of_readers() {
        let (_folder, path) = journal();
        let (first, _) = Journal::open(&path).unwrap();
        assert!(matches!(Journal::open(&path), Err(JournalError::Locked { .. })));
        assert_eq!(Journal::read(&path).unwrap().records.len(), 3);
        drop(first);
        assert!(Journal::open(&path).is_ok());
    }

    #[test]
    fn other_files_are_refused_and_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("study.toml");
        for content in ["format = 1\n", "x", "\u{89}PCJ and something else"] {
            std::fs::write(&path, content).unwrap();
            assert!(matches!(Journal::open(&path), Err(JournalError::NotAJournal { .. })));
            assert_eq!(std::fs::read_to_string(&path).unwrap(), content);
        }
        assert!(matches!(Journal::open(folder.path()), Err(JournalError::NotAJournal { .. })));
        let mut later = header(VERSION);
        drop(Journal::open(&folder.path().join("blank.journal")).unwrap());
        assert!(!folder.path().join("blank.journal").exists(), "nothing was recorded");
        later[MAGIC.len()] = 9;
        std::fs::write(&path, later).unwrap();
        assert!(matches!(Journal::open(&path), Err(JournalError::Version { found: 9, .. })));
        let nowhere = folder.path().join("missing/x.journal");
        assert!(matches!(Journal::open(&nowhere), Err(JournalError::Io { .. })));
    }
}
