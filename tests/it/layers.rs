//! The architecture: a module imports from layers above its own, or from its own layer without cycles, and the
//! evaluator carries no model code.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Modules by layer, from those that know no domain to those that face users.
const LAYERS: [&[&str]; 8] = [
    &["numerics", "random", "statistics", "digest", "expression", "parallel", "progress"],
    &["polynomial", "index_set", "input"],
    &["model", "spectrum", "study"],
    &["journal", "design"],
    &["regression", "fit"],
    &["surrogate", "artifact"],
    &["build", "eval", "part", "reference", "reproduce"],
    &["plot", "report", "cli"],
];

/// What the evaluator may import besides its own files: the surrogate, layers 0 and 1, and the part of the spectrum that
/// turns components into eigenvalues.
const EVALUATOR: [&str; 10] = [
    "numerics",
    "random",
    "statistics",
    "digest",
    "progress",
    "polynomial",
    "index_set",
    "input",
    "surrogate",
    "spectrum",
];
const PURE_SPECTRUM: [&str; 9] = [
    "Block",
    "Component",
    "ModeSummary",
    "Output",
    "OutputKind",
    "Summary",
    "damping_ratio",
    "is_equal_frequency",
    "spectral_abscissa",
];

fn layer(module: &str) -> usize {
    LAYERS
        .iter()
        .position(|layer| layer.contains(&module))
        .unwrap_or_else(|| panic!("module {module} belongs to no layer; give it one in tests/layers.rs"))
}

fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

/// Code without comments and without what only tests compile.
fn code(path: &Path) -> String {
    if path.file_name().is_some_and(|name| name == "tests.rs") {
        return String::new();
    }
    let text = fs::read_to_string(path).unwrap();
    let product = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
    product.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

/// For every module, the files of it and what they import from the crate: (module, rest of the path).
fn imports() -> BTreeMap<String, BTreeSet<(String, String)>> {
    let source = crate::support::repository("src");
    let mut files = Vec::new();
    rust_files(&source, &mut files);
    let mut imports: BTreeMap<String, BTreeSet<(String, String)>> = BTreeMap::new();
    for file in files {
        let first = file.strip_prefix(&source).unwrap().components().next().unwrap();
        let module = Path::new(first.as_os_str()).file_stem().unwrap().to_str().unwrap().to_owned();
        if ["lib", "main"].contains(&module.as_str()) {
            continue;
        }
        let found = imports.entry(module.clone()).or_default();
        for path in code(&file).split("crate::").skip(1) {
            let end = path.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(path.len());
            let rest: String = path[end..].chars().take_while(|&c| c != ';' && c != '(').collect();
            if path[..end] != module {
                found.insert((path[..end].to_owned(), rest));
            }
        }
    }
    imports
}

#[test]
fn modules_import_from_layers_above_their_own() {
    for (module, imported) in imports() {
        for (other, _) in imported {
            assert!(layer(&other) <= layer(&module), "{module} must not import {other}, which is a later layer");
        }
    }
}

/// Paths to other modules start with `crate::`, where the other tests see them: `super::` stays inside a module.
#[test]
fn modules_do_not_leave_themselves_by_super() {
    let source = crate::support::repository("src");
    let mut files = Vec::new();
    rust_files(&source, &mut files);
    for file in files {
        let depth = file.strip_prefix(&source).unwrap().components().count();
        let is_root = file.file_stem().is_some_and(|stem| stem == "mod");
        let to_root = if is_root { depth - 1 } else { depth };
        let leaving = "super::".repeat(to_root.max(1));
        assert!(!code(&file).contains(&leaving), "{} reaches the crate's root by {leaving}", file.display());
    }
}

#[test]
fn modules_of_one_layer_have_no_cycles() {
    let imports = imports();
    let reaches = |from: &str, to: &str| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from.to_owned()]);
        while let Some(module) = open.pop() {
            for (other, _) in imports.get(&module).into_iter().flatten() {
                if seen.insert(other.clone()) {
                    open.push(other.clone());
                }
            }
        }
        seen.contains(to)
    };
    for module in imports.keys() {
        assert!(!reaches(module, module), "{module} imports itself by way of others");
    }
}

#[test]
fn the_evaluator_carries_no_model_code() {
    for (module, rest) in &imports()["eval"] {
        assert!(EVALUATOR.contains(&module.as_str()), "eval must not import {module}");
        if module == "spectrum" {
            for name in rest.split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|name| !name.is_empty()) {
                assert!(PURE_SPECTRUM.contains(&name), "eval must not import spectrum::{name}");
            }
        }
    }
}

#[test]
fn fits_and_files_do_not_know_each_other() {
    let imports = imports();
    for (module, forbidden) in [("fit", "artifact"), ("artifact", "fit")] {
        assert!(imports[module].iter().all(|(other, _)| other != forbidden), "{module} must not import {forbidden}");
    }
}

#[test]
fn bincode_is_used_in_one_file() {
    let mut files = Vec::new();
    rust_files(&crate::support::repository("src"), &mut files);
    let using: Vec<_> = files.iter().filter(|file| code(file).contains("bincode::")).collect();
    assert_eq!(using, [&crate::support::repository("src/artifact/binary.rs")]);
}
