//! A column of a table of measured values.

use crate::tables::{TextError, delimiter, is_decimal_comma, line, number, read_text};
use std::path::Path;
use thiserror::Error;

/// Why a table gives no values.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum TableError {
    /// It cannot be read as text.
    #[error(transparent)]
    Text(#[from] TextError),
    /// It has several columns, and none is named.
    #[error("{file} has {} columns; add column = {:?}, or another of {}", columns.len(), columns[0], columns.join(", "))]
    Columns {
        /// The file.
        file: String,
        /// What they are called.
        columns: Vec<String>,
    },
    /// It has several columns without names, or decimal commas.
    #[error(
        "{file} has {columns} columns of numbers without names; if these are decimal commas, write points \
         (sed 's/,/./g' {file} > points.csv), else name the columns in its first line"
    )]
    Unnamed {
        /// The file.
        file: String,
        /// Number of columns.
        columns: usize,
    },
    /// It has no such column.
    #[error("{file} has no column {column:?}; it has {}", columns.join(", "))]
    NoColumn {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// What they are called.
        columns: Vec<String>,
    },
    /// It has the column more than once.
    #[error("{file} has {column:?} as the name of {count} columns; rename all but one of them")]
    SeveralTimes {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// How often.
        count: usize,
    },
    /// A cell is no number.
    #[error("{file}, line {line}: {found:?} is no finite number; correct it, or remove the line")]
    NotANumber {
        /// The file.
        file: String,
        /// Its line.
        line: u64,
        /// What stands there.
        found: String,
    },
    /// A number with a comma for the point.
    #[error(
        "{file}, line {line}: {found} has a decimal comma; write {}, as sed 's/,/./g' {file} > points.csv does where \
         no comma separates columns",
        found.replace(',', ".")
    )]
    DecimalComma {
        /// The file.
        file: String,
        /// Its line.
        line: u64,
        /// What stands there.
        found: String,
    },
    /// A row is longer or shorter than the first.
    #[error(
        "{file}, line {line}: cells and columns differ in number, {found} and {expected}; write one cell per column"
    )]
    RowLength {
        /// The file.
        file: String,
        /// Its line.
        line: u64,
        /// Number of cells.
        found: usize,
        /// Number of columns.
        expected: usize,
    },
}

/// The numbers of a column. Columns end at commas, or at semicolons or tabs if the first line has some.
pub(super) fn values(file: &str, column: Option<&str>, folder: &Path) -> Result<Vec<f64>, TableError> {
    let name = || file.to_owned();
    let unreadable = |cause: String| TableError::Text(TextError::Unreadable { file: name(), cause });
    let text = read_text(&folder.join(file), file)?;
    let mut reader = csv::ReaderBuilder::new();
    let reader = reader.delimiter(delimiter(&text)).has_headers(false).flexible(true).trim(csv::Trim::All);
    let mut rows = reader.from_reader(text.as_bytes()).into_records();
    let first = rows.next().transpose().map_err(|error| unreadable(error.to_string()))?.unwrap_or_default();
    let head: Vec<String> = first.iter().map(str::to_owned).collect();
    let is_numbers = || head.iter().all(|cell| number(cell).is_some());
    if let Some(found) = head.iter().find(|cell| is_decimal_comma(cell)) {
        return Err(TableError::DecimalComma { file: name(), line: line(&text, &first), found: found.clone() });
    }
    let position = match column {
        Some(column) => position(&head, column).map_err(|count| match count {
            0 => TableError::NoColumn { file: name(), column: column.to_owned(), columns: head.clone() },
            count => TableError::SeveralTimes { file: name(), column: column.to_owned(), count },
        })?,
        None if head.len() > 1 && is_numbers() => {
            return Err(TableError::Unnamed { file: name(), columns: head.len() });
        }
        None if head.len() > 1 => return Err(TableError::Columns { file: name(), columns: head }),
        None => 0,
    };
    // A column without a name begins with its first value.
    let mut values: Vec<f64> =
        if column.is_none() { head.iter().filter_map(|cell| number(cell)).collect() } else { Vec::new() };
    for row in rows {
        let row = row.map_err(|error| unreadable(error.to_string()))?;
        values.push(cell(&row, position, head.len()).map_err(|wrong| wrong.at(name(), line(&text, &row)))?);
    }
    Ok(values)
}

/// Where the one column of this name is; how many there are, if that is not one.
fn position(head: &[String], column: &str) -> Result<usize, usize> {
    let mut named = head.iter().enumerate().filter(|(_, known)| *known == column).map(|(at, _)| at);
    match (named.next(), named.count()) {
        (Some(at), 0) => Ok(at),
        (first, others) => Err(usize::from(first.is_some()) + others),
    }
}

/// What is wrong with a row.
enum Wrong {
    Number(String),
    Comma(String),
    Length { found: usize, expected: usize },
}

impl Wrong {
    fn at(self, file: String, line: u64) -> TableError {
        match self {
            Self::Number(found) => TableError::NotANumber { file, line, found },
            Self::Comma(found) => TableError::DecimalComma { file, line, found },
            Self::Length { found, expected } => TableError::RowLength { file, line, found, expected },
        }
    }
}

/// The number of a row of so many columns.
fn cell(row: &csv::StringRecord, position: usize, columns: usize) -> Result<f64, Wrong> {
    if row.len() != columns {
        // Twice as many cells as columns are numbers that commas have cut in two.
        let halves = [2 * position, 2 * position + 1].map(|at| row.get(at).unwrap_or_default());
        let whole = halves.join(",");
        let is_cut = row.len() == 2 * columns && is_decimal_comma(&whole);
        return Err(if is_cut { Wrong::Comma(whole) } else { Wrong::Length { found: row.len(), expected: columns } });
    }
    let found = row.get(position).unwrap_or_default();
    let wrong =
        || if is_decimal_comma(found) { Wrong::Comma(found.to_owned()) } else { Wrong::Number(found.to_owned()) };
    number(found).ok_or_else(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(content: impl AsRef<[u8]>, column: Option<&str>) -> Result<Vec<f64>, TableError> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("m.csv"), content).unwrap();
        values("m.csv", column, folder.path())
    }

    fn message(content: impl AsRef<[u8]>, column: Option<&str>) -> String {
        read(content, column).unwrap_err().to_string()
    }

    #[test]
    fn columns_are_found_with_and_without_names() {
        assert_eq!(read("1.0\n2\n3e0\n", None), Ok(vec![1.0, 2.0, 3.0]));
        assert_eq!(read("k\n1.0\n2\n", None), Ok(vec![1.0, 2.0]));
        assert_eq!(read("\u{feff}a; k\n5;1.0\n6;2\n\n", Some("k")), Ok(vec![1.0, 2.0]));
        assert_eq!(read("a\tk\r\n5\t1.0\r\n", Some("a")), Ok(vec![5.0]));
        assert_eq!(read("\"a; in N\",k\n5,1.0\n", Some("a; in N")), Ok(vec![5.0]));
        assert_eq!(read("\"x, in m\";k\n5;1.0\n", Some("k")), Ok(vec![1.0]));
        assert_eq!(read("", None), Ok(vec![]));
    }

    #[test]
    fn what_is_no_number_is_named_by_its_line() {
        assert_eq!(
            message("a,k\n1,2\n3,\n", Some("k")),
            "m.csv, line 3: \"\" is no finite number; correct it, or remove the line"
        );
        assert!(message("k\n1\nnan\n", None).contains("line 3: \"nan\""));
        assert!(message("a,k\n1,2\n", None).contains("add column = \"a\", or another of a, k"));
        assert!(message("a,k\n1,2\n", Some("b")).contains("no column \"b\"; it has a, k"));
        assert!(message("a,k\n1,2\n3\n", Some("a")).contains("line 3: cells and columns differ in number, 1 and 2"));
        assert!(message("k\n1\n2,x\n", None).contains("line 3: cells and columns differ in number, 2 and 1"));
    }

    #[test]
    fn lines_are_counted_whatever_ends_them() {
        for (lines, column, line) in [
            (&["k", "1", "x"][..], None, 3),
            (&["k", "", "", "1", "", "x"], None, 6),
            (&["", "", "a;k", "1;2", "3;x"], Some("k"), 5),
            (&["a,k", "\"1", "2\",3", "1,x", "1,2"], Some("k"), 4),
        ] {
            for end in ["\n", "\r\n", "\r"] {
                for last in ["", end] {
                    let message = message(lines.join(end) + last, column);
                    assert!(
                        message.starts_with(&format!("m.csv, line {line}: \"x\"")),
                        "{lines:?}, {end:?}: {message}"
                    );
                }
            }
        }
        assert!(message("\r\n\r\n1,5;2\r\n", None).starts_with("m.csv, line 3: 1,5 has a decimal comma"));
    }

    #[test]
    fn a_column_is_named_once() {
        assert_eq!(
            message("k,k\n1,2\n", Some("k")),
            "m.csv has \"k\" as the name of 2 columns; rename all but one of them"
        );
        assert!(message("k;a; k ;k\n1;2;3;4\n", Some("k")).contains("the name of 3 columns"));
        assert!(message("\"k\"\tk\n1\t2\n", Some("k")).contains("the name of 2 columns"));
        assert_eq!(read("k,a,k\n1,2,3\n", Some("a")), Ok(vec![2.0]), "other columns may be");
    }

    #[test]
    fn decimal_commas_are_called_so() {
        for (content, column, line) in [
            ("k\n1\n1,5\n", None, 3),
            ("k\n\"1,5\"\n", None, 2),
            ("a,k\n1,0,1,5\n", Some("k"), 2),
            ("a;k\n1,0;1,5\n", Some("k"), 2),
            ("a\tk\n2\t1,5\n", Some("k"), 2),
            ("1,5;2,25\n2,5;1,5\n", None, 1),
        ] {
            let expected = format!("m.csv, line {line}: 1,5 has a decimal comma; write 1.5, as sed 's/,/./g' m.csv");
            let message = message(content, column);
            assert!(message.starts_with(&expected), "{content:?}: {message}");
        }
        let two = message("1,5\n2,3\n", None);
        assert!(two.contains("2 columns of numbers without names; if these are decimal commas, write points"), "{two}");
    }

    #[test]
    fn other_encodings_are_called_so() {
        let wide = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
        for (content, encoding) in [
            (b"gr\xf6\xdfe\n1\n".to_vec(), "LATIN1"),
            (b"k\n1\xa0000\n".to_vec(), "LATIN1"),
            (wide("k\n1\n"), "UTF-16"),
            (wide("\u{feff}k\n1\n"), "UTF-16"),
        ] {
            let expected = format!("m.csv is not UTF-8 text; convert it, as with iconv -f {encoding} -t UTF-8 m.csv");
            assert!(message(content, None).starts_with(&expected));
        }
    }
}
