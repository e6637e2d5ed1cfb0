//! The next step, for people at a terminal.

use super::Context;
use super::messages::hint;
use std::io::{self, IsTerminal};
use std::path::Path;

impl Context {
    /// Says which command comes next, with the file that it takes, and what for.
    pub fn hint_at(&self, command: &str, file: &Path, what_for: &str) {
        if is_wanted(self.quiet, self.json, io::stderr().is_terminal()) {
            hint(&step(command, file, what_for));
        }
    }
}

fn is_wanted(quiet: bool, json: bool, is_at_a_terminal: bool) -> bool {
    is_at_a_terminal && !quiet && !json
}

fn step(command: &str, file: &Path, what_for: &str) -> String {
    format!("next, {what_for}:\n  pcc {command} {}", quoted(&file.display().to_string()))
}

/// A file name as a shell takes it.
pub(super) fn quoted(name: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+".contains(c);
    if name.chars().all(is_plain) { name.to_owned() } else { format!("'{}'", name.replace('\'', r"'\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hints_are_for_people_who_look_at_a_terminal() {
        assert!(is_wanted(false, false, true));
        assert!(!is_wanted(true, false, true) && !is_wanted(false, true, true) && !is_wanted(false, false, false));
    }

    #[test]
    fn hints_can_be_typed() {
        assert_eq!(step("eval", Path::new("a b.pcc"), "to sample it"), "next, to sample it:\n  pcc eval 'a b.pcc'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted("runs/belt-1.pcc"), "runs/belt-1.pcc");
    }
}
