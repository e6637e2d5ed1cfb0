//! Real matrices from Matrix Market files, the text format that finite element programs, Matlab and SciPy exchange.
//!
//! Boisvert, Pozo and Remington (1996), NISTIR 5935, <https://math.nist.gov/MatrixMarket/formats.html>:
//!
//! ```text
//! %%MatrixMarket matrix coordinate real symmetric
//! % comments
//! 3 3 2          rows, columns, lines that follow
//! 1 1 4.0        row, column (from 1), value
//! 3 1 -1.5       the lower triangle stands for both
//! ```
//!
//! An `array` file lists all values (of the lower triangle, where there is a symmetry) column by column, one per line,
//! after a line with rows and columns only.
//!
//! Files come from anywhere. Memory follows the length of the text, never the sizes it declares, because those may be
//! anything.

mod error;
#[cfg(test)]
mod tests;

use error::excerpt;
pub use error::{MatrixMarketError, Place};

/// Rows or columns of the largest matrix that is read: as a dense matrix it takes 32 MB.
pub const LARGEST_DIMENSION: usize = 2000;

/// Bytes of the shortest line of a coordinate file, `1 1 1`, which bounds the number of entries whatever it declares.
const SHORTEST_ENTRY: usize = 5;

/// Row and column, both from 0, and value.
type Entry = (usize, usize, f64);

/// A sparse real matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct CoordinateMatrix {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Row, column (both from 0) and value of all entries that are not zero, each once, by column, then row. Both
    /// triangles of a symmetric matrix are there.
    pub entries: Vec<(usize, usize, f64)>,
}

/// The matrix that `text`, the contents of a Matrix Market file, describes.
///
/// Formats `coordinate` and `array`, fields `real` (or `double`) and `integer` (or `unsigned-integer`), symmetries
/// `general`, `symmetric` and `skew-symmetric`, in upper or lower case. Entries that appear several times are added, in
/// the order of the file; then zeros are dropped. Integers beyond 2⁵³ are rounded to the nearest f64. Exponents may
/// have Fortran's D. Blank lines and comments may stand anywhere after the first line.
///
/// # Errors
///
/// [`MatrixMarketError`] names the line and its text. More than [`LARGEST_DIMENSION`] rows or columns are refused.
///
/// # Examples
///
/// ```
/// use pcc_compile::mechanics::model::matrices::read_matrix_market;
/// let text = "%%MatrixMarket matrix coordinate real symmetric\n% stiffness in N/m\n2 2 2\n1 1 4.0\n2 1 -1.5\n";
/// let matrix = read_matrix_market(text)?;
/// assert_eq!((matrix.rows, matrix.columns), (2, 2));
/// assert_eq!(matrix.entries, [(0, 0, 4.0), (1, 0, -1.5), (0, 1, -1.5)]);
/// # Ok::<(), pcc_compile::mechanics::model::matrices::MatrixMarketError>(())
/// ```
pub fn read_matrix_market(text: &str) -> Result<CoordinateMatrix, MatrixMarketError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let header = Header::read(text.lines().next().unwrap_or_default())?;
    let mut lines = text
        .lines()
        .enumerate()
        .skip(1)
        .map(|(index, text)| Line { number: index + 1, text: text.trim() })
        .filter(|line| !line.text.is_empty() && !line.text.starts_with('%'));
    let size = header.size(lines.next().ok_or(MatrixMarketError::NoSize)?)?;
    let mut entries = Vec::with_capacity(size.count.min(text.len() / SHORTEST_ENTRY));
    match header.format {
        Format::Coordinate => header.read_coordinates(&size, lines, &mut entries)?,
        Format::Array => header.read_array(&size, lines, &mut entries)?,
    }
    Ok(CoordinateMatrix { rows: size.rows, columns: size.columns, entries: added(entries)? })
}

/// A line that is neither blank nor a comment, trimmed.
#[derive(Clone, Copy)]
struct Line<'a> {
    /// From 1.
    number: usize,
    text: &'a str,
}

impl<'a> Line<'a> {
    fn place(self) -> Place {
        Place { line: self.number, text: excerpt(self.text) }
    }

    /// The words of a line that must have N of them.
    fn words<const N: usize>(self) -> Option<[&'a str; N]> {
        let mut words = self.text.split_ascii_whitespace();
        let mut found = [""; N];
        for word in &mut found {
            *word = words.next()?;
        }
        words.next().is_none().then_some(found)
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Format {
    Coordinate,
    Array,
}

#[derive(Clone, Copy, PartialEq)]
enum Field {
    Real,
    Integer,
}

#[derive(Clone, Copy, PartialEq)]
enum Symmetry {
    General,
    Symmetric,
    Skew,
}

/// The first line.
struct Header {
    format: Format,
    field: Field,
    symmetry: Symmetry,
}

/// The second line.
struct Size {
    rows: usize,
    columns: usize,
    /// Lines that must follow.
    count: usize,
}

impl Header {
    fn read(text: &str) -> Result<Self, MatrixMarketError> {
        let line = Line { number: 1, text: text.trim() };
        let lower = line.text.to_ascii_lowercase();
        let Some(["%%matrixmarket", "matrix", format, field, symmetry]) = (Line { text: &lower, ..line }).words()
        else {
            return Err(MatrixMarketError::Header(line.place()));
        };
        let unsupported = |word: &str| MatrixMarketError::Unsupported { word: excerpt(word), place: line.place() };
        Ok(Self {
            format: match format {
                "coordinate" => Format::Coordinate,
                "array" => Format::Array,
                other => return Err(unsupported(other)),
            },
            field: match field {
                "real" | "double" => Field::Real,
                "integer" | "unsigned-integer" => Field::Integer,
                other => return Err(unsupported(other)),
            },
            symmetry: match symmetry {
                "general" => Symmetry::General,
                "symmetric" => Symmetry::Symmetric,
                "skew-symmetric" => Symmetry::Skew,
                other => return Err(unsupported(other)),
            },
        })
    }

    fn size(&self, line: Line) -> Result<Size, MatrixMarketError> {
        let words: Option<[&str; 3]> = match self.format {
            Format::Coordinate => line.words(),
            Format::Array => line.words().map(|[rows, columns]| [rows, columns, "0"]),
        };
        let Some([rows, columns, count]) = words.filter(|words| words.iter().all(|word| is_digits(word))) else {
            let expected = match self.format {
                Format::Coordinate => "rows, columns and number of entries",
                Format::Array => "rows and columns",
            };
            return Err(MatrixMarketError::Size { expected, place: line.place() });
        };
        // Numbers of digits that overflow are too large as well.
        let dimension = |word: &str| word.parse().ok().filter(|&dimension: &usize| dimension <= LARGEST_DIMENSION);
        let (Some(rows), Some(columns)) = (dimension(rows), dimension(columns)) else {
            return Err(MatrixMarketError::TooLarge(line.place()));
        };
        if self.symmetry != Symmetry::General && rows != columns {
            return Err(MatrixMarketError::NotSquare(line.place()));
        }
        let count = match self.format {
            Format::Coordinate => count.parse().unwrap_or(usize::MAX),
            Format::Array => (0..columns).map(|column| rows - self.first_row(column).min(rows)).sum(),
        };
        Ok(Size { rows, columns, count })
    }

    /// The first row that is stored in a column.
    fn first_row(&self, column: usize) -> usize {
        match self.symmetry {
            Symmetry::General => 0,
            Symmetry::Symmetric => column,
            Symmetry::Skew => column + 1,
        }
    }

    fn read_coordinates<'a>(
        &self,
        size: &Size,
        lines: impl Iterator<Item = Line<'a>>,
        entries: &mut Vec<Entry>,
    ) -> Result<(), MatrixMarketError> {
        let mut found = 0;
        for line in lines {
            if found == size.count {
                return Err(MatrixMarketError::TooMany { expected: size.count, place: line.place() });
            }
            found += 1;
            let expected = "a row, a column and a value";
            let Some([row, column, value]) =
                line.words().filter(|[row, column, _]| is_digits(row) && is_digits(column))
            else {
                return Err(MatrixMarketError::Entry { expected, place: line.place() });
            };
            let index = |word: &str, end: usize| word.parse().ok().filter(|&from_one| (1..=end).contains(&from_one));
            let (Some(row), Some(column)) = (index(row, size.rows), index(column, size.columns)) else {
                let (rows, columns) = (size.rows, size.columns);
                return Err(MatrixMarketError::OutOfRange { rows, columns, place: line.place() });
            };
            if row - 1 < self.first_row(column - 1) {
                return Err(match self.symmetry {
                    Symmetry::Skew if row == column => MatrixMarketError::OnDiagonal(line.place()),
                    _ => MatrixMarketError::AboveDiagonal(line.place()),
                });
            }
            self.push(entries, (row - 1, column - 1), self.value(value, expected, line)?);
        }
        if found == size.count { Ok(()) } else { Err(MatrixMarketError::TooFew { found, expected: size.count }) }
    }

    fn read_array<'a>(
        &self,
        size: &Size,
        mut lines: impl Iterator<Item = Line<'a>>,
        entries: &mut Vec<Entry>,
    ) -> Result<(), MatrixMarketError> {
        let mut found = 0;
        for column in 0..size.columns {
            for row in self.first_row(column)..size.rows {
                let line = lines.next().ok_or(MatrixMarketError::TooFew { found, expected: size.count })?;
                found += 1;
                let expected = "one value";
                let [value] = line.words().ok_or_else(|| MatrixMarketError::Entry { expected, place: line.place() })?;
                self.push(entries, (row, column), self.value(value, expected, line)?);
            }
        }
        match lines.next() {
            None => Ok(()),
            Some(line) => Err(MatrixMarketError::TooMany { expected: size.count, place: line.place() }),
        }
    }

    fn value(&self, word: &str, expected: &'static str, line: Line) -> Result<f64, MatrixMarketError> {
        let fortran = || word.replace(['d', 'D'], "e").parse();
        let value: f64 = word
            .parse()
            .or_else(|_| fortran())
            .map_err(|_| MatrixMarketError::Entry { expected, place: line.place() })?;
        if !value.is_finite() {
            return Err(MatrixMarketError::NotFinite(line.place()));
        }
        if self.field == Field::Integer && value.fract() != 0.0 {
            return Err(MatrixMarketError::NotInteger(line.place()));
        }
        Ok(value)
    }

    /// Adds an entry and its mirror image.
    fn push(&self, entries: &mut Vec<Entry>, (row, column): (usize, usize), value: f64) {
        entries.push((row, column, value));
        if row != column {
            match self.symmetry {
                Symmetry::General => (),
                Symmetry::Symmetric => entries.push((column, row, value)),
                Symmetry::Skew => entries.push((column, row, -value)),
            }
        }
    }
}

fn is_digits(word: &str) -> bool {
    word.bytes().all(|byte| byte.is_ascii_digit())
}

/// Entries by column, then row; those of the same place as one, without zeros.
fn added(mut entries: Vec<Entry>) -> Result<Vec<Entry>, MatrixMarketError> {
    // A stable sort adds in the order of the file: mirror images get the same sums.
    entries.sort_by_key(|&(row, column, _)| (column, row));
    entries.dedup_by(|next, kept| {
        let is_same_place = (next.0, next.1) == (kept.0, kept.1);
        if is_same_place {
            kept.2 += next.2;
        }
        is_same_place
    });
    if let Some(&(row, column, _)) = entries.iter().find(|(_, _, value)| !value.is_finite()) {
        return Err(MatrixMarketError::Overflow { row: row + 1, column: column + 1 });
    }
    entries.retain(|&(_, _, value)| value != 0.0);
    Ok(entries)
}
