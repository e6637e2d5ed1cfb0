//! Aligned text tables.

use std::fmt;

/// How a column is aligned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

/// Spaces between columns.
const GAP: usize = 2;

/// A table of text cells. As text it keeps to 80 columns, or to the width of the format: `{table:120}`.
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

impl Table {
    /// The same with one column more.
    pub(super) fn with_last_column(mut self, head: &str, cells: impl Iterator<Item = String>) -> Self {
        self.aligns.push(Align::Left);
        let cells = std::iter::once(head.to_owned()).chain(cells);
        self.rows.iter_mut().zip(cells).for_each(|(row, cell)| row.push(cell));
        self
    }

    /// Columns of text that it takes.
    pub(super) fn width(&self) -> usize {
        let widths = self.widths();
        widths.iter().sum::<usize>() + GAP * widths.len().saturating_sub(1)
    }

    fn widths(&self) -> Vec<usize> {
        let width = |k: usize| self.rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
        (0..self.aligns.len()).map(width).collect()
    }

    /// The same in tables of at most `width` columns of text, each with the words that rows begin with.
    fn folded(&self, width: usize) -> Vec<Vec<usize>> {
        let widths = self.widths();
        let keys = self.aligns.iter().take_while(|align| **align == Align::Left).count().min(widths.len());
        let start: Vec<usize> = (0..keys).collect();
        let length = |columns: &[usize]| columns.iter().map(|&k| widths[k] + GAP).sum::<usize>();
        let (mut parts, mut part) = (Vec::new(), start.clone());
        for (column, own) in widths.iter().enumerate().skip(keys) {
            if part.len() > keys && length(&part) + own > width {
                parts.push(std::mem::replace(&mut part, start.clone()));
            }
            part.push(column);
        }
        parts.push(part);
        parts
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let widths = self.widths();
        for (number, columns) in self.folded(super::layout::width(f)).iter().enumerate() {
            if number > 0 {
                writeln!(f)?;
            }
            for row in &self.rows {
                let cell = |&k: &usize| match self.aligns[k] {
                    Align::Left => format!("{:<width$}", row[k], width = widths[k]),
                    Align::Right => format!("{:>width$}", row[k], width = widths[k]),
                };
                let cells: Vec<String> = columns.iter().map(cell).collect();
                writeln!(f, "{}", cells.join(&" ".repeat(GAP)).trim_end())?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_tables_are_folded_and_keep_what_rows_begin_with() {
        let mut table = Table::new(&[("mode", Align::Left), ("mean", Align::Right), ("deviation", Align::Right)]);
        table.row(["re_1", &"1".repeat(20), &"2".repeat(20)]);
        let text = format!("{table:44}");
        assert!(text.lines().all(|line| line.chars().count() <= 44), "{text}");
        assert_eq!(text.lines().filter(|line| line.starts_with("re_1")).count(), 2, "{text}");
        assert_eq!(format!("{table:48}").lines().count(), 2);
    }
}
