//! Relative quantities: numbers like 0.1, or texts like "10%".

use super::error::StudyError;
use super::raw;
use super::validate::Lines;
use toml::Spanned;

impl Lines<'_> {
    /// Half the width of an interval relative to its middle: nearly always a slip of the pen from 1 on.
    pub(super) fn spread(&self, input: &str, raw: &Spanned<raw::Relative>) -> Result<f64, StudyError> {
        let key = format!("{input}.spread");
        let spread = self.relative(&key, raw)?;
        if spread > 0.0 && spread < 1.0 {
            return Ok(spread);
        }
        Err(self.no_relative(&key, raw, "above 0 and below 1; 0.1, or \"10%\", is 10 % up and down"))
    }

    /// A standard deviation relative to its mean.
    pub(super) fn variation(&self, input: &str, raw: &Spanned<raw::Relative>) -> Result<f64, StudyError> {
        let key = format!("{input}.cv");
        let cv = self.relative(&key, raw)?;
        if cv > 0.0 && cv.is_finite() {
            return Ok(cv);
        }
        Err(self.no_relative(&key, raw, "above 0; 0.05, or \"5%\", is a standard deviation of 5 % of the mean"))
    }

    /// A relative quantity as a number: `0.1`, or `"10%"`.
    fn relative(&self, key: &str, raw: &Spanned<raw::Relative>) -> Result<f64, StudyError> {
        match raw.get_ref() {
            raw::Relative::Number(number) => Ok(*number),
            raw::Relative::Text(text) => percent(text)
                .ok_or_else(|| self.no_relative(key, raw, "a number like 0.1, or a percentage like \"10%\"")),
        }
    }

    fn no_relative(&self, key: &str, raw: &Spanned<raw::Relative>, expected: &str) -> StudyError {
        let found = match raw.get_ref() {
            raw::Relative::Number(number) => format!("{number:?}"),
            raw::Relative::Text(text) => format!("{text:?}"),
        };
        StudyError::OutOfRange { place: self.place(key, raw), found, expected: expected.to_owned() }
    }
}

/// The number that a text like `10%` says, rounded once: `10%` is the same double as 0.1.
fn percent(text: &str) -> Option<f64> {
    let number = text.trim().strip_suffix('%')?.trim_end();
    let is_plain = number.chars().all(|c| c.is_ascii_digit() || "+-.".contains(c));
    is_plain.then(|| format!("{number}e-2").parse().ok())?
}

#[cfg(test)]
mod tests {
    use crate::study::{Study, StudyError};

    fn study(input: &str) -> Result<Study, StudyError> {
        Study::from_toml(&format!(
            "format = 1\nname = \"s\"\n[model]\nkind = \"matrices\"\nM = [[1]]\nK = [[\"k\"]]\n[inputs]\nk = {{ distribution = \
             \"uniform\", {input} }}\n"
        ))
    }

    fn refusal(input: &str) -> String {
        study(input).unwrap_err().to_string()
    }

    #[test]
    fn percentages_are_the_doubles_that_numbers_are() {
        for (text, number) in [("10%", 0.1), ("5 %", 0.05), (" 0.1% ", 0.001), ("2.5%", 0.025), ("99.9%", 0.999)] {
            let by_text = study(&format!("nominal = 2.0, spread = \"{text}\"")).unwrap();
            assert_eq!(by_text, study(&format!("nominal = 2.0, spread = {number:?}")).unwrap(), "{text}");
        }
    }

    #[test]
    fn spreads_that_are_no_shares_are_refused_with_an_example() {
        for wrong in ["1", "1.0", "10.0", "0.0", "-0.1", "nan", "inf", "\"100%\"", "\"-10%\"", "\"0%\""] {
            let message = refusal(&format!("nominal = 2.0, spread = {wrong}"));
            let expected = "but must be above 0 and below 1; 0.1, or \"10%\", is 10 % up and down";
            assert!(message.starts_with("line 8: inputs.k.spread: is ") && message.ends_with(expected), "{message}");
        }
        for wrong in
            ["\"\"", "\"%\"", "\"10\"", "\"ten%\"", "\"1e1%\"", "\"inf%\"", "\"10,5%\"", "\"10%%\"", "\"+-.%\""]
        {
            let message = refusal(&format!("nominal = 2.0, spread = {wrong}"));
            let expected = "but must be a number like 0.1, or a percentage like \"10%\"";
            assert!(message.starts_with("line 8: inputs.k.spread: is ") && message.ends_with(expected), "{message}");
        }
        let other = refusal("nominal = 2.0, spread = [0.1]");
        assert!(other.contains("like 0.1, or a text in percent like \"10%\""), "{other}");
    }
}
