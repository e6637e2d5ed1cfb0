//! The text of a table as people and programs write it: encodings, separators, decimal commas, ends of lines.

use std::path::Path;
use thiserror::Error;

/// Why a file is no text of a table.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum TextError {
    /// It cannot be read.
    #[error("{file} cannot be read: {cause}")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system says.
        cause: String,
    },
    /// It is not text as everybody reads it.
    #[error("{file} is not UTF-8 text; convert it, as with iconv -f {encoding} -t UTF-8 {file} > utf8.csv")]
    NotText {
        /// The file.
        file: String,
        /// What it may be instead.
        encoding: &'static str,
    },
}

/// What stands between the whole part of a number and the rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Decimal {
    /// 0.25
    #[default]
    Point,
    /// 0,25
    Comma,
}

impl Decimal {
    /// All of them, with their words in studies.
    pub const ALL: [(&'static str, Self); 2] = [("point", Self::Point), ("comma", Self::Comma)];

    /// Its word in studies.
    pub fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Comma => "comma",
        }
    }

    /// The finite number that a cell holds.
    pub fn number(self, cell: &str) -> Option<f64> {
        match self {
            Self::Point => number(cell),
            // A point may separate thousands here, and is no part of a number.
            Self::Comma if cell.contains('.') => None,
            Self::Comma => number(&cell.replace(',', ".")),
        }
    }
}

/// The separator of columns that a word stands for: its name, or the character itself.
///
/// # Examples
///
/// ```
/// use pcc_compile::tables::separator;
/// assert_eq!((separator("tab"), separator(";"), separator("0")), (Some('\t'), Some(';'), None));
/// ```
pub fn separator(word: &str) -> Option<char> {
    const NAMED: [(&str, char); 5] = [("comma", ','), ("semicolon", ';'), ("tab", '\t'), ("space", ' '), ("bar", '|')];
    let named = NAMED.iter().find(|(name, own)| *name == word || word.chars().eq([*own])).map(|(_, own)| *own);
    named.or_else(|| (word == "\\t").then_some('\t'))
}

/// How a table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Dialect {
    /// What separates columns; by default semicolons or tabs if the first line has some, else commas.
    pub delimiter: Option<char>,
    /// What numbers have for a decimal point.
    pub decimal: Decimal,
}

/// The byte order mark.
const MARK: char = '\u{feff}';

/// What separates columns, in the order of precedence: a file that has semicolons or tabs may have decimal commas, too.
const DELIMITERS: [u8; 2] = [b';', b'\t'];

/// The text of a file that is `shown` in messages.
pub(crate) fn read_text(path: &Path, shown: &str) -> Result<String, TextError> {
    let bytes = std::fs::read(path)
        .map_err(|error| TextError::Unreadable { file: shown.to_owned(), cause: error.to_string() })?;
    text(bytes).map_err(|encoding| TextError::NotText { file: shown.to_owned(), encoding })
}

/// The text of a file; what it may be instead, if it is none.
fn text(bytes: Vec<u8>) -> Result<String, &'static str> {
    let is_wide = bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) || bytes.contains(&0);
    if is_wide {
        return Err("UTF-16");
    }
    let text = String::from_utf8(bytes).map_err(|_| "LATIN1")?;
    Ok(if text.starts_with(MARK) { text.trim_start_matches(MARK).to_owned() } else { text })
}

/// What separates the columns of the first line, but for what stands in quotes.
pub(crate) fn delimiter(text: &str) -> u8 {
    let first = text.split(['\r', '\n']).find(|line| !line.is_empty()).unwrap_or_default();
    let plain: String = first.split('"').step_by(2).collect();
    DELIMITERS.into_iter().find(|byte| plain.as_bytes().contains(byte)).unwrap_or(b',')
}

/// Counts the lines of a text: lines end at LF, CR LF or CR, of which the reader counts LF alone, and it may stand
/// before blank lines or in the middle of CR LF.
#[derive(Debug)]
pub(super) struct LineCounter<'t> {
    text: &'t str,
    /// The line, from 1, of the row that begins at this byte.
    at: usize,
    line: u64,
}

impl<'t> LineCounter<'t> {
    pub fn new(text: &'t str) -> Self {
        Self { text, at: 0, line: 1 }
    }

    /// The line of the row that the reader finds at a byte, none before that of the last call.
    pub fn line(&mut self, start: usize) -> u64 {
        let rest = self.text.get(start..).unwrap_or_default().trim_start_matches(['\r', '\n']);
        let start = (self.text.len() - rest.len()).max(self.at);
        let between = &self.text[self.at..start];
        let [feeds, returns, both] = ["\n", "\r", "\r\n"].map(|end| between.matches(end).count());
        self.line += (feeds + returns - both) as u64;
        self.at = start;
        self.line
    }
}

/// The line on which a row begins.
pub(crate) fn line(text: &str, row: &csv::StringRecord) -> u64 {
    LineCounter::new(text).line(row.position().map_or(0, |position| position.byte() as usize))
}

/// The finite number that a cell holds, with a decimal point.
pub(crate) fn number(cell: &str) -> Option<f64> {
    cell.parse().ok().filter(|value: &f64| value.is_finite())
}

/// Whether it is a number but for the comma that it has for a point.
pub(crate) fn is_decimal_comma(cell: &str) -> bool {
    cell.contains(',') && number(&cell.replace(',', ".")).is_some()
}
