//! Models on servers that speak UM-Bridge.

use super::{Attempts, ModelSettings, Table, attempts, quoted, table};
use crate::mechanics::model::um_bridge::{Argument, ArgumentValue, UmBridgeModel, UmBridgeSettings, check_url};
use crate::study::error::StudyError;
use crate::study::print::Printer;
use crate::study::raw;
use crate::study::validate::Lines;
use pcc_evaluate::probability::inputs::InputSpace;
use serde_json::Value;
use std::fmt::Write;
use toml::Spanned;

/// The keys that say who is asked what; what it answers has those of tables.
pub(super) const KEYS: [&str; 4] = ["url", "name", "config", "parameters"];

/// A model on a server that answers eigenvalues.
#[derive(Debug, Clone, PartialEq)]
pub struct UmBridge {
    /// Where the server is.
    pub url: String,
    /// Name of the model there.
    pub name: String,
    /// Handed on with every request.
    pub config: toml::Table,
    /// Names of inputs and constants in the order in which the model takes them: each once.
    pub parameters: Vec<String>,
    /// What is asked and answered.
    pub answers: Table,
    /// How many requests go on at once, and how long.
    pub attempts: Attempts,
}

impl UmBridge {
    /// The model, ready to run at points of these inputs.
    pub(in crate::study) fn server(&self, inputs: &[&str]) -> UmBridgeModel {
        let constant = |name: &str| self.answers.constants.iter().find(|(known, _)| known == name);
        let value = |name: &str| match (inputs.iter().position(|known| *known == name), constant(name)) {
            (Some(number), _) => Some(ArgumentValue::Input(number)),
            (None, Some((_, value))) => Some(ArgumentValue::Constant(*value)),
            (None, None) => None,
        };
        let argument = |name: &String| Some(Argument { name: name.clone(), value: value(name)? });
        UmBridgeModel::new(UmBridgeSettings {
            url: self.url.clone(),
            name: self.name.clone(),
            config: json_of_table(&self.config),
            arguments: self.parameters.iter().filter_map(argument).collect(),
            inputs: inputs.len(),
            eigenvalues: self.answers.eigenvalues,
            jobs: self.attempts.jobs,
            timeout: self.attempts.limit(),
            retries: self.attempts.retries,
        })
    }
}

impl Lines<'_> {
    pub(super) fn um_bridge(
        &self,
        mut raw: raw::Model,
        constants: Vec<(String, f64)>,
        inputs: &InputSpace,
    ) -> Result<ModelSettings, StudyError> {
        let line = self.place("model.kind", &raw.kind).line;
        let missing = |key, meaning| StudyError::MissingKey { line, key, meaning };
        let url = raw.url.take().ok_or(missing("url", "where the server is, like \"http://localhost:4242\""))?;
        let name = raw.name.take().ok_or(missing("name", "the name of the model, as the server lists it"))?;
        if let Err(expected) = check_url(url.get_ref()) {
            return Err(self.out_of_range("model.url", &url, expected));
        }
        if name.get_ref().is_empty() {
            return Err(self.out_of_range("model.name", &name, "the name of a model, as the server lists it"));
        }
        let config = raw.config.take();
        let foreign = |config: &Spanned<toml::Table>| {
            let (key, value) = config.get_ref().iter().find(|(_, value)| !is_json(value))?;
            Some((self.place(format!("model.config.{key}"), config), value.to_string()))
        };
        if let Some((place, found)) = config.as_ref().and_then(foreign) {
            let expected = "what JSON has: finite numbers, texts, lists, tables, true and false".to_owned();
            return Err(StudyError::OutOfRange { place, found, expected });
        }
        Ok(ModelSettings::UmBridge(UmBridge {
            url: url.into_inner(),
            name: name.into_inner(),
            config: config.map(Spanned::into_inner).unwrap_or_default(),
            parameters: self.parameters(&mut raw, &constants, inputs)?,
            attempts: self.attempts(&mut raw)?,
            answers: self.table(&mut raw, constants, None)?,
        }))
    }

    /// The order in which the model takes inputs and constants. Inputs alone have one; constants have none.
    fn parameters(
        &self,
        raw: &mut raw::Model,
        constants: &[(String, f64)],
        inputs: &InputSpace,
    ) -> Result<Vec<String>, StudyError> {
        let Some(parameters) = raw.parameters.take() else {
            let line = self.place("model.kind", &raw.kind).line;
            let meaning = "the inputs and constants in the order in which the model takes them, like [\"mu\", \"k_n\"]";
            return match constants.is_empty() {
                true => Ok(inputs.names().map(str::to_owned).collect()),
                false => Err(StudyError::MissingKey { line, key: "parameters", meaning }),
            };
        };
        let mut named = parameters.get_ref().clone();
        let names = inputs.names().chain(constants.iter().map(|(name, _)| name.as_str()));
        let mut all: Vec<&str> = names.collect();
        let every_name =
            format!("each of the names {}, once, in the order in which the model takes them", all.join(", "));
        named.sort();
        all.sort_unstable();
        match named == all {
            true => Ok(parameters.into_inner()),
            false => Err(self.out_of_range("model.parameters", &parameters, every_name)),
        }
    }
}

/// Whether JSON has such values.
fn is_json(value: &toml::Value) -> bool {
    match value {
        toml::Value::Datetime(_) => false,
        toml::Value::Float(number) => number.is_finite(),
        toml::Value::Array(values) => values.iter().all(is_json),
        toml::Value::Table(table) => table.values().all(is_json),
        toml::Value::String(_) | toml::Value::Integer(_) | toml::Value::Boolean(_) => true,
    }
}

/// The same in JSON; what JSON does not have was refused.
fn json_of_table(table: &toml::Table) -> Value {
    Value::Object(table.iter().map(|(key, value)| (key.clone(), json(value))).collect())
}

fn json(value: &toml::Value) -> Value {
    match value {
        toml::Value::String(text) => Value::from(text.as_str()),
        toml::Value::Integer(number) => Value::from(*number),
        toml::Value::Float(number) => Value::from(*number),
        toml::Value::Boolean(flag) => Value::from(*flag),
        toml::Value::Datetime(time) => Value::from(time.to_string()),
        toml::Value::Array(values) => values.iter().map(json).collect(),
        toml::Value::Table(table) => json_of_table(table),
    }
}

pub(super) fn print(file: &mut Printer, settings: &UmBridge) {
    file.line("url", quoted(&settings.url), "of the server");
    file.line("name", quoted(&settings.name), "of the model, as the server lists it");
    if !settings.config.is_empty() {
        file.line("config", toml::Value::Table(settings.config.clone()), "handed on with every request");
    }
    let names: Vec<String> = settings.parameters.iter().map(|name| quoted(name)).collect();
    file.line("parameters", format!("[{}]", names.join(", ")), "in the order in which the model takes them");
    table::print(file, &settings.answers);
    attempts::print(file, &settings.attempts, "requests", "a request is given up");
}

/// Not where it is run, but what. Keys of JSON are sorted.
pub(super) fn identify(text: &mut String, settings: &UmBridge, inputs: &InputSpace) {
    let _ = writeln!(text, "name {:?}", settings.name);
    if !settings.config.is_empty() {
        let _ = writeln!(text, "config {}", json_of_table(&settings.config));
    }
    if !inputs.names().eq(settings.parameters.iter().map(String::as_str)) {
        let _ = writeln!(text, "parameters {:?}", settings.parameters);
    }
    table::identify(text, &settings.answers);
}
