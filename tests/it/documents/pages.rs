//! The pages, and the blocks of code on them.

use crate::support::{repository, text};
use std::fs;
use std::ops::Range;
use std::path::Path;

/// A page with its lines.
pub struct Page {
    /// Path from the root of the repository: `docs/reference/numbers.md`.
    pub path: String,
    pub lines: Vec<String>,
}

/// A block of code between fences.
pub struct Block {
    pub language: String,
    /// What comments directly above the fence say: `<!-- file: belt.toml -->` is "file: belt.toml".
    pub comments: Vec<String>,
    /// Its lines on the page, without the fences.
    pub lines: Range<usize>,
    /// These lines, each with its end.
    pub text: String,
}

impl Page {
    pub fn read(path: &str) -> Self {
        Self { path: path.to_owned(), lines: text(path).lines().map(str::to_owned).collect() }
    }

    /// All blocks of code that begin at the left margin.
    pub fn blocks(&self) -> Vec<Block> {
        let mut blocks = Vec::new();
        let mut number = 0;
        while number < self.lines.len() {
            if let Some(language) = self.lines[number].strip_prefix("```") {
                let end = (number + 1..self.lines.len()).find(|&end| self.lines[end].starts_with("```"));
                let end = end.unwrap_or_else(|| panic!("{}:{}: the block has no end", self.path, number + 1));
                let lines = number + 1..end;
                let text = self.lines[lines.clone()].iter().map(|line| format!("{line}\n")).collect();
                let comments = self.comments_above(number);
                blocks.push(Block { language: language.to_owned(), comments, lines, text });
                number = end;
            }
            number += 1;
        }
        blocks
    }

    fn comments_above(&self, fence: usize) -> Vec<String> {
        let comment =
            |line: &String| line.strip_prefix("<!-- ").and_then(|rest| rest.strip_suffix(" -->")).map(str::to_owned);
        self.lines[..fence].iter().rev().map_while(comment).collect()
    }

    /// Its lines outside blocks of code, with their numbers from 1.
    pub fn prose(&self) -> Vec<(usize, &str)> {
        let blocks = self.blocks();
        // With the fences.
        let is_code =
            |number: usize| blocks.iter().any(|block| (block.lines.start - 1..=block.lines.end).contains(&number));
        let all = self.lines.iter().enumerate();
        all.filter(|(number, _)| !is_code(*number)).map(|(number, line)| (number + 1, line.as_str())).collect()
    }
}

impl Block {
    /// What a comment says after `key: `.
    pub fn comment(&self, key: &str) -> Option<&str> {
        self.comments.iter().find_map(|comment| comment.strip_prefix(key)?.strip_prefix(": "))
    }
}

/// Paths of the pages in `docs/`, without its list.
pub fn documents() -> Vec<String> {
    let mut found = Vec::new();
    collect(&repository("docs"), "docs", &mut found);
    found.retain(|path| path != "docs/SUMMARY.md");
    found.sort();
    assert!(found.len() > 20, "the pages are found: {found:?}");
    found
}

fn collect(folder: &Path, path: &str, found: &mut Vec<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let path = format!("{path}/{}", entry.file_name().to_str().unwrap());
        if entry.path().is_dir() {
            collect(&entry.path(), &path, found);
        } else if path.ends_with(".md") {
            found.push(path);
        }
    }
}

/// The README and the pages in `docs/`.
pub fn all() -> Vec<Page> {
    let paths = std::iter::once("README.md".to_owned()).chain(documents());
    paths.map(|path| Page::read(&path)).collect()
}
