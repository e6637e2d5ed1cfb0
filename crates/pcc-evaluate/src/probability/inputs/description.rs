//! How an input is shown: its unit, and words for what it is. Neither changes a number.

use thiserror::Error;

/// Most characters of a unit, and of a label: what fits into the head of a table, and beside an axis.
const LONGEST_UNIT: usize = 40;
const LONGEST_LABEL: usize = 80;

/// Unit and label of an input, as far as they are given.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::probability::inputs::Description;
/// let stiffness = Description::default().with_unit("N/m")?.with_label(" contact stiffness ")?;
/// assert_eq!((stiffness.unit(), stiffness.label()), (Some("N/m"), Some("contact stiffness")));
/// assert!(Description::default().with_unit("N\n/m").is_err());
/// # Ok::<(), pcc_evaluate::probability::inputs::DescriptionError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Description {
    unit: Option<String>,
    label: Option<String>,
}

/// Why a text is no unit or label.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum DescriptionError {
    /// Nothing, or spaces alone.
    #[error("is empty; write a text, or remove the key")]
    Empty,
    /// More than one line, or characters that command a terminal.
    #[error("has control characters, like line breaks and tabs; write it in one line without them")]
    Control,
    /// Too long for tables and axes.
    #[error("has {found} characters; write at most {most}")]
    TooLong {
        /// Characters found.
        found: usize,
        /// Most characters.
        most: usize,
    },
}

impl Description {
    /// The same with this unit. Spaces around it are dropped.
    ///
    /// # Errors
    ///
    /// [`DescriptionError`] if the text is empty, has control characters, or more than 40 characters.
    pub fn with_unit(self, text: &str) -> Result<Self, DescriptionError> {
        Ok(Self { unit: Some(checked(text, LONGEST_UNIT)?), ..self })
    }

    /// The same with this label. Spaces around it are dropped.
    ///
    /// # Errors
    ///
    /// [`DescriptionError`] if the text is empty, has control characters, or more than 80 characters.
    pub fn with_label(self, text: &str) -> Result<Self, DescriptionError> {
        Ok(Self { label: Some(checked(text, LONGEST_LABEL)?), ..self })
    }

    /// The unit of the input's values, like `N/m`.
    pub fn unit(&self) -> Option<&str> {
        self.unit.as_deref()
    }

    /// What the input is, like `contact stiffness`.
    pub fn label(&self) -> Option<&str> {
        self.label.as_deref()
    }

    /// Whether there is neither unit nor label.
    pub fn is_empty(&self) -> bool {
        self.unit.is_none() && self.label.is_none()
    }
}

fn checked(text: &str, most: usize) -> Result<String, DescriptionError> {
    let text = text.trim();
    let found = text.chars().count();
    if found == 0 {
        return Err(DescriptionError::Empty);
    }
    if text.chars().any(char::is_control) {
        return Err(DescriptionError::Control);
    }
    if found > most { Err(DescriptionError::TooLong { found, most }) } else { Ok(text.to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_that_cannot_be_shown_are_refused() {
        let unit = |text: &str| Description::default().with_unit(text).unwrap_err();
        let label = |text: &str| Description::default().with_label(text).unwrap_err();
        assert_eq!([unit(""), label(" \n ")], [DescriptionError::Empty, DescriptionError::Empty]);
        assert_eq!([unit("a\tb"), label("\u{1b}[2Jb")], [DescriptionError::Control, DescriptionError::Control]);
        assert_eq!(unit(&"µ".repeat(41)), DescriptionError::TooLong { found: 41, most: 40 });
        assert_eq!(label(&"µ".repeat(81)), DescriptionError::TooLong { found: 81, most: 80 });
        assert!(Description::default().with_unit(&"µ".repeat(40)).unwrap().with_label(&"µ".repeat(80)).is_ok());
    }
}
