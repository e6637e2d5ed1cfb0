//! The model of a study: which kind, and the settings that belong to it.

use toml::Spanned;

use super::error::StudyError;
use super::settings::{Command, ModelSettings, Table};
use super::validate::Lines;
use super::{defaults, raw};
use crate::mechanics::model::command::results_table::check_names;
use crate::mechanics::model::command::{Keep, Mode};
use crate::mechanics::model::matrices::{Description, Matrices, MatricesError, Role};
use crate::mechanics::model::{CLUTCH_PARAMETERS, Parameter};
use pcc_evaluate::probability::inputs::InputSpace;
use std::path::Path;

/// Longest name of an input or constant: names are columns of tables.
const LONGEST_NAME: usize = 60;

/// More processes at once are a mistake.
const MOST_JOBS: i64 = 10_000;

/// A run answers at most so many eigenvalues: two for each degree of freedom of a large model.
const MOST_EIGENVALUES: i64 = 100_000;

/// Kinds of models.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Clutch,
    Matrices,
    Command,
    Table,
}

const KINDS: [(&str, Kind); 4] =
    [("clutch", Kind::Clutch), ("matrices", Kind::Matrices), ("command", Kind::Command), ("table", Kind::Table)];

impl Lines<'_> {
    pub(super) fn kind(&self, word: &Spanned<String>) -> Result<Kind, StudyError> {
        self.word("model.kind", word, &KINDS)
    }

    pub(super) fn model(
        &self,
        kind: Kind,
        mut raw: raw::Model,
        inputs: &InputSpace,
        folder: &Path,
    ) -> Result<ModelSettings, StudyError> {
        self.keys_of_kind(kind, &raw)?;
        let constants = self.constants(kind, std::mem::take(&mut raw.constants), inputs)?;
        match kind {
            Kind::Clutch => Ok(ModelSettings::Clutch { constants }),
            Kind::Matrices => self.description(raw, constants, inputs, folder),
            Kind::Command => self.command(raw, constants, folder),
            Kind::Table => Ok(ModelSettings::Table(self.table(&mut raw, constants)?)),
        }
    }

    /// Every key that is given belongs to the kind.
    fn keys_of_kind(&self, kind: Kind, raw: &raw::Model) -> Result<(), StudyError> {
        let only = |key: &str, line: Option<usize>, kinds: &[Kind]| match line {
            Some(line) if !kinds.contains(&kind) => {
                let named = KINDS.iter().filter(|(_, kind)| kinds.contains(kind));
                let kinds: Vec<String> = named.map(|(name, _)| format!("\"{name}\"")).collect();
                let place = super::error::Place { key: format!("model.{key}"), line };
                Err(StudyError::KeyOfKind { place, kinds: kinds.join(", ") })
            }
            _ => Ok(()),
        };
        only("let", self.line(&raw.helpers), &[Kind::Matrices])?;
        for (key, value) in [
            ("M", &raw.mass),
            ("C", &raw.damping),
            ("K", &raw.stiffness),
            ("G", &raw.gyroscopic),
            ("N", &raw.circulatory),
            ("A", &raw.state),
        ] {
            only(key, self.line(value), &[Kind::Matrices])?;
        }
        only("command", self.line(&raw.command), &[Kind::Command])?;
        only("shell", self.line(&raw.shell), &[Kind::Command])?;
        only("mode", self.line(&raw.mode), &[Kind::Command])?;
        only("jobs", self.line(&raw.jobs), &[Kind::Command])?;
        only("timeout", self.line(&raw.timeout), &[Kind::Command])?;
        only("retries", self.line(&raw.retries), &[Kind::Command])?;
        only("work", self.line(&raw.work), &[Kind::Command])?;
        only("keep", self.line(&raw.keep), &[Kind::Command])?;
        let answering = [Kind::Command, Kind::Table];
        only("eigenvalues", self.line(&raw.eigenvalues), &answering)?;
        only("on_failure", self.line(&raw.on_failure), &answering)?;
        only("version", self.line(&raw.version), &answering)
    }

    fn line<T>(&self, value: &Option<Spanned<T>>) -> Option<usize> {
        value.as_ref().map(|value| self.place("", value).line)
    }

    /// The parameter of the clutch with this name.
    fn parameter<T>(&self, table: &str, name: &str, value: &Spanned<T>) -> Result<&'static Parameter, StudyError> {
        CLUTCH_PARAMETERS.iter().find(|parameter| parameter.name == name).ok_or_else(|| StudyError::UnknownParameter {
            place: self.place(format!("{table}.{name}"), value),
            known: CLUTCH_PARAMETERS.map(|parameter| parameter.name).join(", "),
        })
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
        if matches!(kind, Kind::Command | Kind::Table) && check_names([&name.to_owned()]).is_err() {
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

    fn description(
        &self,
        raw: raw::Model,
        constants: Vec<(String, f64)>,
        inputs: &InputSpace,
        folder: &Path,
    ) -> Result<ModelSettings, StudyError> {
        let place = self.place("model", &raw.kind);
        let helpers_place = raw.helpers.as_ref().map(|helpers| self.place("model.let", helpers));
        let helpers = raw.helpers.map_or(Vec::new(), |helpers| self.helpers(helpers.into_inner()));
        let values = [raw.mass, raw.damping, raw.stiffness, raw.gyroscopic, raw.circulatory, raw.state];
        let mut matrices = Vec::new();
        let mut places = Vec::new();
        for (role, value) in Role::ALL.into_iter().zip(values) {
            if let Some(value) = value {
                places.push((role.name(), self.place(format!("model.{}", role.name()), &value)));
                matrices.push(self.matrix(role, value, folder)?);
            }
        }
        let description = Description { constants, helpers, matrices };
        // Compiled once here, so that a study that is read is one that runs.
        Matrices::new(&description, &inputs.names().collect::<Vec<_>>()).map_err(|cause| {
            let of_matrix = |name: &str| places.iter().find(|(matrix, _)| *matrix == name).map(|(_, place)| place);
            let found = match cause.matrix() {
                Some(name) => of_matrix(name),
                None if matches!(cause, MatricesError::Name { table: "model.let", .. }) => helpers_place.as_ref(),
                None => None,
            };
            StudyError::Matrices { place: found.unwrap_or(&place).clone(), cause: Box::new(cause) }
        })?;
        Ok(ModelSettings::Matrices(Box::new(description)))
    }

    fn table(&self, raw: &mut raw::Model, constants: Vec<(String, f64)>) -> Result<Table, StudyError> {
        let line = self.place("model.kind", &raw.kind).line;
        let eigenvalues = raw.eigenvalues.take().ok_or(StudyError::MissingKey {
            line,
            key: "eigenvalues",
            meaning: "how many eigenvalues each run answers",
        })?;
        let skips_failures = match raw.on_failure.take() {
            None => false,
            Some(word) => self.word("model.on_failure", &word, &[("stop", false), ("skip", true)])?,
        };
        Ok(Table {
            eigenvalues: self.integer("model.eigenvalues", eigenvalues, 1..=MOST_EIGENVALUES)? as usize,
            constants,
            version: raw.version.take().map_or(defaults::VERSION.to_owned(), Spanned::into_inner),
            skips_failures,
        })
    }

    fn command(
        &self,
        mut raw: raw::Model,
        constants: Vec<(String, f64)>,
        folder: &Path,
    ) -> Result<ModelSettings, StudyError> {
        let line = self.place("model.kind", &raw.kind).line;
        let meaning = "the program and its arguments, like [\"python3\", \"{study}/model.py\"]";
        let command = raw.command.take().ok_or(StudyError::MissingKey { line, key: "command", meaning })?;
        let shell = raw.shell.take().is_some_and(Spanned::into_inner);
        let span = command.span();
        let arguments = match command.into_inner() {
            raw::Command::Arguments(list) => Spanned::new(span, list),
            raw::Command::Line(line) if shell => Spanned::new(span, vec![line]),
            raw::Command::Line(line) => {
                let expected = "a list like [\"python3\", \"{study}/model.py\"]; or add shell = true";
                return Err(self.out_of_range("model.command", &Spanned::new(span, line), expected));
            }
        };
        let has_program = arguments.get_ref().first().is_some_and(|program| !program.is_empty());
        let has_nul = arguments.get_ref().iter().any(|argument| argument.contains('\0'));
        if !has_program || has_nul || (shell && arguments.get_ref().len() != 1) {
            let expected = if shell {
                "one line for the shell, like \"solve params.json > log.txt\""
            } else {
                "a program and its arguments, like [\"python3\", \"{study}/model.py\"], without NUL characters"
            };
            return Err(self.out_of_range("model.command", &arguments, expected));
        }
        let is_beside =
            |argument: &&String| Path::new(argument.as_str()).is_relative() && folder.join(argument).is_file();
        if let Some(argument) = arguments.get_ref().iter().find(is_beside).filter(|_| !shell) {
            let (place, argument) = (self.place("model.command", &arguments), argument.clone());
            return Err(StudyError::FileBesideStudy { place, argument });
        }
        let whole = |key, value: Option<Spanned<i64>>, range, default| {
            value.map_or(Ok(default), |value| self.integer(key, value, range))
        };
        let timeout = match raw.timeout.take() {
            None => None,
            timeout => {
                let expected = "a number of seconds above 0 and at most 1e9";
                let holds = |value| value > 0.0 && value <= 1e9;
                Some(self.number("model.timeout", timeout, 0.0, expected, holds)?)
            }
        };
        let mode = raw
            .mode
            .as_ref()
            .map(|word| self.word("model.mode", word, &[("each", Mode::Each), ("batch", Mode::Batch)]));
        let keeps = [("failed", Keep::Failed), ("always", Keep::Always), ("never", Keep::Never)];
        let keep = raw.keep.as_ref().map(|word| self.word("model.keep", word, &keeps));
        let work = raw.work.take();
        if let Some(work) = work.as_ref().filter(|work| work.get_ref().is_empty() || work.get_ref().contains('\0')) {
            return Err(self.out_of_range("model.work", work, "the name of a folder"));
        }
        Ok(ModelSettings::Command(Command {
            arguments: arguments.into_inner(),
            shell,
            mode: mode.transpose()?.unwrap_or(Mode::Each),
            jobs: whole("model.jobs", raw.jobs.take(), 1..=MOST_JOBS, defaults::JOBS)? as usize,
            timeout,
            retries: whole("model.retries", raw.retries.take(), 0..=1000, 0)? as u32,
            work_folder: work.map_or(defaults::WORK_FOLDER.to_owned(), Spanned::into_inner),
            keep: keep.transpose()?.unwrap_or(Keep::Failed),
            study_folder: folder.to_owned(),
            answers: self.table(&mut raw, constants)?,
        }))
    }
}
