//! What was spelled otherwise in earlier versions: it is read as what it is called now, and that is said.
//!
//! Arguments are rewritten before they are parsed, so that options, their help and their rules know one spelling.

use super::commands::Command;
use clap::Subcommand;
use std::ffi::OsString;

/// Options of commands, how they were called, and how they are.
const RENAMED: [(&str, &str, &str); 3] =
    [("certify", "-m", "-n"), ("compare", "--samples", "--runs"), ("reference", "--samples", "--runs")];

/// Options of `eval` whose value was `NAME=FROM:TO:COUNT` and is `NAME=FROM..TO:COUNT`.
const RANGES: [&str; 2] = ["--sweep", "--histogram"];

/// The arguments as they are spelled now, and for each that was not what to say of it. The first is the program's name.
pub(super) fn modern(arguments: impl IntoIterator<Item = OsString>) -> (Vec<OsString>, Vec<String>) {
    let mut arguments: Vec<OsString> = arguments.into_iter().collect();
    let mut remarks = Vec::new();
    let is_command = |name: &str| Command::has_subcommand(name);
    let place = arguments.iter().skip(1).position(|text| text.to_str().is_some_and(is_command));
    let Some(place) = place.map(|place| place + 1) else {
        let has = |names: &[&str]| arguments.iter().any(|text| names.iter().any(|name| text == name));
        if has(&["--version", "-V"]) && has(&["--verbose"]) {
            arguments.retain(|text| text != "--version" && text != "-V");
            arguments.insert(1, "version".into());
        }
        return (arguments, remarks);
    };
    let command = arguments[place].to_string_lossy().into_owned();
    let mut option = String::new();
    for argument in &mut arguments[place + 1..] {
        let Some(text) = argument.to_str().map(str::to_owned) else { continue };
        if text == "--" {
            break;
        }
        let new = renamed(&command, &text).or_else(|| range(&command, &option, &text));
        if let Some((new, remark)) = new {
            *argument = new.into();
            remarks.push(remark);
        }
        option = text;
    }
    (arguments, remarks)
}

/// The option by its name of today, with the value that is written in the same argument.
fn renamed(command: &str, text: &str) -> Option<(String, String)> {
    let (_, old, new) = RENAMED.iter().find(|(of, old, _)| {
        let value = text.strip_prefix(old);
        *of == command
            && value.is_some_and(|value| value.is_empty() || value.starts_with('=') || !old.starts_with("--"))
    })?;
    Some((format!("{new}{}", &text[old.len()..]), format!("{old} is now {new}")))
}

/// A range with two dots, where `option` stands before it or in the same argument.
fn range(command: &str, option: &str, text: &str) -> Option<(String, String)> {
    if command != "eval" {
        return None;
    }
    let value = RANGES.iter().find_map(|name| match text.strip_prefix(name) {
        Some(rest) => rest.strip_prefix('='),
        None => (option == *name).then_some(text),
    })?;
    let (name, numbers) = value.split_once('=')?;
    let [from, to, count] = numbers.split(':').collect::<Vec<_>>()[..] else { return None };
    let new = format!("{name}={from}..{to}:{count}");
    let remark = format!("{value} is now {new}");
    Some((format!("{}{new}", text.strip_suffix(value)?), remark))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> (String, Vec<String>) {
        let (arguments, remarks) = modern(line.split(' ').map(OsString::from));
        let arguments: Vec<_> = arguments.iter().map(|argument| argument.to_string_lossy().into_owned()).collect();
        (arguments.join(" "), remarks)
    }

    #[test]
    fn old_spellings_are_read_as_what_they_are_called_now() {
        for (old, new, remark) in [
            ("pcc certify x.pcc -m 300", "pcc certify x.pcc -n 300", "-m is now -n"),
            ("pcc --threads 2 certify x.pcc -m300", "pcc --threads 2 certify x.pcc -n300", "-m is now -n"),
            ("pcc compare x --samples=20", "pcc compare x --runs=20", "--samples is now --runs"),
            ("pcc reference x --samples 20", "pcc reference x --runs 20", "--samples is now --runs"),
            ("pcc eval x --sweep mu=0:0.2:9", "pcc eval x --sweep mu=0..0.2:9", "mu=0:0.2:9 is now mu=0..0.2:9"),
            ("pcc eval x --sweep=mu=0:0.2:9", "pcc eval x --sweep=mu=0..0.2:9", "mu=0:0.2:9 is now mu=0..0.2:9"),
            (
                "pcc eval x --histogram re_3=-1:1:9",
                "pcc eval x --histogram re_3=-1..1:9",
                "re_3=-1:1:9 is now re_3=-1..1:9",
            ),
        ] {
            assert_eq!(read(old), (new.to_owned(), vec![remark.to_owned()]));
        }
    }

    /// The parser ends at `--version`.
    #[test]
    fn a_verbose_version_is_a_command() {
        for line in ["pcc --version --verbose", "pcc --verbose -V"] {
            assert_eq!(read(line), ("pcc version --verbose".to_owned(), vec![]));
        }
    }

    #[test]
    fn what_is_spelled_as_it_is_now_stays() {
        for line in [
            "pcc",
            "pcc --help",
            "pcc nonsense -m 3",
            "pcc eval x --samples 20",
            "pcc eval x --samples 20 --sweep mu=0..0.2:9",
            "pcc eval x --where mu=0:0.2:9",
            "pcc eval x --histogram --json",
            "pcc certify -- -m",
            "pcc compare x --samples-of-mine 3",
            "pcc reproduce --runs 3",
        ] {
            assert_eq!(read(line), (line.to_owned(), vec![]));
        }
    }
}
