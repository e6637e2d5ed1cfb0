//! `pcc man`

use crate::cli::arguments::commands;
use crate::cli::overwrite::{Output, claim};
use crate::cli::{Context, Ending};
use anyhow::Context as _;
use clap::{Args, Command};
use clap_mangen::Man;
use pcc_evaluate::foundation::save;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc man ~/.local/share/man/man1   where man finds them
  pcc man man1                      into a folder here";

/// What pages of pcc have near their start.
const PAGE: &str = ".TH pcc";

/// Write the manual pages: pcc.1, and one for each command
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Folder for the pages
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let folder = &options.folder;
    std::fs::create_dir_all(folder).with_context(|| format!("folder {} cannot be created", folder.display()))?;
    let pages = pages()?;
    for (name, _) in &pages {
        claim(&folder.join(name), Output::Marked(PAGE), &[])?;
    }
    let mut files = Vec::new();
    for (name, page) in &pages {
        let file = folder.join(name);
        save(&file, page)?;
        files.push(file.display().to_string());
    }
    context.print(&Written { files })?;
    Ok(Ending::Done)
}

/// Names of pages and what is on them: the program's first.
fn pages() -> anyhow::Result<Vec<(String, Vec<u8>)>> {
    let mut program = commands().disable_help_subcommand(true);
    program.build();
    let named = |command: &Command| command.get_display_name().unwrap_or_else(|| command.get_name()).to_owned();
    let pages = std::iter::once(&program).chain(program.get_subcommands());
    pages.map(|command| Ok((format!("{}.1", named(command)), page(command.clone())?))).collect()
}

fn page(command: Command) -> anyhow::Result<Vec<u8>> {
    let mut page = Vec::new();
    let version = format!("pcc {}", env!("CARGO_PKG_VERSION"));
    Man::new(command).source(version).manual("pcc").render(&mut page)?;
    Ok(page)
}

/// Where the pages are.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(in crate::cli) struct Written {
    files: Vec<String>,
}

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.files.iter().try_for_each(|file| writeln!(f, "{file}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page_that_its_name_begins() {
        let pages = pages().unwrap();
        assert_eq!(pages[0].0, "pcc.1");
        assert!(pages.iter().any(|(name, _)| name == "pcc-eval.1") && pages.len() == commands().get_subcommands().count() + 1);
        for (name, page) in pages {
            let text = String::from_utf8(page).unwrap();
            assert!(text.contains(PAGE) && text.contains(".SH DESCRIPTION"), "{name}: {text}");
        }
    }
}
