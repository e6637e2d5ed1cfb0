//! The model of a study. Every kind is a file: the keys it has, and how it is read, printed and hashed. A new kind is a
//! file here, a variant of [`ModelSettings`] and of [`Kind`], and the lines below that name all kinds.

mod attempts;
mod clutch;
mod command;
mod function;
mod matrices;
mod table;
mod um_bridge;

pub use attempts::Attempts;
pub use command::Command;
pub use function::{Function, FunctionAnswers};
pub use table::Table;
pub use um_bridge::UmBridge;

use super::data::GivenData;
use super::error::{Place, StudyError};
use super::print::{Printer, float};
use super::raw;
use super::validate::Lines;
use crate::mechanics::model::Parameter;
use crate::mechanics::model::command::results_table::check_names;
use crate::mechanics::model::matrices::Description;
use crate::mechanics::spectrum::Target;
use pcc_evaluate::probability::inputs::InputSpace;
use std::path::Path;
use toml::Spanned;

/// Longest name of an input or constant: names are columns of tables.
const LONGEST_NAME: usize = 60;

/// The model and what it is given besides the uncertain inputs.
#[derive(Debug, Clone, PartialEq)]
pub enum ModelSettings {
    /// The built-in clutch.
    Clutch {
        /// Constants that replace nominal values, by name, sorted.
        constants: Vec<(String, f64)>,
    },
    /// Matrices of the user's.
    Matrices(Box<Description>),
    /// A program of the user's.
    Command(Command),
    /// Nothing that pcc runs: answers come in tables.
    Table(Table),
    /// A function of the program that reads the study.
    Function(Function),
    /// A model on a server.
    UmBridge(UmBridge),
}

/// Kinds of models.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Clutch,
    Matrices,
    Command,
    Table,
    Function,
    UmBridge,
}

const KINDS: [(&str, Kind); 6] = [
    ("clutch", Kind::Clutch),
    ("matrices", Kind::Matrices),
    ("command", Kind::Command),
    ("table", Kind::Table),
    ("function", Kind::Function),
    ("um-bridge", Kind::UmBridge),
];

impl Kind {
    /// Whether the kind has a key beside `kind` and `constants`, which all have.
    fn has(self, key: &str) -> bool {
        match self {
            Self::Clutch => false,
            Self::Matrices => matrices::KEYS.contains(&key),
            Self::Command => [&command::KEYS[..], &attempts::KEYS, &table::KEYS].concat().contains(&key),
            Self::Table => table::KEYS.contains(&key),
            Self::Function => function::KEYS.contains(&key),
            Self::UmBridge => [&um_bridge::KEYS[..], &attempts::KEYS, &table::KEYS].concat().contains(&key),
        }
    }

    /// What is expanded by default: for the paper's clutch what the paper expands, else what needs fewer runs.
    pub fn default_target(self) -> Target {
        match self {
            Self::Clutch => Target::Eigenvalues,
            Self::Matrices | Self::Command | Self::Table | Self::Function | Self::UmBridge => Target::Invariants,
        }
    }
}

impl ModelSettings {
    /// Name in study files.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Clutch { .. } => "clutch",
            Self::Matrices(_) => "matrices",
            Self::Command(_) => "command",
            Self::Table(_) => "table",
            Self::Function(_) => "function",
            Self::UmBridge(_) => "um-bridge",
        }
    }

    /// Whether runs that fail are left out of a build instead of ending it.
    pub fn skips_failures(&self) -> bool {
        match self {
            Self::Clutch { .. } | Self::Matrices(_) => false,
            Self::Command(command) => command.answers.skips_failures,
            Self::Table(table) => table.skips_failures,
            Self::Function(function) => function.skips_failures,
            Self::UmBridge(server) => server.answers.skips_failures,
        }
    }

    /// Whether a run is a program's, a server's or an unknown function's, which may take hours. Of matrices pcc
    /// computes the eigenvalues itself, whoever assembles them.
    pub fn is_external(&self) -> bool {
        match self {
            Self::Clutch { .. } | Self::Matrices(_) => false,
            Self::Command(_) | Self::Table(_) | Self::UmBridge(_) => true,
            Self::Function(function) => function.answers == FunctionAnswers::Eigenvalues,
        }
    }

    /// What runs of programs, servers and tables answer.
    pub fn answers(&self) -> Option<&Table> {
        match self {
            Self::Clutch { .. } | Self::Matrices(_) | Self::Function(_) => None,
            Self::Command(command) => Some(&command.answers),
            Self::Table(table) => Some(table),
            Self::UmBridge(server) => Some(&server.answers),
        }
    }

    /// Whether the model knows the derivatives of its state matrix.
    pub fn has_derivatives(&self) -> bool {
        match self {
            Self::Clutch { .. } | Self::Matrices(_) => true,
            Self::Command(_) | Self::Table(_) | Self::UmBridge(_) => false,
            Self::Function(function) => function.answers == FunctionAnswers::Matrices,
        }
    }
}

impl Lines<'_> {
    pub(super) fn kind(&self, word: &Spanned<String>) -> Result<Kind, StudyError> {
        self.word("model.kind", word, &KINDS)
    }

    pub(super) fn model(
        &self,
        kind: Kind,
        mut raw: raw::Model,
        (inputs, data): (&InputSpace, Option<&GivenData>),
        folder: &Path,
    ) -> Result<ModelSettings, StudyError> {
        self.keys_of_kind(kind, &raw)?;
        let constants = self.constants(kind, std::mem::take(&mut raw.constants), inputs)?;
        match kind {
            Kind::Clutch => Ok(ModelSettings::Clutch { constants }),
            Kind::Matrices => self.description(raw, constants, inputs, folder),
            Kind::Command => self.command(raw, constants, folder),
            Kind::Table => {
                let found = data.map(|data| data.runs.eigenvalues);
                Ok(ModelSettings::Table(self.table(&mut raw, constants, found)?))
            }
            Kind::Function => self.function(raw, constants),
            Kind::UmBridge => self.um_bridge(raw, constants, inputs),
        }
    }

    /// Every key that is given belongs to the kind.
    fn keys_of_kind(&self, kind: Kind, raw: &raw::Model) -> Result<(), StudyError> {
        for (key, start) in raw.given() {
            if !kind.has(key) {
                let named = KINDS.iter().filter(|(_, kind)| kind.has(key));
                let kinds: Vec<String> = named.map(|(name, _)| format!("{name:?}")).collect();
                let place = Place { key: format!("model.{key}"), line: self.line(start) };
                return Err(StudyError::KeyOfKind { place, kinds: kinds.join(", ") });
            }
        }
        Ok(())
    }

    /// Checks the name of an input or constant. The clutch has parameters of its own; elsewhere names are columns, keys
    /// and parts of expressions, so they hold nothing that any of these gives a meaning.
    pub(super) fn parameter_of_kind<T>(
        &self,
        kind: Kind,
        table: &str,
        name: &str,
        value: &Spanned<T>,
    ) -> Result<Option<&'static Parameter>, StudyError> {
        if kind == Kind::Clutch {
            return self.parameter(table, name, value).map(Some);
        }
        let is_first = |c: char| c.is_alphabetic() || c == '_';
        let is_name = name.starts_with(is_first) && name.chars().all(|c| is_first(c) || c.is_ascii_digit());
        if matches!(kind, Kind::Command | Kind::Table | Kind::UmBridge) && check_names([&name.to_owned()]).is_err() {
            return Err(StudyError::ReservedName { place: self.place(format!("{table}.{name}"), value) });
        }
        if is_name && name.chars().count() <= LONGEST_NAME {
            return Ok(None);
        }
        let key = format!("{table}.{}", name.escape_debug());
        Err(StudyError::Name { place: self.place(key, value), most: LONGEST_NAME })
    }

    fn constants(
        &self,
        kind: Kind,
        table: raw::Ordered<f64>,
        inputs: &InputSpace,
    ) -> Result<Vec<(String, f64)>, StudyError> {
        let mut constants = Vec::new();
        for (name, value) in table.0 {
            let key = format!("model.constants.{name}");
            let parameter = self.parameter_of_kind(kind, "model.constants", &name, &value)?;
            if inputs.names().any(|input| input == name) {
                return Err(StudyError::ConstantAndInput { place: self.place(key, &value) });
            }
            match parameter {
                Some(parameter) if !parameter.range.contains(*value.get_ref()) => {
                    return Err(self.out_of_range(&key, &value, format!("a number {}", parameter.range.describe())));
                }
                None if !value.get_ref().is_finite() => {
                    return Err(self.out_of_range(&key, &value, "a finite number"));
                }
                _ => constants.push((name, value.into_inner())),
            }
        }
        constants.sort_by(|a, b| a.0.cmp(&b.0));
        Ok(constants)
    }
}

pub(super) fn print(file: &mut Printer, model: &ModelSettings, data: Option<&GivenData>) {
    file.table("model");
    file.line("kind", format!("{:?}", model.kind()), "");
    let constants = match model {
        ModelSettings::Clutch { constants } => constants,
        ModelSettings::Matrices(description) => {
            matrices::print(file, description);
            &description.constants
        }
        ModelSettings::Command(settings) => {
            command::print(file, settings);
            &settings.answers.constants
        }
        ModelSettings::Table(settings) => {
            table::print(file, settings);
            &settings.constants
        }
        ModelSettings::Function(settings) => {
            function::print(file, settings);
            &settings.constants
        }
        ModelSettings::UmBridge(settings) => {
            um_bridge::print(file, settings);
            &settings.answers.constants
        }
    };
    if let Some(data) = data {
        super::data::print(file, data);
    }
    if !constants.is_empty() {
        file.table("model.constants");
    }
    for (name, value) in constants {
        file.line(name, float(*value), unit_of(model, name));
    }
    if let ModelSettings::Matrices(description) = model {
        matrices::print_helpers(file, description);
    }
}

/// The unit of an input or constant, if it is known.
pub(super) fn unit_of(model: &ModelSettings, name: &str) -> &'static str {
    match model {
        ModelSettings::Clutch { .. } => clutch::unit_of(name),
        _ => "",
    }
}

/// The model as text, one fact a line: numbers by their shortest exact decimal, what users wrote as they wrote it.
pub(super) fn identity(model: &ModelSettings, inputs: &InputSpace) -> String {
    let mut text = format!("model {}\n", model.kind());
    match model {
        ModelSettings::Clutch { constants } => clutch::identify(&mut text, constants, inputs),
        ModelSettings::Matrices(description) => matrices::identify(&mut text, description),
        ModelSettings::Command(command) => command::identify(&mut text, command),
        ModelSettings::Table(table) => table::identify(&mut text, table),
        ModelSettings::Function(function) => function::identify(&mut text, function),
        ModelSettings::UmBridge(server) => um_bridge::identify(&mut text, server, inputs),
    }
    text
}

/// A text as TOML writes it.
pub(super) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
