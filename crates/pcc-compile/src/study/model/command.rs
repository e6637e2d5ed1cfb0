//! Models that are programs.

use super::{Attempts, ModelSettings, Table, attempts, quoted, table};
use crate::mechanics::model::command::{CommandModel, CommandSettings, Keep, Mode};
use crate::study::defaults;
use crate::study::error::StudyError;
use crate::study::print::Printer;
use crate::study::raw;
use crate::study::validate::Lines;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// The keys that say how a program is run; what it answers has those of tables.
pub(super) const KEYS: [&str; 5] = ["command", "shell", "mode", "work", "keep"];

/// A program that answers eigenvalues.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    /// The program and its arguments; `{study}` stands for the folder of the study, `{work}` for that of the run.
    pub arguments: Vec<String>,
    /// Whether the one argument is a line for the shell.
    pub shell: bool,
    /// One run per process, or many.
    pub mode: Mode,
    /// What is asked and answered.
    pub answers: Table,
    /// How many processes go on at once, and how long.
    pub attempts: Attempts,
    /// Where the folders of runs are.
    pub work_folder: String,
    /// Which of them are kept.
    pub keep: Keep,
    /// The folder of the study.
    pub study_folder: PathBuf,
}

impl Command {
    /// The program, ready to run at points of these inputs.
    pub(in crate::study) fn program(&self, inputs: &[&str]) -> CommandModel {
        CommandModel::new(CommandSettings {
            command: self.arguments.clone(),
            shell: self.shell,
            mode: self.mode,
            jobs: self.attempts.jobs,
            timeout: self.attempts.limit(),
            retries: self.attempts.retries,
            eigenvalues: self.answers.eigenvalues,
            work_folder: PathBuf::from(&self.work_folder),
            keep: self.keep,
            // Arguments and working folders need it whole, wherever the program is started.
            study_folder: std::path::absolute(&self.study_folder).unwrap_or_else(|_| self.study_folder.clone()),
            inputs: inputs.iter().map(|&name| name.to_owned()).collect(),
            constants: self.answers.constants.clone(),
        })
    }
}

impl Lines<'_> {
    pub(super) fn command(
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
            attempts: self.attempts(&mut raw)?,
            work_folder: work.map_or(defaults::WORK_FOLDER.to_owned(), Spanned::into_inner),
            keep: keep.transpose()?.unwrap_or(Keep::Failed),
            study_folder: folder.to_owned(),
            answers: self.table(&mut raw, constants, None)?,
        }))
    }
}

pub(super) fn print(file: &mut Printer, settings: &Command) {
    let arguments: Vec<String> = settings.arguments.iter().map(|argument| quoted(argument)).collect();
    let meaning = if settings.shell { "a line for the shell" } else { "the program and its arguments; no shell" };
    file.line("command", format!("[{}]", arguments.join(", ")), meaning);
    file.line("shell", settings.shell, "whether command is a line for the shell");
    table::print(file, &settings.answers);
    let (mode, meaning) = match settings.mode {
        Mode::Each => ("each", "a process for each run: params.json in, results.json out; or \"batch\""),
        Mode::Batch => ("batch", "a process for many runs: points.csv in, results.csv out; or \"each\""),
    };
    file.line("mode", format!("{mode:?}"), meaning);
    attempts::print(file, &settings.attempts, "processes", "a process is stopped");
    file.line("work", quoted(&settings.work_folder), "folder for the folders of runs");
    let keep = match settings.keep {
        Keep::Failed => "failed",
        Keep::Always => "always",
        Keep::Never => "never",
    };
    file.line("keep", format!("{keep:?}"), "which of them are kept: \"failed\", \"always\", \"never\"");
}

/// Not how and where it is run, but what.
pub(super) fn identify(text: &mut String, command: &Command) {
    let _ = writeln!(text, "command {:?} {}", command.arguments, command.shell);
    table::identify(text, &command.answers);
}
