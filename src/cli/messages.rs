//! What is said on standard output and standard error, in colour where a terminal shows it and NO_COLOR is not set.

use anstyle::{AnsiColor, Style};
use clap::builder::Styles;
use std::io::{self, Write};

const BOLD: Style = Style::new().bold();
const ERROR: Style = AnsiColor::Red.on_default().bold();
const WARNING: Style = AnsiColor::Yellow.on_default().bold();
const HINT: Style = Style::new().dimmed();

/// What lines with a warning begin with.
const WARNING_MARK: &str = "warning:";

/// Colours of the help and of errors of usage.
pub(super) const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default().bold())
    .placeholder(AnsiColor::Cyan.on_default());

/// A remark on standard error; there is nobody to tell if that fails.
pub(super) fn remark(text: &str) {
    say(if text.starts_with(WARNING_MARK) { WARNING } else { BOLD }, text);
}

/// What went wrong, on standard error.
pub(super) fn complain(text: &str) {
    say(ERROR, text);
}

/// What can be done next, on standard error.
pub(super) fn hint(text: &str) {
    let _ = writeln!(anstream::stderr(), "{HINT}{text}{HINT:#}");
}

fn say(style: Style, text: &str) {
    let _ = writeln!(anstream::stderr(), "{style}pcc:{style:#} {text}");
}

/// Text for programs on standard output, as it is.
pub(super) fn print(text: &str) -> anyhow::Result<()> {
    write_all(&mut io::stdout(), text)
}

/// Text for people on standard output.
pub(super) fn print_report(text: &str) -> anyhow::Result<()> {
    write_all(&mut anstream::stdout(), &with_marked_warnings(text))
}

/// A reader like `head` that has seen enough is no error.
fn write_all(stream: &mut impl Write, text: &str) -> anyhow::Result<()> {
    match stream.write_all(text.as_bytes()).and_then(|()| stream.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => Ok(result?),
    }
}

/// The text with its warnings in their colour.
fn with_marked_warnings(text: &str) -> String {
    let mark = |line: &str| match line.strip_prefix(WARNING_MARK) {
        Some(rest) => format!("{WARNING}{WARNING_MARK}{WARNING:#}{rest}"),
        None => line.to_owned(),
    };
    text.split_inclusive('\n').map(mark).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_with_warnings_are_marked_and_keep_their_words() {
        let text = "answer\n\nwarning: poor\nno warning: here\nwarning: last";
        let marked = with_marked_warnings(text);
        assert_eq!(marked.matches('\u{1b}').count(), 6, "on and off, where on is two codes: {marked:?}");
        assert_eq!(anstream::adapter::strip_str(&marked).to_string(), text);
    }
}
