//! The form of the documents: short lines, a short README.

use super::pages::{self, Page};

/// More would not be read.
const LONGEST_README: usize = 200;
const WIDEST_PROSE: usize = 100;

#[test]
fn the_readme_is_short() {
    let lines = Page::read("README.md").lines.len();
    assert!(lines <= LONGEST_README, "README.md has {lines} lines; move something to docs/");
}

/// But for tables and code.
#[test]
fn prose_ends_at_column_100() {
    for page in pages::all() {
        for (number, line) in page.prose() {
            let width = line.chars().count();
            assert!(width <= WIDEST_PROSE || line.starts_with('|'), "{}:{number} is {width} wide", page.path);
        }
    }
}

/// Otherwise a block would be under no rule.
#[test]
fn blocks_of_code_name_their_language() {
    const KNOWN: [&str; 8] = ["console", "sh", "toml", "csv", "json", "python", "rust", "text"];
    for page in pages::all() {
        for block in page.blocks() {
            let (path, line) = (&page.path, block.lines.start);
            assert!(KNOWN.contains(&block.language.as_str()), "{path}:{line}: language {:?}", block.language);
        }
    }
}
