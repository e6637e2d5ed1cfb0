//! The architecture as ARCHITECTURE.md tells it: rooms import from rows above their own, crates keep their walls.

use crate::support::{repository, text};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What the evaluator must not pull in: it is deployed where no model is built and nobody types.
const NOT_IN_THE_EVALUATOR: [&str; 10] =
    ["anyhow", "clap", "csv", "httparse", "indicatif", "nalgebra", "pcc-compile", "pcc-expressions", "toml", "ureq"];

/// Packages that the evaluator may pull in, itself included.
const MOST_PACKAGES: usize = 55;

/// A room with its crate's sources: `crates/pcc-evaluate/src` and `evaluation/kernel`, say.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Room {
    sources: String,
    path: String,
}

/// The rooms of all tables under headings that name sources, in the order of the page.
fn rooms() -> Vec<Room> {
    let mut rooms = Vec::new();
    let mut sources = None;
    for line in text("ARCHITECTURE.md").lines() {
        if line.starts_with('#') {
            let name = line.strip_prefix("### `").and_then(|rest| rest.strip_suffix('`'));
            sources = name.map(str::to_owned);
        } else if let (Some(sources), Some(row)) = (&sources, line.strip_prefix("| `")) {
            let path = row.split('`').next().unwrap().to_owned();
            rooms.push(Room { sources: sources.clone(), path });
        }
    }
    rooms
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// Code without comments and without what only tests compile.
fn code(path: &Path) -> String {
    let is_of_tests =
        |part: &std::ffi::OsStr| ["tests.rs", "tests", "test_surrogates.rs"].iter().any(|name| part == *name);
    if path.iter().any(is_of_tests) {
        return String::new();
    }
    let text = fs::read_to_string(path).unwrap();
    let product = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
    product.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

/// Paths of the crate that code names, as `evaluation/kernel/lanes`.
fn imports(code: &str) -> BTreeSet<String> {
    let is_of_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let paths = code.split("crate::").skip(1);
    paths.map(|path| path.split(|c| !is_of_path(c)).next().unwrap().trim_end_matches(':').replace("::", "/")).collect()
}

/// The innermost room that a path, or a file, of the crate lies in.
fn room_of<'r>(rooms: &[&'r Room], path: &str) -> Option<&'r Room> {
    let is_inside = |room: &&&Room| {
        path.strip_prefix(&room.path).is_some_and(|rest| rest.is_empty() || rest.starts_with(['/', '.']))
    };
    rooms.iter().filter(is_inside).max_by_key(|room| room.path.len()).copied()
}

/// For every file in a room: the room, the file, and the rooms that it imports from. A path that leads to a group of
/// rooms stands for all of them.
fn imported_rooms() -> Vec<(Room, PathBuf, Vec<Room>)> {
    let all = rooms();
    let mut found = Vec::new();
    let sources: BTreeSet<&str> = all.iter().map(|room| room.sources.as_str()).collect();
    for sources in sources {
        let rooms: Vec<&Room> = all.iter().filter(|room| room.sources == sources).collect();
        let folder = repository(sources);
        for file in rust_files(&folder) {
            let relative = file.strip_prefix(&folder).unwrap().to_str().unwrap();
            let Some(own) = room_of(&rooms, relative) else { continue };
            let mut targets = Vec::new();
            for path in imports(&code(&file)) {
                match room_of(&rooms, &path) {
                    Some(room) => targets.push(room.clone()),
                    None => {
                        let group = format!("{}/", path.split('/').next().unwrap());
                        targets.extend(
                            rooms.iter().filter(|room| room.path.starts_with(&group)).map(|&room| room.clone()),
                        );
                    }
                }
            }
            found.push((own.clone(), file, targets));
        }
    }
    found
}

#[test]
fn rooms_import_from_rows_above_their_own() {
    let rooms = rooms();
    let row = |room: &Room| rooms.iter().position(|known| known == room).unwrap();
    for (own, file, targets) in imported_rooms() {
        for target in targets {
            assert!(
                row(&target) <= row(&own),
                "{}: {} must not import {}, which is further down in ARCHITECTURE.md",
                file.display(),
                own.path,
                target.path
            );
        }
    }
}

/// Otherwise a new room would be under no rule, and the page would tell of rooms that are gone.
#[test]
fn every_folder_is_a_room_of_the_map_and_every_room_is_there() {
    let rooms = rooms();
    assert!(rooms.len() > 20, "the tables of ARCHITECTURE.md are read: {rooms:?}");
    for room in &rooms {
        let path = repository(&room.sources).join(&room.path);
        assert!(path.is_dir() || path.with_extension("rs").is_file(), "{room:?} is not there");
    }
    for sources in rooms.iter().map(|room| &room.sources).collect::<BTreeSet<_>>() {
        let of_crate: Vec<&Room> = rooms.iter().filter(|room| &room.sources == sources).collect();
        let folder = repository(sources);
        for file in rust_files(&folder) {
            let relative = file.strip_prefix(&folder).unwrap().to_str().unwrap();
            let is_contents = ["lib.rs", "main.rs"].contains(&relative)
                || relative
                    .strip_suffix("/mod.rs")
                    .is_some_and(|group| of_crate.iter().any(|room| room.path.starts_with(&format!("{group}/"))))
                || relative.ends_with("test_surrogates.rs");
            assert!(
                is_contents || room_of(&of_crate, relative).is_some(),
                "{sources}/{relative} is in no room; give it a row in ARCHITECTURE.md"
            );
        }
    }
}

/// Files and folders that the map names, in whichever crate, are there: `study/raw.rs`, `fitting/fit/`.
#[test]
fn every_path_on_the_map_exists() {
    let map = text("ARCHITECTURE.md");
    let mut roots: Vec<PathBuf> = vec![repository("")];
    roots.extend(rooms().iter().map(|room| repository(&room.sources)));
    let (mut checked, quoted) = (0, map.split('`').skip(1).step_by(2));
    for path in quoted.filter(|path| path.contains('/') && !path.contains([' ', ':', '→'])) {
        assert!(
            roots.iter().any(|root| root.join(path).exists() || root.join(format!("{path}.rs")).exists()),
            "{path}"
        );
        checked += 1;
    }
    assert!(checked > 40, "the paths are read: {checked}");
}

/// Paths to other rooms start with `crate::`, where the other tests see them: `super::` stays inside a room.
#[test]
fn rooms_are_not_left_by_super() {
    for (own, file, _) in imported_rooms() {
        let inside = file.strip_prefix(repository(&own.sources).join(&own.path));
        let Ok(inside) = inside else { continue };
        let depth = inside.components().count();
        let is_root = inside.file_stem().is_some_and(|stem| stem == "mod");
        let leaving = "super::".repeat(if is_root { depth } else { depth + 1 });
        assert!(!code(&file).contains(&leaving), "{} leaves its room by {leaving}", file.display());
    }
}

#[test]
fn commands_do_not_know_each_other() {
    let folder = repository("src/cli/commands");
    for file in rust_files(&folder).into_iter().filter(|file| !file.ends_with("mod.rs")) {
        let code = code(&file);
        assert!(!code.contains("cli::commands"), "{} imports a command", file.display());
        assert!(!code.contains("super::"), "{} reaches for its neighbours", file.display());
    }
}

#[test]
fn mathematics_knows_no_study_and_fits_know_no_files() {
    for file in rust_files(&repository("crates/pcc-compile/src/fitting")) {
        let code = code(&file);
        for stranger in ["crate::study", "crate::mechanics", "crate::campaign", "crate::compilation", "::artifact"] {
            assert!(!code.contains(stranger), "{} must not know {stranger}", file.display());
        }
    }
}

/// As cargo knows it: what the evaluator depends on, and what that does.
#[test]
fn the_evaluator_carries_no_model_code() {
    let tree = ["tree", "--offline", "--package", "pcc-evaluate", "--edges", "normal", "--prefix", "none"];
    let output = Command::new(env!("CARGO")).args(tree).current_dir(repository("")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let listed = String::from_utf8(output.stdout).unwrap();
    let packages: BTreeSet<&str> = listed.lines().filter_map(|line| line.split(' ').next()).collect();
    assert!(packages.contains("serde"), "the packages are read: {packages:?}");
    for stranger in NOT_IN_THE_EVALUATOR {
        assert!(!packages.contains(stranger), "pcc-evaluate pulls in {stranger}");
    }
    assert!(packages.len() <= MOST_PACKAGES, "pcc-evaluate pulls in {} packages: {packages:?}", packages.len());
}

#[test]
fn bincode_is_used_in_one_file() {
    let all: Vec<PathBuf> =
        ["crates", "src", "tools"].iter().flat_map(|folder| rust_files(&repository(folder))).collect();
    let using: Vec<_> = all.iter().filter(|file| code(file).contains("bincode::")).collect();
    assert_eq!(using, [&repository("crates/pcc-evaluate/src/artifact/binary.rs")]);
}

/// rustfmt wraps code, not comments.
#[test]
fn comments_end_at_column_120() {
    let folders = ["crates", "src", "tests", "tools", "benches", "examples"];
    for file in folders.iter().flat_map(|folder| rust_files(&repository(folder))) {
        let source = fs::read_to_string(&file).unwrap();
        for (number, line) in (1..).zip(source.lines()) {
            let is_prose = line.trim_start().starts_with("//") && !line.contains(" | ");
            assert!(!is_prose || line.chars().count() <= 120, "{}:{number} is too wide", file.display());
        }
    }
}
