//! One point, one process: `params.json` goes in, `results.json` comes out.

use super::error::CommandFailure;
use super::settings::CommandSettings;
use super::{folder, not_numbers, printable, process};
use nalgebra::Complex;
use serde_json::Value;
use std::fs;
use std::io::Read;
use std::path::Path;
use std::sync::atomic::AtomicBool;

const PARAMETERS: &str = "params.json";
const RESULTS: &str = "results.json";

/// Bytes of results that are read: a million eigenvalues.
const LARGEST_RESULTS: u64 = 64 << 20;

/// The eigenvalues at `point`, by a process in `folder`.
pub(super) fn run(
    settings: &CommandSettings,
    point: &[f64],
    folder: &Path,
    interrupted: &AtomicBool,
) -> Result<Vec<Complex<f64>>, CommandFailure> {
    let path = folder.join(PARAMETERS);
    fs::write(&path, parameters(settings, point)).map_err(|error| folder::failure(&path, &error))?;
    process::run(settings, folder, interrupted)?;
    eigenvalues(&read(folder)?, settings.eigenvalues)
}

/// A flat object of inputs and constants, in order. Written by hand, because maps of `serde_json` have an order of
/// their own; numbers by their shortest decimals that read back with the same bits.
fn parameters(settings: &CommandSettings, point: &[f64]) -> String {
    let inputs = settings.inputs.iter().zip(point.iter().copied());
    let constants = settings.constants.iter().map(|(name, value)| (name, *value));
    let members: Vec<String> =
        inputs.chain(constants).map(|(name, value)| format!("  {}: {value:?}", Value::from(name.as_str()))).collect();
    format!("{{\n{}\n}}\n", members.join(",\n"))
}

fn read(folder: &Path) -> Result<Vec<u8>, CommandFailure> {
    let trouble = |error| folder::failure(&folder.join(RESULTS), &error);
    let file = folder::open_results(folder, RESULTS)?;
    let length = file.metadata().map_err(trouble)?.len();
    let mut bytes = Vec::new();
    if length <= LARGEST_RESULTS {
        // One more: something may still be writing.
        file.take(LARGEST_RESULTS + 1).read_to_end(&mut bytes).map_err(trouble)?;
    }
    let length = length.max(bytes.len() as u64);
    if length > LARGEST_RESULTS {
        return Err(CommandFailure::TooLarge { file: RESULTS, length, limit: LARGEST_RESULTS });
    }
    Ok(bytes)
}

fn eigenvalues(bytes: &[u8], expected: usize) -> Result<Vec<Complex<f64>>, CommandFailure> {
    // Some editors and languages start text with a byte order mark.
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    let results: Value = serde_json::from_slice(bytes).map_err(|error| not_json(bytes, &error))?;
    let Some(list) = results.get("eigenvalues").and_then(Value::as_array) else {
        return Err(no_eigenvalues(&results));
    };
    let eigenvalues = list.iter().enumerate().map(|(k, value)| pair(k + 1, value)).collect::<Result<Vec<_>, _>>()?;
    if eigenvalues.len() != expected {
        return Err(CommandFailure::Count { found: eigenvalues.len(), expected });
    }
    Ok(eigenvalues)
}

fn pair(number: usize, value: &Value) -> Result<Complex<f64>, CommandFailure> {
    let parts = value.as_array().map(|parts| parts.iter().map(Value::as_f64).collect::<Vec<_>>());
    let Some([Some(re), Some(im)]) = parts.as_deref() else {
        return Err(CommandFailure::NotAPair {
            number,
            found: printable::line(&value.to_string(), printable::SHOWN_CELL),
        });
    };
    // JSON has no such numbers, but what is built from them must not rely on a reader's mercy.
    if !(re.is_finite() && im.is_finite()) {
        return Err(CommandFailure::NotFinite { cause: format!("eigenvalue {number}") });
    }
    Ok(Complex::new(*re, *im))
}

/// A program that says why it has no eigenvalues is quoted.
fn no_eigenvalues(results: &Value) -> CommandFailure {
    match results.get("error").and_then(Value::as_str) {
        Some(text) if !text.trim().is_empty() && results.get("eigenvalues").is_none_or(Value::is_null) => {
            CommandFailure::Reported { text: printable::line(text.trim(), printable::MESSAGE_LENGTH) }
        }
        _ => CommandFailure::NoEigenvalues,
    }
}

fn not_json(bytes: &[u8], error: &serde_json::Error) -> CommandFailure {
    if bytes.trim_ascii().is_empty() {
        return CommandFailure::NotJson { cause: "it is empty".to_owned() };
    }
    if let Some(word) = not_numbers::bare(&String::from_utf8_lossy(bytes)) {
        return CommandFailure::HoldsNan { word };
    }
    let cause = error.to_string();
    if cause.starts_with("number out of range") {
        return CommandFailure::NotFinite { cause };
    }
    CommandFailure::NotJson { cause }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_wrong_results_is_told_apart() {
        let failure = |text: &str| eigenvalues(text.as_bytes(), 1).unwrap_err();
        assert!(matches!(failure(""), CommandFailure::NotJson { .. }));
        assert!(matches!(failure("eigenvalues"), CommandFailure::NotJson { .. }));
        assert!(matches!(failure(&"[".repeat(100_000)), CommandFailure::NotJson { .. }));
        for text in ["{}", "[]", "3", "null", r#"{"eigenvalues": 3}"#, r#"{"eigenvalues": null, "error": " "}"#] {
            assert_eq!(failure(text), CommandFailure::NoEigenvalues, "{text}");
        }
        for value in ["1", "[1]", "[1, 2, 3]", r#"["1", "2"]"#, "null", "[null, 1]", r#"{"re": 1, "im": 2}"#, "[]"] {
            let text = format!("{{\"eigenvalues\": [{value}]}}");
            assert!(matches!(failure(&text), CommandFailure::NotAPair { number: 1, .. }), "{text}");
        }
        assert!(matches!(failure(r#"{"eigenvalues": [[1e999, 0]]}"#), CommandFailure::NotFinite { .. }));
        assert_eq!(failure(r#"{"eigenvalues": []}"#), CommandFailure::Count { found: 0, expected: 1 });
        assert_eq!(failure(r#"{"error": "a\nb"}"#), CommandFailure::Reported { text: "a\\nb".to_owned() });
    }

    #[test]
    fn whole_numbers_and_other_keys_are_accepted() {
        let text = "\u{feff}{\"error\": \"none\", \"eigenvalues\": [[-1, 18446744073709551616]]}\n";
        assert_eq!(eigenvalues(text.as_bytes(), 1), Ok(vec![Complex::new(-1.0, 2.0_f64.powi(64))]));
    }
}
