//! From the settings to a command of the operating system.
//!
//! Arguments go to the program as they are: no shell sees them. In shell mode the folders are variables of the
//! environment and never a part of the text that the shell reads.

use super::error::CommandFailure;
use super::settings::CommandSettings;
use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::process::Command;

/// The study's folder in the environment of the program.
const STUDY_VARIABLE: &str = "PCC_STUDY_DIR";
/// The run's folder in the environment of the program.
const WORK_VARIABLE: &str = "PCC_WORK_DIR";

/// The command of a run in `folder`, with its environment.
pub(super) fn command(settings: &CommandSettings, folder: &Path) -> Result<Command, CommandFailure> {
    let study = settings.study_folder.as_os_str();
    let mut command = if settings.shell {
        let [text] = settings.command.as_slice() else {
            return Err(CommandFailure::ShellCommand { found: settings.command.len() });
        };
        shell(text)
    } else {
        let mut words = settings.command.iter().map(|word| replace(word, study, folder.as_os_str()));
        let mut command = Command::new(words.next().ok_or(CommandFailure::NoCommand)?);
        command.args(words);
        command
    };
    command.current_dir(folder).env(STUDY_VARIABLE, study).env(WORK_VARIABLE, folder);
    Ok(command)
}

#[cfg(unix)]
fn shell(text: &str) -> Command {
    let variable = |name: &str| OsString::from(format!("${{{name}}}"));
    let mut command = Command::new("sh");
    command.arg("-c").arg(replace(text, &variable(STUDY_VARIABLE), &variable(WORK_VARIABLE)));
    command
}

#[cfg(windows)]
fn shell(text: &str) -> Command {
    use std::os::windows::process::CommandExt;
    let variable = |name: &str| OsString::from(format!("%{name}%"));
    let mut command = Command::new("cmd");
    // As it is: cmd has other rules for quotes than those that arguments are usually quoted by.
    command.arg("/C").raw_arg(replace(text, &variable(STUDY_VARIABLE), &variable(WORK_VARIABLE)));
    command
}

/// `word` with its placeholders replaced, in one pass: a folder may be called `{work}`.
fn replace(word: &str, study: &OsStr, work: &OsStr) -> OsString {
    let mut replaced = OsString::new();
    let mut rest = word;
    while let Some(brace) = rest.find('{') {
        let (before, placeholder) = rest.split_at(brace);
        replaced.push(before);
        let known = [("{study}", study), ("{work}", work)];
        match known.iter().find_map(|(name, folder)| Some((placeholder.strip_prefix(name)?, folder))) {
            Some((after, folder)) => {
                replaced.push(folder);
                rest = after;
            }
            None => {
                replaced.push("{");
                rest = &placeholder[1..];
            }
        }
    }
    replaced.push(rest);
    replaced
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn placeholders_are_replaced_once_and_other_braces_stay() {
        let replaced = |word| replace(word, OsStr::new("/s/{work}"), OsStr::new("/w")).into_string().unwrap();
        assert_eq!(replaced("{study}/a{work}{study}"), "/s/{work}/a/w/s/{work}");
        for word in ["", "{", "{}", "{studyé}", "{{x}", "study}", "{Study}", "${HOME}", "é{"] {
            assert_eq!(replaced(word), word);
        }
        assert_eq!(replaced("{{study}}"), "{/s/{work}}");
    }
}
