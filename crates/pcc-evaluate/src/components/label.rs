//! Names of eigenvalues.

use std::fmt;

/// Whether a column of results may have this name, so that an input must not.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::components::is_result_column;
/// assert!(["max_re", "stable", "verdict", "re_1", "im_12", "re_3_b", "real_2"].into_iter().all(is_result_column));
/// assert!(["max_re_lower", "im_3_upper"].into_iter().all(is_result_column), "ends of intervals");
/// assert!(!["mu", "re", "re_", "real_x", "re_1_c", "stable_share"].into_iter().any(is_result_column));
/// ```
pub fn is_result_column(name: &str) -> bool {
    let name = name.strip_suffix("_lower").or(name.strip_suffix("_upper")).unwrap_or(name);
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let numbered = |start: &str, end: &str| {
        name.strip_prefix(start).and_then(|rest| rest.strip_suffix(end)).is_some_and(is_number)
    };
    matches!(name, "max_re" | "stable" | "verdict")
        || numbered("re_", "")
        || numbered("im_", "")
        || numbered("re_", "_b")
        || numbered("real_", "")
}

/// The name of one eigenvalue that an output yields.
///
/// A mode is a conjugate pair, or the two real eigenvalues that it becomes where it is overdamped or diverges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Label {
    /// The eigenvalue of a mode with Im λ > 0; of two real ones the larger.
    Mode(usize),
    /// Its conjugate; of two real ones the smaller.
    Second(usize),
    /// A real eigenvalue that belongs to no mode.
    Real(usize),
}

impl Label {
    /// The column of Re λ in results: `re_3`, `re_3_b`, `real_1`.
    ///
    /// # Examples
    ///
    /// ```
    /// use pcc_evaluate::components::Label;
    /// let names = [Label::Mode(3), Label::Second(3), Label::Real(1)].map(Label::growth_rate);
    /// assert_eq!(names, ["re_3", "re_3_b", "real_1"]);
    /// ```
    pub fn growth_rate(self) -> String {
        match self {
            Self::Mode(mode) => format!("re_{mode}"),
            Self::Second(mode) => format!("re_{mode}_b"),
            Self::Real(number) => format!("real_{number}"),
        }
    }

    /// Where its column stands: mode by mode, then the real eigenvalues.
    pub fn column(self) -> (usize, usize) {
        match self {
            Self::Mode(mode) => (mode, 0),
            Self::Second(mode) => (mode, 1),
            Self::Real(number) => (usize::MAX, number),
        }
    }

    /// The number of the mode, if it is that of a mode's first eigenvalue.
    pub fn mode(self) -> Option<usize> {
        match self {
            Self::Mode(mode) => Some(mode),
            Self::Second(_) | Self::Real(_) => None,
        }
    }
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mode(mode) => write!(f, "mode {mode}"),
            Self::Second(mode) => write!(f, "second eigenvalue of mode {mode}"),
            Self::Real(number) => write!(f, "real_{number}"),
        }
    }
}
