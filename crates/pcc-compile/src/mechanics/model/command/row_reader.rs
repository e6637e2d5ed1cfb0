//! Rows of a CSV file with the lines they start in, read within bounds.

use super::printable::{self, SHOWN_CELL};
use super::results_table::{LARGEST_CELL, LARGEST_ROW};
use super::table_error::TableError;
use csv::{ByteRecord, ReaderBuilder, StringRecord, Terminator};
use std::io::{self, Chain, Cursor, Read};

const BYTE_ORDER_MARK: &str = "\u{feff}";

/// A file between the bytes at its start that are no byte order mark, and a line end.
type Framed<R> = Chain<Chain<Cursor<Vec<u8>>, R>, &'static [u8]>;

/// Reads rows of any number of cells; spaces around their cells are gone, empty rows are left out.
pub(super) struct RowReader<R> {
    reader: csv::Reader<ShortRows<Framed<R>>>,
    record: ByteRecord,
    /// The header, for messages.
    names: Option<StringRecord>,
}

impl<R: Read> RowReader<R> {
    /// Starts below a byte order mark.
    pub(super) fn new(mut reader: R) -> Result<Self, TableError> {
        let mut start = Vec::new();
        let mark = BYTE_ORDER_MARK.len() as u64;
        reader.by_ref().take(mark).read_to_end(&mut start).map_err(|error| unreadable(&error))?;
        if start == BYTE_ORDER_MARK.as_bytes() {
            start.clear();
        }
        // The last row has a line end as well, so that lines are counted in one way.
        let inner = Cursor::new(start).chain(reader).chain(b"\n".as_slice());
        let reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            // "\r" before it is a space at the end of a cell. With both as line ends, lines would be counted twice.
            .terminator(Terminator::Any(b'\n'))
            .from_reader(ShortRows { inner, delivered: 0, is_exceeded: false });
        Ok(Self { reader, record: ByteRecord::new(), names: None })
    }

    /// The next row and the line it starts in; `None` at the end of the file.
    pub(super) fn next_row(&mut self) -> Result<Option<(u64, StringRecord)>, TableError> {
        loop {
            self.reader.get_mut().delivered = 0;
            let start = self.reader.position().line();
            match self.reader.read_byte_record(&mut self.record) {
                Ok(true) => {}
                Ok(false) => return Ok(None),
                Err(_) if self.reader.get_ref().is_exceeded => return Err(TableError::RowTooLarge { line: start }),
                Err(error) => return Err(unreadable(&error.into())),
            }
            let line = self.line();
            let mut row = StringRecord::from_byte_record_lossy(self.record.clone());
            row.trim();
            if row.iter().all(str::is_empty) && row.len() == 1 {
                continue;
            }
            self.check_cells(line, &row)?;
            self.names.get_or_insert_with(|| row.clone());
            return Ok(Some((line, row)));
        }
    }

    /// Where the row starts that was just read: it ends with the line end before the reader's line, and has those in
    /// its cells. (The reader's own answer is off by the empty rows before.)
    fn line(&self) -> u64 {
        let inside = self.record.as_slice().iter().filter(|&&byte| byte == b'\n').count() as u64;
        self.reader.position().line().saturating_sub(inside + 1).max(1)
    }

    fn check_cells(&self, line: u64, row: &StringRecord) -> Result<(), TableError> {
        let Some(place) = row.iter().position(|cell| cell.len() > LARGEST_CELL) else { return Ok(()) };
        let name = self.names.as_ref().and_then(|names| names.get(place)).map(|name| printable::line(name, SHOWN_CELL));
        let column = name.unwrap_or_else(|| (place + 1).to_string());
        Err(TableError::CellTooLarge { line, column, length: row[place].len() })
    }
}

fn unreadable(error: &io::Error) -> TableError {
    TableError::Unreadable { cause: error.to_string() }
}

/// Fails when a row becomes too long.
struct ShortRows<R> {
    inner: R,
    /// Bytes since the row was asked for.
    delivered: u64,
    is_exceeded: bool,
}

impl<R: Read> Read for ShortRows<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let length = self.inner.read(buffer)?;
        self.delivered += length as u64;
        if self.delivered > LARGEST_ROW {
            self.is_exceeded = true;
            return Err(io::Error::new(io::ErrorKind::InvalidData, "a row is too long"));
        }
        Ok(length)
    }
}
