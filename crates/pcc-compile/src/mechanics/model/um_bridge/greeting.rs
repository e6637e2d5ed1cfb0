//! What is asked before the first run: whether the server has the model, and what it takes and answers.

use super::UmBridgeSettings;
use super::error::UmBridgeFailure;
use super::exchange::Server;
use crate::mechanics::model::printable;
use serde_json::{Value, json};

/// The version of the protocol that is spoken.
const PROTOCOL: f64 = 1.0;

/// Names that are listed.
const NAMED: usize = 8;

/// Sizes that are listed.
const LISTED: usize = 8;

/// How many numbers the model takes in each list, once it is known that it fits the study.
pub(super) fn input_sizes(server: &Server, settings: &UmBridgeSettings) -> Result<Vec<usize>, UmBridgeFailure> {
    check_server(&server.get("Info")?, &settings.name)?;
    let support = server.post("ModelInfo", &json!({ "name": settings.name }))?;
    let support =
        support.get("support").ok_or(UmBridgeFailure::Missing { path: "ModelInfo", missing: "\"support\"" })?;
    if support.get("Evaluate").and_then(Value::as_bool) != Some(true) {
        return Err(UmBridgeFailure::NoEvaluate { name: shown(&settings.name) });
    }
    let model = json!({ "name": settings.name, "config": settings.config });
    let inputs = sizes("InputSizes", "list \"inputSizes\"", server.post("InputSizes", &model)?.get("inputSizes"))?;
    let outputs = sizes("OutputSizes", "list \"outputSizes\"", server.post("OutputSizes", &model)?.get("outputSizes"))?;
    let expected = settings.arguments.len();
    if total(&inputs) != expected as u64 {
        let names: Vec<String> = settings.arguments.iter().take(NAMED).map(|argument| shown(&argument.name)).collect();
        let more = if expected > NAMED { ", …" } else { "" };
        let names = names.join(", ") + more;
        return Err(UmBridgeFailure::InputSizes { found: total(&inputs), sizes: listed(&inputs), expected, names });
    }
    if total(&outputs) != 2 * settings.eigenvalues as u64 {
        let eigenvalues = settings.eigenvalues;
        return Err(UmBridgeFailure::OutputSizes { found: total(&outputs), sizes: listed(&outputs), eigenvalues });
    }
    // No size is larger than their sum.
    Ok(inputs.into_iter().map(|size| size as usize).collect())
}

fn check_server(info: &Value, name: &str) -> Result<(), UmBridgeFailure> {
    let missing = |missing| UmBridgeFailure::Missing { path: "Info", missing };
    let version = info.get("protocolVersion").ok_or(missing("\"protocolVersion\""))?;
    if version.as_f64() != Some(PROTOCOL) {
        let found = printable::line(&version.to_string(), printable::SHOWN_CELL);
        return Err(UmBridgeFailure::Version { found });
    }
    let models = info.get("models").and_then(Value::as_array).ok_or(missing("list \"models\""))?;
    let models: Vec<&str> = models.iter().filter_map(Value::as_str).collect();
    if models.contains(&name) {
        return Ok(());
    }
    let known: Vec<String> = models.iter().take(NAMED).map(|name| format!("{:?}", shown(name))).collect();
    let known = match (models.len(), known.join(", ")) {
        (0, _) => "none".to_owned(),
        (count, known) if count > NAMED => format!("{known} and {} more", count - NAMED),
        (_, known) => known,
    };
    Err(UmBridgeFailure::NoModel { name: shown(name), known })
}

fn sizes(path: &'static str, missing: &'static str, list: Option<&Value>) -> Result<Vec<u64>, UmBridgeFailure> {
    let whole = |value: &Value| value.as_u64().or_else(|| value.as_f64().and_then(as_whole));
    let list = list.and_then(Value::as_array).and_then(|list| list.iter().map(whole).collect());
    list.ok_or(UmBridgeFailure::Missing { path, missing })
}

/// Some languages write whole numbers as `3.0`.
fn as_whole(value: f64) -> Option<u64> {
    /// Larger ones are no sizes.
    const MOST: f64 = 1e15;
    ((0.0..MOST).contains(&value) && value.fract() == 0.0).then_some(value as u64)
}

fn total(sizes: &[u64]) -> u64 {
    sizes.iter().fold(0, |sum: u64, &size| sum.saturating_add(size))
}

fn listed(sizes: &[u64]) -> String {
    let shown: Vec<String> = sizes.iter().take(LISTED).map(u64::to_string).collect();
    let more = if sizes.len() > LISTED { ", …" } else { "" };
    format!("[{}{more}]", shown.join(", "))
}

fn shown(name: &str) -> String {
    printable::line(name, printable::SHOWN_CELL)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_whole_numbers() {
        let found = |text: &str| sizes("InputSizes", "list", Some(&serde_json::from_str(text).unwrap()));
        assert_eq!(found("[3, 1.0, 0]"), Ok(vec![3, 1, 0]));
        for text in ["3", "[1.5]", "[-1]", "[\"1\"]", "[null]", "[1e300]", "{}"] {
            assert!(matches!(found(text), Err(UmBridgeFailure::Missing { .. })), "{text}");
        }
        assert!(sizes("InputSizes", "list", None).is_err());
        assert_eq!((total(&[u64::MAX, 2]), listed(&[1; 9])), (u64::MAX, "[1, 1, 1, 1, 1, 1, 1, 1, …]".to_owned()));
    }
}
