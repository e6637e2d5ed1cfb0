//! Aligned text tables and numbers for people.

use std::fmt;

/// How a column is aligned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

/// A table of text cells.
///
/// # Examples
///
/// ```
/// use pcc::report::{Align, Table};
/// let mut table = Table::new(&[("mode", Align::Left), ("growth 1/s", Align::Right)]);
/// table.row(["3", "-11.7"]);
/// assert_eq!(table.to_string(), "mode  growth 1/s\n3          -11.7\n");
/// ```
#[derive(Debug, Clone)]
pub struct Table {
    aligns: Vec<Align>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these column heads.
    pub fn new(columns: &[(&str, Align)]) -> Self {
        let heads = columns.iter().map(|(head, _)| (*head).to_owned()).collect();
        Self { aligns: columns.iter().map(|(_, align)| *align).collect(), rows: vec![heads] }
    }

    /// Adds a row; missing cells are empty.
    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        let mut row: Vec<String> = cells.into_iter().map(Into::into).collect();
        row.resize(self.aligns.len(), String::new());
        self.rows.push(row);
    }

    /// How each column is aligned.
    pub fn aligns(&self) -> &[Align] {
        &self.aligns
    }

    /// All rows, the column heads first.
    pub fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// The table in Markdown.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc::report::{Align, Table};
    /// let mut table = Table::new(&[("mode", Align::Left), ("growth 1/s", Align::Right)]);
    /// table.row(["3|4", "-11.7"]);
    /// assert_eq!(table.to_markdown(), "| mode | growth 1/s |\n|---|--:|\n| 3\\|4 | -11.7 |\n");
    /// ```
    pub fn to_markdown(&self) -> String {
        let line = |row: &[String]| {
            let cells: Vec<String> = row.iter().map(|cell| cell.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let rule = |align: &Align| if *align == Align::Left { "---" } else { "--:" };
        let rules: Vec<&str> = self.aligns.iter().map(rule).collect();
        let body: String = self.rows[1..].iter().map(|row| line(row)).collect();
        format!("{}|{}|\n{body}", line(&self.rows[0]), rules.join("|"))
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = |k: usize| self.rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.aligns.len()).map(width).collect();
        for row in &self.rows {
            let mut line = String::new();
            for ((cell, &width), align) in row.iter().zip(&widths).zip(&self.aligns) {
                if !line.is_empty() {
                    line.push_str("  ");
                }
                match align {
                    Align::Left => line.push_str(&format!("{cell:<width$}")),
                    Align::Right => line.push_str(&format!("{cell:>width$}")),
                }
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

/// `value` with so many significant digits; powers of ten only for very large and very small numbers.
///
/// # Examples
///
/// ```
/// use pcc::report::significant;
/// assert_eq!(significant(3641.65497, 5), "3641.7");
/// assert_eq!(significant(-0.00012345, 3), "-0.000123");
/// assert_eq!(significant(1.5e-9, 3), "1.50e-9");
/// ```
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return value.to_string();
    }
    let exponent = value.abs().log10().floor() as i32;
    if !(-5..9).contains(&exponent) {
        return format!("{value:.*e}", digits.saturating_sub(1));
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}

/// A number as people write it, with six digits at most and no zeros after the last: for values that were chosen.
///
/// # Examples
///
/// ```
/// use pcc::report::plain;
/// assert_eq!(plain(0.1 + 0.2), "0.3");
/// assert_eq!((plain(15.2e6), plain(-1e-9)), ("15200000".to_owned(), "-1e-9".to_owned()));
/// ```
pub fn plain(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    let size = rounded.abs();
    if size != 0.0 && !(1e-4..1e9).contains(&size) { format!("{rounded:e}") } else { rounded.to_string() }
}
