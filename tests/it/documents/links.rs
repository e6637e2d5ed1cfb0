//! Links lead somewhere, and every page is in the list of the book.

use super::pages::{self, Page};
use crate::support::repository;
use std::collections::{BTreeMap, BTreeSet};

/// Pages outside `docs/` whose links are followed as well.
const OTHER_PAGES: [&str; 4] = ["ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md", "THIRD-PARTY.md"];

/// Targets of the links in prose, as written. Code has none.
fn targets(page: &Page) -> Vec<String> {
    let prose: Vec<&str> = page.prose().into_iter().map(|(_, line)| line).collect();
    let prose = prose.join("\n");
    let without_code: String = prose.split('`').step_by(2).collect();
    without_code.split("](").skip(1).map(|rest| rest.split(')').next().unwrap().to_owned()).collect()
}

/// Anchors of the headings, as GitHub makes them.
fn anchors(page: &Page) -> BTreeSet<String> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    let mut anchors = BTreeSet::new();
    for (_, line) in page.prose().into_iter().filter(|(_, line)| line.starts_with('#')) {
        let title = line.trim_start_matches('#').trim().to_lowercase();
        let kept = title.chars().filter(|c| c.is_alphanumeric() || matches!(c, '-' | '_' | ' '));
        let anchor: String = kept.map(|c| if c == ' ' { '-' } else { c }).collect();
        let count = counts.entry(anchor.clone()).or_default();
        anchors.insert(if *count == 0 { anchor } else { format!("{anchor}-{count}") });
        *count += 1;
    }
    anchors
}

/// The path that a link leads to from a page, from the root of the repository.
fn resolve(from: &str, to: &str) -> String {
    let mut parts: Vec<&str> = from.split('/').collect();
    parts.pop();
    for part in to.split('/') {
        match part {
            "." => {}
            ".." => assert!(parts.pop().is_some(), "{from}: {to} leaves the repository"),
            _ => parts.push(part),
        }
    }
    parts.join("/")
}

#[test]
fn links_lead_to_files_and_headings_that_exist() {
    let others = OTHER_PAGES.iter().chain(&["docs/SUMMARY.md"]).map(|path| Page::read(path));
    let mut followed = 0;
    for page in pages::all().into_iter().chain(others) {
        for target in targets(&page) {
            if target.starts_with("https://") {
                continue;
            }
            let (file, anchor) = target.split_once('#').map_or((target.as_str(), None), |(file, a)| (file, Some(a)));
            let path = if file.is_empty() { page.path.clone() } else { resolve(&page.path, file) };
            assert!(repository(&path).exists(), "{}: {target} is not there", page.path);
            if let Some(anchor) = anchor {
                assert!(anchors(&Page::read(&path)).contains(anchor), "{}: {target} is no heading", page.path);
            }
            // The website of the book has nothing else.
            let is_inside = path.starts_with("docs/") || !page.path.starts_with("docs/");
            assert!(is_inside, "{}: {target} leads out of docs/; name it without a link", page.path);
            followed += 1;
        }
    }
    assert!(followed > 100, "the links are read: {followed}");
}

#[test]
fn the_list_of_the_book_has_every_page_once() {
    let mut listed: Vec<String> =
        targets(&Page::read("docs/SUMMARY.md")).iter().map(|target| resolve("docs/SUMMARY.md", target)).collect();
    listed.sort();
    assert_eq!(listed, pages::documents());
}

/// The name of a page in the list is its title, so that readers know where they are.
#[test]
fn pages_have_the_titles_of_the_list() {
    for line in Page::read("docs/SUMMARY.md").lines {
        let Some((name, rest)) = line.split_once('[').and_then(|(_, rest)| rest.split_once("](")) else { continue };
        let page = Page::read(&format!("docs/{}", rest.trim_end_matches(')')));
        let title = page.lines[0].strip_prefix("# ").unwrap_or_else(|| panic!("{} has no title", page.path));
        assert_eq!(title, name, "{}", page.path);
    }
}
