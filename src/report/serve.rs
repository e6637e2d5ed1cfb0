//! What a server says when it begins to listen.

use super::layout::{Facts, write_verdict};
use crate::serve::{Models, Offered};
use pcc_evaluate::foundation::plural;
use serde::Serialize;
use std::fmt;
use std::net::SocketAddr;

/// Where a surrogate can be asked, and what.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ServeReport {
    /// The surrogate.
    pub file: String,
    /// Where clients connect to.
    pub url: String,
    /// What all models take, in this order.
    pub inputs: Vec<ServedInput>,
    /// What can be asked.
    pub models: Vec<ServedModel>,
}

/// An input of the models.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ServedInput {
    /// Its name.
    pub name: String,
    /// Its unit, if the study says it.
    pub unit: Option<String>,
}

/// A model.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ServedModel {
    /// Its name in the protocol.
    pub name: &'static str,
    /// How many numbers it answers.
    pub outputs: usize,
    /// Which.
    pub meaning: &'static str,
}

impl ServeReport {
    /// What is said of a surrogate in `file` that is asked at `address`.
    pub(crate) fn new(models: &Models<'_>, file: String, address: SocketAddr) -> Self {
        let input = |input: &pcc_evaluate::probability::inputs::Input| ServedInput {
            name: input.name.clone(),
            unit: input.description.unit().map(str::to_owned),
        };
        let model = |model: Offered| ServedModel {
            name: model.name(),
            outputs: models.output_size(model),
            meaning: model.meaning(),
        };
        Self {
            file,
            url: format!("http://{address}"),
            inputs: models.inputs().inputs().iter().map(input).collect(),
            models: Offered::ALL.map(model).into(),
        }
    }
}

impl fmt::Display for ServeReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_verdict(f, &format!("{} can be asked at {}, until Ctrl-C.", self.file, self.url))?;
        let mut facts = Facts::default();
        for ServedModel { name, outputs, meaning } in &self.models {
            facts.add(name, plural(*outputs, "number"), *meaning);
        }
        let name = |input: &ServedInput| match &input.unit {
            Some(unit) => format!("{} ({unit})", input.name),
            None => input.name.clone(),
        };
        let names: Vec<String> = self.inputs.iter().map(name).collect();
        facts.add("inputs of each", plural(self.inputs.len(), "number"), names.join(", "));
        write!(f, "{facts}")
    }
}
